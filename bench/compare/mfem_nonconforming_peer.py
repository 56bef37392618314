# SPDX-License-Identifier: GPL-3.0-or-later
"""MFEM by PyMFEM: nonconforming refinement of tetrahedra into eight, with derefinement.

Neighbors differ by one level at most; nodes hang where they differ, so that the result is another one than ours.
"""

import mfem.ser
import numpy as np

import workload
from mfem_peer import Mfem


class MfemNonconforming(Mfem):
    """The mesh is refined in place. A call with flags for coarsening derefines only, a next one refines."""

    name = Mfem.name + ", nonconforming"

    def __init__(self):
        super().__init__()
        self.kept = None

    def start(self, cells, nodes):
        mesh = super().start(cells, nodes)
        mesh.EnsureNCMesh(True)
        return mesh

    def mark(self, mesh, flags):
        super().mark(mesh, flags)
        self.kept = mfem.ser.Vector(np.where(flags < 0, 0.0, 1.0)) if (flags < 0).any() else None

    def refine(self, mesh):
        if self.kept is not None:
            mesh.DerefineByError(self.kept, 0.5, 1, 1)  # those whose cells add up to less than 0.5
        elif self.marked is None:
            mesh.UniformRefinement()
        else:
            mesh.GeneralRefinement(self.marked, 1, 1)
        return mesh


workload.main(MfemNonconforming())
