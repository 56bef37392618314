# SPDX-License-Identifier: GPL-3.0-or-later
"""pamr-mesh makes level 0 from CAD files by itself. data/can.step is a closed can of radius 1 from z = 0 to 2 (face 1 the side, 2
and 3 top and bottom); data/can.igs is the same as loose faces; data/colored_can.step has a gray side, a red top, a blue bottom;
data/quarter_can.step is a quarter of a can of radius 10 from z = 0 to 20, data/chamfer_box.brep a box with chamfers, both made by Gmsh. assembly.step of the unit tests of
geometry is a housing [0, 2]^3, a ball of radius 0.5 in its middle, and two pegs of side 1, at (2, 0.5, 0.5) and (5, 0, 0)."""
import json
import math
import pathlib
import re
import shutil

import h5py
import numpy as np

from tool_run import FULL, RANKS, of_full_level, prepare_alone, refuses, run, run_tests, same_bytes

prepare_alone("pamr-mark")

DATA = pathlib.Path(__file__).resolve().parent / "data"
ASSEMBLY = DATA.parent.parent / "unit" / "geometry" / "data" / "assembly.step"
CUBE = DATA.parent.parent / "unit" / "geometry" / "data" / "cube.step"
FAR_BOX = """
[mesh]
shape = "surfaces"
length_unit = "mm"
region = "+side & +x0 & -x1 & +y0 & -y1 & +z0 & -z1"
bounds = [[-3, -3, -2], [3, 3, 4]]
[mesh.sizes]
far = 1.2
near = { top = 0.3 }
[[surface]]
name = "side"
kind = "cad"
file = "can.step"
faces = [1, 3]
[[surface]]
name = "top"
kind = "cad"
file = "can.step"
faces = [2]
""" + "".join(f"""[[surface]]
name = "{axis}{end}"
kind = "plane"
point = {[place if axis == k else 0 for k in 'xyz']}
normal = {[int(axis == k) for k in 'xyz']}
""" for axis, places in (("x", (-3, 3)), ("y", (-3, 3)), ("z", (-2, 4))) for end, place in enumerate(places))


def volume_and_walls(mesh):
    """Volume, and the nodes of each patch."""
    with h5py.File(mesh) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        neighbors, names = file["PAMR/cell_to_cell"][:], [name.decode() for name in file["PAMR/patches/names"][:]]
    p = points[cells]
    volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    assert (volume > 0).all()
    walls = {}
    for number, name in enumerate(names):
        cell, slot = np.nonzero(neighbors == -(number + 1))
        walls[name] = points[np.unique([cells[cell, (slot + k) % 4] for k in (1, 2, 3)])]
    return volume.sum(), walls


def refine(mesh, out):
    run("pamr-mark", mesh, "-o", "marked.hdf", "--all", "--force", "--quiet")
    return run("pamr-refine", "marked.hdf", "-o", out, "--force", "--json", "-").json


def is_on_can(nodes, tolerance=1e-13):
    radius, z = np.hypot(nodes[:, 0], nodes[:, 1]), nodes[:, 2]
    return ((np.abs(radius - 1) < tolerance) | (np.abs(z * (z - 2)) < tolerance)).all()


def test_one_line_makes_the_inside_of_a_shape():
    shutil.copy(DATA / "can.step", "can.step")
    run("pamr-mesh", "can.step", "-o", "many.hdf", "--size", "0.5")
    if RANKS > 1:
        run("pamr-mesh", "can.step", "-o", "one.hdf", "--size", "0.5", serial=True)
        assert same_bytes("many.hdf", "one.hdf")
    errors = []
    last = 2 if FULL else 1
    for level in range(last + 1):
        volume, walls = volume_and_walls("many.hdf")
        errors.append(abs(volume / (2 * np.pi) - 1))
        assert sorted(walls) == ["face_1", "face_2", "face_3"]
        assert is_on_can(np.concatenate(list(walls.values())))
        assert (walls["face_2"][:, 2] == 2).all() and (walls["face_3"][:, 2] == 0).all()
        if level < last:
            assert refine("many.hdf", "many.hdf")["off_surface_nodes"] == 0
    assert all(3.7 < coarse / fine < 4.3 for coarse, fine in zip(errors, errors[1:])), errors


