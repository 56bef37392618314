# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-refine refuses bad input: exit code 2, one line that says what is wrong where, no output, nothing left behind."""
import os
import pathlib
import shutil
import subprocess
import tempfile

import h5py
import numpy as np

import tool_run
from lineage_words import Lineage
from tool_run import BIN, FULL, LAUNCHER, LIMIT, RANKS, bare_copy, kuhn_cube, once, refuses, run, run_tests, same_bytes, without_chatter

tool_run.REFUSED_BY_ALL = 1 if FULL else 4  # that all ranks end, and one speaks, is what this is about


@once
def good_meshes():
    """A Kuhn cube refined in one corner, so that it has closure families of both kinds, and marked again: bytes of the files."""
    kuhn_cube("level0.hdf", 3)
    corner = ("--crossing-sphere", "0,0,0,0.4", "--quiet")
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", *corner, serial=True)
    run("pamr-refine", "marked.hdf", "-o", "level1.hdf", "--quiet", serial=True)
    run("pamr-mark", "level1.hdf", "-o", "good.hdf", *corner, serial=True)
    return {name: pathlib.Path(name).read_bytes() for name in ("level1.hdf", "good.hdf")}


def good_mesh():
    for name, contents in good_meshes().items():
        pathlib.Path(name).write_bytes(contents)
    return "good.hdf"


def drop_checksum(file, dataset):
    """As docs/file-format.md asks a script that changes a dataset to do; the checks behind the checksum then apply."""
    if "PAMR/checksums" in file:
        file["PAMR/checksums"].attrs.pop(dataset, None)


def edit(source, target, dataset, change, dtype=None):
    """A copy in which `change` has been applied to the values of a dataset."""
    shutil.copy(source, target)
    with h5py.File(target, "r+") as file:
        values = file[dataset][:]
        values = change(values if dtype is None else values.astype(dtype))
        drop_checksum(file, dataset)
        del file[dataset]
        if values is not None:
            file[dataset] = values
    return target


def with_entry(index, value):
    def change(values):
        values[index] = value
        return values
    return change


def write_bare(name, points, cells, marks=None):
    """A mesh by the /VTKHDF part of docs/file-format-objects.md alone."""
    cells = np.asarray(cells, dtype=np.int64)
    with h5py.File(name, "w") as file:
        vtk = file.create_group("VTKHDF")
        vtk.attrs["Version"] = np.array([1, 0])
        vtk.attrs["Type"] = np.bytes_("UnstructuredGrid")
        vtk["NumberOfPoints"], vtk["NumberOfCells"] = np.array([len(points)]), np.array([len(cells)])
        vtk["NumberOfConnectivityIds"] = np.array([cells.size])
        vtk["Points"], vtk["Connectivity"] = np.asarray(points, dtype=float), cells.ravel()
        vtk["Offsets"], vtk["Types"] = np.arange(0, cells.size + 1, 4), np.full(len(cells), 10, np.uint8)
        vtk["CellData/refine"] = np.ones(len(cells), np.int32) if marks is None else marks
    return name


def no_mesh_from(name, *says, options=()):
    """The tool refuses this input, naming the file."""
    result = refuses("pamr-refine", name, "-o", "out.hdf", *options, says=says, creates="out.hdf")
    assert not list(pathlib.Path(".").glob("out.hdf*")), "something of the output was left behind"
    return result


