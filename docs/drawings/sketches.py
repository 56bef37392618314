# SPDX-License-Identifier: GPL-3.0-or-later
"""Sketches of the published cases, and of the walk around an edge."""
import math

from canvas import CLOSURE, FAINT, INK, MARK, PARTS, REGULAR, Canvas

DEGREES = math.pi / 180


def arc(center, radius, first, last, n=24):
    """Points of an arc from one angle to the other, in degrees counter-clockwise from the first axis."""
    steps = [first + (last - first) * i / n for i in range(n + 1)]
    return [(center[0] + radius * math.cos(a * DEGREES), center[1] + radius * math.sin(a * DEGREES)) for a in steps]


def meridian():
    """The blunt cone from its nose tip to its sting, mm (lib/meshing/blunt_cone.cpp)."""
    return [*arc((12.5, 0), 12.5, 180, 160), *arc((9.172293, 23.75), 1.25, 160, 0), *arc((12.502293, 8.33), 2.08, 180, 270),
            (60, 6.25)]


def path(canvas, points, stroke=INK, width=1.4, dash=""):
    for a, b in zip(points, points[1:]):
        canvas.line(a, b, stroke, width, dash)


def dimension(canvas, a, b, words, at, anchor="middle"):
    """A line with a bar at either end, and its length."""
    length = math.dist(a, b)
    across = ((b[1] - a[1]) * 5 / length, (a[0] - b[0]) * 5 / length)
    canvas.line(a, b, FAINT, 1.2)
    for x, y in (a, b):
        canvas.line((x - across[0], y - across[1]), (x + across[0], y + across[1]), FAINT, 1.2)
    canvas.text(at, words, 14, anchor)


def draw_cone(file):
    """Left the body and its radii, right the gas about it."""
    canvas = Canvas(900, 400)
    body = lambda x, r: (84 + 6.2 * x, 200 - 6.2 * r)
    upper = [body(x, r) for x, r in meridian() if x <= 45] + [body(45, 6.25)]
    canvas.polygon(upper + [body(x, -r) for x, r in reversed([p for p in meridian() if p[0] <= 45] + [(45, 6.25)])], REGULAR, INK, 1.6)
    canvas.line(body(-6, 0), body(47, 0), FAINT, 1.2, "10 4 2 4")
    dimension(canvas, body(-8, -25), body(-8, 25), "50", body(-9.6, 0), "end")
    dimension(canvas, body(41, -6.25), body(41, 6.25), "12.5", body(42, 8))
    for center, radius, angle, words, side in (((12.5, 0), 12.5, 190, "nose 12.5", "start"),
                                               ((9.172293, 23.75), 1.25, 60, "shoulder 1.25", "start"),
                                               ((12.502293, 8.33), 2.08, 225, "fillet 2.08", "start")):
        tip = body(center[0] + radius * math.cos(angle * DEGREES), center[1] + radius * math.sin(angle * DEGREES))
        end = {"nose 12.5": body(15, -3.4), "shoulder 1.25": body(16, 25.5), "fillet 2.08": body(17, 11.5)}[words]
        canvas.line(tip, end, MARK, 1.2)
        canvas.text((end[0] + 4, end[1] + 5), words, 14, side)
    apex = 0.753842 - 4.275252 / math.tan(70 * DEGREES)  # where the cone would meet its axis
    canvas.line(body(apex, 0), body(0.753842, 4.275252), FAINT, 1.2, "4 4")
    path(canvas, [body(x, r) for x, r in arc((apex, 0), 8, 0, 70)], FAINT, 1.4)
    canvas.text(body(apex + 8.3, 4), "70°", 14, "start")
    canvas.text(body(20, -29.5), "the body, mm: of revolution about its axis", 14)

    gas = lambda x, z: (600 + 2.9 * x, 200 - 2.9 * z)
    outline = [(x, r) for x, r in meridian()]
    wall = [gas(-30, -45), gas(-30, 45), gas(60, 45), gas(60, -45)]
    canvas.polygon(wall, PARTS[6], INK, 1.4, 0.5)
    canvas.polygon([gas(x, r) for x, r in outline] + [gas(x, -r) for x, r in reversed(outline)], REGULAR, INK, 1.4)
    for z in (-30, -15, 0, 15, 30):
        a, b = gas(-52, z - 3.9), gas(-30, z)
        canvas.line(a, b, MARK, 1.6)
        canvas.polygon([b, (b[0] - 9, b[1] - 2.4), (b[0] - 7.6, b[1] + 5.6)], MARK, MARK, 1)
    canvas.text((410, 62), "nitrogen,", 14, "start")
    canvas.text((410, 80), "Mach 20, 10°", 14, "start")
    canvas.text(gas(10, 49), "inflow: a cylinder", 14)
    canvas.text(gas(61.5, 20), "outflow", 14, "start")
    canvas.text(gas(-14, -22), "shock", 13, color=FAINT)
    path(canvas, [gas(x, z) for x, z in zip([-3.2 + 0.016 * z * z for z in range(-36, 37, 3)], range(-36, 37, 3))], FAINT, 1.6, "6 4")
    canvas.text(gas(15, -52.5), "the plane of symmetry y = 0; half of the gas is meshed", 14)
    canvas.save(file, "The 70-degree blunt cone: its shape, and the gas about it")