# For CGAL's mesher points 1e16 away were inside by rounding, and it never ended.
@of_full_level
def test_a_quarter_of_a_can_comes_to_an_end():
    shutil.copy(DATA / "quarter_can.step", "quarter.step")
    run("pamr-mesh", "quarter.step", "-o", "quarter.hdf", "--size", "8", serial=True)
    volume, walls = volume_and_walls("quarter.hdf")
    assert abs(volume / (500 * np.pi) - 1) < 0.05 and len(walls) == 5
    assert refine("quarter.hdf", "quarter1.hdf")["off_surface_nodes"] == 0


def test_loose_faces_of_iges_are_sewn():
    shutil.copy(DATA / "can.igs", "can.igs")
    run("pamr-mesh", "can.igs", "-o", "iges.hdf", "--size", "0.6", serial=True)
    volume, walls = volume_and_walls("iges.hdf")
    assert abs(volume / (2 * np.pi) - 1) < 0.1 and len(walls) == 3
    assert is_on_can(np.concatenate(list(walls.values())), 1e-6)
    assert refine("iges.hdf", "iges1.hdf")["off_surface_nodes"] == 0


def test_patches_by_color_and_in_other_units():
    shutil.copy(DATA / "colored_can.step", "can.step")
    report = run("pamr-mesh", "can.step", "-o", "can.hdf", "--size", "0.06", "--unit", "cm", "--json", "-", serial=True).json
    assert sorted(report["patches"]) == ["color_333333", "color_336699", "color_ff0000"], report["patches"]
    volume, walls = volume_and_walls("can.hdf")
    assert abs(volume / (2e-3 * np.pi) - 1) < 0.1
    assert (np.abs(walls["color_ff0000"][:, 2] - 0.2) < 1e-15).all()
    case = FAR_BOX.replace("faces = [2]", 'face_colors = ["#ff0000"]').replace("faces = [1, 3]", 'face_colors = ["#333333", "#336699"]')
    pathlib.Path("case.toml").write_text(case.replace('"#336699"', '"#336698"'))
    refuses("pamr-mesh", "case.toml", "-o", "a.hdf", says=["#336698", "colors of faces of the shape (#333333, #336699, #ff0000)"])
    pathlib.Path("case.toml").write_text(case)
    report = run("pamr-mesh", "case.toml", "-o", "box.hdf", "--json", "-").json
    assert report["patches"]["top"]["faces"] > 20


@of_full_level
def test_a_body_in_a_far_box_has_sizes_by_patch():
    shutil.copy(DATA / "can.step", "can.step")
    pathlib.Path("case.toml").write_text(FAR_BOX)
    run("pamr-mesh", "case.toml", "-o", "box.hdf", serial=True)
    volume, walls = volume_and_walls("box.hdf")
    assert abs((216 - volume) / (2 * np.pi) - 1) < 0.05, volume
    assert len(walls["top"]) > 40 and (walls["top"][:, 2] == 2).all()
    assert is_on_can(walls["side"]) and (walls["x0"][:, 0] == -3).all()
    assert refine("box.hdf", "box1.hdf")["off_surface_nodes"] == 0


@of_full_level
def test_a_mirror_cuts_a_shape_in_half():
    shutil.copy(DATA / "can.step", "can.step")
    pathlib.Path("case.toml").write_text("""
[mesh]
shape = "surfaces"
length_unit = "mm"
region = "-can & +mirror"
bounds = [[-1.2, -0.1, -0.2], [1.2, 1.2, 2.2]]
sizes = { far = 0.5 }
[[surface]]
name = "can"
kind = "cad"
file = "can.step"
[[surface]]
name = "mirror"
kind = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
""")
    run("pamr-mesh", "case.toml", "-o", "half.hdf", serial=True)
    volume, walls = volume_and_walls("half.hdf")
    assert abs(volume / np.pi - 1) < 0.05, volume
    assert (walls["mirror"][:, 1] == 0).all() and is_on_can(walls["can"])
    assert refine("half.hdf", "half1.hdf")["off_surface_nodes"] == 0


