# SPDX-License-Identifier: GPL-3.0-or-later
"""One mesh seen from one side: which shapes are drawn, in which colors."""
import dataclasses

import numpy as np
from vtk.util.numpy_support import vtk_to_numpy

import flow_lines
import palettes
import shapes
import values
from mesh_files import NO_PATCH, patches_named
from refused import Refused
from scene import Scene, lookup_table

# How much of a color is light and shade: little where a number is read off it.
FLAT, NUMBERS, BODY = 0.05, 0.35, 0.53


@dataclasses.dataclass
class Wish:
    """What the user asked for, the same for all panels."""
    cut: object = None            # view.Plane
    whole_cells: bool = False
    condition: tuple = None       # field, whether below, number
    patches: list = None          # names; None: not given
    field: str = None             # None: levels
    scale: float = 1.0
    smooth: int = None            # None: values of cells as they are
    isolines: object = ()         # values, or how many
    streamlines: str = None
    edges: bool = None            # None: without a field
    mirror: str = ""


class Subject:
    """A mesh with the numbers that are shown of it."""

    def __init__(self, mesh, wish):
        self.mesh, self.wish = mesh, wish
        self.remarks = []  # on values that have no place in the picture
        self.plane = wish.cut
        if wish.cut is not None:
            if not len(mesh.cells):
                raise Refused(f"{mesh.file}: --cut: expected tetrahedra, found triangles only")
            self.plane = shapes.within(mesh, wish.cut)
        self.chosen = self._chosen()
        self.patches = self._patches()
        self.values = self._values()
        self.vector = self._vector()
        self._pieces = None

    def _chosen(self):
        """Of each cell whether it is shown as a whole; nothing where none is."""
        mesh, wish = self.mesh, self.wish
        if not wish.whole_cells and wish.condition is None:
            return None
        chosen = np.ones(len(mesh.cells), bool) if self.plane is None else shapes.behind(mesh, self.plane)
        if wish.condition is not None:
            if not len(mesh.cells):
                raise Refused(f"{mesh.file}: --cells: expected tetrahedra, found triangles only")
            name, is_below, bound = wish.condition
            found = values.values_of(mesh, name)
            numbers = values.to_cells(mesh, found.numbers) if found.on_nodes else found.numbers
            self._remark(f"--cells {name}", np.isnan(numbers), "not numbers (NaN), and these cells are left out")
            chosen &= numbers < bound if is_below else numbers > bound
        return chosen

    def _patches(self):
        """Names of the patches that are drawn: all without --patch, but none beside a cut or chosen cells. A mesh whose boundary has no
        names is drawn with all of it."""
        mesh, wanted = self.mesh, self.wish.patches
        if wanted is None:
            return list(mesh.patches) if self.plane is None and self.chosen is None else []
        if "all" in wanted or mesh.patches == [NO_PATCH]:
            return list(mesh.patches)
        drawn = {name for patch in wanted for name in patches_named(patch, mesh.groups)}
        return [name for name in mesh.patches if name in drawn]

    def _values(self):
        wish = self.wish
        if wish.field in (None, "patch"):
            return None
        found = values.values_of(self.mesh, wish.field)
        if wish.smooth is not None:
            found = values.smoothed(self.mesh, found, wish.smooth)
        found.numbers = found.numbers * wish.scale
        return found

    def _vector(self):
        if not self.wish.streamlines:
            return None
        vector, is_finite = values.vector_of(self.mesh, self.wish.streamlines)
        self._remark(f"--streamlines {self.wish.streamlines}", ~is_finite, "not finite and taken as 0")
        return vector

    def _remark(self, option, chosen, what):
        if chosen.any():
            self.remarks.append(f"{self.mesh.file}: {option}: {chosen.sum():,} of {len(chosen):,} values are {what}")

    def remark_on_values(self, is_log):
        """Once a scale for them is found."""
        if self.values is not None:
            numbers, option = self.values.numbers, f"--field {self.wish.field}"
            is_finite = np.isfinite(numbers)
            self._remark(option, ~is_finite, "not finite and drawn in gray")
            self._remark(option, is_finite & (numbers <= 0) & is_log,
                         "not above 0 (--log) and drawn in the lowest color")

    def _nodal_fields(self):
        """Fields on nodes that go through the cut: colors, isolines, streamlines."""
        fields, wish = {}, self.wish
        if self.values is not None and self.values.on_nodes:
            fields["value"] = self.values.numbers
        if wish.isolines and self.values is not None:
            at_nodes = self.values
            if wish.smooth is None and not at_nodes.on_nodes:
                at_nodes = values.smoothed(self.mesh, at_nodes, 2)
            fields["smooth"] = at_nodes.numbers
        if self.vector is not None:
            fields["vector"] = self.vector
        return fields

    def pieces(self):
        """What is drawn: polygons, whether they lie in one plane, and the name of their patch (section: None)."""
        if self._pieces is None:
            self._pieces = list(self._make_pieces())
            if not any(data.GetNumberOfCells() for data, _, _ in self._pieces):
                raise Refused(f"{self.mesh.file}: expected something to draw, found no triangle of what was asked for")
        return self._pieces

    def _make_pieces(self):
        fields, mirror = self._nodal_fields(), self.wish.mirror
        for name in self.patches:
            data = shapes.boundary(self.mesh, [name], fields)
            is_flat = lies_in_plane(vtk_to_numpy(data.GetPoints().GetData()))
            if self.plane is not None:
                data = shapes.clipped(data, self.plane)
            yield shapes.mirrored(data, mirror), is_flat, name
        if self.chosen is not None:
            yield shapes.mirrored(shapes.complete_cells(self.mesh, self.chosen, fields), mirror), False, None
        elif self.plane is not None:
            yield shapes.mirrored(shapes.section(self.mesh, self.plane, fields), mirror), True, None

    def points(self):
        return np.concatenate([vtk_to_numpy(data.GetPoints().GetData()) for data, _, _ in self.pieces()
                               if data.GetNumberOfPoints()])

    def shown_numbers(self):
        """The numbers of what is seen, of each polygon or point."""
        seen = []
        for data, _, _ in self.pieces():
            if data.GetNumberOfCells():
                seen.append(shapes.array(data.GetPointData(), "value") if self.values.on_nodes
                            else self.values.numbers[shapes.array(data.GetCellData(), "owner")])
        return np.concatenate(seen)

    def levels(self):
        return self.mesh.level if self.mesh.level is not None else np.zeros(self.mesh.n_rows, int)


