# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies with curved walls: how each is described to pamr-mesh and to Gmsh, and what is exactly true of it.

A case has `walls` (patch -> surface), the normal field of each curved surface, the exact area of each wall and the exact
volume where they are known, and a mesher: text of a case file of pamr-mesh or a script for Gmsh's kernel with the surfaces
beside it.
"""
import dataclasses
import math
import tomllib

import numpy as np


@dataclasses.dataclass
class Case:
    walls: list                      # curved patches, refined at every level
    case_file: str = ""              # of pamr-mesh, or
    geo: str = ""                    # of Gmsh, with
    surfaces: str = ""               # the surfaces that its patches are tied to
    area: dict = dataclasses.field(default_factory=dict)
    volume: float = math.nan
    normal: dict = dataclasses.field(default_factory=dict)
    sharp: list = dataclasses.field(default_factory=list)  # pairs of patches and the distance of a point from their edge


def sphere(name, radius):
    return f'[[surface]]\nname = "{name}"\nkind = "sphere"\ncenter = [0, 0, 0]\nradius = {radius}\n'


def planes(half):
    """Six planes of a box around the origin, normals outwards; `half` may differ by axis."""
    text = ""
    for axis, letter in enumerate("xyz"):
        for sign, end in ((-1, "min"), (1, "max")):
            point, normal = [0.0] * 3, [0] * 3
            point[axis], normal[axis] = sign * half[axis], sign
            text += f'[[surface]]\nname = "{letter}{end}"\nkind = "plane"\npoint = {point}\nnormal = {normal}\n'
    return text


BOX = " & ".join(f"-{letter}{end}" for letter in "xyz" for end in ("min", "max"))


def made_by_pamr(region, bounds, near, far, surfaces):
    sizes = ", ".join(f"{name} = {size}" for name, size in near.items())
    return (f'[mesh]\nshape = "surfaces"\nlength_unit = "1"\nregion = "{region}"\nbounds = {bounds}\n'
            f"[mesh.sizes]\nfar = {far}\ngrowth = 0.8\nnear = {{ {sizes} }}\n{surfaces}")


def made_by_gmsh(body, sizes, patches):
    """`patches`: name -> list expression of surfaces. `sizes`: largest edge."""
    text = f'SetFactory("OpenCASCADE");\nMesh.MeshSizeMax = {sizes};\nMesh.MeshSizeMin = {sizes};\n{body}\n'
    text += "\n".join(f'Physical Surface("{name}") = {{{tags}}};' for name, tags in patches.items())
    return text + '\nPhysical Volume("gas") = {Volume{:}};\n'


def radial(points):
    return points / np.linalg.norm(points, axis=1)[:, None]


def ball_in_box(h, mesher):
    """The cube |x|, |y|, |z| <= 2 without the unit ball."""
    exact = {"walls": ["ball"], "area": {"ball": 4 * math.pi}, "volume": 64 - 4 / 3 * math.pi, "normal": {"ball": radial}}
    if mesher == "gmsh":
        return Case(geo=made_by_gmsh("Box(1) = {-2, -2, -2, 4, 4, 4};\nSphere(2) = {0, 0, 0, 1};\n"
                                     "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
                                     h, {"box": "1:6", "ball": "7"}),
                    surfaces=sphere("ball", 1.0), **exact)
    return Case(case_file=made_by_pamr(f"+ball & {BOX}", [[-2, -2, -2], [2, 2, 2]], {"ball": h}, max(h, 1.0),
                                       sphere("ball", 1.0) + planes([2, 2, 2])), **exact)


def ball(h, mesher):
    """The inside of the unit ball."""
    exact = {"walls": ["ball"], "area": {"ball": 4 * math.pi}, "volume": 4 / 3 * math.pi, "normal": {"ball": radial}}
    if mesher == "gmsh":
        return Case(geo=made_by_gmsh("Sphere(1) = {0, 0, 0, 1};", h, {"ball": "1"}), surfaces=sphere("ball", 1.0), **exact)
    return Case(case_file=made_by_pamr("-ball", [[-1, -1, -1], [1, 1, 1]], {"ball": h}, h, sphere("ball", 1.0)), **exact)


def torus_normal(points):
    ring = points * [1, 1, 0]
    return radial(points - ring / np.linalg.norm(ring, axis=1)[:, None])


TORUS = '[[surface]]\nname = "torus"\nkind = "torus"\ncenter = [0, 0, 0]\naxis = [0, 0, 1]\nmajor_radius = 1.0\n' \
        "minor_radius = {}\n"


def torus_in_box(h, mesher):
    """A box without a torus of radii 1 and 0.4; h is relative to the smaller one."""
    tube = 0.4
    exact = {"walls": ["torus"], "area": {"torus": 4 * math.pi**2 * tube}, "volume": 4 * 4 * 2 - 2 * math.pi**2 * tube**2,
             "normal": {"torus": torus_normal}}
    if mesher == "gmsh":
        return Case(geo=made_by_gmsh(f"Box(1) = {{-2, -2, -1, 4, 4, 2}};\nTorus(2) = {{0, 0, 0, 1, {tube}}};\n"
                                     "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
                                     h * tube, {"box": "1:6", "torus": "7"}),
                    surfaces=TORUS.format(tube), **exact)
    return Case(case_file=made_by_pamr(f"+torus & {BOX}", [[-2, -2, -1], [2, 2, 1]], {"torus": h * tube}, max(h * tube, 0.8),
                                       TORUS.format(tube) + planes([2, 2, 1])), **exact)


def bored_box(h, mesher):
    """A box with a hole of radius 0.5 through it; its two rims are sharp."""
    radius = 0.5
    wall = {"area": {"hole": 2 * math.pi * radius}, "volume": 4.0 - math.pi * radius**2,
            "normal": {"hole": lambda p: radial(p * [1, 1, 0])}}
    surfaces = f'[[surface]]\nname = "hole"\nkind = "cylinder"\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nradius = {radius}\n' \
        + planes([1, 1, 0.5])
    rims = [("hole", end, lambda p, z=z: np.maximum(np.abs(np.hypot(p[:, 0], p[:, 1]) - radius), np.abs(p[:, 2] - z)))
            for end, z in (("zmin", -0.5), ("zmax", 0.5))]
    if mesher == "gmsh":
        return Case(["hole"], geo=made_by_gmsh(
            "Box(1) = {-1, -1, -0.5, 2, 2, 1};\nCylinder(2) = {0, 0, -1, 0, 0, 2, 0.5};\n"
            "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\ne = 1e-3;\n"
            "lo() = Surface In BoundingBox {-1-e, -1-e, -0.5-e, 1+e, 1+e, -0.5+e};\n"
            "hi() = Surface In BoundingBox {-1-e, -1-e, 0.5-e, 1+e, 1+e, 0.5+e};\n"
            "hole() = Surface In BoundingBox {-0.5-e, -0.5-e, -0.5-e, 0.5+e, 0.5+e, 0.5+e};\n"
            "xlo() = Surface In BoundingBox {-1-e, -1-e, -0.5-e, -1+e, 1+e, 0.5+e};\n"
            "xhi() = Surface In BoundingBox {1-e, -1-e, -0.5-e, 1+e, 1+e, 0.5+e};\n"
            "ylo() = Surface In BoundingBox {-1-e, -1-e, -0.5-e, 1+e, -1+e, 0.5+e};\n"
            "yhi() = Surface In BoundingBox {-1-e, 1-e, -0.5-e, 1+e, 1+e, 0.5+e};", h * radius,
            {"zmin": "lo()", "zmax": "hi()", "hole": "hole()", "xmin": "xlo()", "xmax": "xhi()", "ymin": "ylo()",
             "ymax": "yhi()"}), surfaces=surfaces, sharp=rims, **wall)
    return Case(["hole"], case_file=made_by_pamr(f"+hole & {BOX}", [[-1, -1, -0.5], [1, 1, 0.5]], {"hole": h * radius},
                                                 max(h * radius, 0.5), surfaces), sharp=rims, **wall)


def thin_shell(h, mesher):
    """Between two spheres of radii 1 and 0.9."""
    exact = {"walls": ["outer", "inner"], "area": {"outer": 4 * math.pi, "inner": 4 * math.pi * 0.81},
             "volume": 4 / 3 * math.pi * (1 - 0.729), "normal": {"outer": radial, "inner": radial}}
    surfaces = sphere("outer", 1.0) + sphere("inner", 0.9)
    if mesher == "gmsh":
        return Case(geo=made_by_gmsh("Sphere(1) = {0, 0, 0, 1};\nSphere(2) = {0, 0, 0, 0.9};\n"
                                     "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };",
                                     h, {"outer": "1", "inner": "2"}), surfaces=surfaces, **exact)
    return Case(case_file=made_by_pamr("-outer & +inner", [[-1, -1, -1], [1, 1, 1]], {"outer": h, "inner": h}, h, surfaces),
                **exact)


def ellipsoid(h, mesher):
    """The inside of x^2 + y^2 + z^2 / 4 = 1 as a quadric; smallest radius of curvature 0.5 at the tips."""
    eccentricity = math.sqrt(1 - 0.25)
    area = 2 * math.pi * (1 + 2 / eccentricity * math.asin(eccentricity))
    exact = {"walls": ["egg"], "area": {"egg": area}, "volume": 8 / 3 * math.pi,
             "normal": {"egg": lambda p: radial(p * [1, 1, 0.25])}}
    h *= 0.5
    egg = '[[surface]]\nname = "egg"\nkind = "quadric"\ncoefficients = [1, 1, 0.25, 0, 0, 0, 0, 0, 0, -1]\n'
    return Case(case_file=made_by_pamr("-egg", [[-1, -1, -2], [1, 1, 2]], {"egg": h}, h, egg), **exact)


def dish(h, mesher):
    """Over the square |x|, |y| <= 1, between z = 0 and z = 1 + (x^2 + y^2) / 2, a parametric patch of two segments."""
    grid = (np.arange(2000) + 0.5) / 1000 - 1
    area = np.sqrt(1 + grid[:, None]**2 + grid[None, :]**2).mean() * 4
    x, y, z = [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [1, 0, 0, 0.5, 0, 0.5]
    segments = ",\n".join(f"  {{ x = {x}, y = {y}, z = {z}, u = {u}, v = [-1.5, 1.5] }}" for u in ([-1.5, 0], [0, 1.5]))
    surfaces = f'[[surface]]\nname = "dish"\nkind = "polynomial"\nsegments = [\n{segments},\n]\n' + planes([1, 1, 0])
    surfaces = surfaces[:surfaces.index('[[surface]]\nname = "zmax"')]
    region = "-dish & " + BOX.removesuffix(" & -zmax")
    return Case(["dish"], case_file=made_by_pamr(region, [[-1, -1, 0], [1, 1, 2]], {"dish": h}, h, surfaces),
                area={"dish": area}, volume=4 + 4 / 3,
                normal={"dish": lambda p: radial(np.column_stack([-p[:, 0], -p[:, 1], np.ones(len(p))]))})


def revolved(pieces):
    """Area and volume of a body of revolution: pieces of (x, r) over a parameter in [0, 1], by the midpoint rule."""
    t = np.linspace(0, 1, 200001)
    area = volume = 0.0
    for piece in pieces:
        x, r = piece(t)
        dx, dr, mean = np.diff(x), np.diff(r), (r[1:] + r[:-1]) / 2
        area += 2 * math.pi * (mean * np.hypot(dx, dr)).sum()
        volume += math.pi * ((r[1:]**2 + r[1:] * r[:-1] + r[:-1]**2) / 3 * dx).sum()
    return area, volume


def nearest_on_step(step, x, r):
    """Of points of the half plane: distance from a segment or an arc of a profile, and the normal there."""
    start, end = np.array(step["from"]), np.array(step["to"])
    p = np.column_stack([x, r])
    if "center" not in step:
        along = end - start
        t = np.clip((p - start) @ along / (along @ along), 0, 1)
        away = np.array([-along[1], along[0]]) / np.hypot(*along)
        return np.linalg.norm(p - start - t[:, None] * along, axis=1), np.broadcast_to(away, p.shape)
    center = np.array(step["center"])
    angle = [math.atan2(q[1] - center[1], q[0] - center[0]) for q in (start, end)]
    turn = (angle[1] - angle[0] + math.pi) % (2 * math.pi) - math.pi
    gone = (np.arctan2(r - center[1], x - center[0]) - angle[0] + math.pi) % (2 * math.pi) - math.pi
    there = angle[0] + np.clip(gone / turn, 0, 1) * turn
    normal = np.column_stack([np.cos(there), np.sin(there)])
    return np.linalg.norm(p - center - np.hypot(*(start - center)) * normal, axis=1), normal


def revolution_normal(surface):
    """Normals of a surface of revolution about a line along x: those of the nearest points of its profile."""
    origin = np.array(surface["origin"])

    def normal(points):
        q = points - origin
        r = np.hypot(q[:, 1], q[:, 2])
        found = [nearest_on_step(step, q[:, 0] * surface["axis"][0], r) for step in surface["profile"]]
        nearest = np.argmin([distance for distance, _ in found], axis=0)
        x, out = np.array([n for _, n in found])[nearest, np.arange(len(q))].T
        return np.column_stack([x * surface["axis"][0], out * q[:, 1] / r, out * q[:, 2] / r])

    return normal


def normals_of_file(text, walls):
    """The normal field of each wall from the surfaces that a mesh file describes: {wall: surface}."""
    surfaces = {s["name"]: s for s in tomllib.loads(text)["surface"]}
    return {wall: revolution_normal(surfaces[name]) for wall, name in walls.items()}


def blunt_cone_in_box(h, mesher):
    """A box without a cone of 30 degrees with nose radius 0.5, shoulder radius 0.2 and flat base; h is relative to 0.2."""
    shoulder = 0.2
    root = math.sqrt(3) / 2
    a, b = (0.25, 0.5 * root), (1.25, 0.5 * root + 1 / math.sqrt(3))
    center = (b[0] + shoulder / 2, b[1] - shoulder * root)
    end = (center[0] + shoulder, center[1])
    pieces = [lambda t: (0.5 - 0.5 * np.cos(t * math.pi / 3), 0.5 * np.sin(t * math.pi / 3)),
              lambda t: (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])),
              lambda t: (center[0] - shoulder * np.cos(math.pi / 3 + t * 2 * math.pi / 3),
                         center[1] + shoulder * np.sin(math.pi / 3 + t * 2 * math.pi / 3)),
              lambda t: (end[0] + 0 * t, end[1] * (1 - t))]
    area, volume = revolved(pieces)
    surfaces = (f'[[surface]]\nname = "cone"\nkind = "revolution"\norigin = [-1, 0, 0]\naxis = [1, 0, 0]\nprofile = [\n'
                f"  {{ from = [0, 0], to = {list(a)}, center = [0.5, 0] }},\n  {{ from = {list(a)}, to = {list(b)} }},\n"
                f"  {{ from = {list(b)}, to = {list(end)}, center = {list(center)} }},\n"
                f"  {{ from = {list(end)}, to = [{end[0]}, 0] }},\n]\n")
    return Case(["cone"], case_file=made_by_pamr(f"+cone & {BOX}", [[-2, -2, -2], [2, 2, 2]], {"cone": h * shoulder}, 0.8,
                                                 surfaces + planes([2, 2, 2])), area={"cone": area}, volume=64 - volume,
                normal=normals_of_file(surfaces, {"cone": "cone"}))


# Their argument: edges at the wall over its smallest radius of curvature (thin-shell: over the outer one), and the mesher.
CASES = {"ball-in-box": ball_in_box, "ball": ball, "torus-in-box": torus_in_box, "bored-box": bored_box,
         "cone-in-box": blunt_cone_in_box, "thin-shell": thin_shell, "ellipsoid": ellipsoid, "dish": dish}
