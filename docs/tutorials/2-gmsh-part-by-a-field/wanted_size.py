# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the cell field `wanted` into a mesh file: the edge length that the cell should have, in the unit of the mesh.

    wanted_size.py MESH.hdf

Here it is 1 mm at the rim of the hole on top of the plate and grows with the distance from it; a solver would write what its
error estimate asks for.
"""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "r+") as file:
    grid = file["VTKHDF"]
    corners = grid["Points"][:][grid["Connectivity"][:].reshape(-1, 4)]
    x, y, z = corners.mean(axis=1).T
    from_rim = np.hypot(np.hypot(x - 25, y - 20) - 9, z - 10)
    wanted = np.maximum(1, 0.35 * from_rim)
    data = grid.require_group("CellData")
    if "wanted" in data:
        del data["wanted"]
    data["wanted"] = wanted
