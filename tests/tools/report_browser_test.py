# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of pamr-quality --html in headless Chromium: nothing on the console, pixels, picking. Exit code 77 (skipped)
where there is no Chromium."""
import pathlib
import sys

import h5py
import matplotlib.image
import numpy as np

import report_page
from report_page import OpenPage, opened, screenshot
from tool_run import SHARED, kuhn_cube, of_full_level, once, run, run_tests
from tet import FACE_TO_CORNER

ROOT = pathlib.Path(__file__).parents[2]
if report_page.BROWSER is None:
    print("skipped: there is no Chromium (Debian: chromium)")
    sys.exit(77)



@once
def report(where="meshes"):
    """In a folder of this name, the page of a cube, a field on cells and one on nodes, and of the same refined at a corner."""
    folder = pathlib.Path(SHARED) / where
    folder.mkdir()
    coarse, fine, page = (str(folder / name) for name in ("coarse.hdf", "fine.hdf", "report.html"))
    kuhn_cube(coarse, 5)
    with h5py.File(coarse, "r+") as file:
        grid = file["VTKHDF"]
        points = grid["Points"][:]
        centers = points[grid["Connectivity"][:].reshape(-1, 4)].mean(axis=1)
        grid.require_group("CellData")["heat"] = 300 + centers[:, 0]
        grid["CellData/heat"].attrs["unit"] = "K"
        grid.require_group("PointData")["height"] = points[:, 2]
        grid["CellData/refine"] = (np.linalg.norm(centers, axis=1) < 0.5).astype("i4")
    run("pamr-refine", coarse, "-o", fine, "--quiet")
    run("pamr-quality", coarse, fine, "--html", page, "--quiet")
    return coarse, fine, page


def mesh_of(name):
    with h5py.File(name) as file:
        return (file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4), file["PAMR/cell_to_cell"][:],
                [text.decode() for text in file["PAMR/patches/names"][:]], file["VTKHDF/CellData/heat"][:])


def pixels(name):
    return (matplotlib.image.imread(name)[:, :, :3] * 255).round().astype(int)


def near(image, color, within=14):
    return int((np.abs(image - np.array(color)).max(axis=2) <= within).sum())


def numbers(text):
    return [float(word) for word in text.split() if word.replace(".", "").replace("-", "").replace("e", "").isdigit()]


@of_full_level
def test_complaints_of_a_page_are_seen():
    pathlib.Path("bad.html").write_text("<script>nothing.here()</script>")
    with OpenPage("bad.html") as page:
        said = page.complaints()
    assert said and "nothing is not defined" in said[0], said


@of_full_level
def test_a_picked_triangle_is_the_one_that_lies_there():
    coarse, _, page = report()
    points, cells, neighbors, patches, heat = mesh_of(coarse)
    for look, patch, middle in (("x", "xmin", (0, 0.5, 0.5)), ("y", "ymin", (0.5, 0, 0.5)), ("z", "zmax", (0.5, 0.5, 1))):
        title, said = opened(page, f"#meshes=0;show=boundary;look={look};color=heat;pick=0.503,0.51").picked()
        assert title == "Boundary triangle" and said["patch"].startswith(patch), said
        cell = int(said["cell behind"])
        slot = list(neighbors[cell]).index(-1 - patches.index(patch))
        corners = cells[cell][FACE_TO_CORNER[slot]]
        at = {int(name.split()[1]): numbers(text) for name, text in said.items() if name.startswith("node ")}
        assert set(at) == set(corners), (at, corners)
        for node, position in at.items():
            assert np.allclose(position, points[node], atol=1e-5)
        # the place that was picked is the middle of the face, about
        assert np.abs(points[corners].mean(axis=0) - middle).max() < 0.15
        assert np.isclose(numbers(said["area"])[0], 0.02, rtol=1e-5)
        assert np.isclose(numbers(said["heat"])[0], heat[cell], rtol=2e-5) and said["heat"].endswith(" K")
        assert np.isclose(numbers(said["height, mean of nodes"])[0], points[corners, 2].mean(), rtol=1e-4)


@of_full_level
def test_a_picked_cell_of_a_section_is_cut_there():
    _, fine, page = report()
    points, cells, _, _, heat = mesh_of(fine)
    link = "#meshes=1;show=z;place=0.3;look=z;color=level;pick=0.45,0.52"
    title, said = opened(page, link).picked()
    # no frame is drawn between the moves and the pick
    assert opened(page, link, first="requestAnimationFrame = () => 0").picked() == (title, said)
    cell = int(title.split()[1])
    corners = points[cells[cell]]
    assert corners[:, 2].min() < 0.3 < corners[:, 2].max(), corners
    volume = np.dot(np.cross(corners[1] - corners[0], corners[2] - corners[0]), corners[3] - corners[0]) / 6
    assert np.isclose(numbers(said["volume"])[0], volume, rtol=1e-4)
    assert np.isclose(numbers(said["heat"])[0], heat[cell], rtol=2e-5)


@of_full_level
def test_worst_cells_are_flown_to():
    _, fine, page = report()
    seen = opened(page, "#worst=0;color=mean_ratio")
    title, said = seen.picked()
    first = seen.tables[f"Cells of lowest mean ratio, {fine}"][1]
    assert title == f"Cell {first[0]}" and np.isclose(float(said["mean ratio"]), float(first[6]), rtol=1e-4)


@of_full_level
def test_meshes_are_drawn_side_by_side():
    _, _, page = report()
    image = pixels(screenshot(page, "#show=boundary;color=level;theme=light", "light.png"))
    left, right = image[150:600, 30:430], image[150:600, 470:860]
    first, second = (195, 204, 216), (88, 170, 187)  # of levels 0 and 1
    lit = lambda part, color: sum(near(part, np.array(color) * shade / 100, 10) for shade in range(70, 101, 6))
    assert lit(left, first) > 5000 and lit(right, first) > 5000
    assert lit(left, second) < 200 and lit(right, second) > 1000, (lit(left, second), lit(right, second))
    assert tuple(image[5, 5]) == (255, 255, 255)


@of_full_level
def test_sections_have_the_colors_of_their_values():
    _, _, page = report()
    image = pixels(screenshot(page, "#meshes=0;show=y;look=y;color=heat;theme=dark", "dark.png"))
    assert max(image[5, 5]) < 40, "dark"
    stage = image[150:600, 30:860]
    # heat grows with x from the lower to the upper end of the color map, from left to right
    low, high = (np.abs(stage - np.array(color)).max(axis=2) < 40 for color in ((68, 1, 84), (253, 231, 37)))
    assert low.sum() > 500 and high.sum() > 500
    assert np.nonzero(low)[1].mean() + 200 < np.nonzero(high)[1].mean()


@of_full_level
def test_hidden_patches_are_neither_drawn_nor_picked():
    _, _, page = report()
    title, said = opened(page, "#meshes=0;show=boundary;look=x;hide=xmin;pick=0.503,0.51").picked()
    assert title == "Boundary triangle" and said["patch"].startswith("xmax"), said


@of_full_level
def test_mouse_and_keys_do_what_they_say():
    coarse, fine, file = report()
    with OpenPage(file, "#meshes=0;show=boundary") as page:
        page.rest()
        left, top, width, height = page.value(
            "(({left, top, width, height}) => [left, top, width, height])(document.getElementById('canvas').getBoundingClientRect())")
        page.press("x")
        page.click(left + 0.503 * width, top + 0.51 * height)
        by_click = page.seen().picked()
    assert by_click == opened(file, "#meshes=0;show=boundary;look=x;pick=0.503,0.51").picked()
    assert by_click[1]["patch"].startswith("xmin")
    with OpenPage(file, "#meshes=0;show=boundary") as page:
        edges = page.rest().value("document.getElementById('edges').checked")
        page.press("e", "s")
        assert page.rest().value("document.getElementById('edges').checked") != edges
        assert page.value("document.getElementById('show').value") == "x"
        page.press("+", "ArrowLeft", "n")
        seen = page.seen()
    assert seen.picked()[0] == "Cell " + seen.tables[f"Cells of lowest mean ratio, {coarse}"][1][0]
    with OpenPage(file) as page:
        page.rest().value("""document.querySelectorAll("tr[data-mesh='1'] button")[2].click()""")
        seen = page.seen()
    assert seen.picked()[0] == f"Cell {seen.tables[f'Cells of lowest mean ratio, {fine}'][3][0]}"


def test_without_webgl_the_tables_remain():
    _, _, page = report()
    with OpenPage(page, options=("--disable-3d-apis",)) as without:
        seen, said = without.seen(may_complain=True), without.complaints()
    assert all("WebGL" in text for text in said), said
    assert "WebGL does not work here" in " ".join(seen.by_id["remarks"])
    assert "still" in seen.by_id and "canvas" not in seen.by_id and "controls" not in seen.by_id
    assert seen.by_id["legend"] == ["level", "0", "1"], seen.by_id["legend"]
    assert "Meshes" in seen.tables and seen.by_id["charts"]


def five_meshes():
    """Five small meshes of the project: commands of pamr-mesh, and names of the patches that are no outer ones. The cone is high and
    the rod a band: seen from the usual direction they fill a sixth of a wide picture."""
    yield "sphere", ("--shape", "sphere-in-box", "--size", "0.6"), {"sphere"}
    yield "cone", ("--shape", "blunt-cone", "--size", "0.01"), {"forebody", "base", "sting"}
    yield "spheres", ("--shape", "charged-spheres", "--size", "1.5"), {"sphere"}
    yield "cube", ("--shape", "kuhn-cube", "--n", "6"), set()
    yield "rod", (str(ROOT / "cases/charged-rod/case.toml"),), {"rod"}


@of_full_level
def test_the_first_view_belongs_to_the_body():
    for name, command, inner in five_meshes():
        run("pamr-mesh", *command, "-o", f"{name}.hdf", "--quiet")
        run("pamr-quality", f"{name}.hdf", "--html", f"{name}.html", "--quiet")
        with OpenPage(f"{name}.html") as page:
            found = page.rest().value("""(() => {
                const found = [], {picture} = page;
                for (let x = 0.02; x < 1; x += 0.04) for (let y = 0.03; y < 1; y += 0.06) {
                    const picked = picture.pick(x, y);
                    found.push(!picked ? "" : picked.kind === "cell" ? "section"
                        : picked.scene.data.view.patches[picked.scene.data.facePatch[picked.index]].name);
                }
                return found;
            })()""")
            assert page.value("getComputedStyle(document.getElementById('still')).display") == "none"
        part = sum(patch in inner or patch == "section" for patch in found) / len(found)
        assert part >= 0.25 and set(found) <= inner | {"", "section"} | (set() if inner else set(found)), (name, part, set(found))


@of_full_level
def test_scales_have_three_digits_and_a_power_of_ten():
    _, _, page = report()
    seen = opened(page)
    with OpenPage(page) as other:
        texts = other.rest().value("[[0, 9.319208636925220e20, 1.8638417e21], [300, 300.5, 301], [1e-5, 0.5, 1]]"
                                   ".map((values) => scaleNumbers(values))")
    assert texts == [["0", "9.32 × 10²⁰", "1.86 × 10²¹"], ["300", "300.5", "301"], ["1 × 10⁻⁵", "0.5", "1"]], texts
    assert seen.by_id["legend"][0] == "level"


@of_full_level
def test_tables_come_first_on_a_phone():
    _, _, page = report("a_folder_whose_name_is_wider_than_the_window_of_a_phone" * 2)
    top = "document.getElementById('{}').getBoundingClientRect().top"
    for width, is_first in ((390, True), (480, True), (800, False)):
        with OpenPage(page) as seen:
            seen.rest()  # drawn for a wide window, whose charts follow
            seen._call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=width < 500)
            # A busy machine takes more than a frame or two to give the page its width and to draw its charts anew.
            seen.rest().value("""new Promise((done) => {
                const begin = Date.now(), isLate = () => Date.now() - begin > 60000;
                const see = () => document.documentElement.scrollWidth <= %d || isLate() ? done(0) : requestAnimationFrame(see);
                see();
            })""" % width)
            assert (seen.value(top.format("levels")) < seen.value(top.format("view"))) == is_first, width
            assert seen.value("document.documentElement.scrollWidth") <= width, width


@of_full_level
def test_charts_are_drawn():
    _, _, page = report()
    seen = opened(page)
    assert sum("cumulative" in text for text in seen.by_id["charts"]) >= 6, seen.by_id["charts"][:20]
    assert int(seen.root["data-first-frame"]) > 0


run_tests(globals(), at_once=2)
