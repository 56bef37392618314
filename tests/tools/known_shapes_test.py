# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches that lie on a sphere, cylinder, cone or torus are found, and what only looks like one is left alone."""
import math
import pathlib
import tomllib

import h5py
import numpy as np

from surface_models import icosphere
from tool_run import of_full_level, of_one_process, refuses, run, run_tests, same_bytes


def star(name, points, triangles, patches=None):
    """A mesh of one cell from the middle of a convex body to each triangle of its boundary."""
    points = np.vstack([points, np.mean(points, axis=0)])
    patches = patches or ["all"] * len(triangles)
    names = sorted(set(patches))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'2 {i + 1} "{n}"' for i, n in enumerate(names)] + ["$EndPhysicalNames", "$Nodes", str(len(points))]
    lines += [f"{i + 1} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points.tolist())]
    lines += ["$EndNodes", "$Elements", str(2 * len(triangles))]
    number = 0
    for (a, b, c), patch in zip(triangles, patches):
        tag = names.index(patch) + 1
        lines += [f"{number + 1} 2 2 {tag} {tag} {a + 1} {b + 1} {c + 1}",
                  f"{number + 2} 4 2 1 1 {a + 1} {c + 1} {b + 1} {len(points)}"]
        number += 2
    pathlib.Path(name).write_text("\n".join(lines + ["$EndElements", ""]))
    return name


def prism(sides, layers, top=1.0):
    """A prism, or a frustum: its nodes lie in layers + 1 circles; patches `side` and `ends`."""
    points, triangles, patches = [], [], []
    for k in range(layers + 1):
        r = 1 + (top - 1) * k / layers
        points += [(r * math.cos(2 * math.pi * i / sides), r * math.sin(2 * math.pi * i / sides), 0.7 * k / layers)
                   for i in range(sides)]
    for k in range(layers):
        for i in range(sides):
            a, b, up = k * sides + i, k * sides + (i + 1) % sides, sides
            triangles += [(a, b, b + up), (a, b + up, a + up)]
            patches += ["side", "side"]
    last = layers * sides
    for i in range(1, sides - 1):
        triangles += [(0, i + 1, i), (last, last + i, last + i + 1)]
        patches += ["ends", "ends"]
    return np.array(points), triangles, patches


def found_in(mesh, **how):
    report = run("pamr-convert", mesh, "out.hdf", "--recognize", "--force", "--quiet", "--json", "-", **how).json
    with h5py.File("out.hdf") as file:
        bound = [name.decode() for name in file["PAMR/patches/surfaces"][:]] if "surfaces" in file["PAMR/patches"] else []
    shapes = report.get("shapes", {})
    bound = [name for name in bound if name and not name.startswith("plane of")]
    assert sorted(name for name, shape in shapes.items() if shape["is_bound"]) == sorted(bound)
    return shapes


@of_one_process
def test_what_is_flat_sided_stays_flat_sided():
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    cube = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    assert found_in(star("cube.msh", corners, cube)) == {}, "its eight corners lie on a sphere"
    assert found_in(star("icosahedron.msh", *icosphere(0))) == {}, "twelve nodes for four unknowns"
    tetrahedron = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float)
    assert found_in(star("tetrahedron.msh", tetrahedron, [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])) == {}
    octahedron = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    eight = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    assert found_in(star("octahedron.msh", octahedron, eight)) == {}
    for sides in (3, 4, 6, 8, 10, 12):
        for layers in (1, 4):
            for top in (1.0, 0.6):
                points, triangles, patches = prism(sides, layers, top)
                shapes = found_in(star("prism.msh", points, triangles, patches), serial=True)
                assert not any(shape["is_bound"] for shape in shapes.values()), (sides, layers, top)
                assert not shapes or (layers == 4 and sides >= 10), (sides, layers, top)
    once = found_in(star("geodesic.msh", *icosphere(1)))
    assert once["all"]["kind"] == "sphere" and not once["all"]["is_bound"], "42 nodes: said, not done"
    for sides in (16, 40):
        points, triangles, patches = prism(sides, 1)
        assert found_in(star("two_circles.msh", points, triangles, patches)) == {}, "a cylinder and a sphere"
        points, triangles, patches = prism(sides, 4)
        assert found_in(star("round.msh", points, triangles, patches))["side"]["is_bound"]


