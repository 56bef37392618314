# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies and domains that nobody of PAMR designed meshes for, made by Gmsh with OpenCASCADE.

Each shape is a function of Gmsh's OpenCASCADE factory. It makes the domain and returns its curved walls by name; what else is
flat or free of a description is named by the kind that OpenCASCADE gives it. Refined is what lies at the walls whose
names begin with `at`, or at all that is not flat.
"""
import dataclasses
import math

import gmsh

from walls import Cone, Cylinder, Ellipsoid, Sphere, Torus

SHAPES = {}


@dataclasses.dataclass
class Made:
    walls: dict = dataclasses.field(default_factory=dict)
    at: str = ""  # the wall at which it is refined; else all that are not flat, or the first patch
    options: dict = dataclasses.field(default_factory=dict)  # of Gmsh
    keep_volumes: bool = False  # several volumes, each a physical group
    inner_patch: str = ""  # name of the physical surface of the faces between volumes
    periodic: tuple = ()  # axes whose sides are linked
    refused: bool = False  # pamr-convert must refuse it, and say this
    says: str = ""  # what pamr-convert must say of the mesh
    factor: float = 1  # by which Gmsh multiplies what it writes; walls are as written


def shape(size):
    """Mesh size far from walls; a wall has 12 elements a turn."""
    def add(function):
        SHAPES[function.__name__] = (function, size)
        return function
    return add


def cut(occ, whole, *tools):
    return occ.cut([(3, whole)], [(3, tool) for tool in tools])[0]


@shape(0.7)
def half_ball(occ):
    """A symmetry plane through the body."""
    cut(occ, occ.addBox(-2, -2, 0, 4, 4, 2), occ.addSphere(0, 0, 0, 1))
    return Made({"ball": Sphere((0, 0, 0), 1)})


@shape(0.5)
def eighth_of_a_shell(occ):
    """Three symmetry planes, two concentric spheres."""
    occ.intersect(cut(occ, occ.addSphere(0, 0, 0, 2), occ.addSphere(0, 0, 0, 1)), [(3, occ.addBox(0, 0, 0, 3, 3, 3))])
    return Made({"outer": Sphere((0, 0, 0), 2), "inner": Sphere((0, 0, 0), 1)})


@shape(0.8)
def ball_in_the_ground(occ):
    cut(occ, occ.addBox(-2, -2, 0, 4, 4, 3), occ.addSphere(0.1, 0.2, 0.6, 1))
    return Made({"ball": Sphere((0.1, 0.2, 0.6), 1)})


@shape(0.8)
def cusp_under_a_ball(occ):
    """A ball sunk by 2 % of its radius: it meets the ground at 11 degrees."""
    cut(occ, occ.addBox(-2, -2, 0, 4, 4, 3), occ.addSphere(0, 0, 0.98, 1))
    return Made({"ball": Sphere((0, 0, 0.98), 1)})


@shape(0.8)
def gap_under_a_ball(occ):
    cut(occ, occ.addBox(-2, -2, 0, 4, 4, 3), occ.addSphere(0, 0, 1.05, 1))
    return Made({"ball": Sphere((0, 0, 1.05), 1)})


@shape(0.9)
def gap_between_balls(occ):
    cut(occ, occ.addBox(-3, -2, -2, 6, 4, 4), occ.addSphere(-1.025, 0, 0, 1), occ.addSphere(1.025, 0, 0, 1))
    return Made({"left": Sphere((-1.025, 0, 0), 1), "right": Sphere((1.025, 0, 0), 1)})


@shape(0.9)
def two_bodies_in_the_ground(occ):
    cut(occ, occ.addBox(-3, -2, 0, 6, 4, 3), occ.addSphere(-1.2, 0, 0.3, 1), occ.addCylinder(1.2, 0, -1, 0, 0, 2.2, 0.8))
    return Made({"ball": Sphere((-1.2, 0, 0.3), 1), "pillar": Cylinder((1.2, 0, 0), (0, 0, 1), 0.8)})


@shape(0.7)
def ring_in_a_box(occ):
    cut(occ, occ.addBox(-2, -2, -1, 4, 4, 2), occ.addTorus(0, 0, 0, 1, 0.4))
    return Made({"ring": Torus((0, 0, 0), (0, 0, 1), 1, 0.4)})


@shape(0.4)
def solid_ring(occ):
    occ.addTorus(1, 2, 3, 2, 0.5)
    return Made({"ring": Torus((1, 2, 3), (0, 0, 1), 2, 0.5)})


@shape(0.4)
def solid_ball(occ):
    occ.addSphere(0, 0, 0, 1)
    return Made({"ball": Sphere((0, 0, 0), 1)})


@shape(0.35)
def thin_shell(occ):
    """A wall of a tenth of the radius."""
    cut(occ, occ.addSphere(0, 0, 0, 1), occ.addSphere(0, 0, 0, 0.9))
    return Made({"outer": Sphere((0, 0, 0), 1), "inner": Sphere((0, 0, 0), 0.9)})


@shape(0.4)
def cone_with_apex(occ):
    occ.addCone(0, 0, 0, 0, 0, 2, 0.8, 0)
    return Made({"cone": Cone((0, 0, 2), (0, 0, -1), math.degrees(math.atan(0.4)))})


@shape(0.7)
def frustum_in_a_box(occ):
    cut(occ, occ.addBox(-2, -2, -1, 4, 4, 4), occ.addCone(0, 0, 0, 0, 0, 1.5, 0.9, 0.3))
    return Made({"cone": Cone((0, 0, 2.25), (0, 0, -1), math.degrees(math.atan(0.4)))})


@shape(0.6)
def bore_through_a_box(occ):
    cut(occ, occ.addBox(-1, -1, -1, 2, 2, 2), occ.addCylinder(0, 0, -2, 0, 0, 4, 0.5))
    return Made({"bore": Cylinder((0, 0, 0), (0, 0, 1), 0.5)})


@shape(0.35)
def crossing_pipes(occ):
    """Two cylinders meet along a curve of fourth degree."""
    occ.fuse([(3, occ.addCylinder(-2, 0, 0, 4, 0, 0, 0.7))], [(3, occ.addCylinder(0, 0, 0, 0, 0, 2, 0.5))])
    return Made({"pipe": Cylinder((0, 0, 0), (1, 0, 0), 0.7), "branch": Cylinder((0, 0, 0), (0, 0, 1), 0.5)})


@shape(0.35)
def ball_with_a_bore(occ):
    cut(occ, occ.addSphere(0, 0, 0, 1), occ.addCylinder(0.2, 0, -2, 0, 0, 4, 0.4))
    return Made({"ball": Sphere((0, 0, 0), 1), "bore": Cylinder((0.2, 0, 0), (0, 0, 1), 0.4)})


@shape(0.35)
def capsule(occ):
    """A cylinder joins two spheres without an edge."""
    ends = [(3, occ.addSphere(0, 0, z, 0.5)) for z in (-1, 1)]
    occ.fuse([(3, occ.addCylinder(0, 0, -1, 0, 0, 2, 0.5))], ends)
    return Made({"side": Cylinder((0, 0, 0), (0, 0, 1), 0.5), "top": Sphere((0, 0, 1), 0.5), "bottom": Sphere((0, 0, -1), 0.5)})


@shape(0.8)
def ellipsoid_in_a_box(occ):
    ball = occ.addSphere(0, 0, 0, 1)
    occ.dilate([(3, ball)], 0, 0, 0, 1.5, 1, 0.6)
    cut(occ, occ.addBox(-3, -2, -2, 6, 4, 4), ball)
    return Made({"egg": Ellipsoid((1.5, 1, 0.6))})


@shape(0.5)
def sharp_wedge(occ):
    """Ten degrees."""
    occ.extrude([(2, occ.addPlaneSurface([occ.addWire(_loop(occ, [(0, 0, 0), (2, 0, 0), (2, 2 * math.tan(math.radians(10)), 0)]))]))],
                0, 0, 1)
    return Made()


def _loop(occ, points):
    tags = [occ.addPoint(*p) for p in points]
    return [occ.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1])]


@shape(0.6)
def l_shaped_room(occ):
    cut(occ, occ.addBox(0, 0, 0, 2, 2, 1), occ.addBox(1, 1, -1, 2, 2, 3))
    return Made()


@shape(0.3)
def thin_plate(occ):
    """A hundredth as thick as wide: cells as flat as Gmsh makes them."""
    occ.addBox(0, 0, 0, 2, 2, 0.02)
    return Made()


@shape(0.4)
def rounded_box(occ):
    """Fillets: quarter cylinders and eighths of spheres that nobody describes."""
    box = occ.addBox(0, 0, 0, 2, 2, 1)
    occ.synchronize()
    occ.fillet([box], [tag for _, tag in gmsh.model.getEntities(1)], [0.3])
    return Made()


@shape(0.3)
def vase(occ):
    """A spline turned about an axis."""
    spline = occ.addBSpline([occ.addPoint(x, 0, z) for x, z in ((0.6, 0), (1, 0.5), (0.4, 1.2), (0.5, 1.6), (0.8, 2))])
    ends = occ.addPoint(0, 0, 0), occ.addPoint(0, 0, 2)
    occ.synchronize()
    first, last = (tag for _, tag in gmsh.model.getBoundary([(1, spline)], oriented=False))
    lines = [occ.addLine(ends[0], first), spline, occ.addLine(last, ends[1]), occ.addLine(ends[1], ends[0])]
    occ.revolve([(2, occ.addPlaneSurface([occ.addCurveLoop(lines)]))], 0, 0, 0, 0, 0, 1, 2 * math.pi)
    return Made()


@shape(0.25)
def elbow(occ):
    """A quarter of a ring, its ends flat."""
    disk = occ.addDisk(1.5, 0, 0, 0.4, 0.4)
    occ.rotate([(2, disk)], 1.5, 0, 0, 1, 0, 0, math.pi / 2)
    occ.revolve([(2, disk)], 0, 0, 0, 0, 0, 1, math.pi / 2)
    return Made({"pipe": Torus((0, 0, 0), (0, 0, 1), 1.5, 0.4)})


@shape(0.7)
def two_rooms(occ):
    """Two components that do not touch, a ball in each."""
    for x in (0, 10):
        cut(occ, occ.addBox(x - 2, -2, -2, 4, 4, 4), occ.addSphere(x, 0, 0, 1))
    return Made({"near": Sphere((0, 0, 0), 1), "far": Sphere((10, 0, 0), 1)})


@shape(0.7)
def ball_of_another_matter(occ):
    """Two volumes: the face between them is no boundary."""
    occ.fragment([(3, occ.addBox(-2, -2, -2, 4, 4, 4))], [(3, occ.addSphere(0, 0, 0, 1))])
    return Made(keep_volumes=True)


@shape(0.7)
def unimproved_slivers(occ):
    """As the Delaunay triangulation leaves it."""
    cut(occ, occ.addBox(-2, -2, -2, 4, 4, 4), occ.addSphere(0, 0, 0, 1))
    return Made({"ball": Sphere((0, 0, 0), 1)}, options={"Mesh.Optimize": 0, "Mesh.OptimizeThreshold": 0})


@shape(0.7)
def another_mesher(occ):
    """Gmsh's parallel Delaunay (HXT), and other triangles on the walls."""
    cut(occ, occ.addBox(-2, -2, -2, 4, 4, 4), occ.addSphere(0, 0, 0, 1))
    return Made({"ball": Sphere((0, 0, 0), 1)}, options={"Mesh.Algorithm3D": 10, "Mesh.Algorithm": 6})


