# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture as SVG text: lines, polygons, dots and labels, and tetrahedra seen from one direction."""
import math

from splits import EDGES, FACES, cross, dot, sub

INK, FAINT, MARK, PAPER = "#22303c", "#8b98a5", "#d1442f", "#ffffff"
REGULAR, CLOSURE = "#a9cfe8", "#f6c992"
PARTS = ("#a9cfe8", "#f6c992", "#b5dcab", "#e7b7cf", "#f2e394", "#c5bce6", "#a8dcd5", "#d9cbb8")
FONT = "Helvetica, Arial, sans-serif"

# From the front, a little from the right and from above: x is to the right, y away from the eye, z up.
SIDEWAYS, ABOVE = math.radians(8), math.radians(17)
RIGHT = (math.cos(SIDEWAYS), math.sin(SIDEWAYS), 0.0)
UP = (-math.sin(ABOVE) * math.sin(SIDEWAYS), math.sin(ABOVE) * math.cos(SIDEWAYS), math.cos(ABOVE))
EYE = cross(RIGHT, UP)


def unit(v):
    length = dot(v, v) ** 0.5
    return tuple(x / length for x in v)


LIGHT = unit((0.75, -0.5, 0.9))


def seen(p):
    """Position on paper, before scaling: to the right and downwards."""
    return dot(RIGHT, p), -dot(UP, p)


def shade(color, light):
    """The color, darker where less light falls on it."""
    parts = [int(color[i:i + 2], 16) for i in (1, 3, 5)]
    return "#" + "".join(f"{min(255, round(part * light)):02x}" for part in parts)


class Canvas:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.items = []

    def polygon(self, points, fill, stroke=INK, width=1.2, opacity=1.0):
        text = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        faint = "" if opacity == 1 else f' fill-opacity="{opacity:g}"'
        self.items.append(f'<polygon points="{text}" fill="{fill}"{faint} stroke="{stroke}" stroke-width="{width:g}" '
                          'stroke-linejoin="round"/>')

    def line(self, a, b, stroke=INK, width=1.4, dash=""):
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.items.append(f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" stroke="{stroke}" '
                          f'stroke-width="{width:g}" stroke-linecap="round"{dashed}/>')

    def dot(self, p, fill=MARK, radius=5.0, stroke=PAPER):
        self.items.append(f'<circle cx="{p[0]:.1f}" cy="{p[1]:.1f}" r="{radius:g}" fill="{fill}" stroke="{stroke}" '
                          'stroke-width="1.2"/>')

    def text(self, p, words, size=15, anchor="middle", color=INK, weight="normal"):
        self.items.append(f'<text x="{p[0]:.1f}" y="{p[1]:.1f}" font-size="{size:g}" text-anchor="{anchor}" '
                          f'fill="{color}" font-weight="{weight}">{words}</text>')

    def arrow(self, a, b):
        """From a to b, to the right or downwards."""
        self.line(a, b, FAINT, 2)
        (x, y), across = b, a[1] == b[1]
        head = [(x, y), (x - 8, y - 4.5), (x - 8, y + 4.5)] if across else [(x, y), (x - 4.5, y - 8), (x + 4.5, y - 8)]
        self.polygon(head, FAINT, FAINT, 1)

    def save(self, path, title):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" '
                f'width="{self.width}" height="{self.height}" font-family="{FONT}" role="img">\n'
                f"<title>{title}</title>\n"
                f'<rect width="{self.width}" height="{self.height}" rx="8" fill="{PAPER}"/>\n')
        path.write_text(head + "\n".join(self.items) + "\n</svg>\n", encoding="utf-8")


class View:
    """Puts points in space onto a canvas: `middle` is where the origin goes, `scale` in pixels for each unit."""

    def __init__(self, canvas, middle, scale):
        self.canvas, self.middle, self.scale = canvas, middle, scale

    def place(self, p):
        x, y = seen(p)
        return self.middle[0] + self.scale * x, self.middle[1] + self.scale * y

    def faces_to_the_eye(self, cell):
        """(corners, light) of the faces of a tetrahedron that can be seen."""
        for face in FACES:
            a, b, c = (cell[i] for i in face)
            normal = cross(sub(b, a), sub(c, a))
            length = dot(normal, normal) ** 0.5
            if dot(normal, EYE) > 1e-9 * length:
                yield (a, b, c), 0.84 + 0.16 * max(0.0, dot(normal, LIGHT) / length)

    def edges(self, cell):
        """(seen, end, end) of the six edges of a tetrahedron."""
        near = [frozenset(corners) for corners, _ in self.faces_to_the_eye(cell)]
        for a, b in EDGES:
            yield any({cell[a], cell[b]} <= face for face in near), cell[a], cell[b]

    def glass(self, cell, fill=REGULAR):
        """A cell that can be looked through."""
        for is_seen, a, b in self.edges(cell):
            if not is_seen:
                self.canvas.line(self.place(a), self.place(b), FAINT, 1.2, "4 4")
        for corners, light in self.faces_to_the_eye(cell):
            self.canvas.polygon([self.place(p) for p in corners], shade(fill, light), INK, 1.6, 0.55)

    def solid(self, cell, fill, width=1.2):
        for corners, light in self.faces_to_the_eye(cell):
            self.canvas.polygon([self.place(p) for p in corners], shade(fill, light), INK, width)

    def dots(self, points, radius=5.0):
        for p in points:
            self.canvas.dot(self.place(p), radius=radius)


def is_behind(p, q):
    """Whether the tetrahedron p can be drawn before q: a plane of a face of either parts them, with q to the eye."""
    for t in (p, q):
        for a, b, c in FACES:
            normal = cross(sub(t[b], t[a]), sub(t[c], t[a]))
            of_p, of_q = [dot(normal, x) for x in p], [dot(normal, x) for x in q]
            gap = 1e-9 * max(map(abs, of_p + of_q), default=1)
            towards = dot(normal, EYE)
            if (max(of_p) <= min(of_q) + gap and towards >= 0) or (max(of_q) <= min(of_p) + gap and towards <= 0):
                return True
    return False


def from_behind(cells):
    """Indices of the tetrahedra, those behind first."""
    left, order = list(range(len(cells))), []
    while left:
        free = [i for i in left if all(is_behind(cells[i], cells[k]) for k in left if k != i)]
        order.append(free[0] if free else left[0])
        left.remove(order[-1])
    return order


def exploded(cells, factor):
    """The cells moved away from their common middle."""
    corners = [p for cell in cells for p in cell]
    middle = tuple(sum(p[k] for p in corners) / len(corners) for k in range(3))
    moved = []
    for cell in cells:
        centroid = tuple(sum(p[k] for p in cell) / 4 for k in range(3))
        step = tuple(factor * (c - m) for c, m in zip(centroid, middle))
        moved.append(tuple(tuple(x + s for x, s in zip(p, step)) for p in cell))
    return moved