def test_what_does_not_fit_is_said():
    shutil.copy(DATA / "can.step", "can.step")
    shutil.copy(CUBE, "cube.step")
    refuses("pamr-mesh", "can.step", "-o", "a.hdf", "--unit", "furlong", says=["--unit: expected mm"])
    refuses("pamr-mesh", "none.step", "-o", "a.hdf", says=["none.step"], creates="a.hdf")
    refuses("pamr-mesh", "can.step", "-o", "a.hdf", "--size", "0.01", "--quiet", says=["at most 4 million cells"], creates="a.hdf")
    pathlib.Path("case.toml").write_text(FAR_BOX.replace("faces = [1, 3]", "faces = [1]"))
    refuses("pamr-mesh", "case.toml", "-o", "a.hdf", says=["add a [[surface]] of the same file with faces = [3]"])
    pathlib.Path("case.toml").write_text(FAR_BOX.replace("faces = [1, 3]", ""))
    refuses("pamr-mesh", "case.toml", "-o", "a.hdf", says=["found face 2 on \"side\" and \"top\""])
    pathlib.Path("case.toml").write_text(FAR_BOX.replace("faces = [2]", 'face_names = ["lid"]'))
    refuses("pamr-mesh", "case.toml", "-o", "a.hdf", says=["faces by number: no face of the shape has one of these names"])
    refuses("pamr-mesh", open_cube(), "-o", "a.hdf", "--size", "0.3", creates="a.hdf",
            says=["expected a closed shape, found one that is open at 4 places", "-setnumber Geometry.OCCSewFaces 1"])


def entities(text):
    """The lines between DATA; and ENDSEC; of a STEP text, and what is before and behind them."""
    begin, end = text.index("DATA;") + 5, text.rindex("ENDSEC;")
    return text[:begin], text[begin:end], text[end:]


def step(name, *more):
    """The cube of side 1 as a STEP file with lines behind its last one."""
    head, lines, rest = entities(CUBE.read_text())
    pathlib.Path(name).write_text(head + lines + "\n".join(more) + "\n" + rest)
    return name


def prism(name, n, height):
    """Over a polygon with `n` corners on the unit circle, as a STEP file: two faces with `n` edges."""
    lines = []

    def add(kind, *values):
        word = lambda value: f"{value:.15f}" if isinstance(value, float) else value
        text = ",".join("(" + ",".join(map(word, value)) + ")" if isinstance(value, (list, tuple)) else word(value) for value in values)
        lines.append(f"#{1000 + len(lines)} = {kind}('',{text});")
        return f"#{999 + len(lines)}"

    def axes(place, normal, along):
        return add("AXIS2_PLACEMENT_3D", add("CARTESIAN_POINT", place), add("DIRECTION", normal), add("DIRECTION", along))

    def edge(begin, end):
        (a, first), (b, last) = begin, end
        vector = add("VECTOR", add("DIRECTION", [(y - x) / math.dist(a, b) for x, y in zip(a, b)]), 1.0)
        return add("EDGE_CURVE", first, last, add("LINE", add("CARTESIAN_POINT", a), vector), ".T.")

    def face(edges, *plane):
        loop = add("EDGE_LOOP", [add("ORIENTED_EDGE", "*", "*", one, sense) for one, sense in edges])
        return add("ADVANCED_FACE", [add("FACE_BOUND", loop, ".T.")], add("PLANE", axes(*plane)), ".T.")

    places = [[(math.cos(w), math.sin(w), z) for w in (2 * math.pi * k / n for k in range(n))] for z in (0.0, height)]
    corner = [[(p, add("VERTEX_POINT", add("CARTESIAN_POINT", p))) for p in ring] for ring in places]
    low, high = ([edge(ring[k - 1], ring[k]) for k in range(n)] for ring in corner)
    up = [edge(corner[0][k], corner[1][k]) for k in range(n)]
    faces = [face([(one, ".F.") for one in reversed(low)], (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)),
             face([(one, ".T.") for one in high], (0.0, 0.0, height), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))]
    for k in range(n):
        w = 2 * math.pi * (k - 0.5) / n
        faces.append(face([(low[k], ".T."), (up[k], ".T."), (high[k], ".F."), (up[k - 1], ".F.")], places[0][k], (math.cos(w), math.sin(w), 0.0), (0.0, 0.0, 1.0)))
    solid = add("MANIFOLD_SOLID_BREP", add("CLOSED_SHELL", faces))
    head, own, rest = entities(CUBE.read_text())
    own = own[:own.index("#15 =")].replace("(#11,#15)", f"(#11,{solid})") + "\n".join(lines) + "\n" + own[own.index("#345 ="):]
    pathlib.Path(name).write_text(head + own + rest)
    return name


