# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that are not Gmsh's of a body of OpenCASCADE: by netgen, of STL files, and cell by cell."""
import contextlib
import importlib.util
import math
import os
import pathlib
import sys

import gmsh
import numpy as np

from given_mesh import Given
from shapes import Made
from walls import BallOfTriangles, Cone, Cylinder, Sphere

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/tools"))
from surface_models import icosphere, write_stl  # noqa: E402

MAKERS = {}  # of a name: makes its mesh in the file of this path and returns what is true of it


def maker(function):
    MAKERS[function.__name__] = function
    return function


@maker
def fan_around_an_edge(path):
    """200 cells round one edge, which is the axis of two cones that share their base."""
    n = 200
    angle = 2 * math.pi * np.arange(n) / n
    points = np.vstack([[0, 0, 0], [0, 0, 1], np.stack([np.cos(angle), np.sin(angle), np.full(n, 0.5)], axis=1)])
    here, there = 2 + np.arange(n), 2 + (np.arange(n) + 1) % n
    low, high = np.zeros(n, int), np.ones(n, int)
    half_angle = math.degrees(math.atan(2))
    return Given(Made({"low": Cone((0, 0, 0), (0, 0, 1), half_angle), "high": Cone((0, 0, 1), (0, 0, -1), half_angle)}), points,
                 np.stack([low, high, here, there], axis=1),
                 {"low": np.stack([low, here, there], axis=1), "high": np.stack([high, here, there], axis=1)},
                 math.pi / 3, {"low": math.pi * math.sqrt(1.25), "high": math.pi * math.sqrt(1.25)}).write(path)


def arrays_of_gmsh(name_of):
    """Points, cells and patches of Gmsh's mesh; a surface belongs to the patch that `name_of` gives for its tag."""
    tags, points, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, int)
    place[tags.astype(int)] = np.arange(len(tags))
    def elements(dimension, kind, n, tag=-1):
        return place[gmsh.model.mesh.getElementsByType(kind, tag)[1].astype(int)].reshape(-1, n)
    patches = {}
    for _, tag in gmsh.model.getEntities(2):
        patches.setdefault(name_of(tag), []).append(elements(2, 2, 3, tag))
    return points.reshape(-1, 3), elements(3, 4, 4), {name: np.concatenate(parts) for name, parts in patches.items()}


@maker
def offset_of_a_billion(path):
    """A ball in a box a billion radii from the origin: coordinates have seven digits left."""
    gmsh.clear()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
    gmsh.model.occ.cut([(3, gmsh.model.occ.addBox(-2, -2, -2, 4, 4, 4))], [(3, gmsh.model.occ.addSphere(0, 0, 0, 1))])
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    points, cells, patches = arrays_of_gmsh(lambda tag: "ball" if gmsh.model.getType(2, tag) == "Sphere" else f"flat_{tag}")
    center = (1e9, -2e9, 3e9)
    return Given(Made({"ball": Sphere(center, 1)}), points + center, cells, patches, 64 - 4 * math.pi / 3,
                 {"ball": 4 * math.pi}).write(path)


