// SPDX-License-Identifier: GPL-3.0-or-later
// The page: what is shown, the controls, the keyboard, links such as #color=level;show=x;place=0.3;theme=dark.
"use strict";

const $ = (id) => document.getElementById(id);
const AXES = {x: 0, y: 1, z: 2};
const MANY_FACES = 300000;
const THEMES = ["auto", "light", "dark"];

const page = {
  meshes: [],   // {view, numbers} as read, and `data`, `scene` once shown
  shown: [],    // indices of meshes
  picture: null,
  around: null,   // {mesh, number, position} of the cell that the picture is about
  hidden: new Set(),  // names of patches
  busy: Promise.resolve(),
};

// Elements with data, which are dropped once read.
function takeData(kind) {
  return [...document.querySelectorAll(`script.${kind}`)].map((element) => {
    const value = JSON.parse(element.textContent);
    element.remove();
    return value;
  });
}

function diagonal([low, high]) { return norm(vectorOf(low, high)) || 1; }

async function sceneOf(mesh) {
  if (!mesh.scene) {
    mesh.data = await MeshData.read(mesh.view, mesh.numbers);
    const size = Math.max(...page.meshes.map(({view}) => diagonal(view.box)));
    mesh.scene = new MeshScene(mesh.data, size, page.picture.shared);
  }
  return mesh.scene;
}

function shownScenes() { return page.shown.map((i) => page.meshes[i].scene); }

// Columns that can be shown, patch first.
function columnNames() {
  const names = ["patch"];
  for (const {view} of page.meshes)
    for (const elements of ["faces", "nodes", "cells"])
      for (const {name} of view[elements].columns) if (!names.includes(name)) names.push(name);
  return names;
}

// Names of the patches of all meshes: meshes with other patches keep their colors.
function patchNames() { return [...new Set(page.meshes.flatMap(({view}) => view.patches.map((patch) => patch.name)))]; }

async function valuesOf(data, name) {
  if (name === "patch") {
    const number = data.view.patches.map((patch) => patchNames().indexOf(patch.name));
    return {faces: {values: data.facePatch.map((patch) => number[patch])}, cells: null, nodes: null};
  }
  const result = {};
  for (const elements of ["faces", "cells", "nodes"]) result[elements] = await data.column(elements, name);
  return result;
}

// The colors of what is shown, the same for all meshes side by side.
async function paint(keepsRange) {
  const name = $("color").value, all = [];
  for (const scene of shownScenes()) all.push({scene, columns: await valuesOf(scene.data, name)});
  const coloring = new Coloring(name.replaceAll("_", " "), "", null, null);
  if (name === "patch") {
    coloring.classes = PATCH_COLORS;
    coloring.labels = patchNames();
  }
  for (const {columns} of all)
    for (const column of Object.values(columns)) {
      if (!column) continue;
      coloring.unit = column.unit || coloring.unit;
      coloring.include(column.values);
    }
  if (name === "level") {
    coloring.classes = LEVEL_COLORS;
    coloring.labels = Array.from({length: Math.max(coloring.to, 0) + 1}, (_, level) => String(level));
  }
  for (const end of ["from", "to"]) {
    const given = Number($(end).value);
    if (keepsRange && $(end).value.trim() !== "" && Number.isFinite(given)) coloring[end] = given;
    else $(end).value = coloring.classes || !Number.isFinite(coloring[end]) ? "" : Number(coloring[end].toPrecision(6));
    $(end).disabled = coloring.classes !== null;
  }
  coloring.log = $("log").checked && !coloring.classes;
  for (const {scene, columns} of all)
    scene.paint(coloring, {
      faces: columns.faces && columns.faces.values, cells: columns.cells && columns.cells.values,
      nodes: columns.nodes && columns.nodes.values,
    }, scene.data.view.patches.map((patch) => page.hidden.has(patch.name)));
  setPalette(coloring.classes);
  drawLegend($("legend"), coloring);
  page.picture.draw();
}

function setPalette(classes) {
  const texture = new THREE.DataTexture(paletteBytes(classes), N_SHADES, 1);
  texture.magFilter = texture.minFilter = THREE.NearestFilter;
  texture.needsUpdate = true;
  if (page.picture.shared.palette.value) page.picture.shared.palette.value.dispose();
  page.picture.shared.palette.value = texture;
}

