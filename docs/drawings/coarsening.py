# SPDX-License-Identifier: GPL-3.0-or-later
"""Refining and coarsening in one call (docs/coarsening.md), in the plane: triangles instead of tetrahedra, 1:4 for 1:8."""
import math
from dataclasses import dataclass

UNIT = 96  # side of a square of level 0; corners of all levels are whole numbers
COLUMNS, ROWS = 5, 3
RADIUS = 92


def middle(a, b):
    return (a[0] + b[0]) // 2, (a[1] + b[1]) // 2


def edges(cell):
    return [(cell[i - 2], cell[i - 1]) for i in range(3)]  # opposite corner i


def children(cell):
    a, b, c = cell
    ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
    return [(a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab)]


def roots():
    cells = []
    for i in range(COLUMNS):
        for j in range(ROWS):
            a, b, c, d = [(UNIT * (i + x), UNIT * (j + y)) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
            cells += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return cells


def leaves(splits):
    """The base cells: what the cells of level 0 become when these are split."""
    found, left = [], roots()
    while left:
        cell = left.pop()
        if cell in splits:
            left += children(cell)
        else:
            found.append(cell)
    return found


def close(splits):
    """The fewest splits that hold these, with at most two marks in a base cell and none inside its edges."""
    splits = set(splits)
    while True:
        base = leaves(splits)
        nodes = {p for cell in base for p in cell}
        more = {cell for cell in base
                if all(middle(*e) in nodes for e in edges(cell))
                or any(middle(middle(a, b), end) in nodes for a, b in edges(cell) for end in (a, b))}
        if not more:
            return splits
        splits |= more


def length(edge):
    return math.dist(*edge), sorted(edge)


def closed(splits):
    """(cell, whether it is a closure cell, its base cell) of the mesh with these splits."""
    base = leaves(splits)
    nodes = {p for cell in base for p in cell}
    cells = []
    for cell in base:
        marked = [i for i, e in enumerate(edges(cell)) if middle(*e) in nodes]
        if not marked:
            cells.append((cell, False, cell))
        elif len(marked) == 1:
            (a, b), tip = edges(cell)[marked[0]], cell[marked[0]]
            m = middle(a, b)
            cells += [((a, m, tip), True, cell), ((m, b, tip), True, cell)]
        else:
            longer, other = sorted(marked, key=lambda i: length(edges(cell)[i]), reverse=True)
            end = cell[3 - longer - other]  # on both edges
            third, far = cell[longer], cell[other]
            m, n = middle(*edges(cell)[longer]), middle(*edges(cell)[other])
            cells += [((end, m, n), True, cell), ((m, third, n), True, cell), ((m, far, third), True, cell)]
    return cells


def is_cut(cell, center):
    r = [math.dist(p, center) for p in cell]
    return min(r) < RADIUS < max(r)


def is_near(cell, center):
    middle_of = tuple(sum(p[k] for p in cell) / 3 for k in range(2))
    return abs(math.dist(middle_of, center) - RADIUS) < 0.3 * UNIT


def level(cell):
    return round(math.log2(UNIT / max(abs(a[0] - b[0]) + abs(a[1] - b[1]) for a, b in edges(cell) if a[0] == b[0]
                                      or a[1] == b[1])))


@dataclass
class Step:
    before: list  # (cell, is closure, base cell)
    split: set    # base cells that are to be split
    go: set       # base cells that may be coarsened
    after: list
    gone: set     # parents that are cells again, or closed anew
    kept: set     # base cells that may be coarsened and stay


def step():
    """A front that moves to the right."""
    old, new = (1.75 * UNIT, 1.5 * UNIT), (2.75 * UNIT, 1.5 * UNIT)
    splits = set()
    for _ in range(2):
        splits = close(splits | {cell for cell in leaves(splits) if is_cut(cell, old) and level(cell) < 2})
    base = leaves(splits)
    split = {cell for cell in base if is_cut(cell, new) and level(cell) < 2}
    go = {cell for cell in base if level(cell) > 0 and cell not in split and not is_near(cell, new)}
    candidates = {cell for cell in splits if all(child in go for child in children(cell))}
    after = close((splits - candidates) | split)
    gone = candidates - after
    kept = go - {child for cell in gone for child in children(cell)}
    return Step(closed(splits), split, go, closed(after), gone, kept)
