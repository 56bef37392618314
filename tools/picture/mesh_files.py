# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads mesh files of every kind that a picture can be made of into one form."""
import contextlib
import dataclasses
import fnmatch
import io
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from refused import Refused
from tet import FACE_TO_CORNER

NATIVE = (".hdf", ".vtkhdf")
# Surfaces of triangles are drawn as they are; the files of the second kind hold tetrahedra or triangles alone.
BY_VTK, BY_MESHIO = (".stl", ".ply", ".obj", ".vtp"), (".off",)
MAYBE_BY_VTK, MAYBE_BY_MESHIO = (".vtu", ".vtk"), (".msh", ".mesh", ".meshb")
NO_PATCH = "boundary"


@dataclasses.dataclass
class Mesh:
    """Tetrahedra with their boundary, or a surface of triangles alone (`cells` is empty then)."""
    file: str
    points: np.ndarray                   # N x 3
    cells: np.ndarray                    # M x 4
    faces: np.ndarray                    # F x 3, triangles of the boundary, outward if there are cells
    face_owner: np.ndarray               # F, row of the cell fields: the cell, or the triangle itself
    face_patch: np.ndarray               # F, row of `patches`
    patches: list
    cell_fields: dict = dataclasses.field(default_factory=dict)
    node_fields: dict = dataclasses.field(default_factory=dict)
    units: dict = dataclasses.field(default_factory=dict)  # of fields
    level: np.ndarray = None             # of the rows of the cell fields
    length_unit: str = ""
    more_groups: dict = dataclasses.field(default_factory=dict)  # of patches in several: their names
    region_names: dict = dataclasses.field(default_factory=dict)  # of values of the field `region`

    @property
    def groups(self):
        """Of each patch the names that it answers to."""
        return {patch: [patch] + self.more_groups.get(patch, []) for patch in self.patches}

    @property
    def n_rows(self):
        """Rows of the cell fields."""
        return len(self.cells) if len(self.cells) else len(self.faces)

    @property
    def name(self):
        return os.path.splitext(os.path.basename(self.file.rstrip("/")))[0]


def patches_named(pattern, groups):
    """The patches for which a name stands that a user has given: that of this name and those in the group of this name, or else
    all that fit it as a pattern of the shell. `groups`: of each patch its own name and those of its groups."""
    exact = {name for name, known in groups.items() if pattern in known}
    return exact or {name for name, known in groups.items() if any(fnmatch.fnmatchcase(one, pattern) for one in known)}


def groups_in(text):
    """The names in a text of groups: number, bytes of the name and name of each."""
    rest, names = text.encode(), []
    while rest:
        _, length, rest = rest.split(b" ", 2)
        names.append(rest[:int(length)].decode())
        rest = rest[int(length) + 1:]
    return names


def face_keys(triangles):
    return np.sort(triangles, axis=1).astype(np.int64)


def outer_faces(cells):
    """Faces of one cell only, and these cells."""
    if not len(cells):
        return np.empty((0, 3), cells.dtype), np.empty(0, np.int64)
    triangles = cells[:, FACE_TO_CORNER].reshape(-1, 3)
    keys = face_keys(triangles)
    order = np.lexsort(keys.T[::-1])
    keys = keys[order]
    same = np.concatenate([[False], (keys[1:] == keys[:-1]).all(axis=1), [False]])
    single = np.sort(order[~(same[1:] | same[:-1])])
    return triangles[single], single // 4


def read_native(file):
    """A native file as it is: what is wrong with it can be looked at."""
    import h5py
    try:
        with h5py.File(file) as data:
            if "cell_to_cell" in data.get("PAMR", {}):
                return native_of(file, data)
    except OSError as wrong:
        raise Refused(f"{file}: expected a native mesh (HDF5): {wrong}") from None
    except (KeyError, ValueError, TypeError, IndexError) as wrong:
        raise Refused(f"{file}: expected a native mesh: {wrong.args[0]}") from None
    return read_by_convert(file)  # of another program, or without neighbors


def levels_of(own):
    """Levels of the cells from their lineages (docs/file-format-lineage.md)."""
    first_bit = 8 if own.attrs["format"] == 1 else 12
    return (own["lineage"][:] >> first_bit & 0xFF).astype(int)