// Boundary, section or surroundings in each of the shown meshes.
function arrange() {
  const show = $("show").value, axis = show in AXES ? AXES[show] : null;
  const canMove = page.shown.some((i) => page.meshes[i].view.all_cells);
  $("place").disabled = axis === null || !canMove;
  for (const scene of shownScenes()) {
    const {view} = scene.data;
    scene.cut(axis, view.all_cells ? Number($("place").value) : 0.5);
    scene.showAround(show === "around" ? aroundCellOf(scene) : -1);
    scene.boundary.visible = !scene.around;
  }
}

// The cell that the surroundings are of; in other meshes the one nearest to it.
function aroundCellOf(scene) {
  const {data} = scene;
  if (!page.around) return data.view.worst.length ? data.cellIndex(data.view.worst[0]) : -1;
  return page.meshes[page.around.mesh].scene === scene ? data.cellIndex(page.around.number)
    : data.cellNear(page.around.position);
}

function describe() {
  const labels = $("labels");
  labels.replaceChildren();
  for (const panel of page.picture.panels()) {
    const {numbers} = panel.scene.data;
    const label = addText(labels, "div", `${numbers.file}: ${numbers.cells.toLocaleString("en-US")} cells`);
    Object.assign(label.style, {left: `${100 * panel.x}%`, top: `${100 * panel.y}%`, width: `${100 * panel.width}%`});
  }
  const remarks = [];
  for (const {data} of shownScenes()) {
    const {view, numbers} = data;
    if (!view.all_cells)
      remarks.push(`${numbers.file}: sections through the middle only, where the report has the cells` +
        (view.window < 1 ? ` (the inner ${shortNumber(100 * view.window)} % of the box).` : "."));
    if (view.merged) remarks.push(`${numbers.file}: near nodes of the boundary are drawn as one; the tables are of all.`);
    if (view.left_out.length) remarks.push(`${numbers.file}: not in this file: ${view.left_out.join(", ")}.`);
  }
  $("remarks").textContent = remarks.join(" ");
}

// One change of the picture after the other.
function change(action) {
  page.busy = page.busy.then(action);
  return page.busy;
}

async function showMeshes(indices) {
  page.shown = indices;
  page.picture.scenes = [];
  for (const i of indices) page.picture.scenes.push(await sceneOf(page.meshes[i]));
  document.querySelectorAll("#shown-meshes input").forEach((box, i) => { box.checked = indices.includes(i); });
  arrange();
  describe();
  await paint(false);
}

async function pick(picked) {
  for (const {scene} of page.meshes) if (scene) scene.mark(null);
  if (picked) {
    const {data} = picked.scene, {index} = picked;
    const nodes = picked.kind === "face" ? data.faceNode.subarray(3 * index, 3 * index + 3) : data.nodesOfCell(index);
    picked.scene.mark(nodes);
    if (picked.kind === "cell") setAround(picked.scene, index);
  }
  page.picture.draw();
  await showDetails($("picked"), picked);
}

function markRow(mesh, attribute, number) {
  document.querySelectorAll("tr.current").forEach((row) => row.classList.remove("current"));
  const row = document.querySelector(`tr[data-mesh="${mesh}"][data-${attribute}="${number}"]`);
  if (row) row.classList.add("current");
}

function setAround(scene, cell) {
  const {data} = scene, mesh = page.meshes.findIndex((m) => m.scene === scene);
  page.around = {mesh, number: data.cellNumber[cell], position: data.middleOf(data.nodesOfCell(cell))};
}

// Flies to a cell of the view and shows those around it.
async function flyToCell(mesh, number) {
  if (!page.shown.includes(mesh)) await showMeshes([mesh]);
  const {scene, data} = page.meshes[mesh], cell = data.cellIndex(number);
  if (cell < 0) return;
  setAround(scene, cell);
  $("show").value = "around";
  arrange();
  await paint(true);
  const {position} = page.around, corners = [...data.nodesOfCell(cell)].map((node) => data.position(node));
  const size = Math.max(...corners.map((corner) => norm(vectorOf(position, corner)))) / scene.size;
  page.picture.flyTo(scene.scenePoint(position), size);
  markRow(mesh, "cell", number);
  await pick({scene, kind: "cell", index: cell});
}

