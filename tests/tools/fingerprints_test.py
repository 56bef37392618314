#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes on every machine are those of fingerprints.csv: made, converted, marked, refined and coarsened by the tools. The fingerprint
is of the content, since the same content may be other bytes under another version of HDF5.

Where a change is to give other meshes, it says what it found, as lines of the table.
"""
import csv
import itertools
import pathlib

from tool_run import prepare_alone, run, run_tests

prepare_alone("pamr-convert", "pamr-mark", "pamr-mesh", "pamr-quality")
HERE = pathlib.Path(__file__).parent
MESHES = HERE.parent / "unit/refine/meshes"
EXPECTED = {row["mesh"]: (int(row["cells"]), row["fingerprint"]) for row in csv.DictReader((HERE / "fingerprints.csv").open())}


def expect(found):
    """found: name of each mesh and its file, of which all are looked at before one is refused."""
    measured = {}
    for name, file in found:
        report = run("pamr-quality", file, "--json", "-", "--quiet").json
        measured[name] = (report["cells"], report["fingerprint"])
    wrong = {name: values for name, values in measured.items() if EXPECTED.get(name) != values}
    assert not wrong, "expected other meshes, found\n" + "\n".join(f"{name},{n},{text}" for name, (n, text) in wrong.items())


def refined(mesh, *criteria, policy="removable"):
    """Marked by these criteria and refined (or coarsened)."""
    run("pamr-mark", mesh, "-o", "marked.hdf", *criteria, "--force", "--quiet")
    name = f"{pathlib.Path(mesh).stem}+.hdf"
    run("pamr-refine", "marked.hdf", "-o", name, "--quality-control", policy, "--quiet")
    return name


def levels(name, mesh, steps, **options):
    """Name and file of the mesh and of what each step makes of the one before."""
    yield f"{name} 0", mesh
    for i, criteria in enumerate(steps, 1):
        mesh = refined(mesh, *criteria, **options)
        yield f"{name} {i}", mesh


def test_a_cube_behind_a_front_that_moves_and_coarsened_at_last():
    run("pamr-mesh", "--shape", "kuhn-cube", "--n", 3, "-o", "cube.hdf", "--quiet")
    front = [["--crossing-sphere", f"{x},0,0,0.6", "--coarsen-rest"] for x in (0, 0.1, 0.4)]
    expect(levels("cube", "cube.hdf", front + [["--crossing-sphere", "9,9,9,0.1", "--coarsen-rest"]] * 3))


def test_cells_of_other_shapes_with_closures_that_stay_and_through_other_formats():
    meshes = []
    for name, policy in (("wedge", "short-edge"), ("hole", "none")):
        run("pamr-convert", MESHES / f"{name}.msh", f"{name}.hdf", "--quiet")
        meshes += levels(name, f"{name}.hdf", [["--centroid-shell", "0,0,0,1,0.1"]] * 2, policy=policy)
    for ending in ("msh", "vtu", "mesh", "su2"):
        run("pamr-convert", "wedge+.hdf", f"wedge.{ending}", "--quiet")
        run("pamr-convert", f"wedge.{ending}", f"wedge_{ending}.hdf", "--quiet")
        meshes.append((f"wedge of {ending}", f"wedge_{ending}.hdf"))
    expect(meshes)


def test_a_ball_whose_new_nodes_are_placed_on_its_sphere():
    nodes = [(0, 0, 0)] + [tuple(s if i == axis else 0 for i in range(3)) for axis in range(3) for s in (1, -1)]
    octants = [(1 + i, 3 + j, 5 + k) for i, j, k in itertools.product((0, 1), repeat=3)]
    triangles = [t if sum(n % 2 == 0 for n in t) % 2 == 0 else t[::-1] for t in octants]
    elements = [f"2 2 1 1 {' '.join(str(n + 1) for n in t)}" for t in triangles]
    elements += [f"4 2 2 2 1 {' '.join(str(n + 1) for n in t)}" for t in triangles]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '2 1 "ball"', '3 2 "inside"', "$EndPhysicalNames",
             "$Nodes", str(len(nodes)), *(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(nodes, 1)), "$EndNodes", "$Elements",
             str(len(elements)), *(f"{i} {text}" for i, text in enumerate(elements, 1)), "$EndElements", ""]
    pathlib.Path("ball.msh").write_text("\n".join(lines))
    pathlib.Path("ball.toml").write_text('[[surface]]\nname = "ball"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = 1\n')
    run("pamr-convert", "ball.msh", "ball.hdf", "--surfaces", "ball.toml", "--quiet")
    steps = [["--all"], ["--all"], ["--patch", "ball"], ["--crossing-sphere", "1,0,0,0.5", "--coarsen-rest"]]
    expect(levels("ball", "ball.hdf", steps))


run_tests(globals())
