# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers that a picture shows: a field of the file, or what follows from the mesh itself."""
import dataclasses

import numpy as np

from refused import Refused

COMPONENTS = {"x": 0, "y": 1, "z": 2}


@dataclasses.dataclass
class Values:
    """One number for each row of the cell fields, or for each node."""
    numbers: np.ndarray
    on_nodes: bool
    unit: str = ""
    is_whole: bool = False  # whole numbers of the cells: of regions, materials, levels


def volumes(mesh):
    """Of each cell; areas if the mesh is a surface."""
    x = mesh.points[mesh.cells if len(mesh.cells) else mesh.faces]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    if len(mesh.cells):
        return np.einsum("ij,ij->i", normal, x[:, 3] - x[:, 0]) / 6
    return 0.5 * np.linalg.norm(normal, axis=1)


def mean_ratio(mesh):
    if not len(mesh.cells):
        raise Refused(f"{mesh.file}: mean_ratio: expected tetrahedra, found triangles only")
    x = mesh.points[mesh.cells]
    squares = sum(((x[:, a] - x[:, b]) ** 2).sum(axis=1) for a in range(4) for b in range(a))
    volume = volumes(mesh)
    return 12 * np.sign(volume) * (3 * np.abs(volume)) ** (2 / 3) / squares


def size(mesh):
    """The cubic root of a cell's volume; of a triangle the square root of its area."""
    return np.cbrt(volumes(mesh)) if len(mesh.cells) else np.sqrt(volumes(mesh))


COMPUTED = {"mean_ratio": mean_ratio, "size": size}


def known_names(mesh):
    own = ["level"] if mesh.level is not None else []
    own += ["mean_ratio"] if len(mesh.cells) else []
    return sorted({*mesh.cell_fields, *mesh.node_fields, *own, "size", "patch"})


def component_of(mesh, name, rows, component):
    if component:
        index = COMPONENTS.get(component, int(component) if component.isdigit() else -1)
        n = 1 if rows.ndim == 1 else rows.shape[1]
        if not 0 <= index < n:
            raise Refused(f"{mesh.file}: field '{name}': expected a component from 0 to {n - 1} (or x, y, z), "
                          f"found '{component}'")
        return rows if rows.ndim == 1 else rows[:, index]
    return rows if rows.ndim == 1 else np.linalg.norm(rows, axis=1)


def rows_of(mesh, name):
    """The field as real numbers, whether it is one of nodes, and whether its numbers are whole; None if unknown."""
    for fields, on_nodes, n in ((mesh.cell_fields, False, mesh.n_rows), (mesh.node_fields, True, len(mesh.points))):
        if name in fields:
            rows = fields[name]
            if rows.dtype.kind not in "biuf" or rows.ndim not in (1, 2) or len(rows) != n or not rows.size:
                raise Refused(f"{mesh.file}: field '{name}': expected {n} rows of real numbers, found {rows.dtype} of "
                              f"shape {rows.shape}")
            return rows.astype(float), on_nodes, np.issubdtype(rows.dtype, np.integer)
    return None, False, False


def values_of(mesh, wanted):
    """The field `NAME` or `NAME:COMPONENT`; the length of a vector without a component. A cell field comes before a nodal
    one of the same name, as in pamr-mark, and both before what is computed."""
    name, component = wanted, ""
    if wanted not in mesh.cell_fields and wanted not in mesh.node_fields and ":" in wanted:
        name, component = wanted.rsplit(":", 1)
    unit = {"1": ""}.get(mesh.units.get(name, ""), mesh.units.get(name, ""))
    rows, on_nodes, is_whole = rows_of(mesh, name)
    if rows is not None:
        return Values(component_of(mesh, name, rows, component), on_nodes, unit, is_whole and not on_nodes)
    if name == "level" and mesh.level is not None:
        return Values(mesh.level.astype(float), False, is_whole=True)
    if name in COMPUTED:
        return Values(COMPUTED[name](mesh), False, mesh.length_unit if name == "size" else "")
    raise Refused(f"{mesh.file}: unknown field '{name}'; there are {', '.join(known_names(mesh))}")


def vector_of(mesh, name):
    """A field with three components on the nodes, and of each of its rows whether it is finite: others become 0."""
    rows, on_nodes, _ = rows_of(mesh, name)
    if rows is not None:
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise Refused(f"{mesh.file}: streamlines: expected a field with 3 components, found '{name}' with "
                          f"{1 if rows.ndim == 1 else rows.shape[1]}")
        is_finite = np.isfinite(rows).all(axis=1)
        if not is_finite.any():
            raise Refused(f"{mesh.file}: --streamlines {name}: expected finite vectors, found none")
        rows[~is_finite] = 0
        return rows if on_nodes else to_nodes(mesh, rows), is_finite
    raise Refused(f"{mesh.file}: unknown field '{name}'; there are {', '.join(known_names(mesh))}")


def to_nodes(mesh, rows):
    """Means of the cells at each node, by volume."""
    cells = mesh.cells if len(mesh.cells) else mesh.faces
    weight = np.abs(volumes(mesh))
    corner = cells.ravel()
    total = np.bincount(corner, np.repeat(weight, cells.shape[1]), len(mesh.points))
    total[total == 0] = 1
    columns = rows.reshape(len(rows), -1).T
    means = [np.bincount(corner, np.repeat(c * weight, cells.shape[1]), len(mesh.points)) / total for c in columns]
    return np.column_stack(means).reshape((len(mesh.points),) + rows.shape[1:])


def to_cells(mesh, at_nodes):
    cells = mesh.cells if len(mesh.cells) else mesh.faces
    return at_nodes[cells].mean(axis=1)


def smoothed(mesh, values, passes):
    """The values on the nodes, averaged over the cells around them `passes` times more: what isolines of noisy cell values
    need to follow the field and not the cells."""
    at_nodes = values.numbers if values.on_nodes else to_nodes(mesh, values.numbers)
    for _ in range(passes):
        at_nodes = to_nodes(mesh, to_cells(mesh, at_nodes))
    return Values(at_nodes, True, values.unit)
