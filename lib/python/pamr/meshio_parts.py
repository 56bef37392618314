# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ``meshio.Mesh`` holds, as arrays."""
from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, Mapping, Optional

import numpy as np

from . import _core
from ._core import Error
from .said import listed
from .together import integers, plain, reals, require_shape

# Under which meshio keeps what formats say of triangles and tetrahedra alike, the better one first.
PHYSICAL, ENTITY = "gmsh:physical", "gmsh:geometrical"
TAGS = (PHYSICAL, ENTITY, "medit:ref", "tetgen:ref", "netgen:index", "ugrid:ref", "nastran:ref", "su2:tag",
        "avsucd:material", "CellEntityIds")
PREFIX = {PHYSICAL: "physical_", ENTITY: "surface_", "medit:ref": "ref_", "ugrid:ref": "surface_"}  #: as the readers of these formats
REGION = "region"
# Of the files that PAMR writes: numbers of patches, whose names stand in field data, the second for faces without a tag.
OWN_TAGS, OWN_NAMES = ("boundary_patch", "patch"), ("patch ", "untagged patch ")


#: Nodes of the cells that are cut, what they become, and how many.
CUT = {"wedge": (6, "tetra", 3), "pyramid": (5, "tetra", 2), "quad": (4, "triangle", 2)}


@dataclass
class Parts:
    """Arrays for ``Mesh.from_arrays``."""
    points: np.ndarray
    cells: np.ndarray
    triangles: np.ndarray
    tags: np.ndarray
    names: dict
    regions: dict
    cell_fields: dict
    node_fields: dict
    remarks: list[str] = field(default_factory=list)  #: what was left out
    unused: list[tuple[int, str, int]] = field(default_factory=list)  #: groups of points and lines: dimension, name, elements
    joint: list[tuple[int, int, dict[int, str]]] = field(default_factory=list)  #: dimension, tag, the groups that it stands for


@dataclass
class Group:
    """The triangles or the tetrahedra of a mesh with their tags."""
    kind: str
    nodes: np.ndarray
    tags: Optional[np.ndarray]
    names: dict
    sets: dict[str, np.ndarray]  #: rows of each cell set
    prefix: str  #: of the names of tags that have none
    joint: dict[int, dict[int, str]] = field(default_factory=dict)  #: of tags that stand for several groups: these

    def name(self, tag: int) -> str:
        return self.names.get(tag, f"{self.prefix}{tag}")


def without_prisms(mesh: Any) -> Any:
    """The same mesh, with tetrahedra for wedges and pyramids and triangles for quads. Wedges have Gmsh's order of corners."""
    blocks, data = [], {name: list(arrays) for name, arrays in mesh.cell_data.items()}
    sets = {name: list(arrays) for name, arrays in mesh.cell_sets.items()}
    for i, block in enumerate(mesh.cells):
        if block.type not in CUT:
            blocks.append(block)
            continue
        n_nodes, kind, n_pieces = CUT[block.type]
        nodes = integers(block.type, plain(block.type, block.data), (None, n_nodes))
        flat = _core.cut_elements(block.type, nodes)
        blocks.append(SimpleNamespace(type=kind, data=flat.reshape(-1, 4 if kind == "tetra" else 3)))
        for name, arrays in data.items():
            if i < len(arrays):
                arrays[i] = np.repeat(plain(name, arrays[i]), n_pieces, axis=0)
        for name, arrays in sets.items():
            if i < len(arrays) and arrays[i] is not None and not name.startswith("gmsh:"):
                rows = _rows_in_block(f"cell set {name!r}, block {i}", arrays[i], len(nodes))
                arrays[i] = (n_pieces * rows[:, None] + np.arange(n_pieces)).ravel()
    return SimpleNamespace(points=mesh.points, cells=blocks, point_data=mesh.point_data, cell_data=data, field_data=mesh.field_data,
                           cell_sets=sets, point_sets=mesh.point_sets)


