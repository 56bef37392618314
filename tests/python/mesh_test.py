# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from arrays and files, fields, marks, refinements, surfaces, points, data of parents."""
import inspect
import itertools
import warnings

import numpy as np

import pamr
from collective import COMM, error_of, in_folder, run_tests


def cube_arrays(n, seed=0):
    """Global arrays of a Kuhn cube in random order with corners in any order, and its boundary with a tag for each side."""
    dice = np.random.default_rng(seed)
    grid = np.arange(n + 1) / n
    points = np.array([(x, y, z) for z in grid for y in grid for x in grid])
    steps = np.array([1, n + 1, (n + 1) ** 2])
    cells = []
    for k, j, i in itertools.product(range(n), repeat=3):
        first = i + (n + 1) * (j + (n + 1) * k)
        for order in itertools.permutations(range(3)):
            cells.append(first + np.concatenate(([0], np.cumsum(steps[list(order)]))))
    cells = np.array(cells)
    faces = np.concatenate([np.delete(cells, c, axis=1) for c in range(4)])
    key, count = np.unique(np.sort(faces, axis=1), axis=0, return_counts=True)
    outer = key[count == 1]
    tags = np.zeros(len(outer), int)
    for axis in range(3):
        for side in (0, 1):
            tags[(points[outer][:, :, axis] == side).all(axis=1)] = 10 * axis + side + 1
    number = dice.permutation(len(points))
    points, cells, outer = points[np.argsort(number)], number[cells], number[outer]
    cells = dice.permuted(cells[dice.permutation(len(cells))], axis=1)
    shuffled = dice.permutation(len(outer))
    return points, cells, dice.permuted(outer[shuffled], axis=1), tags[shuffled]


def share(array, seed):
    """A part of global rows for each rank, of random lengths; some ranks may have none."""
    cuts = np.sort(np.random.default_rng(seed).integers(0, len(array) + 1, COMM.size - 1))
    return np.split(array, cuts)[COMM.rank]


def make_mesh(n=3, seed=1, **options):
    points, cells, triangles, tags = cube_arrays(n, seed)
    names = {1: "left", 2: ("right", "wall"), 11: "front", 12: "back", 21: "floor", 22: "roof"}
    return pamr.Mesh.from_arrays(COMM, share(points, seed), share(cells, seed + 1),
                                 (share(triangles, seed + 2), share(tags, seed + 2)), names, repair=True, **options)


def total(values):
    return COMM.allreduce(np.sum(values))


def test_a_mesh_from_arrays_in_any_blocks_is_the_same_mesh():
    expected = pamr.Mesh.kuhn_cube(COMM, 3)
    for seed, order in ((1, "keep"), (2, "curve"), (3, "auto")):
        mesh = make_mesh(3, seed, order=order)
        assert mesh.n_cells == 162 and mesh.n_nodes == 64
        assert abs(total(mesh.volumes()) - 1) < 1e-14 and (mesh.volumes() > 0).all()
        assert mesh.patches == ["left", "right", "front", "back", "floor", "roof"]
        faces = mesh.boundary_faces()
        for patch, (axis, side) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1))):
            nodes = faces.nodes[faces.patches == patch]
            assert (mesh.points[nodes][:, :, axis] == side).all() and total(len(nodes)) == 18
            assert (mesh.cell_to_cell[faces.cells, faces.faces] == -(faces.patches + 1)).all()
        points, cells, _, _ = cube_arrays(3, seed)
        assert np.array_equal(mesh.points, points[mesh.node_origin])
        assert np.array_equal(np.sort(cells[mesh.cell_origin], axis=1), np.sort(mesh.node_origin[mesh.cells], axis=1))
        # the same points and cells as the mesh of the library, whose patches have other names
        centroids = [np.sort(np.concatenate(COMM.allgather(m.points[m.cells].mean(axis=1).round(9) @ (1, 10, 100))))
                     for m in (mesh, expected)]
        assert np.allclose(*centroids)


