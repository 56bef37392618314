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
BY_VTK = (".vtu", ".vtp", ".vtk", ".stl", ".ply", ".obj")
BY_MESHIO = (".msh", ".mesh", ".meshb", ".su2", ".off", ".ugrid")
BY_CONVERT = (".cgns", ".mfem", "")  # "": the folder of an OpenFOAM case
NO_PATCH = "boundary"
# Arrays of tags, and how pamr-convert begins the name of a tag that has none (lib/pamr/io/vtk/vtk_grid.cpp).
TAG_ARRAYS = {"boundary_patch": "patch_", "patch": "patch_", "gmsh:physical": "physical_", "gmsh:geometrical": "surface_",
              "medit:ref": "ref_", "tetgen:ref": "patch_", "netgen:index": "patch_", "ugrid:ref": "surface_", "nastran:ref": "patch_",
              "su2:tag": "patch_", "avsucd:material": "patch_", "CellEntityIds": "patch_"}


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


def matched(faces, tagged, tags):
    """The tag of each face by the tagged triangle with the same nodes, -1 without one."""
    keys = np.concatenate([face_keys(tagged), face_keys(faces)])
    _, number = np.unique(keys, axis=0, return_inverse=True)
    number = number.ravel()
    tag_of = np.full(number.max(initial=0) + 1, -1)
    tag_of[number[:len(tagged)]] = tags
    return tag_of[number[len(tagged):]]


def untagged_name(others):
    """What pamr-convert calls the patch of faces without a tag beside these (lib/pamr/mesh/untagged_patch.cpp)."""
    return next(name for name in (NO_PATCH, *(f"{NO_PATCH}_{i}" for i in range(2, len(others) + 3))) if name not in others)


def with_boundary(file, points, cells, tagged, tags, names, rest=None, **more):
    """A mesh of cells whose patches come from tagged triangles; `names`: of tags; `rest`: of faces without one, if the file says it."""
    faces, owner = outer_faces(cells)
    found = matched(faces, tagged, tags) if len(tagged) else np.full(len(faces), -1)
    known = np.unique(found)
    patches = [names[tag] for tag in known.tolist() if tag >= 0]
    if -1 in known:
        patches.insert(0, rest or untagged_name(list(names.values())))
    return Mesh(file, points, cells, faces, owner, np.searchsorted(known, found), patches, **more)


def read_native(file):
    import h5py
    try:
        with h5py.File(file) as data:
            return native_of(file, data)
    except OSError as wrong:
        raise Refused(f"{file}: expected a native mesh (HDF5): {wrong}") from None
    except KeyError as missing:
        raise Refused(f"{file}: expected a native mesh: {missing.args[0]}") from None


def levels_of(own):
    """Levels of the cells from their lineages (docs/file-format-lineage.md)."""
    first_bit = 8 if own.attrs["format"] == 1 else 12
    return (own["lineage"][:] >> first_bit & 0xFF).astype(int)


def native_of(file, data):
    grid, own = data["VTKHDF"], data.get("PAMR", {})
    points, cells = grid["Points"][:].astype(float), grid["Connectivity"][:].reshape(-1, 4)
    if (grid["Types"][:] != 10).any():
        raise Refused(f"{file}: expected tetrahedra only, found cells of other types")
    more = {"cell_fields": {}, "node_fields": {}, "units": {}}
    for group, key in (("CellData", "cell_fields"), ("PointData", "node_fields")):
        for name, field in grid.get(group, {}).items():
            more[key][name] = field[:]
            if "unit" in field.attrs:
                more["units"][name] = text_of(field.attrs["unit"])
    more["level"] = levels_of(own) if "lineage" in own else np.zeros(len(cells), int)
    unit = getattr(own, "attrs", {}).get("length_unit", "")
    more["length_unit"] = text_of(unit)
    if "cell_to_cell" not in own:
        return with_boundary(file, points, cells, np.empty((0, 3), int), [], {}, **more)
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
    mesh = mesh_of_vtk(file, grid)
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


def patch_names(grid, start):
    """By number, as pamr-convert writes them: an array `patch NAME` (or `untagged patch NAME`) with the number for each patch."""
    return {int(values[0]): name[len(start):] for name, values in arrays_of(grid.GetFieldData()).items() if name.startswith(start)}


def named_tags(tags, names, before):
    """The names of all tags, of those without one as pamr-convert makes them."""
    return {tag: names.get(tag, f"{before}{tag}") for tag in np.unique(tags[tags >= 0]).tolist()}