async function flyToNode(mesh, number, position) {
  if (!page.shown.includes(mesh)) await showMeshes([mesh]);
  $("show").value = "boundary";
  arrange();
  await paint(true);
  const scene = page.meshes[mesh].scene;
  page.picture.flyTo(scene.scenePoint(position), 0.05);
  const node = scene.data.nodeNumber.indexOf(number);
  scene.mark(node < 0 ? null : [node]);
  page.picture.draw();
  markRow(mesh, "node", number);
}

function nextWorst(step) {
  const isShown = page.around && page.shown.includes(page.around.mesh);
  const mesh = isShown ? page.around.mesh : page.shown[page.shown.length - 1];
  const {worst} = page.meshes[mesh].view;
  if (!worst.length) return;
  const now = page.around && page.around.mesh === mesh ? worst.indexOf(page.around.number) : step > 0 ? -1 : 0;
  change(() => flyToCell(mesh, worst[(now + step + worst.length) % worst.length]));
}

// Buttons in the rows of worst cells and of nodes off their surface.
function addRowButtons() {
  for (const row of document.querySelectorAll("tr[data-mesh]")) {
    const {mesh, cell, node, position} = row.dataset;
    const button = addText(addText(row, "td", ""), "button", "Show");
    button.type = "button";
    button.addEventListener("click", () => {
      $("view").scrollIntoView();
      change(() => cell !== undefined ? flyToCell(Number(mesh), Number(cell))
        : flyToNode(Number(mesh), Number(node), position.split(" ").map(Number)));
    });
  }
}

function setTheme(theme) {
  if (theme === "auto") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  $("theme").textContent = `Theme: ${theme}`;
  $("theme").dataset.theme = theme;
  applyTheme();
}

function applyTheme() {
  const numbers = page.meshes.map((mesh) => mesh.numbers);
  drawCharts($("charts"), numbers, $("log-counts").checked);
  drawHistory($("history"), numbers);
  if (!page.picture) return;
  page.picture.shared.ink.value = glColor(styleValue("--ink"));
  page.picture.draw();
}

function connectControls() {
  page.meshes.forEach((mesh, i) => {
    const label = addText($("shown-meshes"), "label", "");
    const box = document.createElement("input");
    box.type = "checkbox";
    label.append(box, " " + mesh.numbers.file);
    box.addEventListener("change", () => {
      const wanted = [...document.querySelectorAll("#shown-meshes input")].flatMap((b, k) => b.checked ? [k] : []);
      change(() => showMeshes(wanted.length ? wanted : [i]));
    });
  });
  $("shown-meshes").hidden = page.meshes.length < 2;
  for (const name of patchNames()) {
    const label = addText($("shown-patches"), "label", ""), box = document.createElement("input");
    box.type = "checkbox";
    box.checked = !page.hidden.has(name);
    box.value = name;
    label.append(box, " " + name);
    box.addEventListener("change", () => change(() => hidePatches(
      [...page.hidden].filter((other) => other !== name).concat(box.checked ? [] : [name]))));
  }
  for (const name of columnNames()) $("color").append(new Option(name.replaceAll("_", " "), name));
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  $("show").addEventListener("change", () => change(async () => { arrange(); await paint(true); }));
  $("place").addEventListener("input", () => change(async () => { arrange(); await paint(true); }));
  $("color").addEventListener("change", () => change(() => paint(false)));
  for (const id of ["from", "to", "log"]) $(id).addEventListener("change", () => change(() => paint(true)));
  $("edges").addEventListener("change", showEdges);
  $("next-worst").addEventListener("click", () => nextWorst(1));
  $("previous-worst").addEventListener("click", () => nextWorst(-1));
  for (const button of document.querySelectorAll("[data-look]"))
    button.addEventListener("click", () => { page.picture.look(button.dataset.look); page.picture.draw(); });
}

async function hidePatches(names) {
  page.hidden = new Set(names);
  for (const box of document.querySelectorAll("#shown-patches input")) box.checked = !page.hidden.has(box.value);
  await paint(true);
}

function showEdges() {
  page.picture.shared.edges.value = $("edges").checked ? 1 : 0;
  page.picture.draw();
}

