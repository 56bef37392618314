# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pamr
from mpi4py import MPI

mesh = pamr.Mesh.kuhn_cube(MPI.COMM_WORLD, 8)  # or pamr.Mesh.from_arrays, read, pamr.from_meshio, pamr.from_dolfinx
for turn in range(3):
    r = np.linalg.norm(mesh.points, axis=1)
    mesh.node_fields["T"] = np.tanh(20 * (r - 0.7))  # your solver
    flags = pamr.mark.flags(mesh, pamr.mark.recovered_error(mesh, "T", bulk=0.5), max_cells=100_000)
    mesh = pamr.refine(mesh, flags, balance="auto").mesh  # equal shares of the ranks, few faces between them
mesh.write("loop.hdf")