@of_one_process
def test_nodes_that_are_not_exactly_on_it_are_only_suggested():
    points, triangles = icosphere(2)
    whole = found_in(star("ball.msh", points, triangles))["all"]
    assert whole["is_bound"] and tomllib.loads(whole["surface"])["surface"] == [
        {"name": "all", "kind": "sphere", "center": [0, 0, 0], "radius": 1}]
    single = points.astype(np.float32).astype(float)
    shape = found_in(star("single.msh", single, triangles))["all"]
    assert shape["kind"] == "sphere" and not shape["is_bound"] and 1e-8 < shape["worst_distance"] < 1e-7
    far = points + np.array([1e9, -1e9, 1e9])
    assert not any(shape["is_bound"] for shape in found_in(star("far.msh", far, triangles)).values())
    egg = points * [1, 1, 1.001]
    assert found_in(star("egg.msh", egg, triangles)) == {}
    dented = points.copy()
    dented[7] *= 1 - 1e-5
    assert found_in(star("dented.msh", dented, triangles)) == {}
    for scale in (1e-9, 1e9):
        shape = found_in(star("scaled.msh", points * scale, triangles))["all"]
        assert shape["is_bound"]
        assert math.isclose(tomllib.loads(shape["surface"])["surface"][0]["radius"], scale, rel_tol=1e-14)


def refined(mesh, patch, levels):
    for level in range(levels):
        run("pamr-mark", mesh, "-o", "marked.hdf", "--patch", patch, "--force", "--quiet", serial=True)
        mesh = f"level{level + 1}.hdf"
        assert run("pamr-refine", "marked.hdf", "-o", mesh, "--quiet", serial=True).err == ""
    return mesh, run("pamr-quality", mesh, "--json", "-", "--quiet", serial=True).json["patches"][patch]


def points_of(mesh, patch):
    with h5py.File(mesh) as file:
        points, cells = file["VTKHDF/Points"][:], file["VTKHDF/Connectivity"][:].reshape(-1, 4)
        neighbors, names = file["PAMR/cell_to_cell"][:], [name.decode() for name in file["PAMR/patches/names"][:]]
    cell, slot = np.nonzero(neighbors == -(names.index(patch) + 1))
    return points[np.unique([cells[cell, (slot + k) % 4] for k in (1, 2, 3)])]


def distance_from(kind, p, place, axis, radius, tube=0.0):
    if kind == "sphere":
        return np.linalg.norm(p - place, axis=1) - radius
    axis = np.array(axis) / np.linalg.norm(axis)
    along = (p - place) @ axis
    across = np.linalg.norm(p - place - np.outer(along, axis), axis=1)
    if kind == "cylinder":
        return across - radius
    if kind == "cone":
        return across * math.cos(radius) - along * math.sin(radius)
    return np.hypot(across - radius, along) - tube


HALF = math.atan2(0.5, 1)
BODIES = {  # by Gmsh: how it is made, elements for a full turn, and the shape of its first face
    "ball": (lambda f: f.addSphere(1, 2, 3, 0.7), 16, ("sphere", (1, 2, 3), None, 0.7)),
    "cap": (lambda f: f.addSphere(0, 0, 0, 2, angle1=0.7), 30, ("sphere", (0, 0, 0), None, 2)),
    "rod": (lambda f: f.addCylinder(1, 2, 3, 1, 2, 3, 0.8), 16, ("cylinder", (1, 2, 3), (1, 2, 3), 0.8)),
    "slice": (lambda f: f.addCylinder(0, 0, 0, 0, 0, 1, 0.5, angle=1), 24, ("cylinder", (0, 0, 0), (0, 0, 1), 0.5)),
    "cone": (lambda f: f.addCone(0, 0, 0, 0, 0, 1, 1, 0.5), 16, ("cone", (0, 0, 2), (0, 0, -1), HALF)),
    "piece": (lambda f: f.addCone(0, 0, 0, 1, 0, 0, 1, 0.5, angle=1.2), 24, ("cone", (2, 0, 0), (-1, 0, 0), HALF)),
    "ring": (lambda f: f.addTorus(0, 0, 0, 1, 0.4), 14, ("torus", (0, 0, 0), (0, 0, 1), 1, 0.4)),
    "bend": (lambda f: f.addTorus(0, 0, 0, 2, 0.5, angle=0.8), 16, ("torus", (0, 0, 0), (0, 0, 1), 2, 0.5)),
}


