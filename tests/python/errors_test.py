# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrong arrays, on one rank or on all: one exception that says which entry, the same on every rank, and nothing hangs."""
import ctypes
import warnings

import numpy as np

import pamr
from collective import CELLS, COMM, FLOOR, POINTS, error_of, in_folder, run_tests

LAST = COMM.size - 1


def on_last(array):
    return array if COMM.rank == LAST else array[:0]


def make(points=POINTS, cells=CELLS, triangles=FLOOR, tags=(1, 1), names=None, **options):
    """All on the last rank, where what is wrong is wrong."""
    return pamr.Mesh.from_arrays(COMM, on_last(np.asanyarray(points)), on_last(np.asanyarray(cells)),
                                 (on_last(np.asarray(triangles)), on_last(np.asarray(tags))), names, **options)


def changed(array, place, value):
    array = np.array(array)
    array[place] = value
    return array


def expect(words, call):
    message = error_of(call)
    for word in words if isinstance(words, (list, tuple)) else [words]:
        assert word in message, message


def test_arrays_of_the_wrong_shape_or_type():
    assert make().n_cells == 6
    expect(["points: expected shape n x 3, found 8 x 2", f"(rank {LAST})"], lambda: make(points=POINTS[:, :2]))
    expect("cells: expected shape n x 4, found 6 x 3", lambda: make(cells=CELLS[:, :3]))
    expect("cells: expected shape n x 4, found 24", lambda: make(cells=CELLS.ravel()))
    expect("cells: expected integers, found float64", lambda: make(cells=CELLS.astype(float)))
    expect("points: expected real numbers, found complex128", lambda: make(points=POINTS.astype(complex)))
    expect("points: expected finite numbers, found nan in row 5", lambda: make(points=changed(POINTS, (5, 1), np.nan)))
    expect("boundary triangles: expected shape n x 3, found 2 x 2", lambda: make(triangles=FLOOR[:, :2]))
    expect("expected a tag for each of 2 triangles, found 1", lambda: make(tags=[1]))
    expect("TypeError", lambda: pamr.Mesh.from_arrays(COMM, POINTS[:0], CELLS[:0], 5 if COMM.rank == LAST else None))


def test_one_patch_of_faces_without_a_tag_on_the_boundary_alone():
    names = {1: ("a", "untagged"), 2: ("b", "untagged")}
    assert make(names={1: names[1]}).patches == ["a"] and make(names={1: "boundary"}).patches == ["boundary", "boundary_2"]
    expect("expected at most one patch of kind 'untagged', found 'a' and 'b'", lambda: make(tags=(1, 2), names=names))
    expect("alone in a patch of kind 'untagged', found 1 inside in 'a'", lambda: make(triangles=[[0, 3, 7]], tags=[1], names={1: names[1]}))


def test_numbers_out_of_range():
    expect("cells: expected numbers of points from 0 to 7, found 8 in row 2", lambda: make(cells=changed(CELLS, (2, 1), 8)))
    expect("cells: expected numbers of points from 0 to 7, found -1", lambda: make(cells=changed(CELLS, (2, 1), -1)))
    expect("boundary triangles: expected numbers of points from 0 to 7, found 9 in row 1",
           lambda: make(triangles=changed(FLOOR, (1, 0), 9)))
    expect("expected cells with a volume, found 1 flat ones", lambda: make(cells=changed(CELLS, (2, 1), 0)))
    for number in (2**63, 2**63 + 5, 2**64 - 1):
        expect(f"cells: expected integers that fit int64, found {number}", lambda: make(cells=np.full((6, 4), number, np.uint64)))


