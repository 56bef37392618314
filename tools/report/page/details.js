// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of what was picked.
"use strict";

function vectorOf(a, b) { return [b[0] - a[0], b[1] - a[1], b[2] - a[2]]; }
function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }
function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
function norm(a) { return Math.sqrt(dot(a, a)); }

function withUnit(value, unit) { return shortNumber(value) + (unit ? ` ${unit}` : ""); }

// Values of all columns at an element, and the mean over its nodes of the nodal ones.
async function columnLines(data, elements, index, nodes) {
  const lines = [];
  for (const {name} of data.view[elements].columns) {
    const column = await data.column(elements, name);
    lines.push([name, withUnit(column.values[index], column.unit)]);
  }
  for (const {name} of data.view.nodes.columns) {
    const column = await data.column("nodes", name);
    const mean = nodes.reduce((sum, node) => sum + column.values[node], 0) / nodes.length;
    lines.push([`${name}, mean of nodes`, withUnit(Number(mean.toPrecision(5)), column.unit)]);
  }
  return lines;
}

function nodeLines(data, nodes) {
  const text = (node) => data.position(node).map((x) => shortNumber(x)).join(" ") + (data.unit && ` ${data.unit}`);
  return nodes.map((node) => [`node ${data.nodeNumber[node]}`, text(node)]);
}

async function faceLines(data, face) {
  const nodes = [...data.faceNode.subarray(3 * face, 3 * face + 3)], [a, b, c] = nodes.map((n) => data.position(n));
  const patch = data.view.patches[data.facePatch[face]], unit = data.unit;
  const area = norm(cross(vectorOf(a, b), vectorOf(a, c))) / 2;
  return [
    ["mesh", data.numbers.file],
    ["patch", patch.name + (patch.kind ? ` (${patch.kind})` : "")],
    ["surface", patch.surface || "none"],
    ["cell behind", String(data.faceCell[face])],
    ["area", withUnit(area, unit && `${unit}²`)],
    ...await columnLines(data, "faces", face, nodes),
    ...nodeLines(data, nodes),
  ];
}

async function cellLines(data, cell) {
  const nodes = [...data.cellNode.subarray(4 * cell, 4 * cell + 4)], points = nodes.map((n) => data.position(n));
  const [u, v, w] = [1, 2, 3].map((i) => vectorOf(points[0], points[i])), unit = data.unit;
  return [
    ["mesh", data.numbers.file],
    ["volume", withUnit(dot(cross(u, v), w) / 6, unit && `${unit}³`)],
    ...await columnLines(data, "cells", cell, nodes),
    ...nodeLines(data, nodes),
  ];
}

async function showDetails(element, picked) {
  if (!picked) {
    element.replaceChildren();
    addText(element, "p", "Click on a triangle or on a section to see its numbers.", "note");
    return;
  }
  const {data} = picked.scene;
  const lines = await (picked.kind === "face" ? faceLines : cellLines)(data, picked.index);
  element.replaceChildren();
  addText(element, "h3", picked.kind === "face" ? "Boundary triangle" : `Cell ${data.cellNumber[picked.index]}`);
  const list = addText(element, "dl", "");
  for (const [name, value] of lines) {
    addText(list, "dt", name.replaceAll("_", " "));
    addText(list, "dd", value);
  }
}
