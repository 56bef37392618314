# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of dolfinx as arrays at the nodes or cells of a mesh of this package, and back."""
from __future__ import annotations

from typing import Any, Union

import numpy as np

from ._core import Error
from .interop import DolfinxMesh, rows_of_numbers
from .mesh import Mesh
from .together import agree, plain

Given = Union[DolfinxMesh, Mesh]


def _rows(given: Given, theirs: Any) -> tuple[np.ndarray, np.ndarray]:
    """Row of each of dolfinx's own cells in the mesh of this package, and of each node of its geometry, -1 for those of ghosts alone."""
    if isinstance(given, DolfinxMesh):
        return given.cell_rows, given.node_rows
    nodes = theirs.geometry.index_map()
    numbers = nodes.local_to_global(np.arange(len(theirs.geometry.x), dtype=np.int32))
    return np.arange(theirs.topology.index_map(3).size_local), rows_of_numbers(given.node_numbers, numbers)


def dolfinx_values(given: Given, u: Any) -> np.ndarray:
    """The values of a function of dolfinx at the nodes or in the cells of the mesh of this package, in the order of its rows of this
    rank: shape (n,), or (n, k) where ``u`` has k components. Local.

    given: the result of ``to_dolfinx``, or the mesh that ``from_dolfinx`` made; ``u`` is on that mesh of dolfinx
    u:     a real Function of Lagrange elements of first order (values at nodes), or of discontinuous elements of order 0 (in cells)

    ``mesh.node_fields["T"] = pamr.dolfinx_values(given, u)`` and ``mesh.cell_fields[...] = ...`` then carry it along.
    """
    from . import dolfinx_versions as versions
    space = u.function_space
    on, size = versions.place_of_values(space), space.dofmap.index_map_bs
    if on is None:
        raise Error("dolfinx_values: expected Lagrange elements of first order, or discontinuous ones of order 0, found "
                    f"{space.ufl_element()}")
    if np.iscomplexobj(u.x.array):
        raise Error("dolfinx_values: expected real values, found complex ones")
    cell_rows, node_rows = _rows(given, space.mesh)
    values, dofs = np.asarray(u.x.array).reshape(-1, size), versions.dofmap(space)
    if on == "cells":
        result = np.empty((len(cell_rows), size))
        result[cell_rows] = values[dofs[:len(cell_rows), 0]]
    else:
        result = np.empty((node_rows.max(initial=-1) + 1, size))
        nodes = versions.dofmap(space.mesh.geometry)[:len(cell_rows)]
        result[node_rows[nodes]] = values[dofs[:len(cell_rows)]]
    return result[:, 0] if size == 1 else result


def dolfinx_function(given: Given, mesh: Any, values: Any, on: str = "nodes") -> Any:
    """A Function of dolfinx of an array at the nodes (Lagrange, first order) or in the cells (discontinuous, order 0) of the mesh of
    this package, as ``dolfinx_values`` gives it. Collective.

    given:  as in ``dolfinx_values``
    mesh:   dolfinx's mesh: ``given.mesh``, or the one that ``from_dolfinx`` took
    values: of the rows of this rank, shape (n,) or (n, k)
    on:     "nodes" or "cells"
    """
    from . import dolfinx_versions as versions
    cell_rows, node_rows = _rows(given, mesh)

    def prepare() -> tuple[np.ndarray, Any]:
        if on not in ("nodes", "cells"):
            raise Error(f'dolfinx_function: expected "nodes" or "cells", found "{on}"')
        array = plain("dolfinx_function", values).astype(float)
        n = len(cell_rows) if on == "cells" else node_rows.max(initial=-1) + 1
        if array.ndim not in (1, 2) or len(array) != n:
            raise Error(f"dolfinx_function: expected values of {n} {on}, found an array of shape {array.shape}")
        return array, (on, array.shape[1:])
    array = agree(mesh.comm, prepare)
    family = ("Lagrange", 1) if on == "nodes" else ("DG", 0)
    space = versions.function_space(mesh, family, None if array.ndim == 1 else array.shape[1])
    result = versions.fem.Function(space, dtype=np.float64)
    theirs, dofs = result.x.array.reshape(-1, space.dofmap.index_map_bs), versions.dofmap(space)
    array = array.reshape(len(array), -1)
    if on == "cells":
        theirs[dofs[:len(cell_rows), 0]] = array[cell_rows]
    else:
        theirs[dofs[:len(cell_rows)]] = array[node_rows[versions.dofmap(mesh.geometry)[:len(cell_rows)]]]
    result.x.scatter_forward()
    return result