def test_a_face_may_have_very_many_edges():
    """From 300 on OpenCASCADE triangulates in another way: its usual one takes a minute and a gigabyte for a plate with 900 holes."""
    report = run("pamr-mesh", prism("prism.step", 6, 0.5), "-o", "prism.hdf", "--size", "0.5", "--json", "-", serial=True).json
    volume = 1.5 * math.sin(math.pi / 3)
    assert abs(report["body_volume"] / volume - 1) < 1e-9 and abs(report["volume"] / volume - 1) < 1e-9, report
    refuses("pamr-mesh", prism("prism.step", 400, 0.5), "-o", "none.hdf", "--solid", "other", says=['found "other"'], creates="none.hdf")


def box_lines(sides, low, first=10000):
    """The lines of a box with numbers from `first` on: the cube without its curves in parameters, stretched and moved."""
    text = re.sub(r"\n\s+", "", entities(CUBE.read_text())[1])
    line = dict(re.findall(r"(#\d+) = SURFACE_CURVE\('',(#\d+),", text))
    text = re.sub(r"(EDGE_CURVE\('',#\d+,#\d+,)(#\d+)", lambda m: m[1] + line[m[2]], text)
    text = re.sub(r"#\d+ = (SURFACE_CURVE|PCURVE|DEFINITIONAL_REPRESENTATION)\([^;]*;\n?", "", text)
    text = re.sub(r"(#\d+ = CARTESIAN_POINT\('',\()([^,()]+,[^,()]+,[^,()]+)", lambda m: m[0] if m[1].startswith("#12 ") else m[1] + ",".join(
        repr(float(x) * side + start) for x, side, start in zip(m[2].split(","), sides, low)), text)  # 12: where all is put
    return re.sub(r"#(\d+)", lambda m: f"#{int(m[1]) + first}", text)


def second_cube(low, side=1):
    return box_lines((side,) * 3, low)


