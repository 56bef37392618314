# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-convert --order 2: meshio and VTK read the cells of second order; Gmsh and dolfinx where they are installed."""
import importlib.util
import pathlib

import h5py
import numpy as np
import vtk

from tool_run import FULL, kuhn_cube, refuses, run, run_tests, same_bytes
from whole_meshio import meshio

CELL_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]  # VTK's and meshio's order
FACE_EDGES = [(0, 1), (1, 2), (2, 0)]
FORMATS = [("2.2", True), ("2.2", False), ("4.1", True), ("4.1", False)]
DOME = '[[surface]]\nname = "dome"\nkind = "sphere"\ncenter = [0.5, 0.5, -0.4]\nradius = 0.8\n'


def ball_in_box(name="box.hdf"):
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.5", "-o", name, "--quiet", serial=True)
    return name


def domed_cube(name="dome.hdf"):
    """A cube on a sphere that bulges far into its cells: the nodes of the patch are not on it yet."""
    kuhn_cube("cube.hdf", 2)
    pathlib.Path("dome.toml").write_text(DOME)
    run("pamr-convert", "cube.hdf", name, "--surfaces", "dome.toml", "--tie", "zmin=dome", "--tolerance", "10", "--no-repair",
        "--quiet", serial=True)
    return name


def expect_nodes_of_the_ball(points, cells, triangles):
    """One node for each edge: in the middle, or on the sphere for an edge of its triangles."""
    on_sphere = np.isclose(np.linalg.norm(points, axis=1), 1, rtol=0, atol=1e-14)
    curved, node_of = set(), {}
    for triangle in triangles:
        if on_sphere[triangle[:3]].all():
            curved |= {frozenset((triangle[a], triangle[b])) for a, b in FACE_EDGES}
    for rows, edges, first in ((cells, CELL_EDGES, 4), (triangles, FACE_EDGES, 3)):
        for row in rows:
            for k, (a, b) in enumerate(edges):
                edge, node = frozenset((row[a], row[b])), row[first + k]
                assert node_of.setdefault(edge, node) == node, "two nodes on one edge"
                if edge not in curved:
                    assert np.array_equal(points[node], 0.5 * (points[row[a]] + points[row[b]])), "not in the middle"
                else:
                    middle = 0.5 * (points[row[a]] + points[row[b]])
                    assert np.allclose(points[node], middle / np.linalg.norm(middle), rtol=0, atol=1e-14)
    assert len(set(node_of.values())) == len(node_of) and len(curved) > 100
    return len(node_of), len(curved)


def test_files_have_a_node_on_every_edge_in_the_order_of_their_format():
    ball_in_box()
    with h5py.File("box.hdf") as file:
        corners, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
    for name, how in [("box.vtu", [])] + [(f"box{version}{text}.msh", ["--gmsh-version", version] + ["--text"] * text)
                                          for version, text in FORMATS]:
        report = run("pamr-convert", "box.hdf", name, "--order", 2, *how, "--json", "-").json
        read = meshio.read(name)
        assert set(read.cells_dict) == {"tetra10", "triangle6"}
        assert np.array_equal(read.points[:len(corners)], corners) and len(read.points) == report["nodes"]
        assert np.array_equal(read.cells_dict["tetra10"][:, :4], cells)
        n_edges, n_curved = expect_nodes_of_the_ball(read.points, read.cells_dict["tetra10"], read.cells_dict["triangle6"])
        assert (n_edges, n_curved) == (report["edges"], report["curved_edges"])
        assert report["order"] == 2 and report["nodes"] == len(corners) + n_edges
        assert report["straightened_edges"] == report["straightened_cells"] == report["off_surface_mid_nodes"] == 0
        assert 0.1 < report["min_jacobian"] <= 1
        if name.endswith(".msh"):
            for patch, (tag, dimension) in read.field_data.items():
                of_patch = read.cells_dict["triangle6"][read.cell_data_dict["gmsh:physical"]["triangle6"] == tag]
                assert len(of_patch) > 0 and dimension == 2
                assert np.allclose(np.linalg.norm(read.points[of_patch], axis=2), 1) == (patch == "sphere")


def test_vtk_sees_the_same_edges():
    ball_in_box()
    run("pamr-convert", "box.hdf", "box.vtu", "--order", 2, "--quiet")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName("box.vtu")
    reader.Update()
    grid = reader.GetOutput()
    types = [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())]
    assert set(types) == {vtk.VTK_QUADRATIC_TETRA, vtk.VTK_QUADRATIC_TRIANGLE}
    for i in range(0, grid.GetNumberOfCells(), 7):
        cell = grid.GetCell(i)
        for e in range(cell.GetNumberOfEdges()):
            a, b, m = (np.array(cell.GetEdge(e).GetPoints().GetPoint(k)) for k in range(3))
            assert np.linalg.norm(m - 0.5 * (a + b)) < 0.1 * np.linalg.norm(b - a)


def test_files_do_not_depend_on_the_number_of_ranks():
    ball_in_box()
    domed_cube()
    for mesh in ("box.hdf", "dome.hdf"):
        for name in ("a.vtu", "a.msh"):
            run("pamr-convert", mesh, name, "--order", 2, "--quiet", "--force", serial=True)
            for ranks in (2, 3, 4, 7) if FULL else (3,):
                run("pamr-convert", mesh, "b" + name, "--order", 2, "--quiet", "--force", ranks=ranks)
                assert same_bytes(name, "b" + name), (mesh, name, ranks)


