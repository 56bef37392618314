# SPDX-License-Identifier: GPL-3.0-or-later
"""Mmg by mmgpy: remeshing to a size field, which wants edges half as long at the corners of the marked cells.

Another way to the same end: nodes move, cells are not nested, no field is carried; so there is no ratio of rates.
"""

import itertools

import mmgpy
import numpy as np

import workload


class Mmg:
    """A mesh is remeshed in place."""

    name = f"Mmg {mmgpy.MMG_VERSION} (mmgpy {mmgpy.__version__})"
    relate = None

    def start(self, cells, nodes):
        return mmgpy.MmgMesh3D(
            np.ascontiguousarray(nodes, dtype=np.float64), np.ascontiguousarray(cells, dtype=np.int32)
        )

    def mark(self, mesh, flags):
        nodes, cells = mesh.get_vertices(), mesh.get_tetrahedra()
        total, count = np.zeros(len(nodes)), np.zeros(len(nodes))
        for a, b in itertools.combinations(range(4), 2):
            length = np.linalg.norm(nodes[cells[:, a]] - nodes[cells[:, b]], axis=1)
            for end in a, b:
                np.add.at(total, cells[:, end], length)
                np.add.at(count, cells[:, end], 1)
        sizes = total / np.maximum(count, 1)
        sizes[np.unique(cells[flags > 0])] *= 0.5
        mesh.set_field("metric", sizes.reshape(-1, 1))

    def refine(self, mesh):
        mesh.remesh(verbose=-1)
        return mesh

    def count(self, mesh):
        return len(mesh.get_tetrahedra())

    def corners(self, mesh):
        return mesh.get_vertices()[mesh.get_tetrahedra()]


workload.main(Mmg())