def parts_of(mesh: Any, tags: Optional[str], names: Optional[Mapping[int, str]]) -> Parts:
    """What there is in the mesh; raises Error for what cannot be taken."""
    _require_tetrahedra(mesh)
    key, remarks = _key_of(mesh, tags), []
    triangle, tetra = _group(mesh, "triangle", key, names), _group(mesh, "tetra", key if key in TAGS else None, None)
    kept = _join_copies(mesh, key, tetra)
    _join_copies(mesh, key, triangle)
    for group in (triangle, tetra):
        _join_sets(group)
    if key is None and triangle.tags is not None:
        triangle.nodes, triangle.tags = triangle.nodes[triangle.tags > 0], triangle.tags[triangle.tags > 0]
    if triangle.tags is None and len(triangle.nodes):
        found = ", ".join(repr(k) for k, v in mesh.cell_data.items() if all(np.asarray(a).dtype.kind in "iu" for a in v))
        remarks.append(f"{len(triangle.nodes)} triangles without tags were left out"
                       + (f" (tags= takes one of {found})" if found else ""))
    of_cells = {k: _joined(mesh, "tetra", f"cell data {k!r}", v)[kept] for k, v in mesh.cell_data.items()
                if (k != key or key not in TAGS + OWN_TAGS) and (k != ENTITY or key != PHYSICAL)}
    if "level" in of_cells and of_cells["level"].dtype == np.uint8:  # what our files show to viewers
        del of_cells["level"]
        remarks.append("cell data 'level' of type uint8 were left out: files of PAMR show the levels of cells by this name")
    if key in OWN_TAGS and "mean_ratio" in of_cells and of_cells["mean_ratio"].dtype == np.float32:
        del of_cells["mean_ratio"]  # worked out for viewers
    _choose_regions(tetra, key if key in TAGS else None, of_cells, remarks)
    remarks += _beside(mesh, key)
    points = np.zeros((len(mesh.points), 3))
    given = reals("points", mesh.points, (len(mesh.points), np.shape(mesh.points)[1]), finite=False)
    points[:, :given.shape[1]] = given
    bad = np.intersect1d(np.flatnonzero(~np.isfinite(points).all(axis=1)), tetra.nodes)
    if len(bad):
        raise Error(f"points: expected finite numbers, found others in row {bad[0]}")
    tagged = (np.empty((0, 3), np.int64), np.empty(0, np.int64)) if triangle.tags is None else (triangle.nodes, triangle.tags)
    regions = tetra.names if REGION in of_cells and of_cells[REGION] is tetra.tags else {}
    of_points = {k: plain(f"point data {k!r}", v) for k, v in mesh.point_data.items()}
    return Parts(points, tetra.nodes, *tagged, triangle.names, regions, of_cells, of_points, remarks,
                 _groups_of_points_and_lines(mesh, key),
                 [(2, tag, groups) for tag, groups in triangle.joint.items()]
                 + [(3, tag, groups) for tag, groups in tetra.joint.items() if tag in regions])


def _beside(mesh: Any, key: Optional[str]) -> list[str]:
    """What else the mesh holds: a remark for each kind of things."""
    remarks = []
    left_out = [f"'{name}' ({len(points)} points)" for name, points in mesh.point_sets.items()]
    if left_out:
        remarks.append(f"point sets were left out: {listed(left_out)}")
    n_lower = sum(len(block.data) for block in mesh.cells if block.type == "vertex" or block.type.startswith("line"))
    if n_lower and key != PHYSICAL:  # else their groups are counted
        remarks.append(f"{n_lower} points and lines were left out" if n_lower > 1 else "1 point or line was left out")
    others = [repr(k) for k, v in mesh.field_data.items()
              if not k.startswith(OWN_NAMES) and not (np.shape(v) == (2,) and np.asarray(v).dtype.kind in "iuf" and v[1] in range(4))]
    if others:
        remarks.append(f"field data were left out: {listed(others)}")
    links = [link for link in getattr(mesh, "gmsh_periodic", None) or [] if link[0] == 2]
    if links:
        remarks.append(f"{len(links)} periodic links of surfaces were left out" if len(links) > 1
                       else "1 periodic link of surfaces was left out")
    return remarks


