# SPDX-License-Identifier: GPL-3.0-or-later
"""From and to other packages; each is imported when it is needed."""
from __future__ import annotations

from typing import Any, Mapping, NamedTuple, Optional

import numpy as np

from . import _core
from ._core import Error
from .mesh import Mesh
from .meshio_parts import Parts, parts_of, without_prisms
from .said import say
from .together import agree, integers


def from_meshio(comm: Any, mesh: Any, tags: Optional[str] = None, names: Optional[Mapping[int, str]] = None, *,
                repair: bool = True, split_prisms: bool = False) -> Mesh:
    """A mesh from a ``meshio.Mesh`` on rank 0 (None on the others): its tetrahedra, its triangles as patches, and its point and cell
    data as fields. Collective.

    tags: the integer cell data whose values on triangles are patches. Default: those of the format ("gmsh:physical", "medit:ref",
        ...), whose values on tetrahedra are the cell field "region" then; where there are none, the cell sets are both (cell data
        "region" come before cell sets).
    names: of the tags; default: those of the file's physical surfaces (``field_data``).
    repair: as in ``Mesh.from_arrays``.
    split_prisms: cut cells of type "wedge" and "pyramid" into tetrahedra, and those of type "quad" into triangles: these have the
        data of the cells, and are in their cell sets. Wedges have Gmsh's order of corners.
    An element in several groups or cell sets is in a patch or region "A+B", which keeps them (``patch_groups``).
    Points and lines, points of no tetrahedron, periodic links and other field data are left out. A Python warning on rank 0 counts
    what is. Cells of other kinds raise pamr.Error.
    """
    def prepare() -> tuple[Any, Any]:
        if comm.rank != 0:
            if mesh is not None:
                raise Error("from_meshio: expected the mesh on rank 0 alone, found one on another")
            return None, bool(repair)
        if not hasattr(mesh, "cells") or not hasattr(mesh, "cell_sets"):
            raise Error(f"from_meshio: expected a meshio.Mesh, found {type(mesh).__name__}")
        return parts_of(without_prisms(mesh) if split_prisms else mesh, tags, names), bool(repair)
    parts = agree(comm, prepare)
    shape = comm.bcast(None if parts is None else (parts.names, parts.regions, _outline(parts.cell_fields),
                                                   _outline(parts.node_fields), parts.joint))
    if parts is None:
        of_cells, of_nodes = ({k: np.empty((0,) + tail, dtype) for k, (dtype, tail) in fields.items()} for fields in shape[2:4])
        parts = Parts(np.empty((0, 3)), np.empty((0, 4), int), np.empty((0, 3), int), np.empty(0, int), *shape[:2], of_cells,
                      of_nodes)
    # Along the curve, and so in runs over the ranks: all cells are on rank 0.
    result, remarks = Mesh._of_arrays(comm, parts.points, parts.cells, (parts.triangles, parts.tags), shape[0],
                                      parts.cell_fields, parts.node_fields, "", "curve", repair, shape[1], "from_meshio",
                                      parts.unused, False, shape[4])
    say(comm, [f"from_meshio: {remark}" for remark in parts.remarks + remarks])
    return result


def _outline(fields: Mapping[str, np.ndarray]) -> dict:
    return {name: (values.dtype, values.shape[1:]) for name, values in fields.items()}


