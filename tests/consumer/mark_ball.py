# SPDX-License-Identifier: GPL-3.0-or-later
import h5py
import numpy

with h5py.File("cube.hdf", "r+") as file:
    grid = file["VTKHDF"]
    cells = grid["Connectivity"][:].reshape(-1, 4)
    centroids = grid["Points"][:][cells].mean(axis=1)
    marks = numpy.linalg.norm(centroids, axis=1) < 0.5
    grid.require_group("CellData")["refine"] = marks.astype("i4")  # 0 keep, 1 split
