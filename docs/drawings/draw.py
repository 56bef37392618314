#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The drawings of the pages. Usage: draw.py [FOLDER]   (default: the folder of this script)"""
import math
import pathlib
import sys

import coarsening
import sketches
from canvas import CLOSURE, FAINT, INK, MARK, PARTS, REGULAR, Canvas, View, exploded, from_behind, seen
from policies import CELL, POLICIES, Mesh, row_of
from splits import EDGES, mean_ratio, midpoint, split


def draw_faces(path):
    """A face with 0 to 3 marks: how it is cut follows from them and, of two, from which marked edge is longer."""
    canvas = Canvas(900, 262)
    a, b, c = (10.0, 150.0), (160.0, 150.0), (62.0, 22.0)
    ab, bc, ca = midpoint(a, b), midpoint(b, c), midpoint(c, a)
    pictures = (
        ("no mark", "stays", [(a, b, c)], []),
        ("one mark", "two parts", [(a, ab, c), (ab, b, c)], [ab]),
        ("two marks", "three parts, cut from the midpoint of the longer marked edge",
         [(b, ab, bc), (a, ab, c), (ab, bc, c)], [ab, bc]),
        ("three marks", "four parts", [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)], [ab, bc, ca]),
    )
    for i, (name, parts, triangles, marks) in enumerate(pictures):
        left = 27 + 223 * i
        move = lambda p, left=left: (p[0] + left, p[1] + 14)
        for k, triangle in enumerate(triangles):
            canvas.polygon([move(p) for p in triangle], PARTS[k], INK, 1.6)
        for p in marks:
            canvas.dot(move(p), radius=5.5)
        canvas.text((left + 85, 194), name, 16, weight="bold")
        for row, words in enumerate(lines_of(parts, 26)):
            canvas.text((left + 85, 215 + 17 * row), words, 13.5)
    canvas.save(path, "Faces with no, one, two and three marks")


def lines_of(words, length):
    lines = [""]
    for word in words.split():
        if len(lines[-1]) + len(word) >= length:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def draw_splits(path, title, pictures):
    """Cells with their marks, and below each its children, moved apart."""
    width, scale = 300, 80
    canvas = Canvas(20 + width * len(pictures), 548)
    for i, (name, words, marks) in enumerate(pictures):
        x = 10 + width * (i + 0.5)
        above, below = View(canvas, (x, 142), scale), View(canvas, (x, 384), scale)
        above.glass(CELL)
        above.dots([midpoint(CELL[a], CELL[b]) for a, b in (EDGES[e] for e in marks)])
        for corner, p in enumerate(CELL):
            away = seen(p)
            length = math.hypot(*away)
            at = above.place(p)
            canvas.text((at[0] + 13 * away[0] / length, at[1] + 13 * away[1] / length + 5), str(corner), 13, color=FAINT)
        children = split(CELL, marks)
        apart = exploded(children, 0.5)
        for k in from_behind(apart):
            below.solid(apart[k], PARTS[k % len(PARTS)])
        canvas.arrow((x, 218), (x, 244))
        canvas.text((x, 504), name, 17, weight="bold")
        canvas.text((x, 527), words, 13.5)
    canvas.save(path, title)


def draw_policies(path):
    """What becomes of a closure family that has to be refined again, under each policy."""
    names = ("before",) + POLICIES
    rows = [row_of(k) for k in range(3)]
    width, height = 184, 196
    canvas = Canvas(20 + width * len(names), 66 + height * len(rows) + 34)
    for i, name in enumerate(names):
        canvas.text((10 + width * (i + 0.5), 32), name, 17, weight="bold")
    for r, meshes in enumerate(rows):
        for i, mesh in enumerate(meshes):
            view = View(canvas, (10 + width * (i + 0.5), 140 + height * r), 64)
            for k in from_behind([cell.corners for cell in mesh.cells]):
                cell = mesh.cells[k]
                view.solid(cell.corners, CLOSURE if cell.is_closure else REGULAR, 1.1)
            view.dots(mesh.marks, 4.5)
            worst = min(mean_ratio(cell.corners) for cell in mesh.cells)
            count = f"{len(mesh.cells)} cells, worst {worst:.2f}"
            canvas.text((10 + width * (i + 0.5), 208 + height * r), count, 13.5)
    y = 66 + height * len(rows) + 10
    legend = ((REGULAR, "regular cell"), (CLOSURE, "closure cell"))
    for i, (color, words) in enumerate(legend):
        x = 60 + 150 * i
        canvas.polygon([(x, y + 6), (x + 18, y + 6), (x + 18, y - 8), (x, y - 8)], color)
        canvas.text((x + 26, y + 4), words, 14, "start")
    canvas.dot((372, y - 1), MARK, 4.5)
    canvas.text((386, y + 4), "new mark; worst: smallest mean ratio", 14, "start")
    canvas.save(path, "A closure family that has to be refined again, under each policy")


