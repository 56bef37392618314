# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn of a mesh: triangles of its boundary, its section with a plane, complete cells behind the plane; and the
lines on them."""
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

from mesh_files import outer_faces
from refused import Refused
from view import Plane

vtk.vtkObject.GlobalWarningDisplayOff()  # what is wrong with a file is said once, in this tool's words


def poly_data(points, rows, are_lines=False):
    """Polygons or lines of equally many corners."""
    data = vtk.vtkPolyData()
    nodes = vtk.vtkPoints()
    nodes.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    data.SetPoints(nodes)
    flat = np.column_stack([np.full(len(rows), rows.shape[1]), rows]).astype(np.int64).ravel()
    cells = vtk.vtkCellArray()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    data.SetLines(cells) if are_lines else data.SetPolys(cells)
    return data


def add_array(data, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.AddArray(array)


def array(data, name):
    return vtk_to_numpy(data.GetArray(name))


def triangles_of(mesh, faces, owner, fields):
    """Triangles with the number of their `owner` (row of the cell fields) and nodal `fields`."""
    used, rows = np.unique(faces, return_inverse=True)
    data = poly_data(mesh.points[used], rows.reshape(-1, 3))
    add_array(data.GetCellData(), "owner", owner.astype(np.int64))
    for name, values in fields.items():
        add_array(data.GetPointData(), name, values[used])
    return data


def boundary(mesh, patches, fields):
    chosen = np.isin(mesh.face_patch, [i for i, name in enumerate(mesh.patches) if name in patches])
    data = triangles_of(mesh, mesh.faces[chosen], mesh.face_owner[chosen], fields)
    add_array(data.GetCellData(), "patch", mesh.face_patch[chosen].astype(np.int64))
    return data


def within(mesh, plane):
    """The plane, moved into the mesh by a millionth of its size if all nodes lie on one side: a section there shows the cells
    at a plane side of the domain."""
    heights = plane.height(mesh.points)
    low, high, step = heights.min(), heights.max(), 1e-6 * np.ptp(mesh.points, axis=0).max()
    if low > step or high < -step:
        axis = int(np.abs(plane.normal).argmax())
        raise Refused(f"{mesh.file}: --cut: expected a plane through the mesh, found one beside it; the mesh has "
                      f"{'xyz'[axis]} from {mesh.points[:, axis].min():.6g} to {mesh.points[:, axis].max():.6g}")
    shift = step if low > -step else -step if high < step else 0.0
    return Plane(plane.normal, plane.offset + shift)


def vtk_plane(plane):
    function = vtk.vtkPlane()
    function.SetNormal(*plane.normal)
    function.SetOrigin(*(plane.normal * plane.offset))
    return function


def grid_of(points, cells):
    grid = vtk.vtkUnstructuredGrid()
    nodes = vtk.vtkPoints()
    nodes.SetData(numpy_to_vtk(points, deep=True))
    grid.SetPoints(nodes)
    flat = np.column_stack([np.full(len(cells), 4), cells]).astype(np.int64).ravel()
    array_of_cells = vtk.vtkCellArray()
    array_of_cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(flat, deep=True))
    grid.SetCells(vtk.VTK_TETRA, array_of_cells)
    return grid


def section(mesh, plane, fields):
    """The polygons in which the plane cuts the cells."""
    heights = plane.height(mesh.points)[mesh.cells]
    cut = np.nonzero((heights.min(axis=1) < 0) & (heights.max(axis=1) >= 0))[0]
    used, rows = np.unique(mesh.cells[cut], return_inverse=True)
    grid = grid_of(mesh.points[used], rows.reshape(-1, 4))
    add_array(grid.GetCellData(), "owner", cut)
    for name, values in fields.items():
        add_array(grid.GetPointData(), name, values[used])
    cutter = vtk.vtkCutter()
    cutter.SetInputData(grid)
    cutter.SetCutFunction(vtk_plane(plane))
    cutter.GenerateTrianglesOff()
    cutter.GenerateCutScalarsOff()
    cutter.Update()
    return cutter.GetOutput()


def behind(mesh, plane):
    """Of each cell, whether its centroid lies below the plane; at a side of the domain whether the plane cuts it."""
    kept = plane.height(mesh.points[mesh.cells].mean(axis=1)) <= 0
    return kept if kept.any() else plane.height(mesh.points)[mesh.cells].min(axis=1) < 0


def complete_cells(mesh, chosen, fields):
    """The outer triangles of these cells, one truth value for each cell of the mesh."""
    kept = np.nonzero(chosen)[0]
    faces, owner = outer_faces(mesh.cells[kept])
    return triangles_of(mesh, faces, kept[owner], fields)


def clipped(data, plane):
    """What lies below the plane."""
    clip = vtk.vtkClipPolyData()
    clip.SetInputData(data)
    clip.SetClipFunction(vtk_plane(plane))
    clip.InsideOutOn()
    clip.Update()
    return clip.GetOutput()


def edges(data, numbers):
    """The edges of all polygons once, each with the largest number of the polygons at it."""
    cells = data.GetPolys()
    begins = vtk_to_numpy(cells.GetOffsetsArray())
    corners = vtk_to_numpy(cells.GetConnectivityArray())
    if len(corners) == 0:
        return poly_data(np.zeros((1, 3)), np.empty((0, 2), int), True), np.empty(0)
    following = np.arange(1, len(corners) + 1)
    following[begins[1:] - 1] = begins[:-1]
    ends = np.sort(np.column_stack([corners, corners[following]]), axis=1)
    unique, which = np.unique(ends, axis=0, return_inverse=True)
    largest = np.full(len(unique), -np.inf)
    np.maximum.at(largest, which.ravel(), np.repeat(numbers, np.diff(begins)))
    return poly_data(vtk_to_numpy(data.GetPoints().GetData()), unique, True), largest


def mirrored(data, axes):
    """With its images in the planes x = 0, y = 0, z = 0 that are named."""
    append = vtk.vtkAppendPolyData()
    append.AddInputData(data)
    images = [data]
    for axis in axes:
        for image in list(images):
            turned = vtk.vtkPolyData()
            turned.DeepCopy(image)
            points = vtk_to_numpy(turned.GetPoints().GetData())
            points[:, "xyz".index(axis)] *= -1
            if turned.GetPointData().HasArray("vector"):
                array(turned.GetPointData(), "vector")[:, "xyz".index(axis)] *= -1
            images.append(turned)
            append.AddInputData(turned)
    append.Update()
    return append.GetOutput()


def isolines(data, name, levels):
    """Lines of these values; none in polygons with a node whose value is not finite."""
    finite = vtk.vtkThreshold()
    finite.SetInputData(data)
    finite.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, name)
    finite.SetLowerThreshold(-sys.float_info.max)
    finite.SetUpperThreshold(sys.float_info.max)
    contour = vtk.vtkContourFilter()
    if np.isfinite(array(data.GetPointData(), name)).all():
        contour.SetInputData(data)
    else:
        contour.SetInputConnection(finite.GetOutputPort())
    contour.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, name)
    for i, value in enumerate(levels):
        contour.SetValue(i, value)
    join = vtk.vtkStripper()
    join.SetInputConnection(contour.GetOutputPort())
    join.JoinContiguousSegmentsOn()
    join.Update()
    return rounded(join.GetOutput())


def rounded(lines, passes=6):
    """Lines with their corners rounded: each inner point moves halfway to the middle of its neighbors."""
    offsets = vtk_to_numpy(lines.GetLines().GetOffsetsArray())
    corners = vtk_to_numpy(lines.GetLines().GetConnectivityArray())
    if len(corners) == 0:
        return lines
    points = vtk_to_numpy(lines.GetPoints().GetData())[corners]
    inner = np.ones(len(corners), bool)
    inner[offsets[:-1]] = inner[offsets[1:] - 1] = False
    at = np.nonzero(inner)[0]
    before, after = at - 1, at + 1
    closed = corners[offsets[:-1]] == corners[offsets[1:] - 1]  # both ends stay one point
    for _ in range(passes):
        moved = 0.5 * points[at] + 0.25 * (points[before] + points[after])
        first, last = offsets[:-1][closed], offsets[1:][closed] - 1
        ends = 0.5 * points[first] + 0.25 * (points[first + 1] + points[last - 1])
        points[at] = moved
        points[first] = points[last] = ends
    result = vtk.vtkPolyData()
    nodes = vtk.vtkPoints()
    nodes.SetData(numpy_to_vtk(points, deep=True))
    result.SetPoints(nodes)
    cells = vtk.vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(offsets.astype(np.int64), deep=True),
                  numpy_to_vtkIdTypeArray(np.arange(len(corners), dtype=np.int64), deep=True))
    result.SetLines(cells)
    return result
