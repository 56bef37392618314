# SPDX-License-Identifier: GPL-3.0-or-later
"""Tetrahedra and their splits, for the drawings: every conforming triangulation of a cell whose marked edges are halved.

Corners are 0 to 3, edges and faces are numbered as in lib/pamr/mesh/tet.hpp: face i is opposite corner i.
"""
import itertools
import math

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # counter-clockwise seen from outside
SIMPLE = ((0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2))  # doubled, so that midpoints are whole numbers


def edge_number(a, b):
    return EDGES.index((min(a, b), max(a, b)))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def midpoint(a, b):
    return tuple((x + y) / 2 for x, y in zip(a, b))


def six_volumes(p):
    return dot(cross(sub(p[1], p[0]), sub(p[2], p[0])), sub(p[3], p[0]))


def mean_ratio(p):
    """12 (3V)^(2/3) / sum of squared edges: 1 for a regular tetrahedron."""
    squares = sum(dot(sub(p[b], p[a]), sub(p[b], p[a])) for a, b in EDGES)
    return 12 * (abs(six_volumes(p)) / 2) ** (2 / 3) / squares


def node(code):
    """Position in the simple cell of a corner (0 to 3) or of the midpoint of edge e (4 + e)."""
    if code < 4:
        return SIMPLE[code]
    a, b = EDGES[code - 4]
    return tuple((x + y) // 2 for x, y in zip(SIMPLE[a], SIMPLE[b]))


def face_cuts(face, marks, first_cut):
    """Triangles of a face, counter-clockwise from outside. `first_cut` chooses for a face with two marks: from the
    midpoint of its first marked edge to the far corner, or from that of the second."""
    a, b, c = FACES[face]
    marked = [edge_number(*pair) in marks for pair in ((a, b), (b, c), (c, a))]
    while marked not in ([False] * 3, [True, False, False], [True, False, True], [True] * 3):
        a, b, c = b, c, a
        marked = marked[1:] + marked[:1]
    ab, bc, ca = (4 + edge_number(*pair) for pair in ((a, b), (b, c), (c, a)))
    if not any(marked):
        return [(a, b, c)]
    if all(marked):
        return [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    if marked == [True, False, False]:
        return [(a, ab, c), (ab, b, c)]
    from_ab = (min(ab, ca) == ab) == first_cut
    return [(a, ab, ca)] + ([(ab, b, c), (ab, c, ca)] if from_ab else [(ab, b, ca), (b, c, ca)])


def are_apart(p, q):
    """Whether the interiors of two tetrahedra of whole-numbered points are disjoint: a plane between them exists."""
    axes = [cross(sub(t[b], t[a]), sub(t[c], t[a])) for t in (p, q) for a, b, c in FACES]
    axes += [cross(sub(p[b], p[a]), sub(q[d], q[c])) for a, b in EDGES for c, d in EDGES]
    for axis in axes:
        if axis != (0, 0, 0):
            of_p, of_q = [dot(axis, x) for x in p], [dot(axis, x) for x in q]
            if max(of_p) <= min(of_q) or max(of_q) <= min(of_p):
                return True
    return False


def triangulations(marks):
    """All triangulations of a cell by its corners and the midpoints of the marked edges: {cuts of its two-mark faces:
    [list of cells]}. A face with three marks is cut as 1:8 cuts it."""
    codes = list(range(4)) + [4 + e for e in sorted(marks)]
    at = {code: node(code) for code in codes}
    cells = []
    for four in itertools.combinations(codes, 4):
        volume = six_volumes([at[c] for c in four])
        if volume != 0:
            cells.append(four if volume > 0 else (four[1], four[0]) + four[2:])
    two_marks = [f for f in range(4) if sum(edge_number(a, b) in marks for a, b in
                                            itertools.combinations(FACES[f], 2)) == 2]
    found = {}
    for choice in itertools.product((True, False), repeat=len(two_marks)):
        first_cut = dict(zip(two_marks, choice))
        front = {t for f in range(4) for t in map(turned, face_cuts(f, marks, first_cut.get(f, True)))}
        found[tuple(sorted(first_cut.items()))] = list(fill(front, [], cells, at))
    return found


def turned(triangle):
    """The same oriented triangle with its smallest node first."""
    i = triangle.index(min(triangle))
    return triangle[i:] + triangle[:i]


def fill(front, chosen, cells, at):
    """Completes a triangulation: `front` holds the triangles, seen from outside, behind which nothing is yet."""
    if not front:
        yield sorted(chosen)
        return
    triangle = min(front)
    for cell in cells:
        faces = {turned(tuple(cell[i] for i in f)) for f in FACES}
        if triangle not in faces:
            continue
        points = [at[c] for c in cell]
        if all(are_apart(points, [at[c] for c in other]) for other in chosen):
            inside = {turned((f[0], f[2], f[1])) for f in faces - front}
            yield from fill((front - faces) | inside, chosen + [cell], cells, at)


def longer_cuts(corners, marks):
    """The cuts of two-mark faces of a real cell: from the midpoint of the longer marked edge."""
    cuts = {}
    for f in range(4):
        marked = sorted(e for e in marks if f not in EDGES[e])
        if len(marked) == 2:
            first, second = (math.dist(corners[EDGES[e][0]], corners[EDGES[e][1]]) for e in marked)
            cuts[f] = first >= second
    return tuple(sorted(cuts.items()))


def split(corners, marks):
    """Children of a real cell, each as four points: of the triangulations with the right cuts the one whose worst mean
    ratio is best."""
    if not marks:
        return [tuple(corners)]
    at = list(corners) + [midpoint(corners[a], corners[b]) for a, b in EDGES]
    made = [[tuple(at[c] for c in cell) for cell in cells]
            for cells in triangulations(frozenset(marks))[longer_cuts(corners, marks)]]
    return max(made, key=lambda children: min(map(mean_ratio, children)))
