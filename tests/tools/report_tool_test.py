# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-quality --html without a browser: the same bytes on any number of ranks, tables, what is refused."""
import base64
import io
import json
import pathlib
import re
import zlib

import h5py
import matplotlib.image
import numpy as np

from report_page import Page
from tool_run import FULL, kuhn_cube, refuses, run, run_tests, same_bytes
from tet import FACE_TO_CORNER


SIZES = {"blunt-cone": "0.01", "charged-spheres": "1.5"}


def levels():
    """A body in a box, and the same refined at its wall; a field on cells and one on nodes."""
    run("pamr-mesh", "--shape", "sphere-in-box", "--size", "0.6", "-o", "level0.hdf", "--quiet", serial=True)
    run("pamr-mark", "level0.hdf", "-o", "marked.hdf", "--patch", "sphere", "--quiet", serial=True)
    run("pamr-refine", "marked.hdf", "-o", "level1.hdf", "--quiet", serial=True)
    with h5py.File("level1.hdf", "r+") as file:
        grid = file["VTKHDF"]
        grid.require_group("CellData")["pressure"] = np.arange(grid["NumberOfCells"][0], dtype=float)
        grid.require_group("PointData")["potential"] = np.log(1 + np.arange(grid["NumberOfPoints"][0], dtype=float))
    return "level0.hdf", "level1.hdf"


def codes(packed):
    """The numbers of pack.hpp before signs and differences are undone."""
    plain = np.frombuffer(zlib.decompress(base64.b64decode(packed)), dtype=np.uint8)
    planes = plain[1:].reshape(int(plain[0]), -1).astype(np.uint64)
    return sum(plane << np.uint64(8 * i) for i, plane in enumerate(planes))


def integers(packed):
    code = codes(packed)
    return np.cumsum((code >> np.uint64(1)).astype(np.int64) ^ -(code & np.uint64(1)).astype(np.int64))


def reals(packed):
    return (codes(packed) << np.uint64(8)).astype(np.uint32).view(np.float32)


def test_the_data_are_those_of_the_mesh():
    _, name = levels()
    run("pamr-quality", name, "--html", "report.html", "--quiet")
    element = re.search(r'<script type="application/json" class="view">(.*?)</script>', pathlib.Path("report.html").read_text())
    view = json.loads(element.group(1))
    with h5py.File(name) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        links = file["PAMR/cell_to_cell"][:]
        potential = file["VTKHDF/PointData/potential"][:]
    low, high = np.array(view["box"])
    assert view["all_cells"] and not view["merged"] and view["left_out"] == []
    assert (integers(view["nodes"]["number"]) == np.arange(len(points))).all()
    parts = np.column_stack([integers(axis) for axis in view["nodes"]["position"]]) / 0xffffff
    assert np.abs(low + parts * (high - low) - points).max() < 4e-8 * (high - low).max()
    assert (integers(view["cells"]["node"]).reshape(-1, 4) == cells).all()
    cell, slot = np.nonzero(links < 0)
    faces = view["faces"]
    assert (integers(faces["cell"]) == cell).all() and (integers(faces["patch"]) == -1 - links[cell, slot]).all()
    corners = FACE_TO_CORNER[slot]
    assert (integers(faces["node"]).reshape(-1, 3) == cells[cell[:, None], corners]).all()
    columns = {column["name"]: column for column in faces["columns"]}
    assert np.allclose(reals(columns["pressure"]["data"]), cell, rtol=1.6e-5)
    assert np.allclose(reals(view["nodes"]["columns"][-1]["data"]), potential, rtol=1.6e-5)


def test_the_bytes_do_not_depend_on_ranks():
    names = levels()
    run("pamr-quality", *names, "--html", "many.html", "--quiet")
    run("pamr-quality", *names, "--html", "one.html", "--quiet", serial=True)
    assert same_bytes("one.html", "many.html")
    assert pathlib.Path("one.html").stat().st_size < 4e6


def test_tables_are_readable_without_scripts():
    names = levels()
    report = run("pamr-quality", *names, "--html", "report.html", "--json", "-", "--quiet").json["meshes"]
    text = pathlib.Path("report.html").read_text()
    page = Page(text)
    outside = re.findall(r"""(?:src|href)=["'](?!#|data:image/png;base64,)[^"']*""", re.sub(r"<script[ >].*?</script>", "", text, flags=re.S))
    assert not outside, outside
    meshes = page.tables["Meshes"]
    assert [row[0] for row in meshes[1:]] == list(names)
    assert [int(row[1].replace(",", "")) for row in meshes[1:]] == [mesh["cells"] for mesh in report]
    assert [row[-1] for row in meshes[1:]] == [mesh["fingerprint"] for mesh in report]
    level_rows = page.tables["Cells by the level of their base cell"]
    for column, mesh in enumerate(report, 1):
        counts = [int(row[column].replace(",", "")) for row in level_rows[1:]]
        n_levels = len(mesh["cells_of_level"])
        assert counts[:n_levels] == mesh["cells_of_level"]
        assert counts[-2:] == [mesh["closure_cells"], mesh["cells"]]
        patches = {row[0]: row for row in page.tables[f"Patches, {names[column - 1]}"][1:]}
        assert set(patches) == set(mesh["patches"])
        for name, patch in mesh["patches"].items():
            assert int(patches[name][3].replace(",", "")) == patch["faces"]
            assert np.isclose(float(patches[name][4]), patch["area"], rtol=1e-5)
        worst = page.tables[f"Cells of lowest mean ratio, {names[column - 1]}"]
        place = worst[0].index("mean ratio")
        ratios = [float(row[place]) for row in worst[1:]]
        assert len(ratios) == 20 and ratios == sorted(ratios)
        assert np.isclose(ratios[0], mesh["mean_ratio"]["min"], rtol=1e-5)
        histogram = page.tables["Cells by mean ratio"]
        assert [int(row[1 + column].replace(",", "")) for row in histogram[1:]] == mesh["mean_ratio"]["histogram"]["counts"]