def native_of(file, data):
    import h5py
    grid, own = data["VTKHDF"], data["PAMR"]
    points, cells = grid["Points"][:].astype(float), grid["Connectivity"][:].reshape(-1, 4)
    if (grid["Types"][:] != 10).any():
        raise Refused(f"{file}: expected tetrahedra only, found cells of other types")
    more = {"cell_fields": {}, "node_fields": {}, "units": {}}
    for group, key in (("CellData", "cell_fields"), ("PointData", "node_fields")):
        for name, field in grid.get(group, {}).items():
            more[key][name] = field[()] if isinstance(field, h5py.Dataset) else np.empty(0)
            if "unit" in field.attrs:
                more["units"][name] = text_of(field.attrs["unit"])
    more["level"] = levels_of(own) if "lineage" in own else np.zeros(len(cells), int)
    more["length_unit"] = text_of(own.attrs.get("length_unit", ""))
    if "regions/names" in own:
        more["region_names"] = dict(zip(own["regions/numbers"][:].tolist(), map(text_of, own["regions/names"][:])))
    neighbors = own["cell_to_cell"][:]
    cell, slot = np.nonzero(neighbors < 0)
    faces = np.take_along_axis(cells[cell], FACE_TO_CORNER[slot], axis=1)
    patches = [text_of(name) for name in own["patches/names"][:]] if "patches/names" in own else [NO_PATCH]
    if "patches/groups" in own:
        more["more_groups"] = dict(zip(patches, map(groups_in, map(text_of, own["patches/groups"][:]))))
    return Mesh(file, points, cells, faces, cell, -neighbors[cell, slot] - 1, patches, **more)


def text_of(value):
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def read_by_vtk(file):
    import vtk
    readers = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".vtp": vtk.vtkXMLPolyDataReader,
               ".vtk": vtk.vtkDataSetReader, ".stl": vtk.vtkSTLReader, ".ply": vtk.vtkPLYReader,
               ".obj": vtk.vtkOBJReader}
    vtk.vtkObject.GlobalWarningDisplayOff()
    reader = readers[os.path.splitext(file)[1].lower()]()
    reader.SetFileName(file)
    reader.Update()
    grid = reader.GetOutput()
    if grid is None or grid.GetNumberOfPoints() == 0 or grid.GetNumberOfCells() == 0:
        raise Refused(f"{file}: expected a mesh, found none that VTK can read")
    mesh = surface_of_vtk(file, grid)
    mesh.units = units_of(grid.GetCellData()) | units_of(grid.GetPointData())
    return mesh


def units_of(data):
    """By name of the array, where VTK's key UNITS_LABEL says one."""
    import vtk
    key = vtk.vtkDataArray.UNITS_LABEL()
    arrays = [array for array in map(data.GetArray, range(data.GetNumberOfArrays())) if array is not None]
    return {array.GetName(): array.GetInformation().Get(key) for array in arrays if array.GetInformation().Has(key)}


def arrays_of(data):
    from vtk.util.numpy_support import vtk_to_numpy
    arrays = (data.GetArray(i) for i in range(data.GetNumberOfArrays()))
    return {array.GetName(): vtk_to_numpy(array) for array in arrays if array is not None and array.GetName()}


