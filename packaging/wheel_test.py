# SPDX-License-Identifier: GPL-3.0-or-later
"""The installed wheel: meshes with the fingerprints of the tools' meshes, and the program of README.md.

    mpirun -n 3 python wheel_test.py SOURCES
"""
import csv
import pathlib
import re
import sys

import numpy as np
import pamr
from mpi4py import MPI

ROOT = pathlib.Path(sys.argv[1])
EXPECTED = {row["mesh"]: (int(row["cells"]), row["fingerprint"]) for row in csv.DictReader((ROOT / "tests/tools/fingerprints.csv").open())}
assert ROOT not in pathlib.Path(pamr.__file__).parents, f"expected the installed package, found {pamr.__file__}"


def check(name, mesh):
    found = (MPI.COMM_WORLD.allreduce(len(mesh.cells)), f"{mesh.fingerprint():016x}")
    assert EXPECTED[name] == found, (name, EXPECTED[name], found)


# As tests/tools/fingerprints_test.py makes them with the tools.
for name, policy in (("wedge", "short-edge"), ("hole", "none")):
    mesh = pamr.Mesh.read(MPI.COMM_WORLD, ROOT / f"tests/unit/refine/meshes/{name}.msh")
    check(f"{name} 0", mesh)
    for level in (1, 2):
        flags = pamr.mark.flags(mesh, pamr.mark.centroid_shell(mesh, (0, 0, 0), 1, 0.1))
        mesh = pamr.refine(mesh, flags, quality_control=policy).mesh
        check(f"{name} {level}", mesh)

program = re.search(r"```python\n(import numpy as np\n.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)[1]
exec(compile(program, "README.md", "exec"))
again = pamr.Mesh.read(MPI.COMM_WORLD, "loop.hdf")
numbers = MPI.COMM_WORLD.gather(again.fingerprint())
if MPI.COMM_WORLD.rank == 0:
    marker = pathlib.Path("fingerprint_of_readme.txt")
    expected = marker.read_text() if marker.exists() else f"{numbers[0]:016x}"
    marker.write_text(expected)
    assert {f"{number:016x}" for number in numbers} == {expected}, (expected, numbers)
    print(f"pamr {pamr.__version__} on {len(numbers)} ranks: the fingerprints of the tools; README's program gives {expected}")
