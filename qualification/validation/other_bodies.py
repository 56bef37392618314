# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse level-0 meshes of bodies that the refinement was not made with: by Gmsh from STEP files, by pamr-mesh, and cell by cell.

Each function of BODIES takes the wanted length of edges at the walls over their smallest radius of curvature.
"""
import dataclasses
import itertools
import math
import pathlib
import subprocess
import sys

import numpy as np

from wall_cases import BOX, made_by_pamr, planes, sphere

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "tests/tools"))
from surface_models import bored_cube, icosphere, wing, write_stl  # noqa: E402


@dataclasses.dataclass
class Body:
    geo: str = ""           # a solid for Gmsh's OpenCASCADE kernel, meshed as the STEP file that it becomes,
    size: float = 0         # with edges of this length;
    keep_geo: bool = False  # or meshed as it is, because a STEP file has no periodic sides
    mesh: tuple = ()        # or points, cells, the patch of each boundary face by its middle
    surfaces: str = ""      # that patches of `mesh` lie on
    case_file: str = ""     # or of pamr-mesh
    stl: tuple = ()         # that the case file names: body.stl


def run_gmsh(folder, steps):
    """Meshes folder/body.msh after these steps, in a process of its own, which Gmsh may end."""
    script = f"import gmsh\ngmsh.initialize(['gmsh', '-v', '1'])\n{steps}\ngmsh.model.mesh.generate(3)\ngmsh.write('body.msh')"
    done = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True)
    if not (folder / "body.msh").exists():
        raise RuntimeError(f"gmsh: {done.stdout[-300:]} {done.stderr[-300:]}")


def by_gmsh(folder, body):
    (folder / "body.geo").write_text('SetFactory("OpenCASCADE");\n' + body.geo)
    steps = "gmsh.open('body.geo'); gmsh.write('body.step')\n"
    if not body.keep_geo:
        steps += "gmsh.clear(); gmsh.open('body.step')\n"
    run_gmsh(folder, steps + f"for end in ('Min', 'Max'): gmsh.option.setNumber('Mesh.MeshSize' + end, {body.size})")


def by_cells(folder, body):
    points, cells, patch_of = body.mesh
    of_cells = cells[:, list(itertools.combinations(range(4), 3))].reshape(-1, 3)
    faces, count = np.unique(np.sort(of_cells, axis=1), axis=0, return_counts=True)
    faces = faces[count == 1]
    patches = patch_of(points, faces)
    names = sorted(set(patches))
    elements = [f"2 2 {names.index(p) + 1} {names.index(p) + 1} {a} {b} {c}" for p, (a, b, c) in zip(patches, faces + 1)]
    elements += [f"4 2 {len(names) + 1} 1 {a} {b} {c} {d}" for a, b, c, d in cells + 1]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", len(names) + 1,
             *(f'2 {i} "{name}"' for i, name in enumerate(names, 1)), f'3 {len(names) + 1} "gas"', "$EndPhysicalNames",
             "$Nodes", len(points), *(f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points.tolist(), 1)), "$EndNodes",
             "$Elements", len(elements), *(f"{i} {e}" for i, e in enumerate(elements, 1)), "$EndElements"]
    (folder / "body.msh").write_text("\n".join(map(str, lines)) + "\n")
    (folder / "body.toml").write_text(body.surfaces)


def make(call, body, folder, repair=False):
    """Level 0 of a Body in a file of the folder; with `repair` after pamr-convert --repair."""
    mesh = make_as_it_is(call, body, folder)
    if repair:
        call("pamr-convert", mesh, folder / "repaired.hdf", "--repair", "--force", "--quiet")
    return folder / "repaired.hdf" if repair else mesh


def make_as_it_is(call, body, folder):
    mesh = folder / "level0.hdf"
    if body.case_file:
        if body.stl:
            write_stl(folder / "body.stl", *body.stl)
        (folder / "case.toml").write_text(body.case_file)
        call("pamr-mesh", folder / "case.toml", "-o", mesh, "--force", "--quiet")
        return mesh
    (by_gmsh if body.geo else by_cells)(folder, body)
    of_walls = ["--cad", folder / "body.step"] if body.geo else ["--surfaces", folder / "body.toml"]
    call("pamr-convert", folder / "body.msh", mesh, *of_walls, "--force", "--quiet")
    return mesh


# --- solids for Gmsh

def cut(tools, size=2.0):
    """A box around the origin without volumes 2, 3, ..."""
    return (f"Box(1) = {{{-size}, {-size}, {-size}, {2 * size}, {2 * size}, {2 * size}}};\n{tools}\n"
            "t() = Volume{:}; t() -= {1};\nBooleanDifference{ Volume{1}; Delete; }{ Volume{t()}; Delete; }\n")


def fillets(h):
    """An angle with a rounded edge outside and a rounded one inside, radii 0.5."""
    points = [(0, 0), (3, 0), (3, 1.2), (1.2, 1.2), (1.2, 3), (0, 3)]
    text = "".join(f"Point({i}) = {{{x}, {y}, 0}};\n" for i, (x, y) in enumerate(points, 1))
    text += "".join(f"Line({i}) = {{{i}, {i % 6 + 1}}};\n" for i in range(1, 7))
    return Body(text + "Curve Loop(1) = {1:6};\nPlane Surface(1) = {1};\nExtrude {0, 0, 1} { Surface{1}; }\n"
                "e() = Curve In BoundingBox {-0.01, -0.01, -0.01, 0.01, 0.01, 1.01};\n"
                "i() = Curve In BoundingBox {1.19, 1.19, -0.01, 1.21, 1.21, 1.01};\n"
                "Fillet{1}{e(), i()}{0.5}\n", 0.5 * h)


def nose(h):
    """A box without a cone of 30 degrees with a round nose of radius 0.5 and a sharp base."""
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    x, r = -0.5 * s, 0.5 * c  # where nose and cone touch; the cone ends at x = 1
    return Body(cut(f"Sphere(2) = {{0, 0, 0, 0.5}};\nCone(3) = {{{x}, 0, 0, {1 - x}, 0, 0, {r}, {r + (1 - x) * s / c}}};\n"
                    "BooleanUnion(4) = { Volume{2}; Delete; }{ Volume{3}; Delete; };"), 0.5 * h)


def nurbs(h):
    """An egg of NURBS: a ball that OpenCASCADE stretched; smallest radius of curvature 0.36."""
    return Body("Sphere(1) = {0, 0, 0, 1};\nDilate {{0, 0, 0}, {1, 0.6, 0.8}} { Volume{1}; }\n", 0.36 * h)


STRETCHED = "Dilate {{{{0, 0, 0}}, {{{0}}}}} {{ Volume{{{1}}}; }}\n"


def nurbs_outside(h):
    """A box around an egg of revolution, of NURBS, a node at each pole; smallest radius of curvature 0.64."""
    return Body(cut("Sphere(2) = {0, 0, 0, 1};\n" + STRETCHED.format("1, 1, 0.8", 2)), 0.64 * h)


def cone(h, stretched=""):
    """A cone with its tip, whose radius of curvature is 0 there; h is over half of the base's radius."""
    return Body("Cone(1) = {0, 0, 0, 0, 0, 1.5, 1, 0};\n" + stretched, 0.5 * h)


