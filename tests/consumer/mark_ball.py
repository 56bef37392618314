# SPDX-License-Identifier: GPL-3.0-or-later
import subprocess

import h5py
import numpy

for turn in range(3):
    with h5py.File(f"level{turn}.hdf", "r+") as file:
        grid = file["VTKHDF"]
        cells = grid["Connectivity"][:].reshape(-1, 4)
        centroids = grid["Points"][:][cells].mean(axis=1)
        marks = numpy.linalg.norm(centroids, axis=1) < 0.5
        data = grid.require_group("CellData")
        data.require_dataset("refine", marks.shape, "i4")[:] = marks  # 0 keep, 1 split
    subprocess.run(["mpirun", "-n", "2", "pamr-refine", "--force",
                    f"level{turn}.hdf", "-o", f"level{turn + 1}.hdf"], check=True)