def test_only_what_solids_refer_to_may_refuse_a_step_file():
    color = "#90003=COLOUR_RGB('',1.,0.,0.);"
    for name, lines in (("marker", ["#90001=POINT_STYLE('',#90002,POSITIVE_LENGTH_MEASURE(3.),#90003);",
                                    "#90002=PRE_DEFINED_POINT_MARKER_SYMBOL('plus');", color]),
                        ("curve", ["#90001=CURVE_STYLE('',$,POSITIVE_LENGTH_MEASURE(0.02),#90003);", color]),
                        ("dangling", ["#90001=CURVE_STYLE('',#99999,POSITIVE_LENGTH_MEASURE(0.02),#90003);", color]),
                        ("note", ["#90001=DRAUGHTING_CALLOUT('',(#90002));", "#90002=ANNOTATION_TEXT_OCCURRENCE('',(),#90003);",
                                  "#90003=TEXT_LITERAL('a',#90004,'left',.LEFT.,#90005);"])):
        report = run("pamr-mesh", step(f"{name}.step", *lines), "-o", "cube.hdf", "--size", "1", "--force", "--json", "-", serial=True).json
        assert abs(report["volume"] - 1) < 1e-12 and abs(report["body_volume"] - 1) < 1e-9, name
    sound = CUBE.read_text()
    for name, old, new in (("vertex", "#22 = VERTEX_POINT('',#23)", "#22 = VERTEX_POINT('',#99999)"),
                           ("face", "#17 = ADVANCED_FACE('',(#18),#32,.F.)", "#17 = ADVANCED_FACE('',(#18),#23,.F.)")):
        assert old in sound
        pathlib.Path(f"{name}.step").write_text(sound.replace(old, new))
        refuses("pamr-mesh", f"{name}.step", "-o", "a.hdf", "--size", "1", says=[f"{name}.step", "STEP text"], creates="a.hdf")


def regions_and_faces_inside(mesh):
    """Volume of each region by its name, and the nodes of the faces of each patch inside as an array (faces, 3, 3)."""
    with h5py.File(mesh) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        region, word = file["VTKHDF/CellData/region"][:], file["VTKHDF/CellData/inner_patch"][:]
        names = dict(zip(file["PAMR/regions/numbers"][:], (name.decode() for name in file["PAMR/regions/names"][:])))
        patches = [name.decode() for name in file["PAMR/patches/names"][:]]
    p = points[cells]
    volume = np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    faces = {}
    for slot in range(4):
        patch = (word >> 16 * slot & 0xffff) - 1
        corners = p[:, [k for k in range(4) if k != slot]]
        for number in np.unique(patch[patch >= 0]):
            faces.setdefault(patches[number], []).append(corners[patch == number])
    return {name: volume[region == number].sum() for number, name in names.items()}, {name: np.concatenate(f) for name, f in faces.items()}


def test_solids_of_an_assembly_are_regions_with_patches_between_them():
    shutil.copy(ASSEMBLY, "assembly.step")
    report = run("pamr-mesh", "assembly.step", "-o", "many.hdf", "--size", "0.9", "--json", "-").json
    if RANKS > 1:
        run("pamr-mesh", "assembly.step", "-o", "one.hdf", "--size", "0.9", serial=True)
        assert same_bytes("many.hdf", "one.hdf")
    assert sorted(report["patches"]) == ["color_00ff00", *(f"face_{n}" for n in range(1, 7)), "housing_ball", "housing_peg_1", "tip"], report
    assert [report["regions"][name]["number"] for name in ("housing", "ball", "peg_1", "peg_2")] == [1, 2, 3, 4]
    ball = np.pi / 6
    for name, exact in (("housing", 8 - ball), ("ball", ball), ("peg_1", 1), ("peg_2", 1)):
        assert abs(report["regions"][name]["body_volume"] / exact - 1) < 1e-3, report["regions"]
    errors = []
    last = 2 if FULL else 1
    for level in range(last + 1):
        volumes, faces = regions_and_faces_inside("many.hdf")
        assert sorted(volumes) == ["ball", "housing", "peg_1", "peg_2"] and sorted(faces) == ["housing_ball", "housing_peg_1"]
        assert abs(volumes["peg_1"] - 1) < 1e-12 and abs(volumes["peg_2"] - 1) < 1e-12 and abs(volumes["housing"] + volumes["ball"] - 8) < 1e-12
        errors.append(1 - volumes["ball"] / ball)
        assert np.abs(np.linalg.norm(faces["housing_ball"] - 1, axis=2) - .5).max() < 1e-13
        flat = faces["housing_peg_1"]
        areas = np.linalg.norm(np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]), axis=1) / 2
        assert (flat[:, :, 0] == 2).all() and abs(areas.sum() / 2 - 1) < 1e-12  # seen from both sides
        if level == 0:
            assert np.isclose(volumes["ball"], report["regions"]["ball"]["volume"], rtol=1e-12)
            assert len(faces["housing_ball"]) == 2 * report["patches"]["housing_ball"]["faces"]
        if level < last:
            assert refine("many.hdf", "many.hdf")["off_surface_nodes"] == 0
    assert all(3.6 < coarse / fine < 4.4 for coarse, fine in zip(errors, errors[1:])), errors