def test_values_that_do_not_fit_are_not_wrapped_or_cut():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    n = len(mesh.cells)

    def set_field(values):
        mesh.cell_fields["u"] = values
    for number in (2**63, 2**63 + 5, 2**64 - 1):
        for dtype in (np.uint64, ">u8"):
            expect(f"field 'u': expected integers that fit int64, found {number}", lambda: set_field(np.full(n, number, dtype)))
    set_field(np.full(n, 2**63 - 1, np.uint64))
    assert (mesh.cell_fields["u"] == 2**63 - 1).all()
    expect("near: expected integers that fit int32, found", lambda: pamr.locate(mesh, POINTS, np.full(8, 2**31)))
    expect("flags: expected 0 or 1, found 256", lambda: pamr.refine(mesh, np.full(n, 256)))
    expect("field 'u': expected real numbers or integers, found object", lambda: set_field([None] * n))
    expect("n: expected an integer, found 2.7", lambda: pamr.Mesh.kuhn_cube(COMM, 2.7))
    expect("layers: expected an integer, found 1.5", lambda: pamr.mark.patch(mesh, "xmin", layers=1.5))
    expect("max_level: expected an integer, found 1.5", lambda: pamr.mark.flags(mesh, np.ones(n), max_level=1.5))
    expect("max_cells: expected an integer, found 99.5", lambda: pamr.mark.flags(mesh, np.ones(n), max_cells=99.5))
    expect("names: expected an integer, found 1.5", lambda: make(names={1.5: "floor"}))
    for number in (2**31, 2**40, -2**70):
        says = f"expected an integer that fits int32, found {number}"
        expect(f"n: {says}", lambda: pamr.Mesh.kuhn_cube(COMM, number))
        expect(f"max_level: {says}", lambda: pamr.mark.flags(mesh, np.ones(n), max_level=number))
        expect(f"layers: {says}", lambda: pamr.mark.patch(mesh, "xmin", layers=number))
    expect("max_cells: expected an integer that fits int64", lambda: pamr.mark.flags(mesh, np.ones(n), max_cells=2**64))
    expect("names: expected an integer that fits int64", lambda: make(names={2**64: "floor"}))
    assert pamr.Mesh.kuhn_cube(COMM, np.int32(2)).n_cells == 48


def test_names_of_the_map_of_level_0_are_for_its_own_fields():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)

    def set_field(fields, name, values):
        fields[name] = values
    for fields, n in ((mesh.cell_fields, len(mesh.cells)), (mesh.node_fields, len(mesh.points))):
        for name, values in (("level0_cell", np.zeros(n, int)), ("level0_key", np.zeros((n, 8), int))):
            expect(f"field '{name}': expected another name", lambda: set_field(fields, name, values))
    assert not len(mesh.cell_fields) and not len(mesh.node_fields)


def test_masked_values_are_refused_with_their_number():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    n = len(mesh.cells)

    def masked(array, count):
        return np.ma.array(array, mask=np.arange(array.size).reshape(array.shape) < count)

    def set_field(values):
        mesh.cell_fields["u"] = values
    says = "expected values without a mask, found"
    expect(f"field 'u': {says} 3 masked of {mesh.n_cells // COMM.size}", lambda: set_field(masked(np.ones(n), 3)))
    expect(f"points: {says} 2 masked of 24", lambda: make(points=masked(POINTS, 2)))
    expect(f"cells: {says} 1 masked of 24", lambda: make(cells=masked(CELLS, 1)))
    expect(f"flags: {says} 4 masked", lambda: pamr.refine(mesh, masked(np.ones(n, int), 4)))
    expect(f"criterion: {says} 4 masked", lambda: pamr.mark.flags(mesh, masked(np.ones(n), 4)))
    expect(f"weights: {says} 1 masked", lambda: pamr.balance(mesh, masked(np.ones(n), 1)))
    expect(f"points: {says} 1 masked", lambda: pamr.locate(mesh, masked(POINTS, 1)))
    result = pamr.refine(mesh, np.zeros(n, int))
    expect(f"values: {says} 2 masked", lambda: result.from_parents(masked(np.ones(n), 2)))
    expect(f"values: {says} 1 masked", lambda: result.from_parents([masked(np.ones(2), 1)] * n))
    expect(f"field 'u': {says} 1 masked of {mesh.n_cells // COMM.size}", lambda: set_field([np.ma.masked] + [1.0] * (n - 1)))
    expect(f"field 'u': {says} {mesh.n_cells // COMM.size} masked of", lambda: set_field([masked(np.ones(2), 1)] * n))
    expect(f"points: {says} 4 masked of 24", lambda: pamr.Mesh.from_arrays(
        COMM, (list(POINTS[:6]) + [tuple(masked(p, 2)) for p in POINTS[6:]]) * (COMM.rank == 0), CELLS[:0]))
    set_field([np.ma.array(i) for i in range(n)])
    assert np.array_equal(mesh.cell_fields["u"], np.arange(n))
    set_field(np.ma.array(np.arange(n)))  # with nothing under the mask
    assert np.array_equal(mesh.cell_fields["u"], np.arange(n))