def test_fields_come_along_and_show_the_memory_of_the_mesh():
    points, cells, _, _ = cube_arrays(2, 5)
    share_points, share_cells = share(points, 5), share(cells, 6)
    mesh = pamr.Mesh.from_arrays(COMM, share_points, share_cells, length_unit="m", order="curve", repair=True,
                                 node_fields={"x": share_points[:, 0].astype("f4")},
                                 cell_fields={"corners": share_cells})
    assert mesh.patches == ["boundary"] and mesh.length_unit == "m"
    assert np.allclose(mesh.node_fields["x"], mesh.points[:, 0])
    assert np.array_equal(mesh.cell_fields["corners"], cells[mesh.cell_origin])
    view = mesh.node_fields["x"]
    view += 1  # the field itself
    assert np.array_equal(mesh.node_fields["x"], view) and np.allclose(view, mesh.points[:, 0] + 1)
    mesh.node_fields.set("x", 2 * view, unit="cm")
    assert mesh.node_fields.units == {"x": "cm"} and np.allclose(mesh.node_fields["x"], 2 * mesh.points[:, 0] + 2)
    del mesh.node_fields["x"]
    assert list(mesh.node_fields) == [] and "x" not in mesh.node_fields and len(mesh.cell_fields) == 1
    points_view = mesh.points
    del mesh
    assert points_view.shape[1] == 3 and not points_view.flags.writeable


def test_arrays_that_were_read_keep_their_values():
    mesh = make_mesh(6)
    n = len(mesh.points)
    mesh.node_fields["off_surface"] = mesh.node_numbers + 0.5
    mesh.cell_fields["c"] = mesh.cell_numbers
    fields = {"same": (mesh.node_fields, np.ones(n)), "shape": (mesh.node_fields, np.ones((n, 2))),
              "type": (mesh.node_fields, np.arange(n)), "gone": (mesh.node_fields, None),
              "off_surface": (mesh.node_fields, None), "c": (mesh.cell_fields, -mesh.cell_numbers)}
    read = {}
    for name, (where, _) in fields.items():
        if name not in where:
            where[name] = np.sqrt(mesh.node_numbers + 1.0)
        read[name] = where[name], where[name][2:], where[name].copy()
    read["points"] = mesh.points, mesh.points[2:], mesh.points.copy()
    read["neighbors"] = mesh.cell_to_cell, mesh.cell_to_cell[2:], mesh.cell_to_cell.copy()
    read["levels"] = mesh.levels, mesh.levels[2:], mesh.levels.copy()

    for name, (where, new) in fields.items():
        if new is not None:
            where[name] = new
            assert np.array_equal(where[name], new)
        elif name == "gone":
            del where[name]
        else:  # what a function of the library replaces
            mesh.associate({"left": pamr.Plane((1e-9, 0, 0), (1, 0, 0))}, tolerance=1e-6)
            assert COMM.allreduce(where[name].max(initial=0), max) == 1e-9
    result = pamr.refine(mesh, np.ones(len(mesh.cells), bool))
    parent = result.parent.copy()
    result.mesh.cell_fields["parent"] = 0 * parent
    kept = result.mesh.node_fields["same"], result.mesh.node_fields["same"].copy()
    numbers = result.from_parents(mesh.cell_numbers)
    del mesh, result, fields, where
    others = [pamr.Mesh.kuhn_cube(COMM, 6) for _ in range(3)]  # what was freed is in use again
    for name, (array, part, values) in read.items():
        assert np.array_equal(array, values) and np.array_equal(part, values[2:]), name
    assert np.array_equal(*kept) and np.array_equal(numbers, parent) and len(others) == 3


def test_convergence_is_seen_by_the_values_before():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.node_fields["T"] = np.zeros(len(mesh.points))
    old = mesh.node_fields["T"]
    mesh.node_fields["T"] = old + 1
    assert (mesh.node_fields["T"] - old == 1).all()
    old[:] = 7  # no longer the field
    assert (mesh.node_fields["T"] == 1).all()


def test_fields_that_are_set_again_and_again_take_no_more_memory():
    import resource
    mesh = pamr.Mesh.kuhn_cube(COMM, 10)
    values = np.zeros((len(mesh.cells), 400))
    for turn in range(40):
        if turn == 4:
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        mesh.cell_fields["u"] = values
        mesh.cell_fields["u"][:] = turn
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown < 5 * values.nbytes / 1024, f"{grown} kB beside {values.nbytes // 1024}"


