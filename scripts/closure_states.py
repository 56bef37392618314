#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Enumerates the closure families: all ways to cut a tetrahedron whose marked edges have a node in the middle.

Usage: closure_states.py [--check] ROOT
Writes lib/pamr/mesh/closure_state_table.hpp and lib/pamr/mesh/family_size_table.hpp under ROOT; with --check it writes
nothing, and its exit code is 1 when they are not what it would write.

Nodes have codes: 0 to 3 the corners, 4 + e the midpoint of edge e. A face with three marks is cut into four, one with two
in both ways, and inside there are no nodes but these. All arithmetic is on integers.
"""
import itertools
import pathlib
import sys

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
# Four times generic corners, so that midpoints are integers.
CORNERS = ((0, 0, 0), (52, 4, 8), (12, 68, 4), (8, 20, 44))
FACE_EDGES = tuple(tuple(e for e in range(6) if face not in EDGES[e]) for face in range(4))


def corners_of(code):
    """The corners that a node is the mean of."""
    return (code,) if code < 4 else EDGES[code - 4]


def position(code):
    of = corners_of(code)
    return tuple(sum(CORNERS[c][k] for c in of) // len(of) for k in range(3))


POSITION = [position(code) for code in range(10)]


def volume(nodes):
    """Six volumes, with the sign of the orientation."""
    (a, b, c) = ([p - q for p, q in zip(POSITION[n], POSITION[nodes[0]])] for n in nodes[1:])
    return (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]))


def faces_with(nodes):
    """The faces of the parent that all of these nodes lie on."""
    return [f for f in range(4) if all(f not in corners_of(n) for n in nodes)]


def triangles_of(face, mask, cut):
    """The triangles of a face with these marks; `cut`: from the second of two marked edges."""
    corners = [c for c in range(4) if c != face]
    marked = [e for e in FACE_EDGES[face] if mask >> e & 1]
    if not marked:
        return [corners]
    if len(marked) == 3:
        return [[4 + e for e in marked]] + [[c] + [4 + e for e in marked if c in EDGES[e]] for c in corners]
    cut_edge = marked[cut]
    apex = next(c for c in corners if c not in EDGES[cut_edge])
    triangles = [[end, 4 + cut_edge, apex] for end in EDGES[cut_edge]]
    if len(marked) == 1:
        return triangles
    other = marked[1 - cut]
    (end,) = set(EDGES[cut_edge]) & set(EDGES[other])
    return [[end, 4 + cut_edge, 4 + other], [4 + cut_edge, 4 + other, apex]] + [t for t in triangles if t[0] != end]


def has_choice(face, mask):
    return sum(mask >> e & 1 for e in FACE_EDGES[face]) == 2


def triangulations(mask, boundary):
    """All sets of cells that fill the parent and have this boundary, by an advancing front."""
    nodes = list(range(4)) + [4 + e for e in range(6) if mask >> e & 1]
    at_triangle = {}
    for cell in itertools.combinations(nodes, 4):
        sides = [(frozenset(cell) - {n}, n) for n in cell]
        if volume(cell) != 0 and all(t in boundary for t, _ in sides if faces_with(t)):
            for triangle, apex in sides:
                at_triangle.setdefault(triangle, []).append((cell, apex))
    side_of = lambda triangle, node: volume(sorted(triangle) + [node]) > 0
    whole = abs(volume((0, 1, 2, 3)))
    found = set()

    def advance(front, cells, filled):
        if not front:
            if filled == whole:
                found.add(frozenset(cells))
            return
        triangle, side = min(front, key=lambda entry: (sorted(entry[0]), entry[1]))
        for cell, apex in at_triangle.get(triangle, ()):
            if side_of(triangle, apex) != side or cell in cells or filled + abs(volume(cell)) > whole:
                continue
            rest, fits = set(front), True
            for node in cell:
                t = frozenset(cell) - {node}
                inner = side_of(t, node)
                if (t, inner) in rest:
                    rest.remove((t, inner))
                elif t in boundary or (t, not inner) in rest:
                    fits = False
                else:
                    rest.add((t, not inner))
            if fits:
                advance(rest, cells | {cell}, filled + abs(volume(cell)))

    advance({(t, side_of(t, faces_with(t)[0])) for t in boundary}, frozenset(), 0)
    return found


def inner_edge(cells):
    """The edge of the smaller number whose midpoint is joined to that of the opposite edge, or -1."""
    for d in range(3):
        if any(4 + d in cell and 9 - d in cell for cell in cells):
            return d
    return -1


def oriented(cell):
    cell = sorted(cell)
    return cell if volume(cell) > 0 else [cell[0], cell[1], cell[3], cell[2]]


def new_states():
    """(marks, cuts, inner edge, children) of all states but those of 1:2, 1:4 and 1:8, in the order of the file format."""
    old = {0, 63} | {1 << e for e in range(6)} | {sum(1 << e for e in edges) for edges in FACE_EDGES}
    for mask in range(64):
        if mask in old:
            continue
        for cut in itertools.product(*((0, 1) if has_choice(f, mask) else (0,) for f in range(4))):
            boundary = {frozenset(t) for f in range(4) for t in triangles_of(f, mask, cut[f])}
            for cells in sorted(triangulations(mask, boundary), key=inner_edge):
                cuts = sum(bit << f for f, bit in enumerate(cut))
                yield mask, cuts, inner_edge(cells), [oriented(cell) for cell in sorted(cells)]


def old_states():
    """Those of 1:2 and 1:4, whose children keep the slots of the parent's corners."""
    for e, (i, j) in enumerate(EDGES):
        yield 1 << e, 0, -1, [[4 + e if c == end else c for c in range(4)] for end in (j, i)]
    for f, edges in enumerate(FACE_EDGES):
        middle = {EDGES[e]: 4 + e for e in edges}
        of = lambda a, b: middle[min(a, b), max(a, b)]
        corners = [c for c in range(4) if c != f]
        children = [[c if c in (k, f) else of(k, c) for c in range(4)] for k in corners]
        children.append([f if c == f else of(*(o for o in corners if o != c)) for c in range(4)])
        yield sum(1 << e for e in edges), 0, -1, children


