// SPDX-License-Identifier: GPL-3.0-or-later
// Reads what pack.cpp wrote: base 64, deflated, bytes of the numbers plane by plane.
"use strict";

// Constants of html_report.cpp.
const {TET_EDGES, TET_FACES, PATCH_COLORS, LEVEL_COLORS, FIRST} = JSON.parse(
  document.querySelector("script.constants").textContent);

async function inflated(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// The first byte says how many planes follow.
function planesOf(bytes) {
  const count = bytes[0];
  const length = count === 0 ? 0 : (bytes.length - 1) / count;
  return {count, length, at: (plane, i) => bytes[1 + plane * length + i]};
}

// Integers up to 2^53. `length` is known beforehand, because zeros alone need no plane. Indices and parts fit 32 bits.
async function unpackIntegers(base64, length, Kind = Float64Array) {
  const planes = planesOf(await inflated(base64));
  const result = new Kind(length);
  if (planes.count === 0) return result;
  let last = 0;
  if (planes.count <= 3) {
    for (let i = 0; i < length; ++i) {
      let code = planes.at(0, i);
      if (planes.count > 1) code |= planes.at(1, i) << 8;
      if (planes.count > 2) code |= planes.at(2, i) << 16;
      last += code & 1 ? -((code + 1) >>> 1) : code >>> 1;
      result[i] = last;
    }
    return result;
  }
  for (let i = 0; i < length; ++i) {
    let code = 0;
    for (let plane = planes.count - 1; plane >= 0; --plane) code = code * 256 + planes.at(plane, i);
    last += code % 2 === 1 ? -(code + 1) / 2 : code / 2;
    result[i] = last;
  }
  return result;
}

async function unpackReals(base64, length) {
  const planes = planesOf(await inflated(base64));
  const bits = new Uint32Array(length);
  for (let plane = 0; plane < planes.count; ++plane)
    for (let i = 0; i < length; ++i) bits[i] |= planes.at(plane, i) << (8 * plane + 8);
  return new Float32Array(bits.buffer);
}

// One mesh of the report: numbers of the view, decoded; values of its columns when they are asked for.
class MeshData {
  static async read(view, numbers) {
    const data = new MeshData();
    data.view = view;
    data.numbers = numbers;
    data.unit = view.unit === "1" ? "" : view.unit;
    data.nNodes = view.n_nodes;
    data.nFaces = view.n_faces;
    data.nCells = view.n_cells;
    data.nodeNumber = await unpackIntegers(view.nodes.number, data.nNodes);
    data.faceNode = await unpackIntegers(view.faces.node, 3 * data.nFaces, Int32Array);
    data.faceCell = await unpackIntegers(view.faces.cell, data.nFaces);
    data.facePatch = await unpackIntegers(view.faces.patch, data.nFaces, Int32Array);
    data.cellNumber = await unpackIntegers(view.cells.number, data.nCells);
    data.cellNode = await unpackIntegers(view.cells.node, 4 * data.nCells, Int32Array);
    data.axes = [];
    for (const axis of view.nodes.position) data.axes.push(await unpackIntegers(axis, data.nNodes, Int32Array));
    data.columns = new Map();
    return data;
  }

  coordinate(node, d) {
    const [low, high] = this.view.box;
    return low[d] + this.axes[d][node] / 0xffffff * (high[d] - low[d]);
  }

  position(node) { return [0, 1, 2].map((d) => this.coordinate(node, d)); }

  // Where a cell lies in the view, or -1. The numbers ascend.
  cellIndex(number) {
    let low = 0, high = this.nCells;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.cellNumber[middle] < number) low = middle + 1;
      else high = middle;
    }
    return low < this.nCells && this.cellNumber[low] === number ? low : -1;
  }

  // The cell of the view whose middle is nearest to a position, or -1.
  cellNear(position) {
    const [low, high] = this.view.box, at = position.map((x, d) => (x - low[d]) / (high[d] - low[d]) * 0xffffff);
    const size = low.map((x, d) => high[d] - x);
    let best = -1, least = Infinity;
    for (let cell = 0; cell < this.nCells; ++cell) {
      let squared = 0;
      for (let d = 0; d < 3; ++d) {
        const axis = this.axes[d];
        let middle = 0;
        for (let i = 0; i < 4; ++i) middle += axis[this.cellNode[4 * cell + i]] / 4;
        squared += ((middle - at[d]) * size[d]) ** 2;
      }
      if (squared < least) [best, least] = [cell, squared];
    }
    return best;
  }

  middleOf(nodes) {
    const points = [...nodes].map((node) => this.position(node));
    return [0, 1, 2].map((d) => points.reduce((sum, point) => sum + point[d], 0) / points.length);
  }

  nodesOfCell(cell) { return this.cellNode.subarray(4 * cell, 4 * cell + 4); }

  // Values of a column of "nodes", "cells" or "faces", or null.
  async column(elements, name) {
    const key = elements + " " + name;
    if (!this.columns.has(key)) {
      const packed = this.view[elements].columns.find((column) => column.name === name);
      const length = {nodes: this.nNodes, cells: this.nCells, faces: this.nFaces}[elements];
      const unpack = packed && (packed.integer ? unpackIntegers : unpackReals);
      this.columns.set(key, packed ? {...packed, data: null, unit: packed.unit === "1" ? "" : packed.unit, values: await unpack(packed.data, length)} : null);
    }
    return this.columns.get(key);
  }
}