def draw_coarsening(path):
    """A front moves to the right: what goes, what is split, and what comes of it."""
    step = coarsening.step()
    width, height = coarsening.UNIT * coarsening.COLUMNS, coarsening.UNIT * coarsening.ROWS
    canvas = Canvas(3 * 22 + 2 * width, height + 132)
    panels = (("before, with what is asked for", step.before), ("after", step.after))
    for i, (name, cells) in enumerate(panels):
        move = lambda p, left=22 + i * (22 + width): (p[0] + left, p[1] + 46)
        canvas.text(move((width / 2, -16)), name, 17, weight="bold")
        for corners, is_closure, base in cells:
            back = i == 1 and base in step.gone
            color = PARTS[2] if back else CLOSURE if is_closure else REGULAR
            canvas.polygon([move(p) for p in corners], color, INK, 1.1)
            if i == 1:
                continue
            middle = tuple(sum(p[k] for p in corners) / 3 for k in range(2))
            if base in step.split:
                canvas.dot(move(middle), radius=3.6)
            elif base in step.go:
                x, y = move(middle)
                canvas.line((x - 3, y), (x + 3, y), INK if base not in step.kept else MARK, 2)
    legend = ((REGULAR, "regular cell", 22), (CLOSURE, "closure cell", 172), (PARTS[2], "parent that is back", 318))
    y = height + 84
    for color, words, x in legend:
        canvas.polygon([(x, y + 6), (x + 18, y + 6), (x + 18, y - 8), (x, y - 8)], color)
        canvas.text((x + 26, y + 4), words, 14, "start")
    canvas.dot((530, y - 1), radius=3.6)
    canvas.text((542, y + 4), "is to be split", 14, "start")
    canvas.line((657, y - 1), (665, y - 1), INK, 2)
    canvas.text((674, y + 4), "flagged, coarsened", 14, "start")
    canvas.line((817, y - 1), (825, y - 1), MARK, 2)
    canvas.text((834, y + 4), "flagged, but stays", 14, "start")
    canvas.text((22, y + 34), "Triangles stand for tetrahedra: four children in place of eight. A closure cell speaks for its "
                "parent.", 14, "start", FAINT)
    canvas.save(path, "A mesh before and after a call that refines and coarsens")


OLD_SETS = (("one edge: 1:2", "two children", [4]), ("one face: 1:4", "four children", [0, 2, 4]),
            ("all edges: 1:8", "eight children, four at a diagonal", list(range(6))))
NEW_SETS = (("two edges of a face", "three children", [0, 4]), ("two opposite edges", "four children", [0, 5]),
            ("five edges", "seven children", [0, 1, 2, 3, 4]))


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__)
    folder = folder if folder.is_dir() else folder.parent
    draw_faces(folder / "faces.svg")
    draw_splits(folder / "splits.svg", "Cells split 1:2, 1:4 and 1:8", OLD_SETS)
    draw_splits(folder / "more-splits.svg", "Cells with two marks on a face, two opposite marks and five marks", NEW_SETS)
    draw_policies(folder / "quality-control.svg")
    draw_coarsening(folder / "coarsening.svg")
    sketches.draw_cone(folder / "blunt-cone.svg")
    sketches.draw_spheres(folder / "charged-spheres.svg")
    sketches.draw_ring(folder / "edge-ring.svg")


main()