def draw_spheres(file):
    """Left the problem from the side, right what is meshed of it."""
    canvas = Canvas(900, 330)
    side = lambda x, z: (225 + 55 * x, 262 - 55 * z)
    canvas.polygon([side(-3.6, 0), side(3.6, 0), side(3.6, -0.22), side(-3.6, -0.22)], CLOSURE, INK, 1.4)
    for x in (-2.25, 2.25):
        canvas.dot(side(x, 2.5), REGULAR, 55 * 0.325, INK)
        canvas.dot(side(x, 2.5), INK, 2)
    dimension(canvas, side(-2.25, 3.15), side(2.25, 3.15), "r = 4.5", side(0, 3.25))
    dimension(canvas, side(-2.25, 0), side(-2.25, 2.175), "h = 2.5", side(-2.15, 1.1), "start")
    canvas.line(side(2.25, 2.5), side(2.48, 2.73), MARK, 1.4)
    canvas.text(side(2.65, 2.75), "a = 0.325", 14, "start")
    canvas.text(side(2.65, 2.35), "psi = 3.0", 14, "start")
    canvas.text(side(1.1, 0.12), "plate, psi = 5.0", 14)
    canvas.text(side(0, 1.7), "salt water", 14, color=FAINT)
    canvas.text((225, 312), "from the side; lengths h to the centers", 14)

    # The meshed quarter: 0 <= x <= 9.75, 0 <= y <= 7.5, 0 <= z <= 10, x to the right, z up, y to the back.
    at = lambda x, y, z: (520 + 19 * x + 10.5 * y, 270 - 19 * z - 6.5 * y)
    x1, y1, z1 = 9.75, 7.5, 10
    for a, b in (((0, y1, 0), (0, 0, 0)), ((0, y1, 0), (x1, y1, 0)), ((0, y1, 0), (0, y1, z1))):
        canvas.line(at(*a), at(*b), FAINT, 1.2, "4 4")
    canvas.polygon([at(0, 0, 0), at(x1, 0, 0), at(x1, y1, 0), at(0, y1, 0)], CLOSURE, CLOSURE, 0.5, 0.7)
    for loop in (((0, 0, 0), (x1, 0, 0), (x1, 0, z1), (0, 0, z1)), ((x1, 0, 0), (x1, y1, 0), (x1, y1, z1), (x1, 0, z1)),
                 ((0, 0, z1), (x1, 0, z1), (x1, y1, z1), (0, y1, z1))):
        corners = [at(*p) for p in loop]
        path(canvas, [*corners, corners[0]], INK, 1.4)
    canvas.dot(at(2.25, 0, 2.5), REGULAR, 19 * 0.325, INK)
    for words, p, anchor in (("y = 0: mirror", (6.9, 0, 7.6), "middle"), ("x = 0: mirror", (-0.4, 0, 5), "end"), ("lid", (4.5, 4, 10), "middle"),
                             ("side, at the back", (5.6, y1, 10.6), "middle"), ("end", (x1, 3.6, 5), "middle"),
                             ("plate", (6.6, 3.4, 0), "middle")):
        canvas.text(at(*p), words, 14, anchor)
    canvas.text(at(3, 0, 2.2), "half a sphere", 14, "start")
    canvas.text((650, 312), "the quarter that is meshed, not to the scale of the left", 14)
    canvas.save(file, "Two charged spheres over a charged plate, and the quarter that is meshed")


def draw_ring(file):
    """The edge A-B seen from its end, and the cells around it: inside, at the boundary, at a rank border."""
    canvas = Canvas(900, 330)
    rings = (("inside the mesh", 5, None, "until the first cell comes again"), ("at the boundary", 3, INK, "both ways, to the ends"),
             ("at the border of a rank", 3, MARK, "the other cells are another rank's"))
    for i, (name, n, border, words) in enumerate(rings):
        x, y, radius = 150 + 300 * i, 150, 92
        corners = [(x + radius * math.cos((90 + 72 * k) * DEGREES), y - radius * math.sin((90 + 72 * k) * DEGREES)) for k in range(6)]
        for k in range(n):
            canvas.polygon([(x, y), corners[k], corners[k + 1]], CLOSURE if k == (1 if border else 0) else PARTS[0], INK, 1.4)
        if border == MARK:
            for k in range(n, 5):
                canvas.polygon([(x, y), corners[k], corners[k + 1]], PARTS[6], FAINT, 1.2, 0.5)
        if border:
            for k in (0, n):
                canvas.line((x, y), corners[k], border, 4)
        for k in range(5 if border is None or border == MARK else 4):
            dx, dy = corners[k][0] - x, corners[k][1] - y
            canvas.text((x + 1.13 * dx, y + 1.13 * dy + 5), str(k + 1), 14)
        for k in range(n if border is None else n - 1):
            turn = range(135 + 72 * k, 190 + 72 * k, 4)
            walk = [(x + 48 * math.cos(a * DEGREES), y - 48 * math.sin(a * DEGREES)) for a in turn]
            if border and k == 0:
                walk.reverse()
            path(canvas, walk, MARK, 1.8)
            (ax, ay), (bx, by) = walk[-2], walk[-1]
            length = math.hypot(bx - ax, by - ay)
            ux, uy = (bx - ax) / length, (by - ay) / length
            canvas.polygon([(bx + 5 * ux, by + 5 * uy), (bx - 4 * ux + 4.5 * uy, by - 4 * uy - 4.5 * ux),
                            (bx - 4 * ux - 4.5 * uy, by - 4 * uy + 4.5 * ux)], MARK, MARK, 1)
        canvas.dot((x, y), INK, 4.5)
        canvas.text((x + 12, y - 10), "A, B", 13, "start")
        canvas.text((x, 284), name, 16, weight="bold")
        canvas.text((x, 307), words, 13)
    canvas.save(file, "The cells around an edge, found through the neighbors of cells")
