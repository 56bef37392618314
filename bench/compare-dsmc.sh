#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Speed of pamr-dsmc's solver beside dsmcFoam (Debian's package openfoam) on the same tetrahedra, density, weight and time
# step, one after the other in one run: nitrogen with rotation in a box of mirrors (dsmc_bench.cpp says how).
#
#   bench/compare-dsmc.sh BUILD_FOLDER [CUBES [STEPS]]     (default 11 cubes along an edge, 50 steps)
#
# OPENFOAM=FOLDER names a folder into which the packages openfoam and libopenfoam were unpacked (dpkg -x); otherwise
# dsmcFoam is looked for in PATH. Exit code 1 if dsmcFoam is faster. Processor time of dsmcFoam: its whole run of STEPS steps less a run of one step.
set -euo pipefail
python=${PAMR_PYTHON:-python3}
build=${1:?compare-dsmc.sh: expected the build folder}
cubes=${2:-11} steps=${3:-50}
if [ -n "${OPENFOAM:-}" ]; then
  PATH=$OPENFOAM/usr/bin:$PATH
  LD_LIBRARY_PATH=$(find "$OPENFOAM" -name 'lib*.so*' -printf '%h\n' | sort -u | paste -sd:)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
  export LD_LIBRARY_PATH WM_PROJECT_DIR=$OPENFOAM/usr/share/openfoam
fi
export WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam}

ours=$("$build/bench/bench_dsmc" "$cubes" "$steps")
echo "$ours"
read -r density dt weight < <(sed -n 's/^case: density \(.*\) 1\/m3, step \(.*\) s, weight \(.*\)$/\1 \2 \3/p' <<<"$ours")
rate=$(sed -n 's/.*: \([0-9.]*\) M particle-steps.*/\1/p' <<<"$ours")
if ! command -v dsmcFoam >/dev/null; then
  echo "dsmcFoam: not installed (Debian: openfoam); no comparison"
  exit 0
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$build/bin/pamr-mesh" --shape kuhn-cube --n "$cubes" -o "$folder/box.hdf" --quiet
"$python" - "$folder" "$density" "$weight" <<'PY'
import pathlib, sys
import h5py
import numpy as np

folder, density, weight = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
with h5py.File(folder / "box.hdf") as file:
    points = file["VTKHDF/Points"][:]
    cells = file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    link = file["PAMR/cell_to_cell"][:]
face_nodes = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # normals point out of the cell
cell, slot = np.meshgrid(np.arange(len(cells)), np.arange(4), indexing="ij")
cell, slot, other = cell.ravel(), slot.ravel(), link.ravel()
inner = np.flatnonzero(other > cell)
inner = inner[np.lexsort((other[inner], cell[inner]))]
outer = np.flatnonzero(other < 0)
order = np.concatenate([inner, outer])
faces = cells[cell[order, None], face_nodes[slot[order]]]


def foam(path, kind, name, body):
    path = folder / path
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n{body}\n")


def rows(values):
    return f"{len(values)}\n(\n" + "\n".join(values) + "\n)"


mesh = "constant/polyMesh/"
foam(mesh + "points", "vectorField", "points", rows([f"({x!r} {y!r} {z!r})" for x, y, z in points.tolist()]))
foam(mesh + "faces", "faceList", "faces", rows([f"3({a} {b} {c})" for a, b, c in faces.tolist()]))
foam(mesh + "owner", "labelList", "owner", rows([str(c) for c in cell[order].tolist()]))
foam(mesh + "neighbour", "labelList", "neighbour", rows([str(c) for c in other[inner].tolist()]))
foam(mesh + "boundary", "polyBoundaryMesh", "boundary",
     f"1 ( walls {{ type wall; nFaces {len(outer)}; startFace {len(inner)}; }} )")