def half_torus(h):
    """The part below z = 0.1 of a torus of NURBS; smallest radius of curvature 0.32."""
    return Body("Torus(1) = {0, 0, 0, 1, 0.4};\n" + STRETCHED.format("1, 0.8, 0.9", 1) + "Box(2) = {-2, -2, 0.1, 4, 4, 2};\n"
                "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n", 0.32 * h)


def loft(h):
    """A duct from a circle to an ellipse, of NURBS; smallest radius of curvature 0.45."""
    return Body("Circle(1) = {0, 0, 0, 1};\nEllipse(2) = {0.3, 0, 1, 1.1, 0.8};\nEllipse(3) = {0, 0, 2, 0.8, 0.6};\n"
                "Curve Loop(1) = {1};\nCurve Loop(2) = {2};\nCurve Loop(3) = {3};\nThruSections(1) = {1, 2, 3};\n", 0.45 * h)


TWO_BALLS = "Sphere({0}) = {{-0.5, 0, 0, 1}};\nSphere({1}) = {{0.5, 0, 0, 1}};\n"
PIPES = "Cylinder({0}) = {{-1.5, 0, 0, 3, 0, 0, 1}};\nCylinder({1}) = {{0, 0, 0, 0, 0, 2, 0.6}};\n"


def periodic(h):
    """A channel over a round hump, periodic along x."""
    return Body("Box(1) = {-2, 0, 0, 4, 2, 2};\nCylinder(2) = {0.3, 0, -0.5, 0, 2, 0, 1};\n"
                "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
                "a() = Surface In BoundingBox {-2.01, -0.01, -0.01, -1.99, 2.01, 2.01};\n"
                "b() = Surface In BoundingBox {1.99, -0.01, -0.01, 2.01, 2.01, 2.01};\n"
                "Periodic Surface {b()} = {a()} Translate {4, 0, 0};\n", h, keep_geo=True)