def box_of_triangles(half):
    """As icosphere: the corners of a cube and its 12 triangles, seen counter-clockwise from outside."""
    points = np.array([(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


@maker
def two_files_of_triangles(path):
    """A box and a ball from an STL file each, merged; the truth is the ball through the corners."""
    folder = pathlib.Path(path).parent
    points, triangles = icosphere(3)
    write_stl(str(folder / "ball.stl"), points, triangles)
    write_stl(str(folder / "box.stl"), *box_of_triangles(2.0))
    gmsh.clear()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.6)
    for name in ("box.stl", "ball.stl"):
        gmsh.merge(str(folder / name))
    gmsh.model.mesh.removeDuplicateNodes()
    gmsh.model.mesh.classifySurfaces(math.radians(40), True, True, math.pi)
    gmsh.model.mesh.createGeometry()
    surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
    is_ball = {tag: np.abs(gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)[1]).max() < 1.5 for tag in surfaces}
    loops = [gmsh.model.geo.addSurfaceLoop([tag for tag in surfaces if is_ball[tag] == wanted]) for wanted in (False, True)]
    gmsh.model.geo.addVolume(loops)
    gmsh.model.geo.synchronize()
    gmsh.model.mesh.generate(3)
    points_of_mesh, cells, patches = arrays_of_gmsh(lambda tag: "ball" if is_ball[tag] else f"flat_{tag}")
    wall = BallOfTriangles("../ball.stl", points[np.array(triangles)])
    return Given(Made({"ball": wall}), points_of_mesh, cells, patches, 64 - wall.volume(), {"ball": wall.area()}).write(path)


@contextlib.contextmanager
def silence():
    """Without what a library in C++ prints."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def mesh_by_netgen(solid, size):
    from netgen.csg import CSGeometry
    with silence():
        geometry = CSGeometry()
        geometry.Add(solid)
        mesh = geometry.GenerateMesh(maxh=size)
    return mesh


def arrays_of_netgen(mesh):
    """Points, cells and patches; each face of the solid is a patch, flat_N where its nodes lie in a plane."""
    points = np.array([p.p for p in mesh.Points()])
    cells = np.array([[v.nr - 1 for v in cell.vertices] for cell in mesh.Elements3D()])
    faces = {}
    for triangle in mesh.Elements2D():
        faces.setdefault(triangle.index, []).append([v.nr - 1 for v in triangle.vertices])
    patches = {}
    for index, triangles in sorted(faces.items()):
        around = points[np.unique(triangles)]
        is_flat = np.linalg.svd(around - around.mean(axis=0))[1][2] < 1e-9
        patches.setdefault(f"flat_{index}" if is_flat else mesh.GetBCName(index - 1), []).extend(triangles)
    return points, cells, {name: np.array(triangles) for name, triangles in patches.items()}


def ball_of_netgen():
    from netgen.csg import OrthoBrick, Pnt, Sphere as Ball
    return mesh_by_netgen(OrthoBrick(Pnt(-2, -2, -2), Pnt(2, 2, 2)) - Ball(Pnt(0, 0, 0), 1).bc("ball"), 0.7)


def netgen_ball_in_a_box(path):
    return Given(Made({"ball": Sphere((0, 0, 0), 1)}), *arrays_of_netgen(ball_of_netgen()), 64 - 4 * math.pi / 3,
                 {"ball": 4 * math.pi}).write(path)


def netgen_pipe_in_the_ground(path):
    """Half a pipe in the ground, from one end of the room to the other."""
    from netgen.csg import Cylinder as Pipe, OrthoBrick, Pnt
    mesh = mesh_by_netgen(OrthoBrick(Pnt(-2, -2, 0), Pnt(2, 2, 2)) - Pipe(Pnt(-3, 0, 0), Pnt(3, 0, 0), 1).bc("pipe"), 0.7)
    return Given(Made({"pipe": Cylinder((0, 0, 0), (1, 0, 0), 1)}), *arrays_of_netgen(mesh), 32 - 2 * math.pi,
                 {"pipe": 4 * math.pi}).write(path)


def netgen_frustum_in_a_box(path):
    from netgen.csg import Cone as Horn, OrthoBrick, Plane, Pnt, Vec
    horn = (Horn(Pnt(0, 0, -1), Pnt(0, 0, 1), 1, 0.5).bc("cone") * Plane(Pnt(0, 0, 1), Vec(0, 0, 1))
            * Plane(Pnt(0, 0, -1), Vec(0, 0, -1)))
    mesh = mesh_by_netgen(OrthoBrick(Pnt(-2, -2, -2), Pnt(2, 2, 2)) - horn, 0.7)
    return Given(Made({"cone": Cone((0, 0, 3), (0, 0, -1), math.degrees(math.atan(0.25)))}), *arrays_of_netgen(mesh),
                 64 - 2 * math.pi / 3 * (1 + 0.5 + 0.25), {"cone": 1.5 * math.pi * math.hypot(2, 0.5)}).write(path)


def netgen_file_of_six_digits(path):
    """As netgen itself writes Gmsh's format: numbers for patches, coordinates with six digits after the point."""
    mesh = ball_of_netgen()
    points, cells, patches = arrays_of_netgen(mesh)
    with silence():
        mesh.Export(str(path), "Gmsh2 Format")
    numbers = {name: f"physical_{'7' if name == 'ball' else name.removeprefix('flat_')}" for name in patches}
    return Given(Made({numbers["ball"]: Sphere((0, 0, 0), 1)}), points, cells, {numbers[name]: t for name, t in patches.items()},
                 64 - 4 * math.pi / 3, {}, flat=[numbers[name] for name in patches if name != "ball"])


if importlib.util.find_spec("netgen"):  # Debian: python3-netgen
    for function in (netgen_ball_in_a_box, netgen_pipe_in_the_ground, netgen_frustum_in_a_box, netgen_file_of_six_digits):
        maker(function)
