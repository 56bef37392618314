// SPDX-License-Identifier: GPL-3.0-or-later
// Sections of cells by a plane, and the cells around one. TET_EDGES and TET_FACES are the corners of a tetrahedron's edges
// and faces.
"use strict";

// Triangles of a section, three vertices each. A vertex lies between the nodes a and b, at the part w from a; `inner` is
// 1 + the corner of its triangle that lies opposite an edge inside of a cell, 0 when all edges are on the cell's surface.
class Section {
  constructor() { Object.assign(this, {a: [], b: [], w: [], inner: [], cell: []}); }

  add(cell, vertices, inner) {
    for (const [a, b, w] of vertices) {
      this.a.push(a);
      this.b.push(b);
      this.w.push(w);
      this.inner.push(inner);
    }
    this.cell.push(cell);
  }
}

// Cells cut by the plane on which axis `d` has the value `at`, in parts of the box (24 bits).
function sectionOf(data, d, at) {
  const x = data.axes[d], section = new Section();
  const side = [0, 0, 0, 0], node = [0, 0, 0, 0];
  for (let cell = 0; cell < data.nCells; ++cell) {
    let above = 0;
    for (let i = 0; i < 4; ++i) {
      node[i] = data.cellNode[4 * cell + i];
      side[i] = x[node[i]] - at;
      if (side[i] >= 0) ++above;
    }
    if (above === 0 || above === 4) continue;
    const points = [];
    for (const [i, k] of TET_EDGES)
      if (side[i] >= 0 !== side[k] >= 0)
        points.push({i, k, vertex: [node[i], node[k], side[i] / (side[i] - side[k])]});
    if (points.length === 3) {
      section.add(cell, points.map((point) => point.vertex), 0);
      continue;
    }
    // Points on opposite edges of the cell lie opposite each other in the quadrangle: 0 and 3, 1 and 2.
    const [p, q, r, s] = [points[0], points[1], points[3], points[2]].map((point) => point.vertex);
    section.add(cell, [p, q, r], 2);
    section.add(cell, [p, r, s], 3);
  }
  return section;
}

// Cells that share a node with a cell of the view, itself first.
function cellsAround(data, cell) {
  const nodes = new Set(data.cellNode.subarray(4 * cell, 4 * cell + 4));
  const around = [cell];
  for (let other = 0; other < data.nCells; ++other)
    for (let i = 0; i < 4; ++i)
      if (nodes.has(data.cellNode[4 * other + i])) {
        if (other !== cell) around.push(other);
        break;
      }
  return around;
}
