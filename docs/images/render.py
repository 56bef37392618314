#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a coarse and a fine mesh of the blunt cone side by side: body and symmetry plane, edges colored by level.

Usage: render.py COARSE.hdf FINE.hdf PICTURE.png    (under xvfb-run where there is no screen)
"""
import sys

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

BODY = ("forebody", "base", "sting")
PLANE = ("symmetry",)
WIDTH, HEIGHT, OVERSAMPLING = 1800, 900, 2
# Edge and face color of each level; deeper levels repeat the last.
EDGE = np.array([(106, 122, 143), (20, 121, 143), (214, 126, 20), (178, 24, 52)], dtype=np.uint8)
PLANE_FACE = np.array([(244, 246, 249), (222, 239, 241), (253, 236, 208), (250, 217, 213)], dtype=np.uint8)
BODY_FACE = np.array([(226, 230, 236), (205, 226, 229), (243, 222, 190), (233, 196, 193)], dtype=np.uint8)
INK = (0.13, 0.16, 0.21)


class Mesh:
    """What the picture needs of a native file: nodes, boundary faces with their patch and level, counts."""

    def __init__(self, name):
        with h5py.File(name, "r") as file:
            grid, own = file["VTKHDF"], file["PAMR"]
            self.points = grid["Points"][:]
            cells = grid["Connectivity"][:].reshape(-1, 4)
            neighbors = own["cell_to_cell"][:]
            level_bit = 8 if own.attrs["format"] == 1 else 12
            levels = (own["lineage"][:] >> level_bit & 0xFF).astype(int) if "lineage" in own else np.zeros(len(cells), int)
            patches = [text.decode() for text in own["patches/names"][:]]
        self.n_cells = len(cells)
        self.deepest = int(levels.max())
        cell, slot = np.nonzero(neighbors < 0)
        corners = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # opposite each slot, outward
        self.face = np.take_along_axis(cells[cell], corners[slot], axis=1)
        self.face_level = levels[cell]
        self.face_patch = np.array(patches)[-neighbors[cell, slot] - 1]

    def part(self, patches):
        chosen = np.isin(self.face_patch, patches)
        return self.face[chosen], self.face_level[chosen]


def poly_data(points, rows, colors, are_lines):
    data = vtk.vtkPolyData()
    nodes = vtk.vtkPoints()
    nodes.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(nodes)
    width = rows.shape[1]
    flat = np.column_stack([np.full(len(rows), width), rows]).astype(np.int64).ravel()
    cells = vtk.vtkCellArray()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    if are_lines:
        data.SetLines(cells)
    else:
        data.SetPolys(cells)
    scalars = numpy_to_vtk(np.ascontiguousarray(colors), deep=True, array_type=vtk.VTK_UNSIGNED_CHAR)
    data.GetCellData().SetScalars(scalars)
    return data


def face_actor(mesh, patches, palette, is_lit):
    face, level = mesh.part(patches)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(poly_data(mesh.points, face, palette[np.minimum(level, len(palette) - 1)], False))
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.5, 1.5)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    if is_lit:
        look.SetAmbient(0.30)
        look.SetDiffuse(0.78)
        look.SetSpecular(0.12)
        look.SetSpecularPower(18)
    else:
        look.LightingOff()
    return actor


def edge_actor(mesh, patches, widths):
    """Every edge once, in the color of the finest face at it."""
    face, level = mesh.part(patches)
    ends = np.sort(face[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, which = np.unique(ends, axis=0, return_inverse=True)
    edge_level = np.zeros(len(edges), int)
    np.maximum.at(edge_level, which.ravel(), np.repeat(level, 3))
    actors = []
    for at in range(edge_level.max() + 1):
        chosen = edge_level == at
        mapper = vtk.vtkPolyDataMapper()
        colors = np.broadcast_to(EDGE[min(at, len(EDGE) - 1)], (chosen.sum(), 3))
        mapper.SetInputData(poly_data(mesh.points, edges[chosen], colors, True))
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        actor.GetProperty().SetLineWidth(widths[min(at, len(widths) - 1)] * OVERSAMPLING)
        actor.GetProperty().SetOpacity((0.9, 0.9, 0.8, 0.6)[min(at, 3)])
        actors.append(actor)
    return actors


def text_actor(text, x, y, size, color=INK, bold=False):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    look = actor.GetTextProperty()
    look.SetFontFamilyToArial()
    look.SetFontSize(size * OVERSAMPLING)
    look.SetColor(*color)
    look.SetBold(bold)
    look.SetBackgroundColor(1, 1, 1)
    look.SetBackgroundOpacity(0.9)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    return actor


def renderer_of(mesh, title, left, right, legend_levels):
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(left, 0, right, 1)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(face_actor(mesh, PLANE, PLANE_FACE, False))
    renderer.AddActor(face_actor(mesh, BODY, BODY_FACE, True))
    for actor in edge_actor(mesh, PLANE, (0.9, 0.8, 0.65, 0.5)) + edge_actor(mesh, BODY, (1.1, 0.9, 0.7, 0.5)):
        renderer.AddActor(actor)
    renderer.AddActor2D(text_actor(title, 0.035, 0.925, 25, bold=True))
    renderer.AddActor2D(text_actor(f"{mesh.n_cells:,} cells", 0.035, 0.882, 19))
    for level in range(legend_levels):
        color = EDGE[min(level, len(EDGE) - 1)] / 255
        renderer.AddActor2D(text_actor(f"level {level}", 0.035 + 0.115 * level, 0.035, 19, color, bold=True))

    renderer.RemoveAllLights()
    for position, strength in (((-0.40, 0.20, -0.25), 0.95), ((0.1, 0.5, -0.1), 0.45)):
        light = vtk.vtkLight()
        light.SetPosition(*position)
        light.SetFocalPoint(0.01, 0, 0)
        light.SetIntensity(strength)
        renderer.AddLight(light)
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(0.0085, 0.006, 0.0005)
    camera.SetPosition(-0.15, 0.30, -0.10)
    camera.SetViewUp(0, 0, -1)  # the stream comes from the left; the body is symmetric in z
    camera.SetViewAngle(12.6)
    renderer.ResetCameraClippingRange()
    return renderer


def white_window(width, height):
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(4)
    window.SetSize(width * OVERSAMPLING, height * OVERSAMPLING)
    background = vtk.vtkRenderer()
    background.SetBackground(1, 1, 1)
    window.AddRenderer(background)
    return window


def save(window, picture):
    """Renders, averages OVERSAMPLING x OVERSAMPLING pixels to one and writes a PNG."""
    window.Render()
    k = OVERSAMPLING
    width, height = (size // k for size in window.GetSize())
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    small = pixels.reshape(height, k, width, k, 3).mean(axis=(1, 3)).round().astype(np.uint8)
    image = vtk.vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(small.reshape(-1, 3), deep=True))
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(picture)
    writer.SetCompressionLevel(9)
    writer.SetInputData(image)
    writer.Write()


def main():
    coarse, fine, picture = Mesh(sys.argv[1]), Mesh(sys.argv[2]), sys.argv[3]
    number = {1: "one refinement", 2: "two refinements", 3: "three refinements"}.get(
        fine.deepest, f"{fine.deepest} refinements")
    window = white_window(WIDTH, HEIGHT)
    window.AddRenderer(renderer_of(coarse, "Level 0", 0, 0.498, 0))
    window.AddRenderer(renderer_of(fine, "After " + number, 0.502, 1, fine.deepest + 1))
    save(window, picture)
    print(f"{picture}: {coarse.n_cells} and {fine.n_cells} cells")


if __name__ == "__main__":
    main()