def test_solids_are_chosen_by_name():
    shutil.copy(ASSEMBLY, "assembly.step")
    report = run("pamr-mesh", "assembly.step", "-o", "pegs.hdf", "--size", "1", "--solid", "peg", "--json", "-", serial=True).json
    assert sorted(report["regions"]) == ["peg_1", "peg_2"] and abs(report["volume"] - 2) < 1e-12
    report = run("pamr-mesh", "assembly.step", "-o", "peg.hdf", "--size", "1", "--solid", "peg_1", "--json", "-", serial=True).json
    assert report["regions"] == {} and abs(report["volume"] - 1) < 1e-12
    refuses("pamr-mesh", "assembly.step", "-o", "a.hdf", "--solid", "wheel", says=["(housing, ball, peg_1, peg_2), found \"wheel\""])
    refuses("pamr-mesh", "--shape", "kuhn-cube", "--n", "2", "-o", "a.hdf", "--solid", "peg", says=["--solid with a STEP"])


def test_solids_that_touch_or_lie_in_others_are_regions_and_overlaps_are_named():
    for name, low, side, inside in (("beside", (1, 0, 0), 1, 0), ("corner", (1, 1, 1), 1, 0), ("part", (1, .25, .25), .5, 0),
                                    ("inside", (.25, .25, .25), .5, 1), ("flush", (.5, .25, .25), .5, 1), ("clear", (2, 0, 0), 1, 0)):
        report = run("pamr-mesh", step(f"{name}.step", second_cube(low, side)), "-o", f"{name}.hdf", "--size", str(side / 2 if side < 1 else 1), "--json", "-", serial=True).json
        regions = report["regions"]
        assert abs(regions["solid_1"]["volume"] - (1 - inside * side ** 3)) < 1e-12 and abs(regions["solid_2"]["volume"] - side ** 3) < 1e-12, (name, regions)
        assert ("solid_1_solid_2" in report["patches"]) == (name not in ("corner", "clear")), (name, report["patches"])
        quality = run("pamr-quality", f"{name}.hdf", "--json", "-", serial=True).json
        assert quality["valid"] and {key: region["volume"] for key, region in quality["regions"].items()} == {
            key: region["volume"] for key, region in regions.items()}, (quality["regions"], regions)
    refuses("pamr-mesh", step("edge.step", second_cube((1, 1, 0))), "-o", "a.hdf", creates="a.hdf", says=["touch along an edge alone at [1, 1, 0.5]"])
    overlap = step("overlap.step", second_cube((.5, .25, .25)))
    refuses("pamr-mesh", overlap, "-o", "a.hdf", creates="a.hdf", says=["\"solid_1\" and \"solid_2\" overlap at [0.75, 0.625, 0.625]", "--solid"])
    assert abs(run("pamr-mesh", overlap, "-o", "a.hdf", "--solid", "solid_2", "--size", "1", "--json", "-", serial=True).json["volume"] - 1) < 1e-12
    pathlib.Path("case.toml").write_text(FAR_BOX.replace("can.step", "beside.step").replace("faces = [1, 3]", "").split("[[surface]]\nname = \"top\"")[0]
                                         .replace("near = { top = 0.3 }", "").replace("+side & +x0 & -x1 & +y0 & -y1 & +z0 & -z1", "-side"))
    refuses("pamr-mesh", "case.toml", "-o", "b.hdf", creates="b.hdf", says=["1 (its middle at [0.5, 0.5, 0.5]) touches or overlaps", "makes a region of each"])


