# SPDX-License-Identifier: GPL-3.0-or-later
"""The four ways to refine a closure family again (docs/refinement.md, "Quality control"), on one family."""
import math
from dataclasses import dataclass, field

from splits import EDGES, mean_ratio, midpoint, split

POLICIES = ("none", "isotropic", "short-edge", "removable")
FACE_EDGES = tuple(frozenset(e for e in range(6) if face not in EDGES[e]) for face in range(4))
ALL = frozenset(range(6))


def stretched_cell():
    """A regular tetrahedron about the origin, corner 1 in front and 3 on top, stretched: no edges of a face tie."""
    radius = 1.28
    angles = [math.radians(a) for a in (168, 288, 48)]
    low, high = -radius * math.sqrt(2) / 4, radius * math.sqrt(2) * 3 / 4
    return tuple((1.12 * radius * math.cos(a), radius * math.sin(a), low) for a in angles) + ((0.0, 0.0, high),)


CELL = stretched_cell()


@dataclass(frozen=True)
class Cell:
    corners: tuple
    is_closure: bool = False
    short: frozenset = frozenset()  # its edges that are halves of an edge of its parent

    def middle(self, edge):
        a, b = (self.corners[i] for i in EDGES[edge])
        return midpoint(*sorted((a, b)))

    def marked(self, marks):
        return frozenset(e for e in range(6) if self.middle(e) in marks)


@dataclass
class Mesh:
    cells: list
    marks: list = field(default_factory=list)  # to be drawn


def children_of(cell, marks):
    """The cells that a cell with these marked edges becomes."""
    if not marks:
        return [cell]
    halves = {cell.middle(e): {cell.corners[i] for i in EDGES[e]} for e in marks}
    children = []
    for corners in split(cell.corners, marks):
        short = frozenset(e for e in range(6) for m, ends in halves.items()
                          if {corners[i] for i in EDGES[e]} in [{m, end} for end in ends])
        children.append(Cell(corners, marks != ALL, short))
    return children


def legal(marks):
    """The smallest set that the templates 1:2, 1:4 and 1:8 know."""
    if len(marks) < 2:
        return marks
    return next((face for face in FACE_EDGES if marks <= face), ALL)


def better_face(cell, edge):
    faces = [face for face in FACE_EDGES if edge in face]
    return max(faces, key=lambda face: min(mean_ratio(child) for child in split(cell.corners, face)))


def required(cell, marks, policy):
    if policy == "isotropic" and cell.is_closure and marks:
        return ALL
    if policy == "short-edge":
        for edge in sorted(marks & cell.short):
            marks = marks | better_face(cell, edge)
    return legal(marks)


def split_further(cells, mark, policy):
    """What the cells become when closure cells are split like others, under the policies that do so."""
    marks = {mark}
    while True:
        grown = marks | {cell.middle(e) for cell in cells for e in required(cell, cell.marked(marks), policy)}
        if grown == marks:
            return [child for cell in cells for child in children_of(cell, cell.marked(marks))]
        marks = grown


def undo(parent, marks, mark):
    """What the family's parent becomes when it is restored first."""
    if mark in {parent.middle(e) for e in range(6)}:
        return children_of(parent, marks | parent.marked({mark}))
    return [grandchild for child in children_of(parent, ALL) for grandchild in children_of(child, child.marked({mark}))]


def row_of(number):
    """One family with its new mark, and what each policy makes of it."""
    parent = Cell(CELL)
    marks = (frozenset({4}), FACE_EDGES[2], frozenset({4}))[number]
    half = midpoint(parent.middle(4), parent.corners[1])
    mark = (half, half, parent.middle(3))[number]
    family = children_of(parent, marks)
    results = [split_further(family, mark, policy) for policy in POLICIES[:3]] + [undo(parent, marks, mark)]
    return [Mesh(family, [mark])] + [Mesh(cells) for cells in results]