// Keys are for the picture while its middle is on the screen, unless something is being typed or chosen.
function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.target.matches("input:not([type=checkbox]), select, textarea")) return;
  const {top, bottom} = $("panels").getBoundingClientRect();
  if (top + bottom < 0 || top + bottom > 2 * innerHeight) return;
  const {picture} = page, look = (where) => { picture.look(where); picture.draw(); };
  const actions = {
    ArrowLeft: () => picture.turn(-0.1, 0), ArrowRight: () => picture.turn(0.1, 0),
    ArrowUp: () => picture.turn(0, 0.1), ArrowDown: () => picture.turn(0, -0.1),
    "+": () => picture.zoom(0.85), "-": () => picture.zoom(1 / 0.85),
    x: () => look("x"), y: () => look("y"), z: () => look("z"), 0: () => look("home"),
    e: () => { $("edges").checked = !$("edges").checked; showEdges(); },
    s: () => {
      const kinds = ["boundary", "x", "y", "z"];
      $("show").value = kinds[(kinds.indexOf($("show").value) + 1) % kinds.length];
      $("show").dispatchEvent(new Event("change"));
    },
    n: () => nextWorst(1), p: () => nextWorst(-1),
    Escape: () => change(() => pick(null)),
  };
  if (!(event.key in actions)) return;
  event.preventDefault();
  actions[event.key]();
}

// #meshes=0,1;color=level;show=x;place=0.3;hide=PATCH,PATCH;look=y;zoom=2;theme=dark;worst=2;pick=0.5,0.5 (a place of
// the picture); links to sections of the page have no "=".
async function followLink() {
  const wanted = new Map(location.hash.slice(1).split(";").filter((part) => part.includes("=")).map(
    (part) => part.split("=")));
  const numbers = (key) => wanted.get(key).split(",").map(Number);
  if (wanted.has("theme") && THEMES.includes(wanted.get("theme"))) setTheme(wanted.get("theme"));
  if (wanted.has("show")) $("show").value = wanted.get("show");
  if (wanted.has("place")) $("place").value = wanted.get("place");
  if (wanted.has("color")) $("color").value = decodeURIComponent(wanted.get("color"));
  if (wanted.has("hide")) await hidePatches(decodeURIComponent(wanted.get("hide")).split(","));
  if (wanted.has("meshes")) await showMeshes(numbers("meshes").filter((i) => i in page.meshes));
  else if (wanted.has("show") || wanted.has("place") || wanted.has("color")) {
    arrange();
    await paint(false);
  }
  if (wanted.has("look") || wanted.has("meshes") || wanted.has("show") || wanted.has("hide"))
    page.picture.look(wanted.has("look") ? wanted.get("look") : "home");
  if (wanted.has("zoom")) page.picture.zoom(1 / numbers("zoom")[0]);
  if (wanted.has("worst")) {
    const mesh = page.shown[page.shown.length - 1], number = page.meshes[mesh].view.worst[numbers("worst")[0]];
    if (number !== undefined) await flyToCell(mesh, number);
  }
  if (wanted.has("pick")) await pick(page.picture.pick(...numbers("pick")));
}

async function start() {
  document.documentElement.classList.add("has-script");
  const numbers = takeData("numbers");
  page.meshes = takeData("view").map((view, i) => ({view, numbers: numbers[i], scene: null}));
  $("theme").addEventListener("click", () => setTheme(
    THEMES[(THEMES.indexOf($("theme").dataset.theme || "auto") + 1) % THEMES.length]));
  $("log-counts").addEventListener("change", applyTheme);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", applyTheme);
  const nFaces = page.meshes.reduce((sum, {view}) => sum + view.n_faces, 0);
  try {
    page.picture = new Picture($("canvas"), nFaces < MANY_FACES, (picked) => change(() => pick(picked)));
  } catch (error) {
    for (const id of ["controls", "canvas", "shown-patches", "picked", "keys"]) $(id).remove();
    $("remarks").textContent = `${$("still").alt}. The picture is a still one, because WebGL does not work here (${error.message}).`;
    applyTheme();
    document.documentElement.dataset.ready = "yes";
    return;
  }
  page.hidden = new Set(FIRST.hidden);
  connectControls();
  addRowButtons();
  $("show").value = FIRST.show;
  $("color").value = FIRST.color;
  addEventListener("keydown", onKey);
  page.picture.shared.ink.value = glColor(styleValue("--ink"));
  await change(() => showMeshes(FIRST.meshes));
  page.picture.look("home");
  page.picture.drawNow();
  document.documentElement.classList.add("has-picture");
  page.picture.wait();
  document.documentElement.dataset.firstFrame = String(Math.round(performance.now()));
  applyTheme();
  await change(followLink);
  addEventListener("hashchange", () => change(followLink));
  document.documentElement.dataset.ready = "yes";
}

start();