@in_folder
def test_torn_arrays_and_files_are_told_in_the_same_words():
    points, cells, _, _ = cube_arrays(2, 3)
    points, cells = np.concatenate([points, points + [1, 0, 0]]), np.concatenate([cells, cells + len(points)])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        mesh = pamr.Mesh.from_arrays(COMM, share(points, 3), share(cells, 4), repair=True)
        mesh.write("torn.vtu")
        pamr.Mesh.read(COMM, "torn.vtu")
    texts = [str(w.message).removeprefix("file 'torn.vtu': ") for w in told
             if "turned over" not in str(w.message) and "without tag" not in str(w.message)]  # arrays without a boundary have no tags
    assert len(texts) == (4 if COMM.rank == 0 else 0) and texts[:2] == texts[2:], texts
    assert not texts or "16 boundary faces lie on others, the first near (1, " in texts[0] and "in 2 pieces" in texts[1], texts


def test_inverted_cells_are_refused_or_turned_over_and_counted():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        mesh = make_mesh(2, 3)
        points, cells, _, _ = cube_arrays(2, 3)
        corners = points[cells]
        inverted = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
        cells[~inverted] = cells[~inverted][:, [1, 0, 2, 3]]  # all of them
        turned = pamr.Mesh.from_arrays(COMM, share(points, 3), share(cells, 4))
    assert mesh.n_turned == inverted.sum() and 0 < mesh.n_turned < 48 == turned.n_turned
    texts = [str(w.message) for w in told]
    assert texts == ([f"{n} inverted cells were turned over" for n in (inverted.sum(), 48)] if COMM.rank == 0 else []), texts
    cells[5] = cells[5][[1, 0, 2, 3]]
    cells[7] = cells[7][[1, 0, 2, 3]]
    message = error_of(lambda: pamr.Mesh.from_arrays(COMM, share(points, 3), share(cells, 4), repair=False))
    assert "found 46 inverted ones among 48 cells" in message and "repair=True" in message, message


def refined_three_times():
    mesh = pamr.Mesh.kuhn_cube(COMM, 4)
    for _ in range(3):
        mesh.node_fields["T"] = np.tanh(10 * (np.linalg.norm(mesh.points, axis=1) - 0.7))
        flags = pamr.mark.flags(mesh, pamr.mark.recovered_error(mesh, "T", bulk=0.4), max_cells=20000)
        expected = pamr.forecast(mesh, flags)
        before = mesh.n_cells
        result = pamr.refine(mesh, flags)
        mesh = result.mesh
        assert (mesh.n_cells, mesh.n_nodes) == expected and result.report["cells_in"] == before
        assert result.report["marked_not_split"] == 0
    return mesh


@in_folder
def test_a_loop_of_three_turns_gives_the_bytes_of_one_rank():
    from mpi4py import MPI
    mesh = refined_three_times()
    assert mesh.n_cells > 2000 and mesh.levels.max() >= 1 and abs(total(mesh.volumes()) - 1) < 1e-12
    report = pamr.quality(mesh)
    assert report["inverted_cells"] == 0 and report["conforming"] and abs(report["volume"] - 1) < 1e-12
    mesh.write("together.hdf")
    again = pamr.Mesh.read(COMM, "together.hdf")
    assert again.fingerprint() == mesh.fingerprint() and "T" in again.node_fields
    if COMM.rank == 0:
        alone = pamr.Mesh.read(MPI.COMM_SELF, "together.hdf")
        alone.write("alone.hdf")
        assert open("together.hdf", "rb").read() == open("alone.hdf", "rb").read()


def test_no_cell_of_a_cube_falls_below_the_shape_floor():
    smallest = []
    for floor in (0, 0.5):
        mesh = pamr.Mesh.kuhn_cube(COMM, 4)
        for _ in range(2):
            centroids = mesh.points[mesh.cells].mean(axis=1)
            flags = np.linalg.norm(centroids, axis=1) < 0.6
            expected = pamr.forecast(mesh, flags, shape_floor=floor)
            mesh = pamr.refine(mesh, flags, shape_floor=floor).mesh
            assert (mesh.n_cells, mesh.n_nodes) == expected
        smallest.append(pamr.quality(mesh)["mean_ratio"]["min"])
    assert smallest[0] < 0.5 <= smallest[1] * (1 + 1e-12)