def _ball_in_a_box(occ, center=(0, 0, 0), factor=1):
    x, y, z = center
    cut(occ, occ.addBox(x - 2, y - 2, z - 2, 4, 4, 4), occ.addSphere(x, y, z, 1))
    return Made({"ball": Sphere(tuple(factor * c for c in center), factor)}, factor=factor)


@shape(0.7)
def far_from_the_origin(occ):
    """A million radii away: coordinates have ten digits left."""
    return _ball_in_a_box(occ, center=(1e6, -2e6, 3e6))


@shape(0.7)
def as_small_as_molecules(occ):
    return _ball_in_a_box(occ, factor=1e-9)


@shape(0.7)
def as_large_as_stars(occ):
    return _ball_in_a_box(occ, factor=1e9)


@shape(0.7)
def inner_patch(occ):
    """Two volumes, and the face between them is a physical surface, too, as solvers with interfaces want it."""
    made = ball_of_another_matter(occ)
    return dataclasses.replace(made, inner_patch="interface")


@shape(0.7)
def wall_between_two_rooms(occ):
    """Two boxes share a face, which is a physical surface; a ball hangs in one of them."""
    rooms = cut(occ, occ.addBox(-2, -2, -2, 4, 4, 4), occ.addSphere(0, 0, 0, 1))
    occ.fragment(rooms, [(3, occ.addBox(2, -2, -2, 2, 4, 4))])
    return Made({"ball": Sphere((0, 0, 0), 1)}, keep_volumes=True, inner_patch="door")