def lies_in_plane(points):
    if len(points) < 3:
        return True
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) if len(points) < 5000 else np.sqrt(
        np.maximum(np.linalg.eigvalsh(np.cov(points.T))[::-1], 0))
    return spread[2] <= 1e-6 * spread[0]


def colored(subject, data, is_flat, patch, coloring):
    """What `Scene.add_faces` needs as colors."""
    owner = shapes.array(data.GetCellData(), "owner")
    if subject.wish.field == "patch":
        if patch is None:
            return np.broadcast_to(palettes.LEVEL_FLAT[0], (len(owner), 3))
        return np.broadcast_to(coloring.patch_color(patch), (len(owner), 3))
    if subject.values is None:
        return palettes.of_levels(palettes.LEVEL_FLAT if is_flat else palettes.LEVEL_LIT, subject.levels()[owner])
    if subject.values.on_nodes:
        shapes.add_array(data.GetPointData(), "position", coloring.position(shapes.array(data.GetPointData(), "value")))
        return "position", lookup_table(coloring.colors)
    return coloring.bytes_of(subject.values.numbers[owner])


def add_edges(scene, subject, data, with_levels):
    """The edges of cells; by level in its color. Thinner where they are dense, so that the faces stay to be seen."""
    levels = subject.levels()[shapes.array(data.GetCellData(), "owner")]
    lines, level = shapes.edges(data, levels)
    ends = vtk_to_numpy(lines.GetLines().GetConnectivityArray()).reshape(-1, 2)
    points = vtk_to_numpy(lines.GetPoints().GetData())
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    for at in np.unique(level).astype(int):
        chosen = level == at
        width = float(np.clip(np.median(length[chosen]) / scene.pixel * 0.045, 0.4, 1.0))
        color = palettes.of_levels(palettes.LEVEL_EDGE, np.array(at)) if with_levels else palettes.INK
        scene.add_lines(shapes.poly_data(points, ends[chosen], True), color, width, 0.85 if with_levels else 0.35)


def draw(subject, view, extent, width, height, coloring):
    """The panel's pixels."""
    wish = subject.wish
    pieces = [piece for piece in subject.pieces() if piece[0].GetNumberOfCells()]
    along = subject.points() @ view.toward
    scene = Scene(view, extent, width, height, (along.min(), along.max()))
    for data, is_flat, patch in pieces:
        light = FLAT if is_flat else BODY if subject.values is None else NUMBERS
        scene.add_faces(data, colored(subject, data, is_flat, patch, coloring), light)
        if wish.edges or (wish.edges is None and subject.values is None):
            add_edges(scene, subject, data, subject.values is None and wish.field is None)
        if len(coloring.isolines):
            scene.add_lines(shapes.isolines(data, "smooth", coloring.isolines), palettes.INK, 0.9)
    if wish.streamlines:
        if len(pieces) == 1 and pieces[0][1]:
            lines = flow_lines.in_plane(pieces[0][0], "vector", view, extent[1] - extent[0])
        else:
            lines = shapes.mirrored(flow_lines.in_volume(subject.mesh, "vector", subject.vector), wish.mirror)
        if not lines.GetNumberOfCells():
            subject.remarks.append(f"{subject.mesh.file}: --streamlines {wish.streamlines}: no line was found")
        scene.add_lines(lines, (255, 255, 255) if subject.values is not None else palettes.INK, 1.1)
    return scene.image()
