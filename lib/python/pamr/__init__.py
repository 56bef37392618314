# SPDX-License-Identifier: GPL-3.0-or-later
"""Parallel adaptive refinement of tetrahedral meshes, in memory.

A mesh lies on the ranks of an mpi4py communicator. It comes from arrays, from a file, from meshio or from dolfinx; cells
are marked and refined, or coarsened (``pamr.adapt``); curved boundaries stay curved; the arrays of the new mesh are at hand
at once::

    import numpy as np
    import pamr
    from mpi4py import MPI

    mesh = pamr.Mesh.kuhn_cube(MPI.COMM_WORLD, 8)
    for level in range(3):
        r = np.linalg.norm(mesh.points, axis=1)
        mesh.node_fields["T"] = np.tanh(20 * (r - 0.7))       # your solver
        flags = pamr.mark.flags(mesh, pamr.mark.recovered_error(mesh, "T", bulk=0.5))
        mesh = pamr.refine(mesh, flags).mesh
    mesh.write("fine.hdf")

``pamr.mark`` has the criteria, ``pamr.openfoam`` the cases and fields of OpenFOAM.

Numbers
    Rows of arrays are those of this rank: ``mesh.cells[c]`` holds rows of ``mesh.points``. ``mesh.cell_numbers`` and
    ``mesh.node_numbers`` give their numbers in the whole mesh, which do not depend on the number of ranks.
Collective
    Functions that say so are called by every rank. What is wrong on one rank raises the same ``pamr.Error`` on all. Errors of
    your own on one rank leave the others waiting, unless the script is started with ``python3 -m mpi4py``.
Warnings
    What is left out, changed or odd is a Python warning on rank 0, in the words of the tools: ``UserWarning`` for what their
    ``--strict`` would refuse, ``pamr.Note`` for their notes. A filter of ``warnings`` that makes errors of them raises on every rank.
"""
from . import mark, openfoam
from ._core import Error, version as __version__
from .dolfinx_values import dolfinx_function, dolfinx_values
from .interop import from_dolfinx, from_meshio, to_dolfinx
from .mesh import BoundaryFaces, Fields, InnerFaces, Mesh
from .said import Note
from .stages import RefineResult, adapt, balance, forecast, locate, quality, refine
from .surfaces import Cone, Cylinder, File, Plane, Sphere, Surface, Toml, Torus

__all__ = ["BoundaryFaces", "Cone", "Cylinder", "Error", "Fields", "File", "InnerFaces", "Mesh", "Note", "Plane", "RefineResult",
           "Sphere", "Surface", "Toml", "Torus", "adapt", "balance", "dolfinx_function", "dolfinx_values", "forecast", "from_dolfinx", "from_meshio",
           "locate", "mark", "openfoam", "quality", "refine", "to_dolfinx"]