def test_the_shape_floor_is_that_of_the_manual_if_none_is_given():
    for function in (pamr.refine, pamr.adapt, pamr.forecast, pamr.mark.flags):
        assert inspect.signature(function).parameters["shape_floor"].default == 0.35, function


def test_marks_are_those_of_arrays_and_criteria_together():
    mesh = pamr.Mesh.kuhn_cube(COMM, 4)
    centroids = mesh.points[mesh.cells].mean(axis=1)
    inside = (centroids <= 0.5).all(axis=1)
    assert np.array_equal(pamr.mark.flags(mesh, pamr.mark.box(mesh, (0, 0, 0), (0.5, 0.5, 0.5))), inside)
    assert np.array_equal(pamr.mark.flags(mesh, inside), inside)
    at_wall = pamr.mark.flags(mesh, pamr.mark.patch(mesh, "xmin"))
    faces = mesh.boundary_faces()
    assert set(np.flatnonzero(at_wall)) == set(faces.cells[faces.patches == 0])
    both = pamr.mark.flags(mesh, inside, pamr.mark.patch(mesh, "xmin"))
    assert np.array_equal(both, inside | (at_wall > 0))
    mesh.cell_fields["e"] = centroids[:, 0]
    assert np.array_equal(pamr.mark.flags(mesh, pamr.mark.field(mesh, "e", above=0.5)), centroids[:, 0] > 0.5)
    half = pamr.mark.flags(mesh, pamr.mark.bulk(mesh, centroids[:, 0] ** 2, 0.5))
    squared = centroids[:, 0] ** 2
    assert total(squared[half > 0]) >= 0.5 * total(squared) and total(half) < 384 / 2
    assert list(mesh.cell_fields) == ["e"]
    assert total(pamr.mark.flags(mesh, pamr.mark.all_cells(mesh), max_level=0)) == 0
    assert total(pamr.mark.flags(mesh, pamr.mark.crossing_sphere(mesh, (0, 0, 0), 0.5), max_cells=500)) > 0
    assert total(pamr.mark.flags(mesh, pamr.mark.centroid_shell(mesh, (0, 0, 0), 0.5, 0.1))) > 0
    mesh.cell_fields["length"] = np.full(len(mesh.cells), 0.1)
    assert total(pamr.mark.flags(mesh, pamr.mark.size_over(mesh, "length", 1.5))) == 0
    assert total(pamr.mark.flags(mesh, pamr.mark.size_over(mesh, "length", 1))) == 384


def test_surfaces_keep_the_boundary_curved():
    points, cells, triangles, tags = cube_arrays(2, 7)
    # every node of the boundary of a cube about the origin moved onto the unit sphere
    points = 2 * points - 1
    outer = np.abs(points).max(axis=1) == 1
    points[outer] /= np.linalg.norm(points[outer], axis=1)[:, None]
    mesh = pamr.Mesh.from_arrays(COMM, share(points, 7), share(cells, 8), (share(triangles, 9), 0 * share(tags, 9)),
                                 {0: "wall"}, repair=True)
    off = mesh.associate({"wall": pamr.Sphere((0, 0, 0), 1)})
    assert off["wall"] < 1e-12 and mesh.surfaces == {"wall": "wall"}
    for _ in range(2):
        mesh = pamr.refine(mesh, np.ones(len(mesh.cells), bool)).mesh
    faces = mesh.boundary_faces()
    assert np.allclose(np.linalg.norm(mesh.points[np.unique(faces.nodes)], axis=1), 1, atol=1e-14)
    flat = pamr.refine(mesh, np.ones(len(mesh.cells), int), project=False).mesh
    nodes = np.unique(flat.boundary_faces().nodes)
    assert COMM.allreduce(np.linalg.norm(flat.points[nodes], axis=1).min(initial=2), min) < 0.999


