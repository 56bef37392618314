#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the heat flux along the meridian in the symmetry plane, level by level, as SVG (the paper's Fig. 14).

Usage: plot_heat.py -o FILE.svg LABEL=WALL.vtu...    the walls that run.sh writes, out/wall<level>.vtu
S is the way along the wall from the nose tip: negative on the side that the stream comes from (z < 0).
"""
import argparse
import math
import re

# The meridian, m: nose and cone touch at NOSE, cone and shoulder at CONE, then the arcs' centers and radii.
RADIUS, ANGLE = 12.5e-3, math.radians(70)
NOSE, CONE = (0.753842e-3, 4.275252e-3), (7.997677e-3, 24.177525e-3)
SHOULDER, FILLET = (9.172293e-3, 23.75e-3, 1.25e-3), (12.502293e-3, 8.33e-3, 2.08e-3)
END = 6.0  # S/Rn at which the drawing ends
COLORS = ("#1f77b4", "#2ca02c", "#d62728", "#9467bd")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 860, 460, 70, 20, 20, 55
N_BINS = 120


def arc_length(x, r):
    """S of a point on the wall, m."""
    nose_end = RADIUS * (math.pi / 2 - ANGLE)
    cone_end = nose_end + math.hypot(CONE[0] - NOSE[0], CONE[1] - NOSE[1])
    shoulder_end = cone_end + SHOULDER[2] * (math.pi / 2 + ANGLE)
    base_end = shoulder_end + SHOULDER[1] - FILLET[1]
    if x <= NOSE[0]:
        return RADIUS * math.atan2(r, RADIUS - x)
    if x <= CONE[0]:
        return nose_end + math.hypot(x - NOSE[0], r - NOSE[1])
    if r > SHOULDER[1] or x < SHOULDER[0]:
        return cone_end + SHOULDER[2] * (math.pi / 2 + ANGLE - math.atan2(r - SHOULDER[1], x - SHOULDER[0]))
    if r > FILLET[1]:
        return shoulder_end + SHOULDER[1] - r
    if x < FILLET[0]:
        return base_end + FILLET[2] * math.atan2(FILLET[1] - r, FILLET[0] - x)
    return base_end + FILLET[2] * math.pi / 2 + x - FILLET[0]


def read(name):
    """Middle, area and heat flux of every face."""
    with open(name, encoding="utf-8") as file:
        text = file.read()

    def array(title):
        body = re.search(f'Name="{title}"[^>]*>([^<]*)<', text).group(1).split()
        return [float(v) for v in body]

    points, corner, q, area = array("Points"), array("connectivity"), array("q"), array("area")
    for face, value in enumerate(q):
        at = [3 * int(corner[3 * face + k]) for k in range(3)]
        yield tuple(sum(points[a + d] for a in at) / 3 for d in range(3)), area[face], value


def curve(name):
    """Means over bins of S of the faces nearer than 20 degrees to the symmetry plane, with their signs."""
    sums = {}
    for (x, y, z), area, q in read(name):
        r = math.hypot(y, z)
        if y > math.sin(math.radians(20)) * r and r > 2e-3:
            continue
        s = math.copysign(arc_length(x, r) / RADIUS, z)
        if abs(s) > END:
            continue
        b = math.floor((s + END) / (2 * END) * N_BINS)
        total = sums.setdefault(b, [0.0, 0.0, 0.0])
        total[0] += area
        total[1] += area * q
        total[2] += area * s
    return [(total[2] / total[0], total[1] / total[0] / 1e3) for _, total in sorted(sums.items())]


def draw(curves):
    top = 5 * math.ceil(max(q for _, points in curves for _, q in points) / 5)

    def at(s, q):
        return (LEFT + (s + END) / (2 * END) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - q / top * (HEIGHT - BOTTOM - TOP))

    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
             'font-size="13">', f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>']
    for q in range(0, top + 1, 5):
        x, y = at(-END, q)
        lines.append(f'<path d="M{x:.1f} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                     f'<text x="{x - 8:.1f}" y="{y + 4:.1f}" text-anchor="end">{q}</text>')
    for s in range(-int(END), int(END) + 1):
        x, y = at(s, 0)
        lines.append(f'<path d="M{x:.1f} {TOP}V{y:.1f}" stroke="#eee"/>'
                     f'<text x="{x:.1f}" y="{y + 18:.1f}" text-anchor="middle">{s}</text>')
    for text, s in (("cone", -1.2), ("cone", 1.2), ("base", -2.95), ("base", 2.95), ("sting", -4.8), ("sting", 4.8)):
        lines.append(f'<text x="{at(s, 0)[0]:.1f}" y="{TOP + 14}" text-anchor="middle" fill="#888">{text}</text>')
    lines.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 12}" text-anchor="middle">S / R_n, negative: the side towards the '
                 'stream</text>')
    lines.append(f'<text transform="translate(20 {HEIGHT / 2}) rotate(-90)" text-anchor="middle">heat flux, kW/m2</text>')
    for i, (label, points) in enumerate(curves):
        color = COLORS[i % len(COLORS)]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in (at(s, q) for s, q in points))
        lines.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="1.6"/>')
        y = TOP + 40 + 20 * i
        lines.append(f'<path d="M{WIDTH - 150} {y}h24" stroke="{color}" stroke-width="2.5"/>'
                     f'<text x="{WIDTH - 120}" y="{y + 4}">{label}</text>')
    return "\n".join(lines + ["</svg>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", required=True)
    parser.add_argument("walls", nargs="+", metavar="LABEL=WALL.vtu")
    options = parser.parse_args()
    text = draw([(label, curve(name)) for label, name in (wall.split("=", 1) for wall in options.walls)])
    with open(options.o, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