zero = "0 0 0"
for name, dimensions, vector, patch in (
        ("boundaryT", "0 0 0 1 0 0 0", 0, "calculated"), ("boundaryU", "0 1 -1 0 0 0 0", 1, "calculated"),
        ("q", "1 0 -3 0 0 0 0", 0, "calculated"), ("fD", "1 -1 -2 0 0 0 0", 1, "calculated"),
        ("rhoN", "0 -3 0 0 0 0 0", 0, "calculated"), ("rhoM", "1 -3 0 0 0 0 0", 0, "calculated"),
        ("dsmcRhoN", "0 -3 0 0 0 0 0", 0, "calculated"), ("linearKE", "1 -1 -2 0 0 0 0", 0, "calculated"),
        ("internalE", "1 -1 -2 0 0 0 0", 0, "calculated"), ("iDof", "0 -3 0 0 0 0 0", 0, "calculated"),
        ("momentum", "1 -2 -1 0 0 0 0", 1, "calculated")):
    value = f"uniform ({zero})" if vector else "uniform 0"
    foam(f"0/{name}", "volVectorField" if vector else "volScalarField", name,
         f"dimensions [{dimensions}];\ninternalField {value};\n"
         f"boundaryField {{ walls {{ type {patch}; value {value}; }} }}")
foam("constant/dsmcProperties", "dictionary", "dsmcProperties", f"""
nEquivalentParticles {weight};
WallInteractionModel SpecularReflection;
BinaryCollisionModel LarsenBorgnakkeVariableHardSphere;
LarsenBorgnakkeVariableHardSphereCoeffs {{ Tref 273; relaxationCollisionNumber 5.0; }}
InflowBoundaryModel none;
typeIdList (N2);
moleculeProperties {{ N2 {{ mass 46.5e-27; diameter 4.17e-10; internalDegreesOfFreedom 2; omega 0.74; }} }}""")
foam("system/dsmcInitialiseDict", "dictionary", "dsmcInitialiseDict",
     f"numberDensities {{ N2 {density}; }}\ntemperature 300;\nvelocity (0 0 0);")
foam("system/fvSchemes", "dictionary", "fvSchemes", """ddtSchemes { default Euler; } gradSchemes { default Gauss linear; }
divSchemes { default none; } laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; } snGradSchemes { default corrected; }""")
foam("system/fvSolution", "dictionary", "fvSolution", "")
PY
control() { # STEPS: the run as far as that
  cat >"$folder/system/controlDict" <<TEXT
FoamFile { version 2.0; format ascii; class dictionary; object controlDict; }
application dsmcFoam; startFrom startTime; startTime 0; stopAt endTime; deltaT $dt;
endTime $("$python" -c "print(repr($dt * $1))"); writeControl timeStep; writeInterval 1000000; writeFormat binary;
writePrecision 10; timePrecision 12; runTimeModifiable no; functions {}
TEXT
}
cpu() { # COMMAND...: user and system seconds of it
  "$python" -c 'import resource, subprocess, sys
done = subprocess.run(sys.argv[2:], stdout=open(sys.argv[1], "w"), stderr=subprocess.STDOUT)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
sys.exit(done.returncode)' "$folder/log" "$@" || { tail -20 "$folder/log" >&2; return 1; }
}
control 1
cpu dsmcInitialise -case "$folder" >/dev/null
short=$(cpu dsmcFoam -case "$folder")
control $((steps + 1))
long=$(cpu dsmcFoam -case "$folder")
grep -E 'Number of dsmc particles|Collisions' "$folder/log" | tail -2
"$python" - "$rate" "$short" "$long" "$steps" "$(sed -n 's/.*Number of dsmc particles *= *//p' "$folder/log" | tail -1)" <<'PY'
import sys
ours, short, long, steps, particles = map(float, sys.argv[1:])
theirs = particles * steps / (long - short) * 1e-6
print(f"dsmcFoam: {theirs:.2f} M particle-steps per CPU second; pamr-dsmc: {ours:.2f} M; ratio {ours / theirs:.1f}")
sys.exit(0 if ours >= theirs else "compare-dsmc.sh: expected pamr-dsmc to be as fast as dsmcFoam")
PY