def _groups_of_points_and_lines(mesh: Any, key: Optional[str]) -> list[tuple[int, str, int]]:
    """Named groups of Gmsh for which a mesh has no place, with their elements."""
    if key != PHYSICAL:
        return []
    groups = []
    for dimension, kinds in enumerate(("vertex", "line")):
        tags = Counter(np.abs(_joined(mesh, kinds, PHYSICAL, mesh.cell_data[PHYSICAL])).tolist())
        names = {int(v[0]): k for k, v in mesh.field_data.items() if np.shape(v) == (2,) and v[1] == dimension}
        for tag in sorted({tag for tag in tags if tag > 0} | set(names)):
            groups.append((dimension, names.get(tag, f"physical_{tag}"), tags[tag]))
    return groups


def _require_tetrahedra(mesh: Any) -> None:
    others: Counter = Counter()
    for block in mesh.cells:
        if block.type not in ("tetra", "triangle", "vertex") and not block.type.startswith("line"):
            others[block.type] += len(block.data)
    found = [f"{n} of type {kind}" for kind, n in sorted(others.items()) if n > 0]
    if found:
        is_cut = all(kind in CUT for kind, n in others.items() if n > 0)
        cure = " (split_prisms=True cuts prisms and pyramids into tetrahedra)" if is_cut else ""
        raise Error("from_meshio: expected tetrahedra and triangles of first order (points and lines are left out), found "
                    + ", ".join(found) + cure)
    kinds = {block.type for block in mesh.cells}
    if "tetra" not in kinds:
        raise Error(f"from_meshio: expected tetrahedra, found {', '.join(sorted(kinds)) or 'no cells'}")


def _key_of(mesh: Any, tags: Optional[str]) -> Optional[str]:
    if tags is None:
        own = [key for key in OWN_TAGS if key in mesh.cell_data and any(k.startswith(OWN_NAMES) for k in mesh.field_data)]
        return next((key for key in (*own, *TAGS) if key in mesh.cell_data), None)
    if tags not in mesh.cell_data:
        found = ", ".join(map(repr, mesh.cell_data)) or "no cell data"
        raise Error(f"from_meshio: expected cell data {tags!r} for the tags, found {found}")
    return tags


def _joined(mesh: Any, kind: str, name: str, arrays: Any) -> np.ndarray:
    parts = [plain(name, array) for block, array in zip(mesh.cells, arrays) if block.type == kind]
    return np.concatenate(parts) if parts else np.empty(0, np.int64)


def _group(mesh: Any, kind: str, key: Optional[str], names: Optional[Mapping[int, str]]) -> Group:
    dimension, n_nodes = (2, 3) if kind == "triangle" else (3, 4)
    nodes = integers(kind, _joined(mesh, kind, kind, [block.data for block in mesh.cells]), (None, n_nodes))
    bad = np.argwhere((nodes < 0) | (nodes >= len(mesh.points)))
    if len(bad):
        raise Error(f"{kind}: expected numbers of points from 0 to {len(mesh.points) - 1}, found {nodes[tuple(bad[0])]} in row "
                    f"{bad[0][0]}")
    tags = None
    if key is not None:
        name = f"cell data {key!r}"
        tags = _numbers(name, _joined(mesh, kind, name, mesh.cell_data[key]), len(nodes))
        if key == PHYSICAL:  # format 4.1 has a minus where the group has an entity with its orientation reversed
            tags = np.abs(tags)
    if names is None and key in OWN_TAGS:
        names = {int(np.ravel(v)[0]): k[len(before):] if before == OWN_NAMES[0] else (k[len(before):], _core.untagged_kind)
                 for k, v in mesh.field_data.items() for before in OWN_NAMES if k.startswith(before) and dimension == 2}
    elif names is None:
        names = {int(v[0]): k for k, v in mesh.field_data.items() if np.shape(v) == (2,) and v[1] == dimension}
    names = dict(names)
    if dimension == 2 and key in PREFIX:
        names = {**{tag: f"{PREFIX[key]}{tag}" for tag in np.unique(tags).tolist()}, **names}
    return Group(kind, nodes, tags, names, _sets(mesh, kind), PREFIX.get(key, "patch_" if dimension == 2 else f"{REGION}_"))


