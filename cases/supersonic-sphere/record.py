#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The flow on one mesh as fields on another mesh, so that meshes of different quality controls are marked by one flow.

    record.py number MESH              gives every cell of level 0 its number as the field root, which children inherit
    record.py sample FLOW MESH OUT     copies MESH to OUT with the fields lambda, n and n_stderr of FLOW: of the cell of FLOW
                                       whose centroid is nearest, among those in the same cell of level 0
"""
import shutil
import sys

import h5py
import numpy as np

FIELDS = ("lambda", "n", "n_stderr")


def put(file, name, values):
    """Writes a cell field in place of one of this name; its checksum, which would be older than the values, goes."""
    data = file["VTKHDF/CellData"]
    if name in data:
        del data[name]
        file["PAMR/checksums"].attrs.pop(f"VTKHDF/CellData/{name}", None)
    data[name] = values


def centroids(file):
    return file["VTKHDF/Points"][...][file["VTKHDF/Connectivity"][...].reshape(-1, 4)].mean(axis=1)


def nearest(root_from, at_from, root_to, at_to):
    """For each point of the second set the nearest of the first with the same root; of equally near ones the first."""
    order = np.argsort(root_from, kind="stable")
    begin = np.searchsorted(root_from[order], np.arange(root_from.max() + 2))
    result = np.empty(len(root_to), np.int64)
    by_root = np.argsort(root_to, kind="stable")
    for group in np.split(by_root, np.flatnonzero(np.diff(root_to[by_root])) + 1):
        candidates = order[begin[root_to[group[0]]]:begin[root_to[group[0]] + 1]]
        for some in np.array_split(group, len(group) * len(candidates) // 1_000_000 + 1):
            distance = ((at_to[some][:, None] - at_from[candidates][None]) ** 2).sum(axis=2)
            result[some] = candidates[distance.argmin(axis=1)]
    return result


def number(mesh):
    with h5py.File(mesh, "a") as file:
        put(file, "root", np.arange(file["VTKHDF/NumberOfCells"][0], dtype=np.int64))


def sample(flow, mesh, out):
    shutil.copyfile(mesh, out)
    with h5py.File(flow) as source, h5py.File(out, "a") as target:
        to = target["VTKHDF/CellData/root"][...]
        rows = nearest(source["VTKHDF/CellData/root"][...], centroids(source), to, centroids(target))
        for name in FIELDS:
            put(target, name, source[f"VTKHDF/CellData/{name}"][...][rows])


if __name__ == "__main__":
    {"number": number, "sample": sample}[sys.argv[1]](*sys.argv[2:])