def sleeve(h):
    """A region between a bore of radius 0.5 and a cylinder of radius 1 in a block."""
    return Body(cut("Cylinder(2) = {0, 0, -3, 0, 0, 6, 0.5};", 1.5) + "Cylinder(9) = {0, 0, -1.5, 0, 0, 3, 1};\n"
                "BooleanFragments{ Volume{1}; Delete; }{ Volume{9}; Delete; }\n"
                "c() = Volume In BoundingBox {-0.51, -0.51, -1.6, 0.51, 0.51, 1.6};\nRecursive Delete { Volume{c()}; }\n", 0.5 * h)


# --- cells

def hexahedra(corner):
    """Cells of hexahedra, corner[i][j][k] each an array of nodes: six around a diagonal."""
    cells = []
    for axes in itertools.permutations(range(3)):
        place, cell = [0, 0, 0], [corner[0][0][0]]
        for axis in axes:
            place[axis] = 1
            cell.append(corner[place[0]][place[1]][place[2]])
        cells.append(np.column_stack(cell))
    return np.concatenate(cells)


def block(n, place, closed=False):
    """n[0] x n[1] x n[2] hexahedra; `place` gives the points of coordinates in [0, 1]; `closed` along the first."""
    m = [n[0] + (not closed), n[1] + 1, n[2] + 1]
    node = np.arange(math.prod(m)).reshape(m)
    if closed:
        node = np.concatenate([node, node[:1]])
    part = [(slice(None, -1), slice(1, None))[k] for k in (0, 1)]
    corner = [[[node[part[i], part[j], part[k]].ravel() for k in (0, 1)] for j in (0, 1)] for i in (0, 1)]
    grid = np.stack(np.meshgrid(*(np.arange(k) / c for k, c in zip(m, n)), indexing="ij"), axis=-1).reshape(-1, 3)
    return turned(place(*grid.T), hexahedra(corner))


def turned(points, cells):
    p = points[cells]
    negative = np.linalg.det(p[:, 1:] - p[:, :1]) < 0
    cells[negative] = cells[negative][:, [0, 1, 3, 2]]
    return points, cells


def by_distance(*walls):
    """The patch of a face: the last whose function is 0 at its corners, but no floor or lid; all others are one patch."""
    def patch_of(points, faces):
        names = np.full(len(faces), "sides", dtype=object)
        for name, function in walls:
            names[(np.abs(function(points[faces])) < 1e-9).all(axis=1) & (np.ptp(points[faces][..., 2], axis=1) > 1e-9)] = name
        return names.tolist()
    return patch_of