def shape_derivatives(l):
    """Of the ten shape functions in VTK's order by the three last barycentric coordinates."""
    steps = np.array([[-1, 1, 0, 0], [-1, 0, 1, 0], [-1, 0, 0, 1]], float)
    return np.array([[(4 * l[i] - 1) * s[i] for i in range(4)] + [4 * (s[a] * l[b] + l[a] * s[b]) for a, b in CELL_EDGES]
                     for s in steps])


def smallest_jacobian(points, cells, n=8):
    smallest = np.inf
    for i in range(n + 1):
        for j in range(n + 1 - i):
            for k in range(n + 1 - i - j):
                l = np.array([n - i - j - k, i, j, k]) / n
                smallest = min(smallest, np.linalg.det(shape_derivatives(l) @ points[cells]).min())
    return smallest


def test_cells_that_would_fold_are_straightened_and_counted():
    domed_cube()
    result = run("pamr-convert", "dome.hdf", "dome.vtu", "--order", 2, "--json", "-")
    report = result.json
    assert report["straightened_cells"] > 0 and report["straightened_edges"] > 0 and report["straightening_rounds"] > 0
    assert "would fold" in result.err and f"{report['straightened_edges']} of" in result.err
    read = meshio.read("dome.vtu")
    assert smallest_jacobian(read.points, read.cells_dict["tetra10"]) > 0
    distance = np.abs(np.linalg.norm(read.points - [0.5, 0.5, -0.4], axis=1) - 0.8)
    on_floor = np.unique(read.cells_dict["triangle6"][read.cell_data_dict["patch"]["triangle6"] == 4])
    assert np.allclose(read.point_data["off_surface"][on_floor], distance[on_floor], atol=1e-12)
    assert np.isclose(distance[on_floor[on_floor >= 27]].max(), report["max_off_surface"])


def test_fields_on_nodes_reach_the_mid_edge_nodes():
    kuhn_cube("cube.hdf", 2)
    with h5py.File("cube.hdf", "r+") as file:
        file["VTKHDF"].require_group("PointData")["flow"] = file["VTKHDF/Points"][:] * 2
        file["VTKHDF"].require_group("CellData")["weight"] = np.arange(file["VTKHDF/Types"].shape[0]) * 0.5
    run("pamr-convert", "cube.hdf", "cube.vtu", "--order", 2, "--quiet")
    read = meshio.read("cube.vtu")
    assert np.array_equal(read.point_data["flow"], 2 * read.points)
    assert np.array_equal(read.cell_data_dict["weight"]["tetra10"], np.arange(48) * 0.5)


def test_other_formats_and_orders_are_refused():
    kuhn_cube("cube.hdf", 1)
    for name in ("x.hdf", "x.stl", "case"):
        refuses("pamr-convert", "cube.hdf", name, "--order", 2, says=["--order 2", ".msh or .vtu", name], creates=name)
    refuses("pamr-convert", "cube.hdf", "x.msh", "--order", 3, says=["--order"], creates="x.msh")
    run("pamr-convert", "cube.hdf", "x.msh", "--order", 2, "--quiet")
    refuses("pamr-convert", "x.msh", "back.hdf", says=["x.msh"], creates="back.hdf")


if importlib.util.find_spec("gmsh"):  # CMakeLists.txt says so where it is missing
    def test_gmsh_finds_all_jacobians_positive():
        import gmsh
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        ball_in_box()
        domed_cube()
        for mesh, volume in (("box.hdf", 64 - 4 * np.pi / 3), ("dome.hdf", None)):
            for version, text in FORMATS:
                run("pamr-convert", mesh, "g.msh", "--order", 2, "--gmsh-version", version, *["--text"] * text, "--quiet",
                    "--force", serial=True)
                gmsh.clear()
                gmsh.open("g.msh")
                kinds, tags, _ = gmsh.model.mesh.getElements(3)
                assert list(kinds) == [11]
                points, weights = gmsh.model.mesh.getIntegrationPoints(11, "Gauss6")
                determinants = np.array(gmsh.model.mesh.getJacobians(11, points)[1]).reshape(len(tags[0]), -1)
                assert determinants.min() > 0
                assert volume is None or np.isclose((determinants @ weights).sum(), volume, rtol=1e-4)
            gmsh.plugin.setNumber("AnalyseMeshQuality", "Recompute", 1)
            gmsh.plugin.setNumber("AnalyseMeshQuality", "JacobianDeterminant", 1)
            gmsh.plugin.setNumber("AnalyseMeshQuality", "CreateView", 1)
            gmsh.plugin.setNumber("AnalyseMeshQuality", "DimensionOfElements", 3)
            gmsh.plugin.run("AnalyseMeshQuality")  # smallest over largest Jacobian of each cell, by Bezier bounds of its own
            ratio = np.array(gmsh.view.getModelData(gmsh.view.getTags()[-1], 0)[2]).ravel()
            assert len(ratio) == len(tags[0]) and ratio.min() > 0
        gmsh.finalize()


run_tests(globals(), on_ranks=(test_files_do_not_depend_on_the_number_of_ranks,
                               test_cells_that_would_fold_are_straightened_and_counted))