@in_folder
def test_files_of_triangles_say_what_is_left_out():
    points, cells, triangles, tags = cube_arrays(1)
    mesh = pamr.Mesh.from_arrays(COMM, share(points, 1), share(cells, 2), (share(triangles, 3), 0 * share(tags, 3)), {0: "wall"},
                                 repair=True)
    if COMM.rank == 0:
        with open("cube.obj", "w") as file:
            file.writelines(f"v {x} {y} {z}\n" for x, y, z in itertools.product((0, 1), repeat=3))
            file.writelines(f"f {face}\n" for face in ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"))
            file.write("vn 0 0 1\nvt 0 1\n")
    COMM.barrier()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert mesh.associate({"wall": pamr.File("cube.obj")})["wall"] == 0
    texts = [str(w.message) for w in told if "left out" in str(w.message)]
    assert texts == (['surface "wall": left out: 1 normal, 1 texture coordinate'] if COMM.rank == 0 else []), texts


def test_patches_have_the_tags_of_their_numbers():
    """Without numbers from 0 on; faces that had no tag come back without one, those of a patch that is called `boundary` have it."""
    from pamr.interop import _tags_of_patches
    points, cells, triangles, tags = cube_arrays(1)
    given = [(share(points, 1), share(cells, 2), (share(triangles, 3), share(tags, 3)), {1: "a", 2: "boundary"})]
    given += [(*given[0][:2], (share(triangles[tags > 2], 3), share(tags[tags > 2], 3)), {11: "a"})]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        meshes = [pamr.Mesh.from_arrays(COMM, *arrays, repair=True) for arrays in given]
    assert _tags_of_patches(meshes[0]) == dict(enumerate((1, 2, 11, 12, 21, 22)))
    assert meshes[1].patches[-1] == "boundary" and _tags_of_patches(meshes[1]) == dict(enumerate((11, 12, 21, 22)))
    assert _tags_of_patches(pamr.Mesh.kuhn_cube(COMM, 1)) == dict(enumerate(range(6)))


def test_points_are_found_and_walks_change_nothing():
    mesh = pamr.balance(make_mesh(4, 11), method="scotch")
    dice = np.random.default_rng(COMM.rank)
    points = dice.random((200, 3)) * 1.2 - 0.1
    cell, rank = pamr.locate(mesh, points)
    inside = ((points >= 0) & (points <= 1)).all(axis=1)
    assert np.array_equal(rank >= 0, inside) and np.array_equal(cell >= 0, inside)
    near = dice.integers(-1, len(mesh.cells), len(points))
    assert all(np.array_equal(a, b) for a, b in zip(pamr.locate(mesh, points, near), (cell, rank)))
    own = rank == COMM.rank
    corners = mesh.points[mesh.cells[np.searchsorted(mesh.cell_numbers, cell[own])]]
    weights = np.linalg.solve(np.concatenate([corners.transpose(0, 2, 1), np.ones((own.sum(), 1, 4))], axis=1),
                              np.concatenate([points[own], np.ones((own.sum(), 1))], axis=1)[..., None])
    assert (weights > -1e-12).all()


def test_data_of_any_length_follows_the_cells():
    mesh = make_mesh(3, 13)
    flags = mesh.points[mesh.cells].mean(axis=1)[:, 0] < 0.4
    table = np.stack([mesh.cell_numbers, mesh.cell_numbers ** 2], axis=1).astype(float)
    particles = [np.arange(k % 4) + 10.0 * k for k in mesh.cell_numbers]
    result = pamr.refine(mesh, flags)
    assert np.array_equal(result.from_parents(table)[:, 0], result.parent)
    for number, own in zip(result.parent, result.from_parents(particles)):
        assert np.array_equal(own, np.arange(number % 4) + 10.0 * number)
    # integrals of cell fields are kept, also where closure cells are taken back
    mesh = result.mesh
    mesh.cell_fields["density"] = mesh.points[mesh.cells].mean(axis=1)[:, 1] + 1
    before = total(mesh.volumes() * mesh.cell_fields["density"])
    fine = pamr.refine(mesh, mesh.points[mesh.cells].mean(axis=1)[:, 2] > 0.5).mesh
    assert abs(total(fine.volumes() * fine.cell_fields["density"]) - before) < 1e-12


def test_refining_and_taking_all_back_gives_the_mesh_that_there_was():
    mesh = make_mesh(3, 5)
    mesh.cell_fields["a"] = 1.0 + np.arange(len(mesh.cells)) + mesh.cell_numbers
    before, mass = mesh.fingerprint(), total(mesh.cell_fields["a"] * mesh.volumes())
    for _ in range(2):
        mesh = pamr.refine(mesh, np.linalg.norm(mesh.points, axis=1)[mesh.cells].min(axis=1) < 0.4).mesh
    fine = mesh
    x = mesh.points[mesh.cells].mean(axis=1)[:, 0]
    flags = np.where(x > 0.7, 1, np.where(x < 0.3, -1, 0))
    expected = pamr.forecast(mesh, flags)
    both = pamr.adapt(mesh, flags)
    assert (both.mesh.n_cells, both.mesh.n_nodes) == expected
    assert both.report["coarsening"]["octets_gone"] > 0 and both.report["marked"] > 0
    assert both.report["rounds"] == both.report["closure_rounds"] > 0, "the keys of pamr-refine, and those of Python alone"
    assert both.report["coarsening"]["rounds"] > 0 and both.report["off_surface_nodes"] == 0 < len(both.report["seconds"])
    assert abs(total(both.mesh.cell_fields["a"] * both.mesh.volumes()) - mass) < 1e-12 * mass
    for level in (1, 0):
        mesh = pamr.adapt(mesh, -np.ones(len(mesh.cells), int), integrals=["a"]).mesh
        assert max(COMM.allgather(int(mesh.levels.max(initial=0)))) == level
    assert mesh.fingerprint() == before != fine.fingerprint()
    assert abs(total(mesh.cell_fields["a"] * mesh.volumes()) - mass) < 1e-12 * mass


def test_balance_spreads_the_weights():
    mesh = make_mesh(4, 17)
    weights = 1 + 50.0 * (mesh.points[mesh.cells].mean(axis=1)[:, 0] < 0.25)
    mesh.cell_fields["w"] = weights
    spread = pamr.balance(mesh, weights)
    loads = COMM.allgather(spread.cell_fields["w"].sum())
    assert max(loads) < 1.4 * np.mean(loads) and spread.fingerprint() == mesh.fingerprint()


def gmsh_text(cells, version="2.2"):
    nodes = ["1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1", "5 1 1 1"]
    return "\n".join([f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n$PhysicalNames\n3", '2 1 "inlet"', '2 2 "all"', '3 3 "gas"',
                      "$EndPhysicalNames\n$Nodes\n5", *nodes, "$EndNodes\n$Elements", str(len(cells)), *cells,
                      "$EndElements", ""])


@in_folder
def test_gmsh_files_are_read_as_the_tool_reads_them():
    cells = ["1 4 2 3 1 1 2 3 4", "2 4 2 3 1 2 3 4 5", "3 2 2 2 1 1 2 3", "4 2 2 1 1 1 2 3", "5 2 2 1 1 1 2 4", "6 2 2 2 1 2 1 4"]
    if COMM.rank == 0:
        open("groups.msh", "w").write(gmsh_text(cells))
        open("turned.msh", "w").write(gmsh_text(["1 4 2 3 1 2 1 3 4", *cells[1:2]]))
    COMM.barrier()

    def read(*args, **options):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            mesh = pamr.Mesh.read(COMM, *args, **options)
        return mesh, COMM.bcast([str(w.message) for w in told])
    mesh, told = read("groups.msh")
    assert mesh.patches == ["inlet+all", "boundary"] and mesh.regions == {3: "gas"}
    assert told == ["file 'groups.msh': 4 boundary faces without tag are in the patch 'boundary'"], told
    assert "found 1 inverted ones among 2 cells" in error_of(lambda: pamr.Mesh.read(COMM, "turned.msh", repair=False))
    mesh, told = read("turned.msh")
    assert mesh.n_cells == 2 and any("1 inverted cell was turned over" in text for text in told), told


@in_folder
def test_files_of_other_kinds_and_rewritten_fields():
    import h5py
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    mesh.cell_fields["u"] = mesh.cell_numbers.astype(float)
    for name in ("mesh.vtkhdf", "mesh.msh", "mesh.vtu", "case"):
        mesh.write(name)
    assert pamr.Mesh.read(COMM, "mesh.msh").n_cells == 48
    if COMM.rank == 0:
        with h5py.File("mesh.vtkhdf", "r+") as file:
            file["VTKHDF/CellData/u"][:] += 1
    COMM.barrier()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        again = pamr.Mesh.read(COMM, "mesh.vtkhdf")
    assert np.array_equal(again.cell_fields["u"], again.cell_numbers + 1.0)
    assert [("CellData/u" in str(w.message)) for w in told] == ([True] if COMM.rank == 0 else [])


run_tests(globals())