def surface_of_vtk(file, grid):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    nodes, fields = arrays_of(grid.GetPointData()), arrays_of(grid.GetCellData())
    if grid.IsA("vtkPolyData"):
        strips = vtk.vtkTriangleFilter()
        strips.SetInputData(grid)
        strips.PassLinesOff()
        strips.PassVertsOff()
        strips.Update()
        grid = strips.GetOutput()
        fields = arrays_of(grid.GetCellData())
        triangles = vtk_to_numpy(grid.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        return surface(file, points, triangles, fields, nodes)
    types = vtk_to_numpy(grid.GetCellTypesArray())
    rows = np.nonzero(types == 5)[0]
    require_triangles(file, len(rows), [f"cells of type {kind}" for kind in np.unique(types[types > 9])])  # vtkCellType.h
    begins = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    triangles = connectivity[begins[rows][:, None] + np.arange(3)]
    return surface(file, points, triangles, {name: values[rows] for name, values in fields.items()}, nodes)


def require_triangles(file, n_triangles, others):
    """A file with cells of volume (or of second order) is no surface: pamr-convert reads it, or says why not."""
    if n_triangles == 0 or others:
        raise Refused(f"{file}: expected triangles of first order, found {', '.join(others) or 'none'}")


def surface(file, points, triangles, fields, nodes, patch=None, names=None):
    """A mesh of triangles alone."""
    if patch is None and "patch" in fields and fields["patch"].ndim == 1:
        patch = fields["patch"].astype(int)
    patch = np.zeros(len(triangles), int) if patch is None else patch
    known = np.unique(patch)
    names = names or ({} if len(known) > 1 else {int(known[0]): NO_PATCH})
    labels = [names.get(tag, f"patch_{tag}") for tag in known.tolist()]
    return Mesh(file, points, np.empty((0, 4), int), triangles, np.arange(len(triangles)),
                np.searchsorted(known, patch), labels, cell_fields=fields, node_fields=nodes)


def read_by_meshio(file):
    try:
        import meshio
    except ImportError:
        raise Refused(f"{file}: reading this format needs the package python3-meshio; or convert it: "
                      f"pamr-convert {file} mesh.hdf") from None
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            mesh = meshio.read(file)
    except SystemExit:
        raise Refused(f"{file}: expected a mesh, found one that meshio cannot read") from None
    except Exception as wrong:  # its readers raise anything on a bad file
        raise Refused(f"{file}: expected a mesh, found one that meshio cannot read: {wrong}") from None
    points = np.zeros((len(mesh.points), 3))
    points[:, :mesh.points.shape[1]] = mesh.points
    blocks = [i for i, block in enumerate(mesh.cells) if block.type == "triangle"]
    require_triangles(file, len(blocks), sorted({block.type for block in mesh.cells} - {"vertex", "line", "triangle", "quad"}))
    fields = {name: np.concatenate([values[i] for i in blocks]) for name, values in mesh.cell_data.items()}
    array = next((name for name in ("gmsh:physical", "medit:ref") if name in fields), None)
    names = {int(tag): name for name, (tag, dimension) in mesh.field_data.items() if dimension == 2}
    return surface(file, points, np.concatenate([mesh.cells[i].data for i in blocks]), fields, dict(mesh.point_data),
                   fields[array].astype(int) if array else None, names)


def read_by_convert(file):
    """A mesh of tetrahedra as all tools see it: through a native file of pamr-convert, which lies beside this tool and whose warnings
    are passed on."""
    tool = os.path.join(os.path.dirname(os.path.realpath(sys.argv[0])), "pamr-convert")
    tool = tool if os.path.exists(tool) else shutil.which("pamr-convert")
    if tool is None:
        raise Refused(f"{file}: reading this format needs pamr-convert beside pamr-picture, found none")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMI", "PRTE_"))}  # alone
    from files import tell, unfinished
    from x_server import dies_with_its_parent
    with tempfile.TemporaryDirectory(prefix="pamr-picture-") as folder:
        unfinished.append(folder)
        native = os.path.join(folder, "mesh.hdf")
        done = subprocess.run([tool, "--quiet", "--", file, native], capture_output=True, env=environment,
                              preexec_fn=dies_with_its_parent)
        said = [line.removeprefix("pamr-convert: ") for line in os.fsdecode(done.stderr).split("\n")]
        if done.returncode:
            wrong = [line.removeprefix("error: ") for line in said if line.startswith("error: ")]
            raise Refused("pamr-convert: " + (wrong[0] if wrong else f"{file}: ended with exit code {done.returncode}"))
        mesh = read_native(native)
    mesh.file = file
    for line in said:
        if line.startswith("warning: "):
            tell("pamr-picture: warning: pamr-convert: " + line.removeprefix("warning: "))
    return mesh


def read_by(reader):
    """Through pamr-convert; where it refuses what is a surface of triangles alone, by this reader."""
    def read_file(file):
        try:
            return read_by_convert(file)
        except Refused as wrong:
            with contextlib.suppress(Refused):
                return reader(file)
            raise wrong from None
    return read_file


READERS = {**dict.fromkeys(NATIVE, read_native), **dict.fromkeys(BY_VTK, read_by_vtk), **dict.fromkeys(BY_MESHIO, read_by_meshio),
           **dict.fromkeys(MAYBE_BY_VTK, read_by(read_by_vtk)), **dict.fromkeys(MAYBE_BY_MESHIO, read_by(read_by_meshio))}


def require_sound(mesh):
    """Refuses a mesh without the parts that a picture needs; it may be wrong in other ways."""
    def require(is_true, expected):
        if not is_true:
            raise Refused(f"{mesh.file}: expected {expected}, found others")
    n = len(mesh.points)
    require(mesh.points.shape == (n, 3) and np.isfinite(mesh.points).all(), "finite coordinates x, y and z")
    require(mesh.n_rows > 0, "cells or triangles")
    for rows in (mesh.cells, mesh.faces):
        require(not rows.size or 0 <= rows.min() and rows.max() < n, f"numbers of nodes from 0 to {n - 1}")
    n_patches = len(mesh.patches)
    require(not len(mesh.faces) or mesh.face_patch.max() < n_patches, f"patches from 0 to {n_patches - 1}")
    require(mesh.level is None or len(mesh.level) == mesh.n_rows, f"{mesh.n_rows} lineages, one of each cell")


def read(file):
    """The mesh of a file; the extension decides who reads it."""
    extension = "" if os.path.isdir(file) else os.path.splitext(file)[1].lower()
    mesh = READERS.get(extension, read_by_convert)(file)
    require_sound(mesh)
    return mesh
