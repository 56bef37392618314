# SPDX-License-Identifier: GPL-3.0-or-later
"""What PAMR writes is read by other programs: meshio, Gmsh, VTK, cgnscheck and PAMR itself, over a matrix of meshes. What is not
installed is left out, and said. The full level has the whole product, and VTK."""
import importlib.util
import itertools
import os
import pathlib
import shutil
import subprocess
import warnings

import numpy as np

import pamr
from collective import COMM, in_folder, run_tests

CONVERT = pathlib.Path(pamr.__file__).resolve().parents[2] / "bin" / "pamr-convert"
FULL = os.environ.get("PAMR_TEST_LEVEL") == "full"
ODD = ['a "quoted" wall', "two words", "in/out", "100 %", "sölid = <b> & 'c'", "semi;colon{}"]
MATRIX = [{}, {"regions": [0]}, {"regions": [3, 7]}, {"regions": [0, 5]}, {"regions": [-1, 2]}, {"names": ODD}, {"empty": True},
          {"cells": 1}, {"cells": 1, "regions": [0]}, {"names": ODD, "empty": True, "fields": True, "regions": [0, 2]}]
if FULL:
    MATRIX = [dict(zip(("cells", "regions", "names", "empty", "fields"), how)) for how in itertools.product(
        (1, 48), (None, [0], [3, 7], [0, 5], [-1, 2]), (None, ODD), (False, True), (False, True))]


def has(module, package):
    found = importlib.util.find_spec(module) is not None
    if not found:
        print(f"{module} was not found and reads nothing here (Debian: {package})", flush=True)
    return found


def has_program(name, package):
    if shutil.which(name) is None:
        print(f"{name} was not found and reads nothing here (Debian: {package})", flush=True)
    return shutil.which(name) is not None


def one_cell():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    triangles = np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]])
    return pamr.Mesh.from_arrays(COMM, points, [[0, 1, 2, 3]], (triangles, np.arange(4)))


def make(name, cells=48, regions=None, names=None, empty=False, fields=False):
    """A mesh. `regions`: values of the field, in turn; `names` of patches; `empty`: one more patch without faces."""
    import h5py
    mesh = one_cell() if cells == 1 else pamr.Mesh.kuhn_cube(COMM, 2)
    n = len(mesh.cells)
    if regions:
        mesh.cell_fields["region"] = np.resize(np.array(regions, np.int32), n)
    if fields:
        mesh.cell_fields["pressure"], mesh.node_fields["T"] = np.arange(n) + 0.5, mesh.points[:, 0] + 0.1
        mesh.node_fields["v"], mesh.cell_fields["material"] = 2 * mesh.points, np.arange(n)
    mesh.write(name)
    if not names and not empty:
        return mesh
    with h5py.File(name, "r+") as file:
        patches = file["PAMR/patches"]
        old = [text.decode() for text in patches["names"][:]]
        new = (list(names)[:len(old)] if names else old) + (["nothing here"] if empty else [])
        for key in list(patches):
            values = patches[key][:]
            data = new if key == "names" else list(values) + ([values[0]] if empty else [])
            dtype = h5py.string_dtype() if key == "names" else patches[key].dtype
            del patches[key]
            patches.create_dataset(key, data=data, dtype=dtype)
            file["PAMR/checksums"].attrs.pop("PAMR/patches/" + key, None)
    return pamr.Mesh.read(COMM, name)


def in_order(mesh, values):
    """Values on the points of the mesh, by their numbers."""
    result = np.empty_like(values)
    result[mesh.node_numbers] = values
    return result


def each_mesh():
    for how in MATRIX:
        how = {key: value for key, value in how.items() if value}
        mesh = make("mesh.hdf", **how)
        counts = np.bincount(mesh.boundary_faces().patches, minlength=len(mesh.patches)).tolist()
        yield how, mesh, {name: n for name, n in zip(mesh.patches, counts) if n}


def written(mesh, ending, *options):
    if options:
        mesh.write("mesh.hdf")
        subprocess.run([CONVERT, "mesh.hdf", "out." + ending, "--quiet", "--force", *options], check=True)
    else:
        mesh.write("out." + ending)
    return "out." + ending


def gmsh_kinds(how):
    """Format 4.1 in binary always, the others by the tool, which takes longer, where most is in the mesh."""
    return [()] + [("--gmsh-version", "2.2", "--text"), ("--gmsh-version", "2.2"), ("--text",)] * (FULL or len(how) > 1)


def counts_of(tags):
    return sorted(np.unique(tags, return_counts=True)[1].tolist())