def from_dolfinx(mesh: Any, facet_tags: Any = None, names: Optional[Mapping[int, str]] = None, cell_tags: Any = None) -> Mesh:
    """A mesh from a ``dolfinx.mesh.Mesh`` of tetrahedra of first order, with facet tags (``MeshTags`` of dimension 2, on the
    boundary or inside) as patches and cell tags as the cell field "region". Collective.

    Row c of ``cells`` is dolfinx's cell c of this rank, and ``node_numbers`` are the numbers of dolfinx's geometry, so that
    values go over by ``values[c]`` and by number; ghosts are left out. A Python warning on rank 0 counts faces without a tag and names
    the tags that no facet has.
    """
    from . import dolfinx_versions as versions
    geometry, topology = mesh.geometry, mesh.topology
    topology.create_connectivity(2, 0)
    topology.create_connectivity(2, 3)

    def prepare() -> tuple[Any, Any]:
        if topology.dim != 3 or versions.dofmap(geometry).shape[1] != 4:
            raise Error("from_dolfinx: expected tetrahedra of first order, found other cells")
        index_map = geometry.index_map()
        n_cells = topology.index_map(3).size_local
        corners = index_map.local_to_global(versions.dofmap(geometry)[:n_cells].ravel().astype(np.int32)).reshape(-1, 4)
        triangles, tags = np.empty((0, 3), np.int64), np.empty(0, np.int64)
        if facet_tags is not None:
            tags = integers("facet_tags", facet_tags.values, (None,))
            nodes = versions.facet_nodes(mesh, np.asarray(facet_tags.indices, dtype=np.int32))
            triangles = index_map.local_to_global(nodes.ravel().astype(np.int32)).reshape(-1, 3)
        fields = {}
        if cell_tags is not None:
            region = np.zeros(n_cells, dtype=np.int32)
            own = np.asarray(cell_tags.indices) < n_cells
            region[np.asarray(cell_tags.indices)[own]] = integers("cell_tags", cell_tags.values, (None,), np.int32)[own]
            fields["region"] = region
        return (np.asarray(geometry.x)[:index_map.size_local], corners, (triangles, tags), fields), sorted(fields)
    points, cells, boundary, fields = agree(mesh.comm, prepare)
    # dolfinx has no order of corners that makes a volume positive
    result, remarks = Mesh._of_arrays(mesh.comm, points, cells, None if facet_tags is None else boundary, names, fields, None, "", "keep",
                                      True, None, "from_dolfinx", oriented=False)
    say(mesh.comm, [f"from_dolfinx: {remark}" for remark in remarks])
    return result


class DolfinxMesh(NamedTuple):
    """What ``to_dolfinx`` gives; arrays are of this rank."""
    mesh: Any                #: dolfinx.mesh.Mesh
    facet_tags: Any          #: MeshTags of dimension 2: of each face of the boundary, or inside, its patch as in ``names``
    cell_rows: np.ndarray    #: row of ``pamr.Mesh.cells`` of each of dolfinx's own cells
    node_numbers: np.ndarray  #: number in the pamr mesh of each node of dolfinx's geometry, ghosts too
    names: dict[int, str]    #: of the facet tags: the patches' own numbers, the lowest free ones for patches without one
    cell_tags: Any           #: MeshTags of dimension 3: the cell field "region" where it is not 0; None without the field
    node_rows: np.ndarray    #: row of ``pamr.Mesh.points`` of each node of dolfinx's geometry, -1 for those of ghosts alone


def _tags_of_patches(mesh: Mesh) -> dict[int, int]:
    """The tag of each patch by index. Faces that had no tag come back without one."""
    numbers, names = mesh.patch_numbers, mesh.patches
    tagged = [patch for patch, (_, kind, _) in enumerate(mesh._core.patches) if kind != _core.untagged_kind]
    return dict(zip(tagged, _core.tags_of_patches([names[patch] for patch in tagged], [numbers[patch] for patch in tagged])))