def test_the_good_mesh_is_accepted():
    run("pamr-refine", good_mesh(), "-o", "out.hdf")
    run("pamr-refine", bare_copy("good.hdf", "bare.hdf"), "-o", "out.hdf", "--force")
    write_bare("one.hdf", [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    run("pamr-refine", "one.hdf", "-o", "out.hdf", "--force")


def test_files_that_are_no_mesh():
    contents = pathlib.Path(good_mesh()).read_bytes()
    no_mesh_from("missing.hdf", "missing.hdf")
    os.mkdir("folder.hdf")
    no_mesh_from("folder.hdf", "folder.hdf")
    os.mkfifo("pipe.hdf")
    no_mesh_from("pipe.hdf", "pipe.hdf")
    pathlib.Path("text.hdf").write_text("not a mesh\n" * 1000)
    no_mesh_from("text.hdf", "text.hdf", "HDF5")
    for size in (0, 8, 600, len(contents) // 10, len(contents) // 2, 9 * len(contents) // 10, len(contents) - 1):
        pathlib.Path("short.hdf").write_bytes(contents[:size])
        no_mesh_from("short.hdf", "short.hdf", "HDF5")


def test_a_flipped_byte_in_any_dataset():
    contents = pathlib.Path(good_mesh()).read_bytes()
    places = {}
    with h5py.File("good.hdf") as file:
        file.visititems(lambda name, item: places.__setitem__(
            name, item.id.get_offset() + item.id.get_storage_size() // 2) if isinstance(item, h5py.Dataset) else None)
    assert len(places) >= 12, places
    for name, place in places.items():
        damaged = bytearray(contents)
        damaged[place] ^= 0x10
        pathlib.Path("flipped.hdf").write_bytes(damaged)
        if name == "VTKHDF/CellData/level":  # for viewers: not read, and written anew
            for mesh in ("good", "flipped"):
                run("pamr-refine", f"{mesh}.hdf", "-o", f"from_{mesh}.hdf", "--quiet")
            assert same_bytes("from_good.hdf", "from_flipped.hdf")
            continue
        if name.startswith(("VTKHDF/CellData/", "VTKHDF/PointData/")):  # as if a solver had rewritten it: a remark
            done = subprocess.run([str(BIN / "pamr-refine"), "flipped.hdf", "-o", "flipped-fine.hdf", "--force"],
                                  capture_output=True, text=True, timeout=LIMIT)
            assert done.returncode in (0, 2) and name in done.stderr and "checksum" in done.stderr, done
            continue
        # a wrong count shows at the datasets that ought to have it
        no_mesh_from("flipped.hdf", "flipped.hdf", name if "NumberOf" not in name else "expected")


def test_shapes_and_types():
    good_mesh()
    for dataset, change, dtype in (
            ("VTKHDF/Points", lambda v: v[:, :2], None), ("VTKHDF/Points", np.ravel, None),
            ("VTKHDF/Points", lambda v: v[:-1], None), ("VTKHDF/Points", lambda v: v, np.int64),
            ("VTKHDF/Connectivity", lambda v: v[:-1], None), ("VTKHDF/Connectivity", lambda v: v.reshape(-1, 4), None),
            ("VTKHDF/Connectivity", lambda v: v, float), ("VTKHDF/Types", with_entry(3, 12), None),
            ("VTKHDF/Offsets", with_entry(3, 11), None), ("VTKHDF/NumberOfCells", lambda v: v + 1, None),
            ("VTKHDF/NumberOfCells", lambda v: 0 * v + 2**62, None), ("VTKHDF/Points", lambda v: None, None),
            ("PAMR/cell_to_cell", lambda v: v[:, :3], None), ("PAMR/cell_to_cell", lambda v: v, float),
            ("PAMR/lineage", lambda v: v[:-1], None), ("PAMR/lineage", lambda v: v, float)):
        # a wrong count shows at the datasets that ought to have it
        word = dataset if "NumberOf" not in dataset else "expected"
        no_mesh_from(edit("good.hdf", "bad.hdf", dataset, change, dtype), "bad.hdf", word, "expected", "found")


def test_node_numbers_and_coordinates():
    good_mesh()
    with h5py.File("good.hdf") as file:
        n_nodes = len(file["VTKHDF/Points"])
    for value in (float("nan"), float("inf"), -float("inf")):
        no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/Points", with_entry((7, 1), value)), "Points", "7")
    for value in (-1, n_nodes, 2**31, 2**32, 2**63 - 1, -2**63):
        no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/Connectivity", with_entry(42, value)), "Connectivity", "42",
                     str(value))
    no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/Connectivity", with_entry(42, 2**63), np.uint64), "Connectivity")


def twice(index):
    def change(values):
        values[4 * index:4 * index + 4] = values[4 * index + 4:4 * index + 8]
        return values
    return change


def inverted(index):
    def change(values):
        values[4 * index:4 * index + 2] = values[4 * index:4 * index + 2][::-1].copy()
        return values
    return change


def test_bad_cells():
    bare_copy(good_mesh(), "bare.hdf")
    no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/Connectivity", inverted(20)), "bad.hdf", "20")
    turned = run("pamr-refine", edit("bare.hdf", "turned.hdf", "VTKHDF/Connectivity", inverted(20)), "-o", "fine.hdf")
    assert "turned.hdf': 1 of" in turned.err, turned.err  # of other programs, which do not care
    for source in ("good.hdf", "bare.hdf"):
        no_mesh_from(edit(source, "bad.hdf", "VTKHDF/Connectivity", twice(20)), "bad.hdf")

    def same_node(values):
        values[81] = values[82]
        return values
    no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/Connectivity", same_node), "Connectivity", "80", "twice")
    corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    for height in (1e-13, 0):  # too flat to be split, flat
        no_mesh_from(write_bare("flat.hdf", corner + [[0.3, 0.3, height]], [[0, 1, 2, 3]]), "flat.hdf", "cell 0")


def test_bad_faces():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.3, -1], [0.3, 0.2, -2]]
    no_mesh_from(write_bare("three.hdf", points, [[0, 1, 2, 3], [0, 2, 1, 4], [0, 2, 1, 5]]), "three.hdf", "face")
    no_mesh_from(write_bare("over.hdf", points[:4] + [[0.1, 0.1, 2]], [[0, 1, 2, 3], [0, 1, 2, 4]]), "over.hdf")


def test_neighbors_that_are_not_mutual():
    good_mesh()
    with h5py.File("good.hdf") as file:
        neighbors = file["PAMR/cell_to_cell"][:]
        n_patches = len(file["PAMR/patches/names"])
    c = next(c for c, row in enumerate(neighbors) if (row >= 0).all() and c > 20)
    exchanged = neighbors[c][[1, 0, 2, 3]]
    for index, value in ((c, exchanged), ((c, 0), c), ((c, 0), len(neighbors)), ((c, 0), 2**31), ((c, 0), 2**63 - 1),
                         ((c, 0), -1), ((c, 0), -n_patches - 1), ((c, 0), -2**63),
                         ((c, 0), (neighbors[c, 0] + 5) % len(neighbors))):
        no_mesh_from(edit("good.hdf", "bad.hdf", "PAMR/cell_to_cell", with_entry(index, value)), "bad.hdf")


def test_lineage_that_describes_no_families():
    good_mesh()
    with h5py.File("good.hdf") as file:
        lineage = file["PAMR/lineage"][:]
    word = Lineage(lineage)
    edge = np.flatnonzero((word.state >= 1) & (word.state <= 6) & (word.child == 0))[0]
    face = np.flatnonzero((word.state >= 7) & (word.state <= 10) & (word.child == 0))[0]
    known = np.flatnonzero(word.path != 0)[0]
    exchanged = lineage.copy()
    exchanged[face:face + 2] = exchanged[face:face + 2][::-1]

    def turned(first, end, bit):
        return with_entry(slice(first, end), lineage[first:end] ^ np.uint64(1 << bit))

    def of_other_state(first, end):
        """As many cells in the family, another edge or face."""
        size = 2 if word.state[first] <= 6 else 4
        step = size if word.state[first] in (1, 7) else -size
        return with_entry(slice(first, end), (lineage[first:end].astype(np.int64) + step).astype(np.uint64))
    for change in (with_entry(edge + 1, 0), with_entry(edge, 0), with_entry(face + 2, 0), lambda v: exchanged,
                   of_other_state(edge, edge + 1), of_other_state(face, face + 1), turned(edge, edge + 1, 11),
                   turned(edge, edge + 1, 13), turned(edge, edge + 1, 23), with_entry(0, 3), with_entry(0, 0x7FF),
                   # paths that cannot be: without an end, with the end in no place, longer than the level
                   with_entry(known, 1 << 20), with_entry(known, 7 << 12 | 16 << 20), with_entry(known, 64 << 20),
                   with_entry(0, np.uint64(2**63)), with_entry(0, np.uint64(2**64 - 1)),
                   # whole families of another template: the cells are not what it says
                   of_other_state(edge, edge + 2), of_other_state(face, face + 4)):
        no_mesh_from(edit("good.hdf", "bad.hdf", "PAMR/lineage", change), "bad.hdf", "lineage")


def test_a_patch_whose_surface_is_not_there():
    edit(good_mesh(), "bad.hdf", "PAMR/patches/surfaces", with_entry(2, b"nope"))
    refuses("pamr-refine", "bad.hdf", "-o", "out.hdf", says=['"ymin"', '"nope"', "found none"], creates="out.hdf")
    run("pamr-refine", "bad.hdf", "-o", "out.hdf", "--no-project", "--quiet")


def test_bad_marks():
    good_mesh()
    field = "VTKHDF/CellData/refine"
    no_mesh_from("level1.hdf", "refine")
    no_mesh_from(edit("good.hdf", "bad.hdf", field, lambda v: v, float), "refine", "integer")
    no_mesh_from(edit("good.hdf", "bad.hdf", field, lambda v: v[:-1]), "refine")
    no_mesh_from(edit("good.hdf", "bad.hdf", field, lambda v: np.stack([v, v], axis=1)), "refine", "component")
    for value in (2, -2, 2**31 - 1):
        no_mesh_from(edit("good.hdf", "bad.hdf", field, with_entry(17, value)), "refine", str(value), "17")
    no_mesh_from(edit("good.hdf", "bad.hdf", field, with_entry(17, 2**32), np.int64), "refine")
    no_mesh_from("good.hdf", "other", options=["--marks", "other"])
    no_mesh_from("good.hdf", "parent", options=["--marks", "parent"])  # an integer field that holds no marks


def test_a_field_of_data_with_the_name_of_the_parents():
    good_mesh()
    no_mesh_from(edit("good.hdf", "bad.hdf", "VTKHDF/CellData/parent", lambda v: v + 0.5, float), "'parent'", "found reals")


def test_outputs_that_cannot_be():
    contents = pathlib.Path(good_mesh()).read_bytes()
    refuses("pamr-refine", "good.hdf", "-o", "nowhere/out.hdf", says=["nowhere"], creates="nowhere")
    refuses("pamr-refine", "good.hdf", "-o", "/proc/out.hdf", says=["/proc"], creates="/proc/out.hdf")
    pathlib.Path("kept.hdf").write_text("precious")
    refuses("pamr-refine", "good.hdf", "-o", "kept.hdf", says=["kept.hdf", "--force"])
    assert pathlib.Path("kept.hdf").read_text() == "precious"
    os.mkdir("folder")
    os.symlink("good.hdf", "symbolic.hdf")
    os.link("good.hdf", "hard.hdf")
    for output in ("good.hdf", "./folder/../good.hdf", "symbolic.hdf", "hard.hdf"):
        refuses("pamr-refine", "good.hdf", "-o", output, "--force", says=["good.hdf"])
        assert pathlib.Path("good.hdf").read_bytes() == contents
    refuses("pamr-refine", "good.hdf", "-o", "folder", "--force", says=["folder"])
    refuses("pamr-refine", "good.hdf", "-o", "out.hdf", "--json", "out.hdf", creates="out.hdf")
    refuses("pamr-refine", "good.hdf", "-o", "out.hdf", "--json", "good.hdf", creates="out.hdf")
    refuses("pamr-refine", "good.hdf", "-o", "out.hdf", "--json", "nowhere/report.json", creates="out.hdf")
    assert pathlib.Path("good.hdf").read_bytes() == contents


def test_bad_usage():
    good_mesh()
    no_mesh_from("good.hdf", "--frobnicate", options=["--frobnicate"])
    no_mesh_from("good.hdf", "greedy", options=["--quality-control", "greedy"])
    no_mesh_from("good.hdf", "level1.hdf", options=["level1.hdf"])
    refuses("pamr-refine", says=["MESH"])
    refuses("pamr-refine", "good.hdf", says=["--output"])
    refuses("pamr-refine", "good.hdf", "-o", "", says=["output"])


def refine_onto_full_disk(output, limit_kib=None):
    """Runs with this largest size of a file (of the tool's own processes only), without shared memory files of MPI."""
    limited = ["sh", "-c", f'ulimit -f {limit_kib}; exec "$@"', "sh"] if limit_kib else []
    command = LAUNCHER + limited + [str(BIN / "pamr-refine"), "good.hdf", "-o", output, "--force"]
    return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT,
                          env=os.environ | {"OMPI_MCA_btl": "self,tcp", "PMIX_MCA_gds": "hash"})


def check_full_disk(done, folder, survivors):
    lines = without_chatter(done.stderr).splitlines()
    assert done.returncode == 2, (done.returncode, done.stderr)
    assert len(lines) == 1 and lines[0].startswith("pamr-refine: error: ") and "out.hdf" in lines[0], done.stderr
    assert sorted(os.listdir(folder)) == survivors, os.listdir(folder)


def test_a_file_that_outgrows_the_limit():
    good_mesh()
    os.mkdir("disk")
    for limit in (1, 64):  # units of 512 bytes or 1 KiB, as the shell likes
        check_full_disk(refine_onto_full_disk("disk/out.hdf", limit), "disk", [])
    pathlib.Path("disk/out.hdf").write_text("precious")
    check_full_disk(refine_onto_full_disk("disk/out.hdf", 64), "disk", ["out.hdf"])
    assert pathlib.Path("disk/out.hdf").read_text() == "precious"


def test_a_full_disk():
    """On a small file system where this user may mount one; the limit on files above stands for it elsewhere."""
    good_mesh()
    os.mkdir("disk")
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=128k", "tmpfs", "disk"], capture_output=True)
    if mounted.returncode != 0:
        print("        no right to mount: nothing but the limit on files was tried")
        return
    try:
        check_full_disk(refine_onto_full_disk("disk/out.hdf"), "disk", [])
    finally:
        subprocess.run(["umount", "disk"], check=True)


def scaled(target, factor):
    """The cube with other coordinates and without its surfaces; checksums of what has changed go."""
    shutil.copyfile("cube.hdf", target)
    with h5py.File(target, "r+") as file:
        file["VTKHDF/Points"][:] = file["VTKHDF/Points"][:] * factor
        del file["PAMR/surfaces"], file["PAMR/patches/surfaces"]
        for name in ("VTKHDF/Points", "PAMR/surfaces", "PAMR/patches/surfaces"):
            del file["PAMR/checksums"].attrs[name]
    return target


def test_no_mesh_is_written_that_is_refused_when_it_is_read():
    """Meshes whose volumes are too small for a double, and flat cells that a closure makes flatter."""
    kuhn_cube("cube.hdf", 2)
    for tool, output in (("pamr-mark", ["-o", "no.hdf", "--all"]), ("pamr-quality", [])):
        refuses(tool, scaled("tiny.hdf", 1e-107), *output, says=["tiny.hdf: expected a mesh larger than 1e-30"], creates="no.hdf")
    flat = ["expected cells with a mean ratio of at least 1e-08, found ", "first cell 0"]

    run("pamr-mark", scaled("thin.hdf", np.array([1, 1, 0.9e-12])), "-o", "thinner.hdf", "--box", "0,0,-1,0.3,0.3,1", "--quiet",
        serial=True)
    refuses("pamr-refine", "thinner.hdf", "-o", "no.hdf", "--quality-control", "none", says=["no.hdf"] + flat, creates="no.hdf")


def with_names(source, target, names, where="PAMR/patches/names"):
    shutil.copyfile(source, target)
    with h5py.File(target, "r+") as file:
        del file[where]
        file[where] = names
        del file["PAMR/checksums"].attrs[where]
    return target


def test_names_are_not_cut_at_a_nul_character():
    kuhn_cube("cube.hdf", 1)
    rest = [b"b", b"c", b"d", b"e", b"f"]
    mesh = with_names("cube.hdf", "nul.hdf", np.array([b"wall\0 of the body"] + rest))
    refuses("pamr-refine", mesh, "-o", "out.hdf", says=["/PAMR/patches/names", "NUL", "'wall'", "row 0"], creates="out.hdf")
    kinds = with_names("cube.hdf", "kinds.hdf", np.array([b"", b"\0wall"] + rest[:4]), "PAMR/patches/kinds")
    refuses("pamr-refine", kinds, "-o", "out.hdf", says=["/PAMR/patches/kinds", "row 1"], creates="out.hdf")
    shutil.copyfile("cube.hdf", "unit.hdf")
    with h5py.File("unit.hdf", "r+") as file:
        file["PAMR"].attrs["length_unit"] = np.bytes_(b"m\0m")
    refuses("pamr-refine", "unit.hdf", "-o", "out.hdf", says=["/PAMR@length_unit"], creates="out.hdf")


def with_fields(target, fields):
    shutil.copyfile("cube.hdf", target)
    with h5py.File(target, "r+") as file:
        cells = file["VTKHDF"].require_group("CellData")
        for name, values in fields.items():
            cells[name] = values
    return target


def test_as_many_fields_and_as_long_names_as_can_be_read_can_be_written():
    kuhn_cube("cube.hdf", 1)
    many = with_fields("many.hdf", {f"field {i}": np.full(6, float(i)) for i in range(4095)})
    long = with_fields("long.hdf", {"f" * 60000: np.arange(6.0)})
    for mesh in (many, with_names("cube.hdf", "names.hdf", np.array([b"w" * 65000, b"b", b"c", b"d", b"e", b"f"])), long):
        run("pamr-convert", mesh, "out.hdf", "--force", "--quiet", serial=mesh != many)
        run("pamr-convert", "out.hdf", "again.hdf", "--force", "--quiet", serial=True)
        assert same_bytes("out.hdf", "again.hdf")
        with h5py.File(mesh) as before, h5py.File("again.hdf") as after:
            for name in ("VTKHDF/CellData", "PAMR/patches"):
                assert set(before[name]) <= set(after[name])
            assert all(np.array_equal(before[f"VTKHDF/CellData/{f}"], after[f"VTKHDF/CellData/{f}"]) for f in before["VTKHDF/CellData"])
            assert list(before["PAMR/patches/names"]) == list(after["PAMR/patches/names"])
    for fields, says in (({"g" * 60001: np.arange(6.0)}, ["at most 60000 bytes, found 60001", "ggg...'"]),):
        refuses("pamr-convert", with_fields("bad.hdf", fields), "no.hdf", says=says, creates="no.hdf")


def test_a_stream_is_no_mesh():
    kuhn_cube("cube.hdf", 1)
    for tool, more in (("pamr-refine", ("-o", "out.hdf")), ("pamr-quality", ()), ("pamr-mark", ("--all", "-o", "out.hdf"))):
        for name in ("/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"):
            with open("cube.hdf", "rb") as mesh:
                done = subprocess.run([str(BIN / tool), name, *more], stdin=mesh, capture_output=True, text=True, timeout=LIMIT)
            assert done.returncode == 2 and f"{name}: expected the name of a file on a disk" in done.stderr, done.stderr
    if os.access("/dev/shm", os.W_OK):
        with tempfile.TemporaryDirectory(dir="/dev/shm") as memory:
            run("pamr-mark", kuhn_cube(f"{memory}/cube.hdf", 1), "--all", "-o", f"{memory}/out.hdf")


def test_the_same_input_is_still_good_after_all_that():
    run("pamr-refine", good_mesh(), "-o", "a.hdf")
    run("pamr-refine", "good.hdf", "-o", "b.hdf", serial=True)
    assert same_bytes("a.hdf", "b.hdf")


if __name__ == "__main__":
    print(f"{RANKS} ranks")
    run_tests(globals())