@shape(0.7)
def periodic_in_two_directions(occ):
    """A ball in the unit of a lattice."""
    return dataclasses.replace(_ball_in_a_box(occ), periodic=(0, 2), says="periodic")


@shape(0.7)
def ball_across_a_periodic_side(occ):
    """Half of it at either side."""
    cut(occ, occ.addBox(-2, -2, -2, 4, 4, 4), occ.addSphere(-2, 0, 0, 1), occ.addSphere(2, 0, 0, 1))
    return Made({"low": Sphere((-2, 0, 0), 1), "high": Sphere((2, 0, 0), 1)}, periodic=(0,), says="periodic")


@shape(0.5)
def rooms_that_touch_at_an_edge(occ):
    """Four faces of the boundary meet in one edge."""
    occ.fragment([(3, occ.addBox(-1, -1, 0, 1, 1, 1))], [(3, occ.addBox(0, 0, 0, 1, 1, 1))])
    return Made(refused=True, says="touches itself in an edge")


@shape(0.5)
def rooms_that_touch_at_a_corner(occ):
    occ.fragment([(3, occ.addBox(-1, -1, -1, 1, 1, 1))], [(3, occ.addBox(0, 0, 0, 1, 1, 1))])
    return Made()


@shape(0.7)
def five_components(occ):
    """Three balls in the void, one in a room, and the room."""
    for center in ((0, 0, 0), (9, 0, 0), (0, 9, 0)):
        occ.addSphere(*center, 1)
    cut(occ, occ.addBox(7, 7, 7, 4, 4, 4), occ.addSphere(9, 9, 9, 1.5))
    occ.addSphere(9, 9, 9, 1)
    return Made({"first": Sphere((0, 0, 0), 1), "second": Sphere((9, 0, 0), 1), "third": Sphere((0, 9, 0), 1),
                 "hollow": Sphere((9, 9, 9), 1.5), "core": Sphere((9, 9, 9), 1)})