@in_folder
def test_meshio_reads_every_format():
    if not has("meshio", "python3-meshio"):
        return
    from whole_meshio import meshio
    keys = {"msh": "gmsh:physical", "vtu": "patch", "su2": "su2:tag", "lb8.ugrid": "ugrid:ref"}
    for how, mesh, n_faces in each_mesh():
        for ending, options in [(e, ()) for e in ("vtu", "mesh", "meshb", "su2", "lb8.ugrid")] + [("msh", o) for o in gmsh_kinds(how)]:
            where = f"meshio, {how} {ending} {options}"
            try:
                read = meshio.read(written(mesh, ending, *options))
            except BaseException as error:
                raise AssertionError(f"{where}: {type(error).__name__}: {error}") from error
            assert np.array_equal(read.points, in_order(mesh, mesh.points)), where
            assert sorted(read.cells_dict["tetra"].tolist()) == sorted(mesh.node_numbers[mesh.cells].tolist()), where
            key = keys.get(ending, "medit:ref")
            assert counts_of(read.cell_data_dict[key]["triangle"]) == sorted(n_faces.values()), where
            if ending == "msh":
                names = {name for name, (_, dimension) in read.field_data.items() if dimension == 2}
                assert names >= {name.replace('"', "'") for name in n_faces}, (where, names)
            if "regions" in how and key in ("medit:ref", "gmsh:physical"):
                assert counts_of(read.cell_data_dict[key]["tetra"]) == counts_of(mesh.cell_fields["region"]), where
            if how.get("fields") and ending == "vtu":
                assert np.array_equal(read.cell_data_dict["pressure"]["tetra"], mesh.cell_fields["pressure"]), where
                assert np.array_equal(read.point_data["v"], 2 * read.points), where


def gmsh_content(file):
    import gmsh
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.logger.start()
    try:
        gmsh.open(file)
        troubles = [line for line in gmsh.logger.get() if line.startswith(("Error", "Warning"))]
        elements = [sum(len(tags) for tags in gmsh.model.mesh.getElements(dimension)[1]) for dimension in (2, 3)]
        groups = {gmsh.model.getPhysicalName(*group): group for group in gmsh.model.getPhysicalGroups()}
        return len(gmsh.model.mesh.getNodes()[0]), elements, groups, troubles
    finally:
        gmsh.logger.stop()
        gmsh.finalize()


@in_folder
def test_gmsh_reads_its_own_and_medit():
    if not has("gmsh", "python3-gmsh"):
        return
    for how, mesh, n_faces in each_mesh():
        for ending, options in [("mesh", ())] + [("msh", o) for o in gmsh_kinds(how)]:
            where = f"Gmsh, {how} {ending} {options}"
            n_nodes, elements, groups, troubles = gmsh_content(written(mesh, ending, *options))
            assert n_nodes == len(mesh.points) and elements == [sum(n_faces.values()), len(mesh.cells)], (where, n_nodes, elements)
            assert not troubles, (where, troubles)
            if ending == "msh":
                assert set(groups) >= {name.replace('"', "'") for name in n_faces}, (where, groups)
                n_volumes = sum(dimension == 3 for dimension, _ in groups.values())
                assert n_volumes == 1 or n_volumes == len(set(how.get("regions", [1]))) or len(mesh.cells) == 1, (where, groups)


@in_folder
def test_vtk_reads_grids_and_surfaces():
    if not FULL or not has("vtk", "python3-vtk9"):
        return
    import vtk
    readers = {"vtu": vtk.vtkXMLUnstructuredGridReader, "vtp": vtk.vtkXMLPolyDataReader, "stl": vtk.vtkSTLReader,
               "ply": vtk.vtkPLYReader, "obj": vtk.vtkOBJReader}
    for how, mesh, n_faces in each_mesh():
        for ending, reader in readers.items():
            problems, source = [], reader()
            source.AddObserver("ErrorEvent", lambda *_: problems.append(1))
            source.SetFileName(written(mesh, ending))
            source.Update()
            read = source.GetOutput()
            assert not problems and read.GetNumberOfCells() == sum(n_faces.values()) + (len(mesh.cells) if ending == "vtu" else 0), (how, ending)
            if ending == "vtu" and how.get("fields"):
                assert read.GetPointData().GetArray("v").GetTuple(1) == tuple(2 * in_order(mesh, mesh.points)[1])


@in_folder
def test_cgnscheck_finds_no_fault():
    if not has_program("cgnscheck", "cgns-convert"):
        return
    for how, mesh, _ in each_mesh():
        done = subprocess.run(["cgnscheck", "-v", written(mesh, "cgns")], capture_output=True, text=True)
        lines = (done.stdout + done.stderr).splitlines()
        # names of fields are the user's, not those of the standard
        known = ("dataclass not given", "dataclass is not given", "not a CGNS data-name identifier")
        bad = [line for line in lines if "ERROR" in line or "WARNING" in line and not line.endswith(known)]
        assert done.returncode == 0 and "checking complete" in lines and not bad, (how, bad)


@in_folder
def test_pamr_reads_all_of_it_back():
    for how, mesh, n_faces in each_mesh():
        for ending in ("msh", "vtu", "mesh", "meshb", "su2", "lb8.ugrid", "cgns", ""):
            name = written(mesh, ending) if ending else "case"
            if not ending:
                mesh.write(name)
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                back = pamr.Mesh.read(COMM, name)
            told = [str(w.message) for w in told if "1 named group has no element: 'nothing" not in str(w.message)]
            counts = sorted(np.bincount(back.boundary_faces().patches).tolist())
            where = f"{how} {ending}"
            assert (back.n_cells, back.n_nodes, counts) == (mesh.n_cells, mesh.n_nodes, sorted(n_faces.values())), where
            assert np.isclose(back.volumes().sum(), mesh.volumes().sum(), rtol=1e-12) and not told, (where, told)
            if ending in ("msh", "vtu", "cgns", "mesh", "meshb") and "regions" in how:
                assert counts_of(back.cell_fields["region"]) == counts_of(mesh.cell_fields["region"]), where
                assert set(back.cell_fields["region"]) == set(mesh.cell_fields["region"]), where


run_tests(globals())