def test_names_of_regions_that_are_not_there():
    def with_regions(values):
        return make(cell_fields={"region": on_last(np.asarray(values))} if values is not None else None, regions={1: "gas", 5: "no"})
    for values in (None, np.ones(6), np.ones((6, 2), int)):
        expect("regions: expected names for the values of an integer cell field 'region'", lambda: with_regions(values))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        assert with_regions([1, 1, 1, 2, 2, 2]).regions == {1: "gas", 5: "no"}
    assert [str(w.message) for w in told] == (["1 named group has no element: 'no' (tetrahedra)",
                                               "10 boundary faces without tag are in the patch 'boundary'"] if COMM.rank == 0 else [])


def test_fields_with_the_name_of_patches_inside():
    for words in ([0, 0, 0, 0, 0, 5], [0, 1 << 16, 0, 0, 0, 0], [-1, 0, 0, 0, 0, 0]):
        expect("arrays: field 'inner_patch': expected patches", lambda: make(cell_fields={"inner_patch": on_last(np.array(words))}))
    assert make(cell_fields={"inner_patch": on_last(np.zeros(6, int))}).n_cells == 6


def test_triangles_that_are_no_faces():
    expect(["arrays: expected tagged triangles that are faces of the tetrahedra", "found 1 apart from the cells",
            "the first with nodes 1, 2 and 4 in "], lambda: make(triangles=changed(FLOOR, 1, (1, 2, 4))))
    expect("expected one tag for each face, found 1 faces in two surfaces, the first with nodes 3, 0 and 1 in 'roof'",
           lambda: make(triangles=[[0, 1, 3], [3, 0, 1]], tags=[1, 2], names={1: "floor", 2: "roof"}))
    expect("expected different names", lambda: make(tags=[1, 2], names={1: "a", 2: "a"}))


def test_meshes_that_are_none():
    expect("expected one cell or more, found none", lambda: make(points=POINTS[:0], cells=CELLS[:0], triangles=FLOOR[:0], tags=[]))
    flat = changed(POINTS, 0, POINTS[7])
    assert error_of(lambda: make(points=flat)) != "no error"
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        mesh = make(points=np.concatenate([POINTS[:2], POINTS[:1] + 5, POINTS[2:]]), cells=CELLS + (CELLS > 1), triangles=FLOOR + (FLOOR > 1))
    assert mesh.n_nodes == 8 and (COMM.rank > 0 or "1 node of no cell was left out" in str(told[0].message))
    assert set(np.concatenate(COMM.allgather(mesh.node_origin)).tolist()) == set(range(9)) - {2}
    twice = np.concatenate([CELLS, CELLS[:1]])
    expect("at most two cells at a face", lambda: make(cells=twice))


def test_ranks_that_disagree():
    if COMM.size == 1:
        return
    expect("expected the same on every rank", lambda: make(order="keep" if COMM.rank else "curve"))
    expect("expected the same on every rank", lambda: make(names={1: f"name{COMM.rank}"}))
    mesh = make()

    def set_different():
        mesh.cell_fields["a" if COMM.rank else "b"] = np.zeros(len(mesh.cells))
    expect("expected the same on every rank", set_different)

    def set_types():
        mesh.cell_fields["a"] = np.zeros(len(mesh.cells), int if COMM.rank else float)
    expect("expected the same on every rank", set_types)
    assert len(mesh.cell_fields) == 0


