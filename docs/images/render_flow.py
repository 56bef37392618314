#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the flow about the blunt cone in its symmetry plane: density with streamlines, temperature and Mach number.

Usage: render_flow.py FLOW.hdf PREFIX    writes PREFIX-density.png, PREFIX-temperature.png, PREFIX-mach.png
(under xvfb-run where there is no screen). FLOW.hdf is what pamr-dsmc wrote for cases/blunt-cone/case.toml.
"""
import sys

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

DENSITY, TEMPERATURE = 1.116e21, 13.6  # of the free stream
WIDTH, HEIGHT, OVERSAMPLING = 1000, 1000, 2
INK = (0.13, 0.16, 0.21)
# Name, title of the scale, bounds, logarithmic, isolines.
PICTURES = (("density", "n / n_inf", (0.05, 20), True, (0.1, 0.5, 1.05, 2, 4, 8, 16)),
            ("temperature", "T / T_inf", (0, 80), False, (5, 20, 40, 60)),
            ("mach", "Ma", (0, 20), False, (1, 2, 5, 10)))


def read(name):
    """The mesh as a VTK grid, millimeters, with the flow on its nodes: means over the cells by volume."""
    with h5py.File(name) as file:
        grid, data = file["VTKHDF"], file["VTKHDF/CellData"]
        points, cells = grid["Points"][:] * 1e3, grid["Connectivity"][:].reshape(-1, 4)
        fields = {"density": data["n"][:] / DENSITY, "temperature": data["T"][:] / TEMPERATURE, "mach": data["Ma"][:]}
        velocity = data["u"][:]
        neighbors = file["PAMR/cell_to_cell"][:]
        plane = [text.decode() for text in file["PAMR/patches/names"][:]].index("symmetry")
    x = points[cells]
    volume = np.einsum("ij,ij->i", np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), x[:, 3] - x[:, 0])
    weight = np.bincount(cells.ravel(), np.repeat(volume, 4))

    def on_nodes(values):
        return np.bincount(cells.ravel(), np.repeat(values * volume, 4)) / weight

    cell, slot = np.nonzero(neighbors == -(plane + 1))
    corners = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # opposite each slot
    faces = np.take_along_axis(cells[cell], corners[slot], axis=1)
    velocity = np.column_stack([on_nodes(velocity[:, k]) for k in range(3)])
    return points, faces, {key: on_nodes(value) for key, value in fields.items()}, velocity


def cell_array(rows):
    cells = vtk.vtkCellArray()
    flat = np.column_stack([np.full(len(rows), rows.shape[1]), rows]).astype(np.int64).ravel()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    return cells


def plane_of(points, faces, values, velocity):
    """The symmetry plane's triangles with a scalar and the velocity, laid into z = 0: x along the axis, y up."""
    used, rows = np.unique(faces, return_inverse=True)
    data = vtk.vtkPolyData()
    nodes = vtk.vtkPoints()
    flat = np.column_stack([points[used, 0], points[used, 2], np.zeros(len(used))])
    nodes.SetData(numpy_to_vtk(flat, deep=True))
    data.SetPoints(nodes)
    data.SetPolys(cell_array(rows.reshape(-1, 3)))
    scalar = numpy_to_vtk(values[used], deep=True)
    scalar.SetName("value")
    data.GetPointData().SetScalars(scalar)
    vector = numpy_to_vtk(np.column_stack([velocity[used, 0], velocity[used, 2], np.zeros(len(used))]), deep=True)
    vector.SetName("u")
    data.GetPointData().SetVectors(vector)
    return data


def colors(bounds, is_log):
    table = vtk.vtkLookupTable()
    table.SetNumberOfTableValues(256)
    stops = np.array([(0.19, 0.07, 0.23), (0.27, 0.48, 0.95), (0.10, 0.84, 0.76), (0.64, 0.99, 0.24), (0.98, 0.73, 0.22),
                      (0.86, 0.24, 0.03), (0.48, 0.01, 0.01)])
    for i in range(256):
        at = i / 255 * (len(stops) - 1)
        low = min(int(at), len(stops) - 2)
        table.SetTableValue(i, *(stops[low] + (at - low) * (stops[low + 1] - stops[low])), 1)
    if is_log:
        table.SetScaleToLog10()
    table.SetRange(*bounds)
    table.Build()
    return table


def line_actor(lines, color, width):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(lines.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.GetProperty().SetLineWidth(width)
    return actor


def streamlines(data):
    seeds = vtk.vtkPoints()
    for z in np.arange(-56, 57, 4.0):
        seeds.InsertNextPoint(-20 if abs(z) < 45 else 0, z, 0)
    for x in (14, 18, 24, 32):  # the recirculation behind the base
        for z in (9, 13, 18, -9, -13, -18):
            seeds.InsertNextPoint(x, z, 0)
    start = vtk.vtkPolyData()
    start.SetPoints(seeds)
    tracer = vtk.vtkStreamTracer()
    tracer.SetInputData(data)
    tracer.SetSourceData(start)
    tracer.SetSurfaceStreamlines(True)
    tracer.SetIntegrationDirectionToBoth()
    tracer.SetMaximumPropagation(300)
    tracer.SetMaximumNumberOfSteps(20000)
    tracer.SetInitialIntegrationStep(0.2)
    tracer.SetIntegratorTypeToRungeKutta4()
    return tracer


def render(data, title, bounds, is_log, isolines, with_streamlines, name):
    table = colors(bounds, is_log)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    mapper.InterpolateScalarsBeforeMappingOn()
    surface = vtk.vtkActor()
    surface.SetMapper(mapper)
    surface.GetProperty().LightingOff()
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(surface)
    if with_streamlines:
        renderer.AddActor(line_actor(streamlines(data), (1, 1, 1), 1.6 * OVERSAMPLING))
    contour = vtk.vtkContourFilter()
    contour.SetInputData(data)
    for i, value in enumerate(isolines):
        contour.SetValue(i, value)
    renderer.AddActor(line_actor(contour, INK, 1.0 * OVERSAMPLING))
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title)
    bar.SetNumberOfLabels(6)
    bar.SetLabelFormat("%.3g")
    bar.UnconstrainedFontSizeOn()
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        text.SetColor(*INK)
        text.SetFontSize(15 * OVERSAMPLING)
        text.ItalicOff()
        text.BoldOff()
        text.ShadowOff()
    bar.SetPosition(0.84, 0.2)
    bar.SetWidth(0.12)
    bar.SetHeight(0.6)
    renderer.AddActor2D(bar)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(22, 0, 0)
    camera.SetPosition(22, 0, 200)
    camera.SetViewUp(0, 1, 0)
    camera.SetParallelScale(64)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(WIDTH * OVERSAMPLING, HEIGHT * OVERSAMPLING)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    shrink = vtk.vtkImageResize()
    shrink.SetInputConnection(grab.GetOutputPort())
    shrink.SetOutputDimensions(WIDTH, HEIGHT, 1)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(name)
    writer.SetInputConnection(shrink.GetOutputPort())
    writer.Write()


def main():
    points, faces, fields, velocity = read(sys.argv[1])
    for key, title, bounds, is_log, isolines in PICTURES:
        data = plane_of(points, faces, fields[key], velocity)
        render(data, title, bounds, is_log, isolines, key == "density", f"{sys.argv[2]}-{key}.png")


if __name__ == "__main__":
    main()