def test_faces_beside_several_solids_are_named_and_shells_alone_too():
    lines = shell_of_one_face(second_cube((2, 0, 0)))
    refuses("pamr-mesh", step("three.step", lines, box_lines((1, 1, 1), (4, 0, 0), 20000)), "-o", "a.hdf", creates="a.hdf",
            says=["found 2 solids, and 1 face that belongs to none, at [2, 0.5, 0.5]", "a shell without a solid"])
    pathlib.Path("shell.step").write_text(CUBE.read_text().replace("MANIFOLD_SOLID_BREP('',#16)", "SHELL_BASED_SURFACE_MODEL('',(#16))"))
    refuses("pamr-mesh", "shell.step", "-o", "a.hdf", "--solid", "solid_1", creates="a.hdf", says=["expected solids, found none", "shells"])


def shell_of_one_face(lines):
    """The lines of a box with one face of it as a shell, in place of the solid."""
    lines = re.sub(r"MANIFOLD_SOLID_BREP\('',#10016\)", "SHELL_BASED_SURFACE_MODEL('',(#10016))", lines)
    lines = re.sub(r"#10016 = CLOSED_SHELL\('',\((#\d+),[^;]*;", r"#10016 = OPEN_SHELL('',(\1));", lines)
    kept = re.search(r"#10016 = OPEN_SHELL\('',\((#\d+)\)\)", lines)[1]
    lines = re.sub(r"(#\d+) = ADVANCED_FACE\([^;]*;\n", lambda m: m[0] if m[1] == kept else "", lines)
    return lines.replace("ADVANCED_BREP_SHAPE_REPRESENTATION", "MANIFOLD_SURFACE_SHAPE_REPRESENTATION")


def test_a_face_beside_a_solid_is_named():
    refuses("pamr-mesh", step("face.step", shell_of_one_face(second_cube((2, 0, 0)))), "-o", "a.hdf", creates="a.hdf",
            says=["found 1 solid, and 1 face that belongs to none, at [2, 0.5, 0.5] (face 7)"])


def test_default_sizes_are_bound_by_thickness_and_longer_ones_are_warned_of():
    head, _, rest = entities(CUBE.read_text())
    pathlib.Path("plate.step").write_text(head + box_lines((1.2, 1.2, .25), (0, 0, 0)) + rest)
    out = run("pamr-mesh", "plate.step", "-o", "plate.hdf", "--json", "plate.json", serial=True)
    report = json.loads(pathlib.Path("plate.json").read_text())
    assert abs(report["volume"] - 0.36) < 1e-12 and "warning" not in out.err and "of the body's 0.36 (+0.0 %)" in out.out, out.err + out.out
    pathlib.Path("small.step").write_text(head + box_lines((1, 1, .25), (0, 0, 0)) + rest)
    warned = run("pamr-mesh", "small.step", "-o", "long.hdf", "--size", "0.5", serial=True)
    assert "the body is 0.25 thick near [" in warned.err.lower() and "--size 0.25 or less" in warned.err, warned.err


def open_cube():
    """The cube without its first face."""
    text = pathlib.Path("cube.step").read_text()
    shell = re.search(r"CLOSED_SHELL\([^;]*;", text)[0]
    first = re.search(r"\((#\d+),", shell)[1]
    text = text.replace(shell, shell.replace(first + ",", "", 1))
    text = re.sub(re.escape(first) + r" *= *ADVANCED_FACE\([^;]*;\n", "", text)
    pathlib.Path("open.step").write_text(text)
    return "open.step"


@of_full_level
def test_another_size_is_taken_and_told_where_cgal_fails():
    out = run("pamr-mesh", DATA / "chamfer_box.brep", "-o", "box.hdf")
    assert "all sizes were multiplied by" in out.err and "CGAL's mesher failed" in out.err, out.err
    assert run("pamr-quality", "box.hdf", "--json", "-").json["valid"]


run_tests(globals())