def test_fields_flags_and_the_rest():
    mesh = pamr.Mesh.kuhn_cube(COMM, 2)
    n = len(mesh.cells)

    def wrong_here(good, bad):
        return bad if COMM.rank == LAST else good

    def set_field(values):
        mesh.cell_fields["u"] = values
    expect(f"field 'u': expected {n} rows", lambda: set_field(wrong_here(np.zeros(n), np.zeros(n + 1))))
    expect("field 'u': expected real numbers or integers", lambda: set_field(np.zeros(n, complex)))
    expect("flags: expected shape", lambda: pamr.refine(mesh, wrong_here(np.zeros(n, int), np.zeros(n + 1, int))))
    two = changed(np.zeros(n, int), 3, 2)
    expect("flags: expected 0 or 1, found 2 for cell 3", lambda: pamr.refine(mesh, wrong_here(np.zeros(n, int), two)))
    expect("flags: expected -1, 0 or 1, found 2 for cell 3", lambda: pamr.adapt(mesh, wrong_here(np.zeros(n, int), two)))
    expect("found no cell field 'mass'", lambda: pamr.adapt(mesh, -np.ones(n, int), integrals=["mass"]))
    expect("integrals: expected a list of names", lambda: pamr.adapt(mesh, -np.ones(n, int), integrals="mass"))
    expect("flags: expected integers, found float64", lambda: pamr.refine(mesh, np.zeros(n)))
    expect("quality_control: expected one of", lambda: pamr.refine(mesh, np.zeros(n, int), quality_control="good"))
    expect("shape_floor: expected a number from 0 to 1", lambda: pamr.refine(mesh, np.zeros(n, int), shape_floor=1.5))
    expect("balance: expected one of", lambda: pamr.refine(mesh, np.zeros(n, int), balance="fair"))
    mesh.cell_fields["rows"], mesh.cell_fields["bad"] = np.ones((n, 2)), wrong_here(np.ones(n), np.full(n, np.nan))
    for call in (pamr.refine, pamr.adapt):  # where no cell moves, too
        for weights, words in (("none", "expected a cell field 'none', found none"), ("rows", "one component, found 'rows' of 2"),
                               ("bad", "cell field 'bad': expected finite numbers"), (8, "weights: expected \"exact\"")):
            for balance in ("auto", "none"):
                expect(words, lambda: call(mesh, np.zeros(n, int), weights=weights, balance=balance))
    expect("nowhere", lambda: pamr.mark.patch(mesh, "nowhere"))
    expect("no_such", lambda: pamr.mark.field(mesh, "no_such", above=1))
    expect("either above or below", lambda: pamr.mark.field(mesh, "no_such"))
    expect("criterion: expected numbers, found NaN for cell 1",
           lambda: pamr.mark.flags(mesh, wrong_here(np.zeros(n), changed(np.zeros(n), 1, np.nan))))
    expect("weights: expected", lambda: pamr.balance(mesh, wrong_here(np.ones(n), -np.ones(n))))
    expect("points: expected shape n x 3", lambda: pamr.locate(mesh, np.zeros((2, 2))))
    expect("near: expected shape", lambda: pamr.locate(mesh, np.zeros((2, 3)), np.zeros(3, int)))
    expect("expected one of pamr's surfaces", lambda: mesh.associate({"xmin": "sphere"}))
    expect("no_patch", lambda: mesh.associate({"no_patch": pamr.Plane((0, 0, 0), (1, 0, 0))}))
    result = pamr.refine(mesh, np.zeros(n, int))
    expect("expected a row for each", lambda: result.from_parents(wrong_here(np.zeros(n), np.zeros(n + 2))))


@in_folder
def test_files_that_are_not_there_or_have_no_known_name():
    expect("expected a file, found none", lambda: pamr.Mesh.read(COMM, "none.hdf"))
    expect("expected a name that ends in .hdf", lambda: pamr.Mesh.kuhn_cube(COMM, 1).write("mesh.xyz"))
    expect("TypeError", lambda: pamr.Mesh.read(COMM, 5 if COMM.rank == LAST else "none.hdf"))
    expect("without NUL characters", lambda: pamr.Mesh.read(COMM, "cube.hdf\0.old"))
    expect("without NUL characters", lambda: pamr.Mesh.kuhn_cube(COMM, 1).write("cube.hdf\0.old"))
    expect("without NUL characters", lambda: pamr.Mesh.kuhn_cube(COMM, 1).write_rows("cube\0", np.zeros(6)))


@in_folder
def test_what_a_format_has_no_place_for_is_a_warning():
    mesh = pamr.Mesh.from_arrays(COMM, on_last(POINTS), on_last(CELLS), (on_last(FLOOR), on_last(np.array([1, 1]))),
                                 {1: 'the "floor"'})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mesh.write("floor.msh")
    said = [str(warning.message) for warning in caught if "Gmsh" in str(warning.message)]
    assert len(said) == (1 if COMM.rank == 0 else 0), said
    assert not said or "'the \"floor\"' is written as 'the 'floor''" in said[0], said


def written(array, place, value):
    """Writes where a client can, though the array says that it is for reading: through its address."""
    memory = (ctypes.c_byte * array.nbytes).from_address(array.ctypes.data)
    np.frombuffer(memory, array.dtype).reshape(array.shape)[place] = value


def cube_with_a_sheet():
    """Two unit cubes of six cells on top of each other, with a patch inside between them, on all ranks."""
    corners = np.array([[x, y, z] for z in range(3) for y in range(2) for x in range(2)], float)
    paths = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]  # Kuhn's, from corner to corner
    cells = np.array([[4 * k + i for i in path] for k in range(2) for path in paths])
    sheet = np.array([(4, 5, 7), (4, 6, 7)])
    return pamr.Mesh.from_arrays(COMM, on_last(corners), on_last(cells), (on_last(sheet), on_last(np.array([1, 1]))), {1: "sheet"})