def saddle(h, turn=False):
    """A block under z = 1 + (x^2 - y^2) / 2, whose radius is 1, or under z = 1.5 + x y."""
    n = max(2, round(2 / h))
    top = (lambda x, y: 1.5 + x * y) if turn else (lambda x, y: 1 + 0.5 * (x * x - y * y))

    def place(u, v, w):
        x, y = 2 * u - 1, 2 * v - 1
        return np.column_stack([x, y, w * top(x, y)])
    coefficients = [0, 0, 0, -1, 0, 0, 0, 0, 1, -1.5] if turn else [-0.5, 0.5, 0, 0, 0, 0, 0, 0, 1, -1]
    return Body(mesh=(*block((n, n, max(1, n // 2)), place), by_distance(("saddle", lambda p: p[..., 2] - top(p[..., 0], p[..., 1])))),
                surfaces=f'[[surface]]\nname = "saddle"\nkind = "quadric"\ncoefficients = {coefficients}\n')


def cylinder(name, radius, x=0):
    return f'[[surface]]\nname = "{name}"\nkind = "cylinder"\npoint = [{x}, 0, 0]\naxis = [0, 0, 1]\nradius = {radius}\n'


def tube(h, inner, layers):
    """Between cylinders of radii `inner` and 1."""
    n = max(3, round(math.pi / math.asin(min(0.87, h / 2))))

    def place(u, v, w):
        r, angle = inner + v * (1 - inner), 2 * math.pi * u + 0.1
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), w * 0.5])
    walls = [(name, lambda p, r=r: np.hypot(p[..., 0], p[..., 1]) - r) for name, r in (("bore", inner), ("mantle", 1.0))]
    return Body(mesh=(*block((n, layers, 1), place, closed=True), by_distance(*walls)),
                surfaces=cylinder("bore", inner) + cylinder("mantle", 1.0))


def bore(n, shift=0.2, radius=0.3):
    """A disk of radius 1 with a bore of n edges around, off its center."""
    def place(u, v, w):
        x, y = np.cos(2 * math.pi * u + 0.1), np.sin(2 * math.pi * u + 0.1)
        return np.column_stack([(1 - v) * (shift + radius * x) + v * x, (1 - v) * radius * y + v * y, w])
    walls = [("bore", lambda p: np.hypot(p[..., 0] - shift, p[..., 1]) - radius), ("mantle", lambda p: np.hypot(p[..., 0], p[..., 1]) - 1)]
    return Body(mesh=(*block((n, 3, 3), place, closed=True), by_distance(*walls)),
                surfaces=cylinder("bore", radius, shift) + cylinder("mantle", 1.0))


def shell(level, radii):
    """Layers of prisms between spheres of 12 nodes (level 0), 42 or 162."""
    directions, triangles = icosphere(level)
    n, cells = len(directions), []
    for layer in range(len(radii) - 1):
        a, b, c = (np.sort(triangles, axis=1) + layer * n).T
        cells += [[a, b, c, c + n], [a, b, b + n, c + n], [a, a + n, b + n, c + n]]
    cells = np.concatenate([np.column_stack(part) for part in cells])
    walls = [(name, lambda p, r=r: np.linalg.norm(p, axis=-1) - r) for name, r in (("inner", radii[0]), ("outer", radii[-1]))]
    return Body(mesh=(*turned(np.concatenate([r * directions for r in radii]), cells), by_distance(*walls)),
                surfaces=sphere("inner", radii[0]) + sphere("outer", radii[-1]))


def level_of(h):
    return 0 if h > 0.8 else 1 if h > 0.4 else 2


def cubed_ball(h):
    """The unit ball as a cube of n^3 hexahedra blown up: cells with two faces on the wall, which pamr-convert splits."""
    n = max(2, round(1.6 / h))

    def place(*u):
        p = 2 * np.column_stack(u) - 1
        most, length = np.abs(p).max(axis=1), np.linalg.norm(p, axis=1)
        return p * np.where(length > 0, most / np.where(length > 0, length, 1), 0)[:, None]
    return Body(mesh=(*block((n, n, n), place), by_distance(("wall", lambda p: np.linalg.norm(p, axis=-1) - 1))),
                surfaces=sphere("wall", 1.0))


def disc_cylinder(h):
    """A cylinder of radius 1 as a blown-up square prism."""
    n = max(2, round(1.5 / h))

    def place(u, v, w):
        p = 2 * np.column_stack([u, v]) - 1
        most, length = np.abs(p).max(axis=1), np.linalg.norm(p, axis=1)
        p *= np.where(length > 0, most / np.where(length > 0, length, 1), 0)[:, None]
        return np.column_stack([p, w])
    return Body(mesh=(*block((n, n, max(1, n // 2)), place), by_distance(("wall", lambda p: np.hypot(p[..., 0], p[..., 1]) - 1))),
                surfaces=cylinder("wall", 1.0))


def hourglass(h):
    """A waist of revolution: radius 2 - sqrt(1 - z^2) for |z| < 0.8, around a rod of radius 0.4."""
    surfaces = ('[[surface]]\nname = "waist"\nkind = "revolution"\norigin = [0, 0, 0]\naxis = [0, 0, 1]\nprofile = [\n'
                "  { from = [-0.8, 1.4], to = [0.8, 1.4], center = [0, 2] },\n]\n" + cylinder("rod", 0.4))
    n, layers = max(4, round(2 * math.pi / h)), max(2, round(1.6 / h))

    def place(u, v, w):
        z = 1.6 * w - 0.8
        r, angle = 0.4 + v * (1.6 - np.sqrt(1 - z * z)), 2 * math.pi * u
        return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    walls = [("rod", lambda p: np.hypot(p[..., 0], p[..., 1]) - 0.4),
             ("waist", lambda p: np.hypot(np.hypot(p[..., 0], p[..., 1]) - 2, p[..., 2]) - 1)]
    return Body(mesh=(*block((n, 2, layers), place, closed=True), by_distance(*walls)), surfaces=surfaces)


# --- by pamr-mesh

def meshed_saddle(h):
    surfaces = ('[[surface]]\nname = "saddle"\nkind = "quadric"\ncoefficients = [-0.5, 0.5, 0, 0, 0, 0, 0, 0, 1, -1]\n'
                + planes([1, 1, 0]))
    surfaces = surfaces[:surfaces.index('[[surface]]\nname = "zmax"')]
    return Body(case_file=made_by_pamr("-saddle & " + BOX.removesuffix(" & -zmax"), [[-1, -1, 0], [1, 1, 2]], {"saddle": h}, h,
                                       surfaces))


def meshed_lens(h):
    two = sphere("a", 1.0).replace("[0, 0, 0]", "[-0.5, 0, 0]") + sphere("b", 1.0).replace("[0, 0, 0]", "[0.5, 0, 0]")
    return Body(case_file=made_by_pamr("-a & -b", [[-1, -1, -1], [1, 1, 1]], {"a": h, "b": h}, h, two))


def scan(model, h, region, bounds, more=""):
    text = made_by_pamr(region, bounds, {"body": h}, h, '[[surface]]\nname = "body"\nkind = "triangulation"\nfile = "body.stl"\n' + more)
    return Body(case_file=text, stl=model)


HOLE = (1.0, 1.3, 1.8, 2.6, 4.0)
BODIES = {
    "step-bored-block": lambda h: Body(cut("Cylinder(2) = {0, 0, -3, 0, 0, 6, 0.5};", 1.0), 0.5 * h),
    "step-fillets": fillets,
    "step-torus": lambda h: Body(cut("Torus(2) = {0, 0, 0, 1, 0.4};"), 0.4 * h),
    "step-pipes": lambda h: Body(PIPES.format(1, 2) + "BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n", 0.6 * h),
    "step-pipes-outside": lambda h: Body(cut(PIPES.format(2, 3) + "BooleanUnion{ Volume{2}; Delete; }{ Volume{3}; Delete; }\n", 2.5), 0.6 * h),
    "step-nose": nose,
    "step-nurbs": nurbs,
    "step-nurbs-outside": nurbs_outside,
    "step-cone": cone,
    "step-nurbs-cone": lambda h: cone(h, STRETCHED.format("1, 0.8, 1", 1)),
    "step-half-torus": half_torus,
    "step-loft": loft,
    "step-capsule": lambda h: Body("Cylinder(1) = {0, 0, 0, 0, 0, 2, 1};\nSphere(2) = {0, 0, 0, 1};\nSphere(3) = {0, 0, 2, 1};\n"
                                   "BooleanUnion{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; }\n", h),
    "step-lens": lambda h: Body(TWO_BALLS.format(1, 2) + "BooleanIntersection{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n", h),
    "step-lens-outside": lambda h: Body(cut(TWO_BALLS.format(2, 3) + "BooleanIntersection{ Volume{2}; Delete; }{ Volume{3}; Delete; }"), h),
    "step-peanut": lambda h: Body(TWO_BALLS.format(1, 2) + "BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n", h),
    "step-peanut-outside": lambda h: Body(cut(TWO_BALLS.format(2, 3) + "BooleanUnion{ Volume{2}; Delete; }{ Volume{3}; Delete; }", 3.0), h),
    "ball-of-two-regions": lambda h: Body("Sphere(1) = {0, 0, 0, 1};\nSphere(2) = {0.6, 0, 0, 1};\n"
                                          "BooleanIntersection(3) = { Volume{1}; }{ Volume{2}; Delete; };\n"
                                          "BooleanFragments{ Volume{1}; Delete; }{ Volume{3}; Delete; }\n", h),
    "region-in-bore": sleeve,
    "periodic-hump": periodic,
    "saddle": saddle,
    "saddle-turned": lambda h: saddle(h, True),
    "thin-tube": lambda h: tube(h, 0.75, 1),
    "two-cell-tube": lambda h: tube(h, 0.5, 2),
    "thin-shell-of-prisms": lambda h: shell(level_of(h), (1.0, 1.3)),
    "two-cell-shell": lambda h: shell(level_of(h), (1.0, 1.5, 2.2)),
    "hole-of-12": lambda h: shell(0, HOLE),  # this one and those below have one size
    "hole-of-42": lambda h: shell(1, HOLE),
    "bore-of-5": lambda h: bore(5),
    "bore-of-6": lambda h: bore(6),
    "bore-of-8": lambda h: bore(8),
    "bore-of-9": lambda h: bore(9, 0.1, 0.5),
    "cubed-ball": cubed_ball,
    "disc-cylinder": disc_cylinder,
    "hourglass": hourglass,
    "meshed-saddle": meshed_saddle,
    "meshed-lens": meshed_lens,
    "scan-of-bore": lambda h: scan(bored_cube(32), 0.5 * h, "-body", [[-1, -1, -1], [1, 1, 1]]),
    "scan-of-wing": lambda h: scan(wing(16), 0.4 * h, f"+body & {BOX}", [[-1, -1, -2], [2, 1, 2]],
                                   planes([2, 1, 2]).replace("[-2, 0", "[-1, 0")),
}