def _numbers(name: str, values: np.ndarray, n: int) -> np.ndarray:
    """n integers, which formats of text have as reals."""
    if values.dtype.kind == "f" and np.array_equal(values, np.rint(values)):
        values = values.astype(np.int64)
    return integers(name, values, (n,))


def _sets(mesh: Any, kind: str) -> dict[str, np.ndarray]:
    """Rows of the triangles or tetrahedra of each cell set."""
    blocks = [block for block in mesh.cells if block.type == kind]
    starts = dict(zip(map(id, blocks), np.cumsum([0] + [len(block.data) for block in blocks])))
    sets = {}
    for name, arrays in mesh.cell_sets.items():
        if name.startswith("gmsh:"):  # numbers of entities
            continue
        if len(arrays) != len(mesh.cells):
            raise Error(f"cell set {name!r}: expected cells of each of {len(mesh.cells)} blocks, found those of {len(arrays)}")
        rows = [starts[id(block)] + _rows_in_block(f"cell set {name!r}, block {i}", array, len(block.data))
                for i, (block, array) in enumerate(zip(mesh.cells, arrays)) if id(block) in starts and array is not None]
        rows = np.concatenate(rows) if rows else np.empty(0, np.int64)
        if len(rows):
            sets[name] = rows
    return sets


def _rows_in_block(name: str, array: Any, n: int) -> np.ndarray:
    """Rows of a block of n cells, given by their numbers in it or by a mask."""
    array = plain(name, array)
    if array.dtype == bool and array.size:
        require_shape(name, array, (n,))
        return np.flatnonzero(array)
    rows = integers(name, array, (None,))
    bad = rows[(rows < 0) | (rows >= n)]
    if len(bad):
        raise Error(f"{name}: expected numbers of its cells from 0 to {n - 1}, found {bad[0]}")
    return rows


def _join_copies(mesh: Any, key: Optional[str], group: Group) -> np.ndarray:
    """Makes one of the copies of an element that Gmsh's format 2.2 writes for each group of its entity, in all of these. Returns which
    rows stay."""
    kept = np.ones(len(group.nodes), bool)
    if key != PHYSICAL or ENTITY not in mesh.cell_data or group.tags is None or not len(kept):
        return kept
    entity = integers(ENTITY, _joined(mesh, group.kind, ENTITY, mesh.cell_data[ENTITY]), (len(kept),))
    if len(np.unique(np.stack([entity, group.tags]), axis=1)[0]) == len(np.unique(entity)):
        return kept
    _, first, place = np.unique(np.sort(group.nodes, axis=1), axis=0, return_index=True, return_inverse=True)
    row = first[place.ravel()]
    pairs = np.unique(np.stack([row, group.tags], axis=1), axis=0)
    in_several = np.bincount(pairs[:, 0], minlength=len(kept)) > 1
    kept = (row == np.arange(len(kept))) | ~in_several[row]
    new_row = np.cumsum(kept) - 1
    group.sets = {name: np.unique(new_row[row[members]]) for name, members in group.sets.items()}
    pairs = pairs[in_several[pairs[:, 0]]]
    group.nodes, group.tags = group.nodes[kept], group.tags[kept]
    _join(group, np.stack([new_row[pairs[:, 0]], pairs[:, 1]], axis=1))
    return kept


