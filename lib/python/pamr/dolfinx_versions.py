# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between the versions of dolfinx that are known to work, 0.5 and 0.9; imported where dolfinx is."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
import ufl
import dolfinx
from dolfinx import fem


def dofmap(owner: Any) -> np.ndarray:
    """Nodes of a geometry in cells, n x 4 for tetrahedra of first order, or the degrees of freedom of a space."""
    of_cells = getattr(owner.dofmap, "list", owner.dofmap)
    return of_cells.array.reshape(of_cells.num_nodes, -1) if hasattr(of_cells, "num_nodes") else np.asarray(of_cells)


def adjacency(values: np.ndarray, offsets: np.ndarray) -> Any:
    """Values of each row, as partitioners return them; both int32."""
    try:
        return dolfinx.cpp.graph.AdjacencyList_int32(values, offsets)
    except AttributeError:
        return dolfinx.graph.adjacencylist(values, offsets)._cpp_object


def straight_tetrahedra() -> Any:
    """The ufl.Mesh of tetrahedra of first order."""
    if hasattr(ufl, "VectorElement"):
        return ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
    import basix.ufl
    return ufl.Mesh(basix.ufl.element("Lagrange", "tetrahedron", 1, shape=(3,)))


def facet_nodes(mesh: Any, facets: np.ndarray) -> np.ndarray:
    """Nodes of the geometry at facets, n x 3."""
    if len(facets) == 0:
        return np.empty((0, 3), np.int32)
    if hasattr(dolfinx.mesh, "entities_to_geometry"):
        return np.asarray(dolfinx.mesh.entities_to_geometry(mesh, 2, facets))
    cpp = getattr(mesh, "_cpp_object", getattr(mesh, "_mesh", mesh))
    return np.asarray(dolfinx.cpp.mesh.entities_to_geometry(cpp, 2, facets, False))


def function_space(mesh: Any, element: Any, n_components: Optional[int] = None) -> Any:
    """Of a family and an order; of vectors where there are components."""
    if hasattr(fem, "functionspace"):
        return fem.functionspace(mesh, element if n_components is None else (*element, (n_components,)))
    return fem.FunctionSpace(mesh, element) if n_components is None else fem.VectorFunctionSpace(mesh, element, dim=n_components)


def place_of_values(space: Any) -> Optional[str]:
    """Where the values of a space are: at "nodes", in "cells", or None for all elements but the two of the lowest order."""
    element = space.ufl_element()
    if hasattr(element, "element_family"):
        import basix
        if element.element_family != basix.ElementFamily.P:
            return None
        degree, is_cut = element.degree, element.discontinuous
    else:
        if element.family() not in ("Lagrange", "Q", "Discontinuous Lagrange"):
            return None
        degree, is_cut = element.degree(), element.family() == "Discontinuous Lagrange"
    return "cells" if degree == 0 else "nodes" if degree == 1 and not is_cut else None


def edges_of(mesh: Any, cells: np.ndarray) -> np.ndarray:
    """Edges of these cells, int32."""
    mesh.topology.create_entities(1)
    mesh.topology.create_connectivity(3, 1)
    try:
        return dolfinx.mesh.compute_incident_entities(mesh.topology, cells, 3, 1)
    except (AttributeError, TypeError):
        return dolfinx.mesh.compute_incident_entities(mesh, cells, 3, 1)


def refined(mesh: Any, edges: np.ndarray) -> Any:
    """By dolfinx's own bisection of these edges; cells stay on their ranks. Collective."""
    try:
        return dolfinx.mesh.refine(mesh, edges, redistribute=False)
    except TypeError:  # without that option it returns cells and facets of the parents, too
        return dolfinx.mesh.refine(mesh, edges, partitioner=None)[0]
