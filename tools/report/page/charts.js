// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms and cumulative curves of the metrics, all meshes in one chart.
"use strict";

const METRICS = ["mean_ratio", "radius_ratio", "aspect_ratio", "edge_ratio", "min_dihedral", "max_dihedral"];

function styleValue(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

// Edges of the bins, and for each mesh the part of its cells in a bin and that below an edge, in percent.
function curvesOf(meshes, metric, isLog) {
  const edges = meshes[0][metric].histogram.edges;
  const curves = [edges];
  for (const mesh of meshes) {
    const counts = mesh[metric].histogram.counts, all = Math.max(mesh.cells, 1);
    const parts = counts.map((count) => count === 0 && isLog ? null : 100 * count / all);
    let below = 0;
    curves.push([...parts, parts[parts.length - 1]]);
    curves.push([0, ...counts.map((count) => (below += count, 100 * below / all))]);
  }
  return curves;
}

function axis(extra) {
  return {stroke: styleValue("--soft"), grid: {stroke: styleValue("--line"), width: 1}, ticks: {show: false}, ...extra};
}

function sizeIn(box) { return {width: Math.max(box.clientWidth - 14, 320), height: 230}; }

// As wide as its box, also when the window gets another width.
function chartIn(box, options, data) {
  const chart = new uPlot({...options, ...sizeIn(box)}, data, box);
  new ResizeObserver(() => { if (sizeIn(box).width !== chart.width) chart.setSize(sizeIn(box)); }).observe(box);
  return chart;
}

function drawChart(parent, meshes, metric, isLog) {
  const colors = styleValue("--series").split(",").map((color) => color.trim());
  const isRatio = metric === "aspect_ratio" || metric === "edge_ratio";
  const series = [{label: metric.replace("_", " "), value: (u, x) => x === null ? "" : shortNumber(x)}];
  meshes.forEach((mesh, i) => {
    const stroke = colors[i % colors.length];
    const percent = (u, y) => y === null || y === undefined ? "" : `${shortNumber(Number(y.toPrecision(4)))} %`;
    series.push({label: mesh.file, stroke, fill: meshes.length === 1 ? stroke + "33" : undefined, width: 1.5,
      paths: uPlot.paths.stepped({align: 1}), points: {show: false}, value: percent});
    series.push({label: "cumulative", scale: "sum", stroke, dash: [5, 4], width: 1, points: {show: false},
      value: percent});
  });
  const box = addText(parent, "div", "", "chart");
  return chartIn(box, {
    title: `${metric.replace("_", " ")}: cells and cumulative, percent`, series,
    scales: {
      x: {time: false, distr: isRatio ? 3 : 1, range: (u, min, max) => [min, max]},
      y: isLog ? {distr: 3} : {range: (u, min, max) => [0, max * 1.05 || 1]},
      sum: {range: [0, 100]},
    },
    axes: [axis({size: 30}), axis({size: 48}), axis({scale: "sum", side: 1, size: 40, grid: {show: false}})],
  }, curvesOf(meshes, metric, isLog));
}

function drawCharts(parent, meshes, isLog) {
  parent.replaceChildren();
  for (const metric of METRICS) drawChart(parent, meshes, metric, isLog);
}

// Cells and the worst cell from mesh to mesh.
function drawHistory(parent, meshes) {
  parent.replaceChildren();
  if (meshes.length < 2) return;
  const colors = styleValue("--series").split(",").map((color) => color.trim());
  const box = addText(parent, "div", "", "chart");
  const label = (u, i) => meshes[i] ? meshes[i].file : "";
  return chartIn(box, {
    title: "Cells (left) and worst mean ratio (right), mesh by mesh",
    series: [
      {label: "mesh", value: label},
      {label: "cells", stroke: colors[0], width: 1.5},
      {label: "worst mean ratio", scale: "ratio", stroke: colors[1], width: 1.5, dash: [5, 4]},
    ],
    scales: {x: {time: false, range: [-0.2, meshes.length - 0.8]}, y: {distr: 3}, ratio: {range: [0, 1]}},
    axes: [
      axis({size: 30, splits: () => meshes.map((_, i) => i), values: (u, places) => places.map((i) => label(u, i))}),
      axis({size: 70}), axis({scale: "ratio", side: 1, size: 40, grid: {show: false}}),
    ],
  }, [meshes.map((_, i) => i), meshes.map((mesh) => mesh.cells), meshes.map((mesh) => mesh.mean_ratio.min)]);
}