def to_dolfinx(mesh: Mesh) -> DolfinxMesh:
    """A ``dolfinx.mesh.Mesh`` of the same cells on the same ranks, with the cells behind the faces of the rank border as ghosts, and
    with its patches as facet tags and its regions as cell tags. Collective."""
    import dolfinx
    from . import dolfinx_versions as versions
    comm = mesh.comm
    rows, offset = _ranks_at_cells(mesh)

    def stay(*_: Any) -> Any:
        return versions.adjacency(rows, offset)
    numbers = np.ascontiguousarray(mesh.node_numbers[mesh.cells])
    theirs = dolfinx.mesh.create_mesh(comm, numbers, mesh._core.node_block(), versions.straight_tetrahedra(),
                                       partitioner=stay)
    n_cells = theirs.topology.index_map(3).size_local
    first = comm.exscan(len(mesh.cells)) or 0
    rows = np.asarray(theirs.topology.original_cell_index)[:n_cells] - first
    nodes = np.asarray(theirs.geometry.input_global_indices)

    theirs.topology.create_connectivity(2, 0)
    theirs.topology.create_connectivity(2, 3)
    faces, inside = mesh.boundary_faces(), mesh.inner_faces()
    ours = np.sort(mesh.node_numbers[np.concatenate([faces.nodes, inside.nodes])], axis=1)
    tags = _tags_of_patches(mesh)
    patches = np.concatenate([faces.patches, inside.patches])
    tag_of = dict(zip(map(tuple, ours.tolist()), [tags.get(patch, -1) for patch in patches.tolist()]))
    # Facets of one cell, where those of ghost cells are no faces of ours, and those of which all nodes are nodes of faces inside.
    n_cells_at = np.diff(theirs.topology.connectivity(2, 3).offsets)
    facets = np.flatnonzero(n_cells_at == 1) if len(inside.cells) == 0 else np.arange(len(n_cells_at))
    of_facets = np.sort(nodes[versions.facet_nodes(theirs, np.asarray(facets, dtype=np.int32))], axis=1)
    if len(inside.cells):
        chosen = (n_cells_at == 1) | np.isin(of_facets, ours[len(faces.cells):]).all(axis=1)
        facets, of_facets = facets[chosen], of_facets[chosen]
    values = np.array([tag_of.get(face, -1) for face in map(tuple, of_facets.tolist())], dtype=np.int32)
    facets, values = facets[values >= 0], values[values >= 0]
    facet_tags = dolfinx.mesh.meshtags(theirs, 2, np.asarray(facets, dtype=np.int32), values)
    names = {tag: mesh.patches[patch] for patch, tag in tags.items()}
    cell_tags = None
    if "region" in mesh.cell_fields:
        region = np.asarray(mesh.cell_fields["region"])[rows].astype(np.int32)
        cells = np.flatnonzero(region != 0).astype(np.int32)
        cell_tags = dolfinx.mesh.meshtags(theirs, 3, cells, region[cells])
    return DolfinxMesh(theirs, facet_tags, rows, nodes, names, cell_tags, rows_of_numbers(mesh.node_numbers, nodes))


def rows_of_numbers(known: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Where each wanted number stands among the known ones, -1 where it does not."""
    if len(known) == 0:
        return np.full(len(wanted), -1)
    order = np.argsort(known)
    rows = order[np.searchsorted(known, wanted, sorter=order).clip(max=len(known) - 1)]
    return np.where(known[rows] == wanted, rows, -1)


def _ranks_at_cells(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Of each cell of this rank the rank itself, then the other ranks that have a neighbor of it, and where each cell's begin.
    dolfinx finds the nodes that ranks share by the ghost cells."""
    comm, n = mesh.comm, len(mesh.cells)
    own = np.full(n, comm.rank, np.int32).view(np.uint8)
    _, found = _core.fetch_rows(mesh._core, mesh.n_cells, mesh.cell_numbers, 4 * np.arange(n + 1), own, mesh.ghost_numbers)
    cell, slot = np.nonzero(mesh.cell_to_cell >= n)
    other = found.view(np.int32)[mesh.cell_to_cell[cell, slot] - n]
    pairs = np.unique(np.stack([cell, other], axis=1).astype(np.int64), axis=0)
    counts = 1 + np.bincount(pairs[:, 0], minlength=n)
    offset = np.concatenate(([0], np.cumsum(counts))).astype(np.int32)
    rows = np.full(offset[-1], comm.rank, np.int32)
    rest = np.ones(len(rows), bool)
    rest[offset[:-1]] = False
    rows[rest] = pairs[:, 1]
    return rows, offset