def mesh_of_vtk(file, grid):
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
    begins = vtk_to_numpy(grid.GetCells().GetOffsetsArray())
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    rows = {kind: np.nonzero(types == code)[0] for kind, code in (("cells", 10), ("triangles", 5))}
    cells = connectivity[begins[rows["cells"]][:, None] + np.arange(4)]
    triangles = connectivity[begins[rows["triangles"]][:, None] + np.arange(3)]
    if len(cells) + len(triangles) == 0:
        raise Refused(f"{file}: expected tetrahedra or triangles, found cells of other types only")
    if len(cells) == 0:
        return surface(file, points, triangles, {n: v[rows["triangles"]] for n, v in fields.items()}, nodes)
    array = next((name for name in TAG_ARRAYS if name in fields and fields[name].ndim == 1 and fields[name].dtype.kind in "iu"), None)
    tags = fields[array][rows["triangles"]].astype(int) if array else np.full(len(triangles), -1)
    untagged = patch_names(grid, "untagged patch ") if array else {}
    tags[np.isin(tags, list(untagged))] = -1
    names = named_tags(tags, patch_names(grid, "patch "), TAG_ARRAYS.get(array))
    fields = {name: values[rows["cells"]] for name, values in fields.items() if name not in ("patch", "boundary_patch")}
    level = fields["level"].astype(int) if "level" in fields else None
    return with_boundary(file, points, cells, triangles, tags, names, rest=next(iter(untagged.values()), None), cell_fields=fields,
                         node_fields=nodes, level=level)


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
    blocks = {kind: [i for i, block in enumerate(mesh.cells) if block.type == kind] for kind in ("tetra", "triangle")}

    def joined(values, kind, width):
        parts = [values[i] for i in blocks[kind]]
        return np.concatenate(parts) if parts else np.empty((0, width), int)

    data = [block.data for block in mesh.cells]
    cells, triangles = joined(data, "tetra", 4), joined(data, "triangle", 3)
    array = next((name for name in TAG_ARRAYS if name in mesh.cell_data), None) if len(triangles) else None
    tags = joined(mesh.cell_data[array], "triangle", 0).astype(int) if array else np.zeros(len(triangles), int)
    names = {int(tag): name for name, (tag, dimension) in mesh.field_data.items() if dimension == 2}
    if len(cells):
        if array in (None, "gmsh:physical"):  # 0 is no group
            tags[tags == 0] = -1
        fields = {k: joined(v, "tetra", 0) for k, v in mesh.cell_data.items()}
        return with_boundary(file, points, cells, triangles, tags, named_tags(tags, names, TAG_ARRAYS.get(array)), cell_fields=fields,
                             node_fields=dict(mesh.point_data))
    if len(triangles) == 0:
        raise Refused(f"{file}: expected tetrahedra or triangles of first order, found "
                      f"{', '.join(sorted({block.type for block in mesh.cells})) or 'no cells'}")
    fields = {k: joined(v, "triangle", 0) for k, v in mesh.cell_data.items()}
    return surface(file, points, triangles, fields, dict(mesh.point_data), tags, names)


def read_by_convert(file):
    """Through a native file that pamr-convert writes, which lies beside this tool."""
    tool = os.path.join(os.path.dirname(os.path.realpath(sys.argv[0])), "pamr-convert")
    tool = tool if os.path.exists(tool) else shutil.which("pamr-convert")
    if tool is None:
        raise Refused(f"{file}: reading this format needs pamr-convert beside pamr-picture, found none")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMI", "PRTE_"))}  # alone
    from picture import unfinished
    with tempfile.TemporaryDirectory(prefix="pamr-picture-") as folder:
        unfinished.append(folder)
        native = os.path.join(folder, "mesh.hdf")
        done = subprocess.run([tool, file, native, "--quiet"], capture_output=True, text=True, env=environment)
        if done.returncode:
            raise Refused(done.stderr.strip().removeprefix("pamr-convert: error: ") or f"{file}: pamr-convert failed")
        mesh = read_native(native)
    mesh.file = file
    return mesh


# Who reads which ending; tests/python/formats_test.py compares it with the table of formats (lib/pamr/io/formats.cpp).
READERS = {**dict.fromkeys(NATIVE, read_native), **dict.fromkeys(BY_VTK, read_by_vtk), **dict.fromkeys(BY_MESHIO, read_by_meshio),
           **dict.fromkeys(BY_CONVERT, read_by_convert)}


def is_mfem(file):
    """Both MFEM and Medit call their files .mesh."""
    with open(file, "rb") as text:
        return text.read(8).removeprefix(b"\xef\xbb\xbf").startswith(b"MFEM")


def read(file):
    """The mesh of a file; the extension decides who reads it."""
    extension = "" if os.path.isdir(file) else os.path.splitext(file)[1].lower()
    if not os.path.exists(file):
        raise Refused(f"{file}: expected a mesh file, found nothing of that name")
    if not os.path.isfile(file) and not os.path.isdir(file):
        raise Refused(f"{file}: expected a mesh file, found a device")
    if extension not in READERS or extension == "" and not os.path.isdir(file):
        raise Refused(f"{file}: expected a name that ends in {', '.join(filter(None, READERS))}, or an OpenFOAM case")
    if extension == ".mesh" and is_mfem(file):
        extension = ".mfem"
    mesh = READERS[extension](file)
    if not np.isfinite(mesh.points).all():
        raise Refused(f"{file}: expected finite coordinates, found others")
    return mesh