def gmsh_body(name, make, per_turn):
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", per_turn)
    body = make(gmsh.model.occ)
    gmsh.model.occ.synchronize()
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    gmsh.model.addPhysicalGroup(3, [body])
    gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, faces[:1]), "shape")
    if faces[1:]:
        gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, faces[1:]), "rest")
    gmsh.model.mesh.generate(3)
    gmsh.write(name)
    gmsh.finalize()


def check_body(name):
    make, per_turn, (kind, place, axis, *sizes) = BODIES[name]
    gmsh_body("body.msh", make, per_turn)
    told = run("pamr-convert", "body.msh", "plain.hdf")
    shapes = found_in("body.msh")
    assert list(shapes) == ["shape"] and shapes["shape"]["kind"] == kind and shapes["shape"]["is_bound"], shapes
    one = pathlib.Path("out.hdf").read_bytes()
    found_in("body.msh", serial=True)
    assert pathlib.Path("out.hdf").read_bytes() == one, "the same on any number of ranks"

    described = tomllib.loads(shapes["shape"]["surface"])["surface"][0]
    keys = {"torus": ("major_radius", "minor_radius"), "cone": ("half_angle",)}.get(kind, ("radius",))
    for key, size in zip(keys, sizes):
        value = math.radians(described[key]) if key == "half_angle" else described[key]
        assert math.isclose(value, size, rel_tol=1e-14), (key, described)
    fine, patch = refined("out.hdf", "shape", 1 if name == "ring" else 3)  # the ring has most cells, the bend is a part of one
    assert patch["off_surface_nodes"] == 0 and patch["surface"] == "shape", patch
    off = abs(distance_from(kind, points_of(fine, "shape"), np.array(place, float), axis, *sizes)).max()
    assert off < 2e-14, off

    lines = told.err.splitlines()
    begin = lines.index("  [[surface]]")
    assert "fits a " + kind in lines[begin - 1] and "--recognize" in lines[begin - 1]
    pathlib.Path("written.toml").write_text("\n".join(line[2:] for line in lines[begin:] if line.startswith("  ")) + "\n")
    run("pamr-convert", "body.msh", "by_hand.hdf", "--surfaces", "written.toml", "--quiet")
    assert same_bytes("by_hand.hdf", "out.hdf"), "the text that is suggested is what --recognize does"


for body in BODIES:
    of_body = lambda body=body: check_body(body)
    globals()[f"test_a_{body}_of_gmsh_is_recognized_and_refined"] = \
        of_body if body in ("ball", "rod", "cone", "ring") else of_full_level(of_body)


def test_recognizing_goes_together_with_surfaces_and_only_with_a_mesh_to_write():
    points, triangles = icosphere(2)
    star("ball.msh", points, triangles)
    refuses("pamr-convert", "ball.msh", "ball.stl", "--recognize", says=["--recognize", "a boundary"], creates="ball.stl")
    pathlib.Path("own.toml").write_text(
        '[[surface]]\nname = "all"\nkind = "quadric"\ncoefficients = [1, 1, 1, 0, 0, 0, 0, 0, 0, -1]\n')
    report = run("pamr-convert", "ball.msh", "own.hdf", "--surfaces", "own.toml", "--recognize", "--json", "-").json
    assert "shapes" not in report and report["ties"]["all"]["surface"] == "all", "what is described is not looked at"


run_tests(globals())