HEAD = """// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

// Made by scripts/closure_states.py: do not edit.
// clang-format off
"""


def state_table(states):
    rows = "".join(f'    {{{mask}, {cuts}, {inner}, "{" ".join("".join(map(str, c)) for c in cells)}"}},\n'
                   for mask, cuts, inner, cells in states)
    return HEAD + f"""namespace pamr::mesh::detail {{

/// How a closure family cuts its parent: the marked edges; bit f where face f, which has two marks, is cut from the one of
/// the larger number; the inner edge, from the midpoint of that edge to that of the opposite one, or -1; the node codes
/// of each child.
struct ClosureRow {{
  std::uint8_t mask;
  std::uint8_t cuts;
  std::int8_t inner_edge;
  const char* children;
}};

/// By state.
inline constexpr std::array<ClosureRow, {len(states)}> closure_rows{{{{
{rows}}}}};

}}  // namespace pamr::mesh::detail
"""


def size_table(states):
    sizes = [str(len(cells)) for _, _, _, cells in states]
    lines = "".join("    " + ", ".join(sizes[i:i + 36]) + ",\n" for i in range(0, len(sizes), 36))
    return HEAD + f"""namespace pamr::mesh::detail {{

/// Cells of a family by its state.
inline constexpr std::array<std::uint8_t, {len(states)}> family_sizes{{
{lines}}};

}}  // namespace pamr::mesh::detail
"""


def main(arguments):
    states = [(0, 0, -1, [[0, 1, 2, 3]])] + list(old_states()) + list(new_states())
    folder = pathlib.Path(arguments[-1]) / "lib/pamr/mesh"
    files = {folder / "closure_state_table.hpp": state_table(states), folder / "family_size_table.hpp": size_table(states)}
    if "--check" not in arguments:
        for path, text in files.items():
            path.write_text(text)
        return 0
    stale = [path.name for path, text in files.items() if not path.exists() or path.read_text() != text]
    print("\n".join(f"{name}: not what scripts/closure_states.py writes" for name in stale) or f"{len(states)} states")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
