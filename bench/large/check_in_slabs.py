#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks a mesh file slab by slab, without any code of PAMR and without ever holding its cells.

Usage: check_in_slabs.py MESH.hdf [REPORT.json]

Every cell is positive; every node is used; every inner face has two sides that name each other and the same three
nodes (the sums of a hash over the sides of lower and of higher cells are equal); the outward areas of the boundary sum
to nothing. Prints counts, volume and areas, and of the report of pamr-refine time, memory and bytes. Exit code 1 when
anything is wrong. Memory: the nodes and some 100 bytes for each of 2,000,000 cells.
"""
import json
import os
import sys

import h5py
import numpy as np

SLAB = 2_000_000
FACES = [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)]
A, B = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9)


def hash_of(*numbers):
    value = np.zeros(len(numbers[0]), np.uint64)
    for number in numbers:
        value = (value ^ number.astype(np.uint64)) * A
        value = (value ^ (value >> np.uint64(29))) * B
        value ^= value >> np.uint64(32)
    return value


class Check:
    def __init__(self, points, n_cells):
        self.points, self.n_cells = points, n_cells
        self.is_used = np.zeros(len(points), bool)
        self.sums = np.zeros(2, np.uint64)  # over the sides of lower cells, of higher ones
        self.inner_sides = self.boundary_faces = self.not_positive = self.out_of_range = 0
        self.volume, self.smallest = 0.0, np.inf
        self.outward, self.area = np.zeros(3), {}

    def add(self, first, cells, neighbors):
        if cells.min() < 0 or cells.max() >= len(self.points) or neighbors.max() >= self.n_cells:
            self.out_of_range += 1
            return
        self.is_used[cells.ravel()] = True
        p = self.points[cells]
        volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
        self.volume += volume.sum()
        self.smallest = min(self.smallest, volume.min())
        self.not_positive += int((volume <= 0).sum())
        here = np.arange(first, first + len(cells))
        for slot in range(4):
            self.add_sides(here, cells[:, FACES[slot]], cells[:, slot], neighbors[:, slot])

    def add_sides(self, here, corners, opposite, other):
        inner = other >= 0
        nodes = np.sort(corners[inner], axis=1)
        low, high = np.minimum(here, other)[inner], np.maximum(here, other)[inner]
        value = hash_of(nodes[:, 0], nodes[:, 1], nodes[:, 2], low, high)
        is_lower = here[inner] == low
        self.sums += np.array([value[is_lower].sum(dtype=np.uint64), value[~is_lower].sum(dtype=np.uint64)])
        self.inner_sides += int(inner.sum())
        outer = ~inner
        self.boundary_faces += int(outer.sum())
        p, q = self.points[corners[outer]], self.points[opposite[outer]]
        area = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) / 2
        area *= np.sign(np.einsum("ij,ij->i", area, p[:, 0] - q))[:, None]
        self.outward += area.sum(axis=0)
        size = np.linalg.norm(area, axis=1)
        for patch in np.unique(other[outer]):
            self.area[int(patch)] = self.area.get(int(patch), 0) + size[other[outer] == patch].sum()

    def findings(self):
        total = sum(self.area.values())
        return [what for what, is_wrong in (
            ("numbers out of range", self.out_of_range > 0), (f"{self.not_positive} cells not positive", self.not_positive > 0),
            ("nodes of no cell", not self.is_used.all()),
            ("inner faces whose sides do not agree", self.sums[0] != self.sums[1] or self.inner_sides % 2 != 0),
            ("a boundary that is not closed", np.abs(self.outward).max() > 1e-9 * total)) if is_wrong]


def print_report(path, mesh):
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    cells = report["cells_out"]
    print(f"{report['cells_in']} cells, {report['marked']} marked, to {cells} cells, {report['nodes_out']} nodes on "
          f"{report['ranks']} ranks; file {os.path.getsize(mesh) / 1e9:.2f} GB")
    print(f"{report['seconds']['total']['max']:.0f} s, CPU {report['cpu_seconds']['total']['max']:.0f} s on the slowest rank; memory of all "
          f"{report['peak_rss_bytes_sum'] / 1e9:.2f} GB, {report['peak_rss_bytes_sum'] / cells:.1f} bytes a cell")
    print("seconds: " + ", ".join(f"{step} {value['max']:.1f}" for step, value in report["seconds"].items()))


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    if len(sys.argv) == 3:
        print_report(sys.argv[2], sys.argv[1])
    with h5py.File(sys.argv[1]) as file:
        neighbors, nodes = file["PAMR/cell_to_cell"], file["VTKHDF/Connectivity"]
        check = Check(file["VTKHDF/Points"][:], len(neighbors))
        for first in range(0, len(neighbors), SLAB):
            end = min(first + SLAB, len(neighbors))
            check.add(first, nodes[4 * first:4 * end].reshape(-1, 4), neighbors[first:end])
    print(f"{check.n_cells} cells, {len(check.points)} nodes, {check.inner_sides // 2} inner and {check.boundary_faces} "
          f"boundary faces; volume {check.volume:.12g}, smallest cell {check.smallest:.3g}")
    print("areas of the patches: " + ", ".join(f"{area:.9g}" for _, area in sorted(check.area.items(), reverse=True)))
    findings = check.findings()
    print("; ".join(findings) if findings else "nothing is wrong")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