def _join_sets(group: Group) -> None:
    """Cell sets are groups, too: of the number that has their name, or of one that is free."""
    if not group.sets:
        return
    if group.tags is None:
        group.tags = np.zeros(len(group.nodes), np.int64)
    numbers = {name: tag for tag, name in group.names.items() if tag not in group.joint}
    pairs = [np.stack([rows, group.tags[rows]], axis=1) for rows in group.sets.values()]
    free = max([0, *group.names, *np.unique(group.tags).tolist()]) + 1
    for name, rows in group.sets.items():
        number = numbers.setdefault(name, free)
        group.names[number] = name
        free += number == free
        pairs.append(np.stack([rows, np.full(len(rows), number)], axis=1))
    pairs = np.concatenate(pairs)
    _join(group, pairs[pairs[:, 1] != 0])


def _join(group: Group, pairs: np.ndarray) -> None:
    """Gives each row of the pairs (row, group) the tag of its group, or where it has several one that stands for these: the lowest free
    number, with the name A+B."""
    before = set(np.unique(group.tags).tolist())
    parts = {joint: set(groups) for joint, groups in group.joint.items()}
    rows, place = np.unique(pairs[:, 0], return_inverse=True)
    label = np.zeros(len(rows), np.int64)  # equal for rows in the same groups
    for number in np.unique(pairs[:, 1]):
        is_in = np.zeros(len(rows), bool)
        is_in[place.ravel()[pairs[:, 1] == number]] = True
        _, label = np.unique(2 * label + is_in, return_inverse=True)
    first = np.unique(label, return_index=True)[1]
    found = [tuple(sorted(set().union(*(parts.get(tag, {tag}) for tag in pairs[pairs[:, 0] == row, 1].tolist()))))
             for row in rows[first].tolist()]
    tags = {}
    for groups in sorted(set(found)):
        known = [tag for tag, numbers in parts.items() if numbers == set(groups)]
        if len(groups) == 1 or known:
            tags[groups] = known[0] if known else groups[0]
            continue
        taken = before | set(group.names) | set(group.joint)
        tags[groups] = tag = next(number for number in range(1, len(taken) + 2) if number not in taken)
        group.joint[tag] = {number: group.name(number) for number in groups}
        name = "+".join(group.joint[tag].values())
        while name in group.names.values():
            name += "+"
        group.names[tag] = name
    group.tags = group.tags.copy()
    group.tags[rows] = np.array([tags[groups] for groups in found], np.int64)[label] if len(rows) else []
    used = set(np.unique(group.tags).tolist())
    group.joint = {tag: groups for tag, groups in group.joint.items() if tag in used}
    known = used.union(*group.joint.values())
    group.names = {tag: name for tag, name in group.names.items() if tag in known or tag not in before}


def _choose_regions(tetra: Group, key: Optional[str], of_cells: dict, remarks: list[str]) -> None:
    """The field "region": what the format says, or else the cell data of this name, or else the cell sets."""
    given = of_cells.get(REGION)
    if given is not None:
        given = of_cells[REGION] = _numbers(f"cell data '{REGION}'", given, len(tetra.nodes))
    if tetra.tags is None:
        return
    if given is None or np.array_equal(given, tetra.tags):
        of_cells[REGION] = tetra.tags
    elif key is None:
        remarks.append(f"cell sets of tetrahedra were left out, the field '{REGION}' has the cell data of this name: "
                       + ", ".join(f"'{name}' ({len(rows)} tetrahedra)" for name, rows in tetra.sets.items()))
    elif tetra.tags.any():
        n = int((given != tetra.tags).sum())
        remarks.append(f"cell data '{REGION}' were left out, the field '{REGION}' has {key!r}: {n} tetrahedra differ")
        of_cells[REGION] = tetra.tags
