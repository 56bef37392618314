# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from meshio: patches by tags, names, fields, points of no cell."""
import warnings

import numpy as np

import pamr
from collective import CELLS, COMM, FLOOR, POINTS, error_of, in_folder, run_tests


def tagged():
    import meshio
    points = np.insert(POINTS, 3, (9, 9, 9), axis=0)  # belongs to no tetrahedron
    new = np.array([0, 1, 2, 4, 5, 6, 7, 8])
    return meshio.Mesh(points, [("triangle", new[FLOOR]), ("tetra", new[CELLS]), ("line", [[0, 1]])],
                       point_data={"T": np.arange(9.0)},
                       cell_data={"gmsh:physical": [[4, 4], [7] * 6, [1]], "mark": [[0, 0], np.arange(6), [0]]},
                       field_data={"floor": np.array([4, 2]), "gas": np.array([7, 3])})


def test_a_mesh_on_rank_zero_is_spread_over_all():
    mesh = pamr.from_meshio(COMM, tagged() if COMM.rank == 0 else None)
    assert mesh.n_cells == 6 and mesh.n_nodes == 8 and mesh.patches == ["floor", "boundary"]
    faces = mesh.boundary_faces()
    assert COMM.allreduce(int((faces.patches == 0).sum())) == 2
    assert (mesh.points[faces.nodes[faces.patches == 0]][:, :, 2] == 0).all()
    expected = np.array([0, 1, 2, 4, 5, 6, 7, 8.0])
    by_place = {tuple(p): t for p, t in zip(POINTS, expected)}
    assert all(by_place[tuple(p)] == t for p, t in zip(mesh.points, mesh.node_fields["T"]))
    assert sorted(np.concatenate(COMM.allgather(mesh.cell_fields["mark"]))) == list(range(6))
    assert COMM.allreduce(len(mesh.cells), max) == -(-6 // COMM.size)


def test_what_is_no_tetrahedral_mesh_is_refused_everywhere():
    import meshio
    for kind, nodes in (("wedge", [range(6)]), ("tetra10", [range(10)]), ("quad", [range(4)] * 3), ("triangle6", [range(6)])):
        points = np.concatenate([POINTS, POINTS + 9])
        mixed = meshio.Mesh(points, [("tetra", CELLS), (kind, np.array([list(n) for n in nodes])), ("line3", [[0, 1, 2]])])
        assert f"(points and lines are left out), found {len(nodes)} of type {kind}" in error_of(
            lambda: pamr.from_meshio(COMM, mixed if COMM.rank == 0 else None))
    flat = meshio.Mesh(POINTS, [("triangle", FLOOR)])
    assert "expected tetrahedra, found triangle" in error_of(
        lambda: pamr.from_meshio(COMM, flat if COMM.rank == 0 else None))
    for none in (None, POINTS):
        assert f"expected a meshio.Mesh, found {type(none).__name__} (rank 0)" in refused(none)
    if COMM.size > 1:
        assert "on rank 0 alone" in error_of(lambda: pamr.from_meshio(COMM, tagged()))


def layer():
    """The unit cube as two wedges, with a pyramid on x = 1; two quads and the floor are tagged."""
    import meshio
    points = np.concatenate([POINTS, [(1.5, 0.5, 0.5)]])
    return meshio.Mesh(points, [("quad", [[0, 1, 5, 4], [2, 6, 7, 3]]), ("wedge", [[0, 1, 3, 4, 5, 7], [0, 3, 2, 4, 7, 6]]),
                                ("triangle", FLOOR), ("pyramid", [[1, 3, 7, 5, 8]])],
                       cell_data={"gmsh:physical": [[4, 5], [7, 7], [6, 6], [8]], "mark": [[0, 0], [1.5, 2.5], [0, 0], [3.5]]},
                       cell_sets={"half": [np.array([], int), np.array([1]), None, None]},
                       field_data={"y0": np.array([4, 2]), "y1": np.array([5, 2]), "floor": np.array([6, 2]), "gas": np.array([7, 3])})


def volumes(mesh):
    p = mesh.points[mesh.cells]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6


def area_of(mesh, patch):
    faces = mesh.boundary_faces()
    p = mesh.points[faces.nodes[faces.patches == mesh.patches.index(patch)]]
    return COMM.allreduce(np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2)


def test_wedges_pyramids_and_quads_are_cut_on_request():
    mesh, told = taken(layer(), split_prisms=True)
    assert mesh.n_cells == 8 and mesh.n_turned == 0 and told == [], told
    volume, mark, region = volumes(mesh), mesh.cell_fields["mark"], mesh.cell_fields["region"]
    for value, expected in ((1.5, 0.5), (2.5, 0.5), (3.5, 0.5 / 3)):
        assert abs(COMM.allreduce(volume[mark == value].sum()) - expected) < 1e-14, value
    joint = next(number for number, name in mesh.regions.items() if name == "gas+half")
    for number, expected in ((7, 1.5), (joint, 2.5), (8, 3.5)):
        assert set(np.concatenate(COMM.allgather(mark[region == number]))) == {expected}
    for patch in ("y0", "y1", "floor"):
        assert abs(area_of(mesh, patch) - 1) < 1e-14, patch
    text = refused(layer())
    assert "found 1 of type pyramid, 2 of type quad, 2 of type wedge (split_prisms=True cuts" in text, text


@in_folder
def test_files_with_prisms_are_cut_on_request():
    if COMM.rank == 0:
        layer().write("layer.mesh", file_format="medit")
    COMM.barrier()
    assert "2 prisms, 1 pyramids (--split-prisms, in Python split_prisms=True" in error_of(lambda: pamr.Mesh.read(COMM, "layer.mesh"))
    mesh = pamr.Mesh.read(COMM, "layer.mesh", split_prisms=True)
    assert mesh.n_cells == 8 and abs(COMM.allreduce(volumes(mesh).sum()) - 7 / 6) < 1e-14


def taken(mesh, **options):
    """The mesh of one of meshio, and what was said, but for the count of faces without a tag, which has to be right."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        result = pamr.from_meshio(COMM, mesh if COMM.rank == 0 else None, **options)
    told = COMM.bcast([str(w.message) for w in told])
    n = faces_of(result).get("boundary", 0)
    faces = [f"from_meshio: {n} boundary faces without tag are in the patch 'boundary'"] if n else []
    assert [text for text in told if "faces without tag" in text] == faces, told
    return result, [text for text in told if text not in faces]


def refused(mesh, **options):
    return error_of(lambda: pamr.from_meshio(COMM, mesh if COMM.rank == 0 else None, **options))


def faces_of(mesh):
    faces = mesh.boundary_faces()
    return dict(zip(mesh.patches, COMM.allreduce(np.bincount(faces.patches, minlength=len(mesh.patches)))))


def test_tags_of_all_formats_are_patches_and_regions():
    import meshio
    for key, name in {"gmsh:physical": "physical_", "medit:ref": "ref_", "nastran:ref": "patch_", "su2:tag": "patch_",
                      "ugrid:ref": "surface_", "CellEntityIds": "patch_"}.items():
        given = meshio.Mesh(POINTS, [("tetra", CELLS), ("triangle", FLOOR)],
                            cell_data={key: [[5, 5, 5, 8, 8, 8], [3, 4.0]]}, field_data={"gas": np.array([5, 3])})
        mesh, told = taken(given)
        assert faces_of(mesh) == {f"{name}3": 1, f"{name}4": 1, "boundary": 10} and told == []
        assert list(mesh.cell_fields) == ["region"] and mesh.regions == {5: "gas"}
        assert sorted(np.concatenate(COMM.allgather(mesh.cell_fields["region"]))) == [5, 5, 5, 8, 8, 8]
    given.cell_data = {"mine": [np.arange(6), np.array([3, 4])]}
    assert "expected cell data 'ph' for the tags, found 'mine'" in refused(given, tags="ph")
    mesh, _ = taken(given, tags="mine")
    assert faces_of(mesh) == {"patch_3": 1, "patch_4": 1, "boundary": 10} and list(mesh.cell_fields) == ["mine"]
    mesh, told = taken(given)
    assert faces_of(mesh) == {"boundary": 12} and "2 triangles without tags" in told[0] and "'mine'" in told[0]
    given.cell_data = {"gmsh:physical": [np.zeros(6), np.array([3, 4.5])]}
    assert "cell data 'gmsh:physical': expected integers, found float64" in refused(given)


def test_cell_sets_are_patches_and_regions():
    import meshio
    sets = {"inlet": [np.array([0, 1]), np.array([0])], "wall": [np.array([1, 2]), np.array([0, 1])]}
    mesh, told = taken(meshio.Mesh(POINTS, [("tetra", CELLS), ("triangle", FLOOR)], cell_sets=sets))
    assert faces_of(mesh) == {"wall": 1, "inlet+wall": 1, "boundary": 10} and told == [], (faces_of(mesh), told)
    assert mesh.regions == {1: "inlet", 2: "wall", 3: "inlet+wall"}
    assert sorted(np.concatenate(COMM.allgather(mesh.cell_fields["region"]))) == [0, 0, 0, 1, 2, 3]
    groups = {1: "inlet", 2: "wall"}
    assert mesh.patch_groups == {"inlet+wall": groups} and mesh.region_groups == {3: groups}
    by_tags = meshio.Mesh(POINTS, [("triangle", FLOOR), ("tetra", CELLS)], cell_sets={"all": [[0, 1], []], "gmsh:x": [[0], [0]]},
                          cell_data={"gmsh:physical": [[4, 5], [1] * 6]}, field_data={"all": [4, 2], "in": [5, 2]})
    mesh, told = taken(by_tags)
    assert set(mesh.patches) == {"all", "all+in", "boundary"} and mesh.patch_groups == {"all+in": {4: "all", 5: "in"}} and told == []
    by_tags.cell_sets = {"third": [[1], [0]], "fourth": [[1], []]}
    mesh, told = taken(by_tags)
    assert mesh.patch_groups == {"in+third+fourth": {5: "in", 6: "third", 7: "fourth"}} and told == [], (mesh.patch_groups, told)
    assert mesh.region_groups == {3: {1: "physical_1", 2: "third"}} and mesh.regions[3] == "physical_1+third", mesh.regions
    by_tags.cell_data["mine"] = [[4, 4], [0] * 6]
    mesh, told = taken(by_tags, tags="mine")
    assert mesh.regions == {1: "third"} and COMM.allreduce(int((mesh.cell_fields["region"] == 1).sum())) == 1, mesh.regions


@in_folder
def test_cell_sets_of_the_boundary_and_inside_come_back_from_files():
    import meshio
    triangles = np.concatenate([FLOOR, [[0, 3, 7]]])  # the last one is inside
    sets = {"7": [[0, 1], []], "sheet 12": [[2], []], "gas": [[], np.arange(6)]}
    mesh, told = taken(meshio.Mesh(POINTS, [("triangle", triangles), ("tetra", CELLS)], cell_sets=sets))
    expected = {"7": 2, "sheet 12": 0, "boundary": 10}
    assert faces_of(mesh) == expected and told == [], (faces_of(mesh), told)
    assert COMM.allreduce(int(mesh.inner_faces().first.sum())) == 1
    for name in ("sets.msh", "sets.vtu", "sets.cgns", "sets.hdf"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh.write(name)
            back = pamr.Mesh.read(COMM, name)
        assert faces_of(back) == expected and COMM.allreduce(int(back.inner_faces().first.sum())) == 1, (name, faces_of(back))
        assert [kind for _, kind, _ in back._core.patches] == ["untagged" if patch == "boundary" else "" for patch in back.patches], name
    with warnings.catch_warnings():  # Medit has numbers alone: sets have the lowest ones, in their order
        warnings.simplefilter("ignore")
        mesh.write("sets.mesh")
        back = pamr.Mesh.read(COMM, "sets.mesh")
    assert faces_of(back) == {"ref_1": 2, "ref_2": 0, "boundary": 10}, faces_of(back)


def test_cell_sets_are_masks_or_numbers_within_their_blocks():
    import meshio
    given = meshio.Mesh(POINTS, [("triangle", FLOOR[:1]), ("triangle", FLOOR[1:]), ("tetra", CELLS)])

    def with_set(*arrays):
        given.cell_sets = {"in": list(arrays)}
        return given
    mesh, _ = taken(with_set(np.array([False]), np.array([True]), np.array([False, True, True, False, False, False])))
    assert faces_of(mesh) == {"in": 1, "boundary": 11}
    by_place = mesh.cell_origin[mesh.cell_fields["region"] == 1]
    assert sorted(np.concatenate(COMM.allgather(by_place))) == [1, 2]
    says = "cell set 'in', block"
    assert f"{says} 0: expected numbers of its cells from 0 to 0, found 1" in refused(with_set([1], [], [0]))
    assert f"{says} 1: expected numbers of its cells from 0 to 0, found -1" in refused(with_set([], [-1], [0]))
    assert f"{says} 2: expected numbers of its cells from 0 to 5, found 7" in refused(with_set([], None, [0, 7]))
    assert f"{says} 2: expected shape 6, found 2" in refused(with_set([], [], np.array([True, False])))
    assert "cell set 'in': expected cells of each of 3 blocks, found those of 2" in refused(with_set([0], [0]))


@in_folder
def test_elements_in_several_groups_keep_them_as_in_files():
    import meshio
    twice = np.concatenate([FLOOR, FLOOR[:1][:, [2, 0, 1]]])
    given = meshio.Mesh(POINTS, [("triangle", twice), ("tetra", np.concatenate([CELLS[::-1], CELLS]))],
                        cell_data={"gmsh:physical": [[2, 2, 1], [8] * 6 + [7] * 6], "gmsh:geometrical": [[1] * 3, [1] * 12],
                                   "number": [np.zeros(3, int), np.arange(12)]},
                        field_data={"all": [2, 2], "inlet": [1, 2], "steel": [7, 3], "hot": [8, 3]})
    mesh, told = taken(given)
    assert mesh.n_cells == 6 and faces_of(mesh) == {"inlet+all": 1, "all": 1, "boundary": 10} and told == [], told
    assert sorted(np.concatenate(COMM.allgather(mesh.cell_fields["number"]))) == [0, 1, 2, 3, 4, 5]
    assert mesh.patch_groups == {"inlet+all": {1: "inlet", 2: "all"}} and mesh.region_groups == {1: {7: "steel", 8: "hot"}}
    assert mesh.regions == {1: "steel+hot", 7: "steel", 8: "hot"}
    for name in ("groups.msh", "groups.hdf"):
        mesh.write(name)
        back = pamr.Mesh.read(COMM, name)
        assert faces_of(back) == faces_of(mesh) and back.regions == mesh.regions, name
        assert back.patch_groups == mesh.patch_groups and back.region_groups == mesh.region_groups, name
    given.field_data["inlet+all"] = [9, 2]
    mesh, told = taken(given)
    assert set(mesh.patches) == {"inlet+all+", "all", "boundary"} and "'inlet+all' (triangles)" in told[0], (mesh.patches, told)


def test_groups_of_gmsh_keep_their_names_where_an_entity_is_reversed():
    import meshio
    given = meshio.Mesh(POINTS, [("triangle", FLOOR), ("tetra", CELLS)],
                        cell_data={"gmsh:physical": [[-4, 4], [-7] * 6]}, field_data={"floor": [4, 2], "gas": [7, 3]})
    mesh, _ = taken(given)
    assert faces_of(mesh) == {"floor": 2, "boundary": 10} and mesh.regions == {7: "gas"}
    assert (mesh.cell_fields["region"] == 7).all()
    given.cell_data["medit:ref"] = given.cell_data.pop("gmsh:physical")  # where a minus means nothing
    assert set(faces_of(taken(given)[0])) == {"ref_-4", "floor", "boundary"}


def test_what_is_left_out_beside_tags_is_said():
    import meshio
    tags = {"gmsh:physical": [[4, 4], [7] * 3 + [8] * 3], "gmsh:geometrical": [[1, 1], [1] * 6]}

    def given(regions=None, **data):
        data = {k: [np.zeros(2, int), v] for k, v in {**data, **({} if regions is None else {"region": regions})}.items()}
        return meshio.Mesh(POINTS, [("triangle", FLOOR), ("tetra", CELLS)], cell_data={**tags, **data},
                           field_data={"floor": [4, 2], "gas": [7, 3]})

    def regions_of(mesh):
        return sorted(np.concatenate(COMM.allgather(mesh.cell_fields["region"])).tolist())
    mesh, told = taken(given([7, 7, 7, 8, 8, 9]))
    assert regions_of(mesh) == [7, 7, 7, 8, 8, 8] and mesh.regions == {7: "gas"} and list(mesh.cell_fields) == ["region"]
    assert "cell data 'region' were left out, the field 'region' has 'gmsh:physical': 1 tetrahedra differ" in told[0]
    mesh, told = taken(given([7.0, 7, 7, 8, 8, 8]))
    assert mesh.regions == {7: "gas"} and told == []
    assert "cell data 'region': expected integers, found float64" in refused(given([0.5] * 6))
    assert "cell data 'region': expected shape 6, found 6 x 2" in refused(given(np.zeros((6, 2), int)))
    mesh, told = taken(given(level=np.arange(6, dtype=np.uint8)))
    assert "cell data 'level' of type uint8 were left out" in told[0]
    mesh, told = taken(given(mine=np.arange(6)), tags="mine")
    assert set(mesh.cell_fields) == {"mine", "gmsh:physical", "gmsh:geometrical"} and mesh.regions == {}
    untagged = given([3] * 6)
    untagged.cell_data["gmsh:physical"][1][:] = 0
    assert regions_of(taken(untagged)[0]) == [3] * 6
    by_sets = given([3] * 6)
    del by_sets.cell_data["gmsh:physical"], by_sets.cell_data["gmsh:geometrical"]
    by_sets.cell_sets, by_sets.point_sets = {"steel": [[0], [0, 1]]}, {"corner": [0]}
    mesh, told = taken(by_sets)
    assert regions_of(mesh) == [3] * 6 and faces_of(mesh) == {"steel": 1, "boundary": 11}
    assert "the field 'region' has the cell data of this name: 'steel' (2 tetrahedra)" in told[0]
    assert "point sets were left out: 'corner' (1 points)" in told[1]
    beside = meshio.Mesh(POINTS, [("tetra", CELLS), ("line", [[0, 1], [1, 3]]), ("vertex", [[0]])], field_data={"TIME": np.array([3.5]), "who": "me"})
    beside.gmsh_periodic = [[2, (1, 2), None, np.array([[0, 1]])], [1, (3, 4), None, np.array([[0, 1]])]]  # of surfaces and of curves
    _, told = taken(beside)
    assert told == [f"from_meshio: {text}" for text in (
        "3 points and lines were left out", "field data were left out: 'TIME', 'who'", "1 periodic link of surfaces was left out")], told


def test_triangles_within_the_mesh_points_of_nothing_and_inverted_cells():
    import meshio
    inner = meshio.Mesh(POINTS, [("tetra", CELLS), ("triangle", [[0, 1, 7], [0, 1, 3]])],
                        cell_data={"gmsh:physical": [[1, 2, 1, 1, 1, 1], [9, 4]]}, field_data={"sheet": np.array([9, 2])})
    mesh, told = taken(inner)
    assert faces_of(mesh) == {"physical_4": 1, "sheet": 0, "boundary": 11} and told == []
    inside = mesh.inner_faces()
    assert COMM.allreduce(int(inside.first.sum())) == 1 and COMM.allreduce(len(inside.first)) == 2
    assert all(mesh.patches[p] == "sheet" for p in inside.patches)
    inner.cell_data["gmsh:physical"][0] = np.ones(6, int)
    mesh = taken(inner)[0]
    assert COMM.allreduce(len(mesh.inner_faces().first)) == 2
    apart = meshio.Mesh(np.concatenate([POINTS, POINTS + 5]), [("tetra", CELLS), ("triangle", [[8, 9, 10]])],
                        cell_data={"gmsh:physical": [[1] * 6, [9]]})
    assert "found 1 apart from the cells" in refused(apart)
    del apart.cells[1], apart.cell_data["gmsh:physical"][1]
    assert "8 nodes of no cell were left out" in taken(apart)[1][0]
    turned = CELLS.copy()
    turned[:2] = turned[:2][:, [1, 0, 2, 3]]
    assert "found 2 inverted ones among 6 cells" in refused(meshio.Mesh(POINTS, [("tetra", turned)]), repair=False)
    mesh, told = taken(meshio.Mesh(POINTS, [("tetra", turned)]))
    assert mesh.n_turned == 2 and told == ["from_meshio: 2 inverted cells were turned over"], told
    strange = np.concatenate([POINTS, [[np.nan] * 3]])  # of no cell
    assert taken(meshio.Mesh(strange, [("tetra", CELLS)]))[0].n_nodes == 8
    strange[5, 1] = np.inf
    assert "points: expected finite numbers, found others in row 5" in refused(meshio.Mesh(strange, [("tetra", CELLS)]))
    far = CELLS.copy()
    far[3, 1] = 8
    assert "tetra: expected numbers of points from 0 to 7, found 8 in row 3" in refused(meshio.Mesh(POINTS, [("tetra", far)]))
    masked = meshio.Mesh(POINTS, [("tetra", CELLS)])
    masked.point_data = {"T": np.ma.masked_equal(np.arange(8.0), 3)}
    assert "point data 'T': expected values without a mask, found 1 masked of 8" in refused(masked)


@in_folder
def test_the_level_that_files_show_is_no_field():
    from whole_meshio import meshio
    pamr.from_meshio(COMM, tagged() if COMM.rank == 0 else None).write("mesh.vtu")
    for tags in (None, "patch"):  # our own files say which names their patches have
        mesh = pamr.from_meshio(COMM, meshio.read("mesh.vtu") if COMM.rank == 0 else None, tags=tags)
        assert set(mesh.cell_fields) == {"mark", "region"} and mesh.patches == ["floor", "boundary"]
        assert [kind for _, kind, _ in mesh._core.patches] == ["", "untagged"]
    mesh.write("mesh.hdf")
    assert set(pamr.Mesh.read(COMM, "mesh.hdf").cell_fields) == set(mesh.cell_fields)
    mesh.cell_fields["level"] = np.zeros(len(mesh.cells), np.uint8)
    assert "'level': expected another name or type than uint8" in error_of(lambda: mesh.write("other.hdf"))


run_tests(globals())
