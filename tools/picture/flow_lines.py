# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines along a vector field: evenly spaced ones in a plane, and some through a volume."""
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from refused import Refused
from shapes import add_array, array, grid_of, poly_data

SPACES = 34  # between lines across the picture


def in_plane(data, name, view, width):
    """Evenly spaced lines of the field's part in the picture's plane. `data`: polygons that lie in one plane."""
    joined = vtk.vtkCleanPolyData()  # mirror images have points in common
    joined.SetInputData(data)
    joined.SetTolerance(0)
    joined.Update()
    data = joined.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData())
    flat = np.column_stack([view.flat(points), np.zeros(len(points))])
    height = float(np.median(points @ view.toward))
    vectors = np.column_stack([view.flat(array(data.GetPointData(), name)), np.zeros(len(points))])
    plane = with_margin(flat, data.GetPolys(), name, vectors, 3 * width / SPACES)
    tracer = vtk.vtkEvenlySpacedStreamlines2D()
    tracer.SetInputData(plane)
    tracer.SetIntegratorTypeToRungeKutta4()
    tracer.SetIntegrationStepUnit(1)  # lengths
    tracer.SetInitialIntegrationStep(width / 1000)
    tracer.SetMaximumNumberOfSteps(4000)
    tracer.SetSeparatingDistance(width / SPACES)
    tracer.SetSeparatingDistanceRatio(0.45)
    tracer.SetClosedLoopMaximumDistance(width / 500)
    tracer.SetStartPosition(*flat[len(flat) // 2])
    tracer.Update()
    lines = tracer.GetOutput()
    if lines.GetNumberOfPoints() == 0:
        return lines
    bent = vtk_to_numpy(lines.GetPoints().GetData()).astype(float)
    back = bent[:, :1] * view.right + bent[:, 1:2] * view.up + height * view.toward
    begins = vtk_to_numpy(lines.GetLines().GetOffsetsArray())
    corners = vtk_to_numpy(lines.GetLines().GetConnectivityArray())
    segments = [pairs(corners[a:b]) for a, b in zip(begins[:-1], begins[1:]) if b - a > 1]
    return poly_data(back, np.concatenate(segments), True) if segments else vtk.vtkPolyData()


def with_margin(flat, polygons, name, vectors, margin):
    """The polygons and, `margin` outside of their box, two triangles in which nothing flows. The tracer looks for lines near
    the begin of a new one in a grid over the box of its input, and crashes where that begin lies outside of it."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    corner = margin * np.array([[1, 1, 0], [0.9, 1, 0], [1, 0.9, 0]])
    nodes = vtk.vtkPoints()
    nodes.SetData(numpy_to_vtk(np.vstack([flat, low - corner, high + corner]), deep=True))
    cells = vtk.vtkCellArray()
    cells.DeepCopy(polygons)
    for first in (len(flat), len(flat) + 3):
        cells.InsertNextCell(3, (first, first + 1, first + 2))
    plane = vtk.vtkPolyData()
    plane.SetPoints(nodes)
    plane.SetPolys(cells)
    add_array(plane.GetPointData(), name, np.vstack([vectors, np.zeros((6, 3))]))
    plane.GetPointData().SetActiveVectors(name)
    return plane


def pairs(line, step=4):
    """Segments over several steps of integration: shorter ones than a pixel would leave holes in the line."""
    kept = line[np.unique(np.append(np.arange(0, len(line), step), len(line) - 1))]
    return np.column_stack([kept[:-1], kept[1:]])


def in_volume(mesh, name, vectors, n_across=6):
    """Lines through points spread evenly over the mesh."""
    if not len(mesh.cells):
        raise Refused(f"{mesh.file}: --streamlines: expected tetrahedra or one flat patch, found other triangles")
    grid = grid_of(mesh.points, mesh.cells)
    add_array(grid.GetPointData(), name, vectors)
    grid.GetPointData().SetActiveVectors(name)
    centers = mesh.points[mesh.cells].mean(axis=1)
    low, span = centers.min(axis=0), np.ptp(centers, axis=0).max()
    box = np.floor((centers - low) / span * n_across * 0.999).astype(int)
    _, first = np.unique(box, axis=0, return_index=True)
    tracer = vtk.vtkStreamTracer()
    tracer.SetInputData(grid)
    tracer.SetSourceData(poly_data(centers[first], np.arange(len(first))[:, None]))
    tracer.SetIntegrationDirectionToBoth()
    tracer.SetMaximumPropagation(3 * span)
    tracer.SetMaximumNumberOfSteps(4000)
    tracer.SetIntegratorTypeToRungeKutta45()
    tracer.Update()
    return tracer.GetOutput()