def still_of(name):
    """The still picture of a page: rows of red, green, blue and opacity, 0 to 255."""
    text = pathlib.Path(name).read_text()
    packed = re.search(r'<img id="still" src="data:image/png;base64,([^"]*)" alt="([^"]*)"', text)
    picture = matplotlib.image.imread(io.BytesIO(base64.b64decode(packed.group(1))), format="png")
    first = json.loads(re.search(r'class="constants">(.*?)</script>', text).group(1))["FIRST"]
    return (picture * 255).round().astype(int), packed.group(2), first


def near(image, color, within=20):
    return int(((np.abs(image[:, :, :3] - np.array(color)).max(axis=2) <= within) & (image[:, :, 3] == 255)).sum())


def test_a_still_picture_shows_the_body_without_its_box():
    run("pamr-quality", *levels(), "--html", "both.html", "--quiet", serial=True)
    image, words, first = still_of("both.html")
    assert image.shape == (560, 1000, 4) and words == "Boundary of level0.hdf and of level1.hdf, without box", words
    assert first == {"show": "boundary", "color": "level", "hidden": ["box"], "meshes": [0, 1], "from": [-1.05, -1.22, 0.72], "up": [0, 0, 1]}, first
    left, right = image[:, :500], image[:, 500:]
    for panel in left, right:
        assert (panel[:, :, 3] > 0).mean() > 0.25, (panel[:, :, 3] > 0).mean()
    # level 0 in gray, level 1 in blue, both in light and shade
    shades = lambda panel, color: sum(near(panel, np.array(color) * s / 100, 3) for s in range(62, 101, 6))
    assert shades(left, (195, 204, 216)) > 20000 and shades(left, (88, 170, 187)) < 500
    assert shades(right, (88, 170, 187)) > 20000 and shades(right, (195, 204, 216)) < 500
    assert near(image, (91, 102, 118), 40) > 2000, "edges"
    page = Page(pathlib.Path("both.html").read_text())
    assert page.by_id["legend"] == ["level", "0", "1"] and "Boundary of level0.hdf" in page.by_id["remarks"][0]


def test_first_views_are_of_bodies_or_of_a_section():
    """Boxes with bodies of which one lies at a side, boxes with nothing in them, and parts without a box."""
    for name, shape, hidden, show, share in (("cone", "blunt-cone", {"inflow", "outflow", "symmetry"}, "boundary", 0.25),
                                             ("spheres", "charged-spheres", None, "boundary", 0.25)):
        if name == "cone" and not FULL:
            continue  # takes long to mesh
        run("pamr-mesh", "--shape", shape, "--size", SIZES[shape], "-o", f"{name}.hdf", "--quiet", serial=True)
        run("pamr-quality", f"{name}.hdf", "--html", f"{name}.html", "--quiet", serial=True)
        image, words, first = still_of(f"{name}.html")
        assert first["show"] == show and first["color"] == "patch", first
        assert hidden is None or set(first["hidden"]) == hidden, first
        is_body = image[:, :, 3] > 0
        assert is_body.mean() > share, (name, is_body.mean())
        assert max(is_body.any(axis=0).mean(), is_body.any(axis=1).mean()) > 0.85, "the body does not reach the edges of the picture"
    kuhn_cube("cube.hdf", 4)
    run("pamr-quality", "cube.hdf", "--html", "cube.html", "--quiet", serial=True)
    image, words, first = still_of("cube.html")
    assert (first["show"], first["color"], first["hidden"]) == ("y", "level", []) and "Section through the middle" in words
    assert near(image, (195, 204, 216), 1) > 30000, "the section is not shaded"
    assert (image[:, :, 3] > 0).mean() > 0.25, (image[:, :, 3] > 0).mean()


def test_names_are_text_not_markup():
    kuhn_cube("a<b>&\"{{c}}.hdf", 2)
    run("pamr-quality", "a<b>&\"{{c}}.hdf", "--html", "report.html", "--quiet")
    text = pathlib.Path("report.html").read_text()
    assert Page(text).tables["Meshes"][1][0] == "a<b>&\"{{c}}.hdf"
    assert "a<b>" not in text


def test_invalid_meshes_are_shown():
    kuhn_cube("bad.hdf", 2)
    with h5py.File("bad.hdf", "r+") as file:
        del file["PAMR"]
        cell = file["VTKHDF/Connectivity"][20:24]
        file["VTKHDF/Connectivity"][20:24] = cell[[1, 0, 2, 3]]
    run("pamr-quality", "bad.hdf", "--html", "report.html", "--quiet", code=1)
    text = pathlib.Path("report.html").read_text()
    assert "orientation_positive" in text


def test_bad_requests_are_refused():
    kuhn_cube("a.hdf", 2)
    refuses("pamr-quality", "a.hdf", "--html", "no folder/a.html", says=["no folder"])
    refuses("pamr-quality", "a.hdf", "--html", "a.hdf", says=["a.hdf"])
    refuses("pamr-quality", "a.hdf", "--html", "b.csv", "--csv", "b.csv", says=["b.csv"], creates="b.csv")
    pathlib.Path("old.html").write_text("mine")
    refuses("pamr-quality", "a.hdf", "--html", "old.html", says=["--force"])
    assert pathlib.Path("old.html").read_text() == "mine"


run_tests(globals())