def members_of_damage():
    """Array, place, value, and the invariant that is said to be broken: of each array all that numbers and places can be."""
    far = 2**31 - 1

    def other_cell(mesh):
        return (mesh.cell_to_cell[0].max() + 1) % max(len(mesh.cells), 2)
    return [("cells", (0, 0), lambda mesh: mesh.cells[0, 1], "distinct_corners"), ("cells", (0, 3), far, "ids_in_range"),
            ("cells", 0, lambda mesh: mesh.cells[0][[1, 0, 2, 3]], ""),  # inverted
            ("cells", (0, 0), lambda mesh: next(n for n in range(len(mesh.points)) if n not in mesh.cells[0]), ""),
            ("cell_to_cell", (0, 0), -far - 1, ""), ("cell_to_cell", (0, 0), -far, ""), ("cell_to_cell", (0, 0), far, "ids_in_range"),
            ("cell_to_cell", (0, 0), other_cell, ""), ("cell_to_cell", (0, 1), other_cell, ""), ("cell_to_cell", (0, 2), other_cell, ""),
            ("cell_to_cell", (0, 3), 0, ""),  # itself
            ("cell_to_cell", 0, lambda mesh: mesh.cell_to_cell[0][[1, 0, 3, 2]], ""), ("cell_to_cell", 0, 0, ""),
            ("cell_to_cell", 0, -1, ""), ("cell_to_cell", 0, -9, ""), ("cell_to_cell", (slice(None), slice(None)), -1, ""),
            ("cell_numbers", -1, lambda mesh: mesh.cell_numbers[0], ""), ("cell_numbers", 0, 2**62, "ids_in_range"),
            ("node_numbers", 1, lambda mesh: mesh.node_numbers[0], ""), ("node_numbers", 0, -2**63, "ids_in_range"),
            ("points", (0, 1), np.inf, "finite_coordinates"), ("points", (0, 2), -1e308, ""),
            ("points", (slice(None), 2), 0, "orientation_positive"), ("points", 1, lambda mesh: mesh.points[0], ""),
            ("inner_patch", 0, -1, ""), ("inner_patch", 0, 1 << 48, ""), ("inner_patch", slice(None), 0x7fff7fff7fff7fff, "")]


def test_arrays_that_a_client_has_damaged_are_found_on_request():
    for name, place, value, broken in (("cells", (0, 1), 10**6, "ids_in_range"), ("cells", (0, 1), -7, "ids_in_range"),
                                       ("cell_to_cell", (0, 2), 10**6, "ids_in_range"), ("cell_numbers", 0, -1, "ids_in_range"),
                                       ("points", (0, 0), np.nan, "finite_coordinates"), ("points", (0, 0), 1e6, ""),
                                       ("node_numbers", 0, 10**9, "ids_in_range")):
        mesh = pamr.Mesh.kuhn_cube(COMM, 3)
        n = len(mesh.cells)
        mesh.validate()
        pamr.refine(mesh, np.zeros(n, int), check=True)
        if COMM.rank == LAST:
            written(getattr(mesh, name), place, value)
        for call in (mesh.validate, lambda: pamr.refine(mesh, np.ones(n, int), check=True),
                     lambda: pamr.adapt(mesh, np.ones(n, int), check=True)):
            expect(["mesh: expected a valid mesh, found `", broken], call)
    for name, place, value, broken in members_of_damage():
        mesh = cube_with_a_sheet()
        if COMM.rank == LAST:
            array = mesh.cell_fields["inner_patch"] if name == "inner_patch" else getattr(mesh, name)
            written(array, place, value(mesh) if callable(value) else value)
        for call in (mesh.validate, lambda: pamr.refine(mesh, np.ones(len(mesh.cells), int), check=True)):
            expect(["mesh: expected a valid mesh, found `", broken], call)
    if COMM.size > 1:
        mesh = pamr.Mesh.kuhn_cube(COMM, 2)
        written(mesh.ghost_numbers, 0, mesh.ghost_numbers[0] - 1 if mesh.ghost_numbers[0] else 1)
        expect("expected a valid mesh", lambda: pamr.refine(mesh, np.ones(len(mesh.cells), int), check=True))
        mesh = pamr.Mesh.kuhn_cube(COMM, 2)
        expect("arguments: expected the same on every rank",
               lambda: pamr.refine(mesh, np.zeros(len(mesh.cells), int), check=COMM.rank == LAST))


run_tests(globals())
