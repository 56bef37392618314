// SPDX-License-Identifier: GPL-3.0-or-later
// The picture: meshes side by side in one canvas, seen by one camera; boundary, section, and a cell with those around.
"use strict";

const VERTEX = `
in float place;
#ifdef HAS_INNER
in float inner;
#endif
uniform vec4 plane;
out vec3 seen;
out vec3 corner;
out float shade;
out float beyond;
void main() {
  vec4 point = modelViewMatrix * vec4(position, 1.0);
  seen = point.xyz;
  shade = place;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
#ifdef HAS_INNER
  if (inner > 0.5) corner[int(inner + 0.5) - 1] = 1.0;
#endif
  beyond = dot(plane.xyz, position) - plane.w;
  gl_Position = projectionMatrix * point;
}`;

// Edges are where a barycentric coordinate vanishes. In triangles less than ten pixels high they fade with the height: the
// edges of such triangles darken all of them alike.
const FRAGMENT = `
precision highp float;
in vec3 seen;
in vec3 corner;
in float shade;
in float beyond;
uniform sampler2D palette;
uniform vec3 nothing, edge;
uniform float edges, lit;
out vec4 color;
void main() {
  if (beyond > 0.0 || shade < -1.5) discard;
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 base = shade < -0.5 ? nothing : texture(palette, vec2(shade, 0.5)).rgb;
  base *= mix(1.0, 0.62 + 0.38 * abs(normal.z), lit);
  vec3 across = dFdx(corner), down = dFdy(corner);
  vec3 width = sqrt(across * across + down * down); // one over the heights of the triangle, in pixels
  vec3 away = smoothstep(vec3(0.0), 1.2 * width + 1e-6, corner);
  float line = 1.0 - min(away.x, min(away.y, away.z));
  float room = min(0.1 / max(width.x, max(width.y, width.z)), 1.0);
  color = vec4(mix(base, edge, 0.62 * edges * line * room), 1.0);
}`;

const NUMBER_FRAGMENT = `
precision highp float;
precision highp int;
in float beyond;
in float shade;
flat in int triangle;
uniform int first;
out vec4 color;
void main() {
  if (beyond > 0.0 || shade < -1.5) discard;
  int number = first + triangle;
  color = vec4(number & 255, (number >> 8) & 255, (number >> 16) & 255, (number >> 24) & 255) / 255.0;
}`;

const NUMBER_VERTEX = `
in float place;
uniform vec4 plane;
out float beyond;
out float shade;
flat out int triangle;
void main() {
  shade = place;
  triangle = gl_VertexID / 3;
  beyond = dot(plane.xyz, position) - plane.w;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const PLAIN_VERTEX = `
void main() {
  gl_PointSize = 15.0;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const LINE_FRAGMENT = `
precision highp float;
uniform vec3 ink;
out vec4 color;
void main() { color = vec4(ink, 1.0); }`;
const RING_FRAGMENT = `
precision highp float;
uniform vec3 ink;
out vec4 color;
void main() {
  float r = length(gl_PointCoord - 0.5) * 15.0;
  if (r > 7.0 || r < 5.0) discard;
  color = vec4(ink, 1.0);
}`;

const LOOKS = {x: [-1, 0, 0], y: [0, -1, 0], z: [0, 0, 1], home: FIRST.from};  // from where
const BEFORE_SECTION = 2.5;  // how much more `home` looks along the axis that a section is across
const MANY_CORNERS = 200000;
const FIELD_OF_VIEW = 35;  // degrees, of the shorter side of a panel
const NO_PLANE = [0, 0, 0, 0];
const HIDDEN = -2;  // place of a triangle that is not drawn

function glColor(color) { return rgb(color).map((value) => value / 255); }

function geometryOf(position, attributes = {}) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  for (const [name, values] of Object.entries(attributes))
    geometry.setAttribute(name, new THREE.BufferAttribute(values, 1));
  return geometry;
}

// One mesh in the picture. Coordinates of the scene: from the middle of its box, in parts of the largest diagonal.
class MeshScene {
  constructor(data, size, shared) {
    this.data = data;
    this.scene = new THREE.Scene();
    const [low, high] = data.view.box;
    this.middle = low.map((value, d) => (value + high[d]) / 2);
    this.size = size;
    this.plane = {value: new THREE.Vector4(...NO_PLANE)};
    this.uniforms = (lit) => ({
      plane: this.plane, palette: shared.palette, edges: shared.edges, edge: shared.edge, nothing: shared.nothing,
      lit: {value: lit},
    });
    this.shared = shared;
    this.boundary = this.addTriangles(this.boundaryPositions(), 1);
    this.section = null;
    this.axis = null;
    this.around = null;
    this.marks = [];
  }

  scenePoint(position) { return position.map((value, d) => (value - this.middle[d]) / this.size); }

  nodePoints() {
    if (!this.points) {
      const {data} = this;
      this.points = new Float32Array(3 * data.nNodes);
      for (let d = 0; d < 3; ++d) {
        const [low, high] = data.view.box;
        const step = (high[d] - low[d]) / 0xffffff / this.size, first = (low[d] - this.middle[d]) / this.size;
        for (let node = 0; node < data.nNodes; ++node) this.points[3 * node + d] = first + step * data.axes[d][node];
      }
    }
    return this.points;
  }

  boundaryPositions() {
    const points = this.nodePoints(), corners = this.data.faceNode;
    const position = new Float32Array(3 * corners.length);
    for (let i = 0; i < corners.length; ++i) {
      const from = 3 * corners[i], to = 3 * i;
      position[to] = points[from];
      position[to + 1] = points[from + 1];
      position[to + 2] = points[from + 2];
    }
    return position;
  }

  addTriangles(position, lit, inner = null, plane = this.plane) {
    const geometry = geometryOf(position, {place: new Float32Array(position.length / 3), ...(inner && {inner})});
    const mesh = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, side: 2,
      defines: inner ? {HAS_INNER: 1} : {},
      uniforms: {...this.uniforms(lit), plane},
    }));
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return mesh;
  }

  remove(object) {
    if (!object) return null;
    this.scene.remove(object);
    object.geometry.dispose();
    object.material.dispose();
    return null;
  }

  // A section across axis d at a part of the box, the boundary cut open there; d null: none.
  cut(d, part) {
    this.section = this.remove(this.section);
    this.plane.value.set(...NO_PLANE);
    this.axis = d;
    if (d === null) return;
    const at = Math.round(part * 0xffffff);
    const section = this.sectionData = sectionOf(this.data, d, at);
    const points = this.nodePoints(), n = section.a.length, position = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i)
      for (let k = 0; k < 3; ++k) {
        const a = points[3 * section.a[i] + k], b = points[3 * section.b[i] + k];
        position[3 * i + k] = a + section.w[i] * (b - a);
      }
    this.section = this.addTriangles(position, 0, Float32Array.from(section.inner), {value: new THREE.Vector4(...NO_PLANE)});
    const [low, high] = this.data.view.box;
    this.height = this.scenePoint(low)[d] + part * (high[d] - low[d]) / this.size;
  }

  // Takes away the half in front of the section.
  openTowards(camera) {
    if (this.axis === null) return;
    const sign = camera.position.getComponent(this.axis) >= this.height ? 1 : -1, normal = [0, 0, 0];
    normal[this.axis] = sign;
    this.plane.value.set(...normal, sign * this.height);
  }

  // A cell of the view with its faces, the cells around it as lines.
  showAround(cell) {
    this.around = this.remove(this.around);
    this.lines = this.remove(this.lines);
    if (cell < 0) return;
    this.aroundCell = cell;
    const points = this.nodePoints(), corners = (c) => this.data.cellNode.subarray(4 * c, 4 * c + 4);
    const at = (node) => points.subarray(3 * node, 3 * node + 3);
    const faces = TET_FACES.flatMap((face) => face.flatMap((i) => [...at(corners(cell)[i])]));
    this.around = this.addTriangles(Float32Array.from(faces), 1, null, {value: new THREE.Vector4(...NO_PLANE)});
    const lines = cellsAround(this.data, cell).flatMap((c) => TET_EDGES.flatMap(
      (edge) => edge.flatMap((i) => [...at(corners(c)[i])])));
    this.lines = this.addPlain(THREE.LineSegments, Float32Array.from(lines), LINE_FRAGMENT, this.shared.ink, true);
  }

  addPlain(Kind, position, fragmentShader, ink, depthTest) {
    const object = new Kind(geometryOf(position), new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: PLAIN_VERTEX, fragmentShader, uniforms: {ink}, depthTest,
    }));
    object.frustumCulled = false;
    object.renderOrder = 1;
    this.scene.add(object);
    return object;
  }

  // Outlines a triangle or a cell, given by its nodes, and rings its middle.
  mark(nodes) {
    this.marks.forEach((mark) => this.remove(mark));
    this.marks = [];
    if (!nodes) return;
    const points = [...nodes].map((node) => [...this.nodePoints().subarray(3 * node, 3 * node + 3)]);
    const lines = points.flatMap((a, i) => points.slice(i + 1).flatMap((b) => [...a, ...b]));
    const middle = [0, 1, 2].map((d) => points.reduce((sum, point) => sum + point[d], 0) / points.length);
    this.marks = [
      this.addPlain(THREE.LineSegments, Float32Array.from(lines), LINE_FRAGMENT, this.shared.accent, false),
      this.addPlain(THREE.Points, Float32Array.from(middle), RING_FRAGMENT, this.shared.accent, false),
    ];
  }

  // Places in the palette for what is drawn: values of faces, else of nodes; of cells, else of nodes. Patches with
  // `isHidden` are not drawn.
  paint(coloring, {faces, cells, nodes}, isHidden) {
    const place = this.boundary.geometry.attributes.place, corners = this.data.faceNode, patch = this.data.facePatch;
    for (let face = 0, i = 0; face < patch.length; ++face) {
      const same = isHidden[patch[face]] ? HIDDEN : faces ? coloring.place(faces[face]) : -1;
      for (const end = i + 3; i < end; ++i)
        place.array[i] = nodes && !faces && same === -1 ? coloring.place(nodes[corners[i]]) : same;
    }
    place.needsUpdate = true;
    if (this.section) {
      const {a, b, w, cell} = this.sectionData, attribute = this.section.geometry.attributes.place;
      for (let i = 0; i < a.length; ++i)
        attribute.array[i] = cells ? coloring.place(cells[cell[Math.floor(i / 3)]])
          : nodes ? coloring.place(nodes[a[i]] + w[i] * (nodes[b[i]] - nodes[a[i]])) : -1;
      attribute.needsUpdate = true;
    }
    if (this.around) {
      const attribute = this.around.geometry.attributes.place;
      attribute.array.fill(cells ? coloring.place(cells[this.aroundCell]) : -1);
      attribute.needsUpdate = true;
    }
  }
}

class Picture {
  // `isSmooth`: with antialiasing, which costs too much for very many triangles.
  constructor(canvas, isSmooth, onPick) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: isSmooth, alpha: true, preserveDrawingBuffer: true});
    this.renderer.autoClear = false;
    this.camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
    this.camera.up.set(...FIRST.up);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.shared = {
      palette: {value: null}, edges: {value: 1}, ink: {value: [0, 0, 0]}, edge: {value: glColor("#1d2430")}, nothing: {value: glColor(NO_VALUE)},
      accent: {value: glColor("#ff2d78")},
    };
    this.target = new THREE.WebGLRenderTarget(1, 1);
    this.numbering = new THREE.ShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: NUMBER_VERTEX, fragmentShader: NUMBER_FRAGMENT, side: 2,
      uniforms: {plane: {value: new THREE.Vector4()}, first: {value: 0}},
    });
    this.scenes = [];
    this.look("home");
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || event.button !== 0 || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      onPick(this.pick((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height));
    });
    new ResizeObserver(() => this.drawNow()).observe(canvas);
  }

  // Panels in rows of at most three: place and size in parts of the canvas, from its upper left corner.
  panels() {
    const n = this.scenes.length, columns = Math.min(n, 3), rows = Math.ceil(n / columns);
    return this.scenes.map((scene, i) => ({
      scene, x: i % columns / columns, y: Math.floor(i / columns) / rows, width: 1 / columns, height: 1 / rows,
    }));
  }

  // Calls `take` with the coordinates of the corners of what is drawn of the meshes; of very many, with some of them.
  forCorners(toward, take) {
    for (const scene of this.scenes)
      for (const part of [scene.boundary, scene.section]) {
        if (!part) continue;
        const {position, place} = part.geometry.attributes, step = Math.ceil(position.count / MANY_CORNERS);
        const d = part === scene.boundary ? scene.axis : null, sign = d !== null && toward.getComponent(d) < 0 ? -1 : 1;
        for (let i = 0; i < position.count; i += step) {
          if (place.array[i] === HIDDEN || (d !== null && sign * (position.getComponent(i, d) - scene.height) > 0)) continue;
          take(position.getX(i), position.getY(i), position.getZ(i));
        }
      }
  }

  // From one side, as near as shows all that is drawn (still.cpp does the same).
  look(where) {
    const across = where === "home" ? this.scenes.find((scene) => scene.axis !== null)?.axis ?? null : null;
    const toward = new THREE.Vector3(...LOOKS[where].map((x, d) => d === across ? BEFORE_SECTION * x : x)).normalize();
    const {up: vertical} = this.camera;
    if (Math.abs(toward.dot(vertical)) > 0.999) toward.addScaledVector(new THREE.Vector3(0, -vertical.z, vertical.z - 1), 0.0006).normalize();
    const right = vertical.clone().cross(toward).normalize(), up = toward.clone().cross(right);
    const axes = [right, up, toward], least = [Infinity, Infinity, Infinity], most = least.map((x) => -x);
    const along = ({x, y, z}, a, b, c) => x * a + y * b + z * c;
    this.forCorners(toward, (...p) => axes.forEach((axis, d) => {
      const place = along(axis, ...p);
      least[d] = Math.min(least[d], place);
      most[d] = Math.max(most[d], place);
    }));
    const middle = least.map((x, d) => x <= most[d] ? (x + most[d]) / 2 : 0);
    const [panel] = this.panels(), {clientWidth, clientHeight} = this.canvas;
    const aspect = panel && clientHeight ? panel.width * clientWidth / (panel.height * clientHeight) : 1;
    const high = Math.tan(FIELD_OF_VIEW * Math.PI / 360) / Math.min(aspect, 1), wide = high * aspect;
    let distance = 0;
    this.forCorners(toward, (...p) => {
      const [x, y, z] = axes.map((axis, d) => along(axis, ...p) - middle[d]);
      distance = Math.max(distance, z + 1.06 * Math.max(Math.abs(x) / wide, Math.abs(y) / high));
    });
    this.controls.target.set(0, 0, 0);
    axes.forEach((axis, d) => this.controls.target.addScaledVector(axis, middle[d]));
    this.camera.position.copy(this.controls.target).addScaledVector(toward, distance || 1.7);
    this.controls.update();
  }

  // The camera in front of a place of a scene, near enough to see something of this size.
  flyTo(point, size) {
    const direction = new THREE.Vector3().subVectors(this.camera.position, this.controls.target).normalize();
    this.controls.target.set(...point);
    this.camera.position.set(...point).addScaledVector(direction, 4 * size);
    this.controls.update();
    this.draw();
  }

  turn(right, up) {
    const {up: vertical} = this.camera;
    const offset = new THREE.Vector3().subVectors(this.camera.position, this.controls.target);
    offset.applyAxisAngle(vertical, right);
    const height = Math.asin(offset.dot(vertical) / offset.length());
    const down = height - Math.min(Math.max(height + up, -1.55), 1.55);
    offset.applyAxisAngle(vertical.clone().cross(offset).normalize(), down);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  aim(panel, width, height) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.aspect = panel.width * width / (panel.height * height);
    const half = Math.tan(FIELD_OF_VIEW * Math.PI / 360) / Math.min(this.camera.aspect, 1);
    this.camera.fov = 360 / Math.PI * Math.atan(half);
    this.camera.near = Math.max(1e-3 * distance, 1e-7);
    this.camera.far = distance + 4;
    this.camera.updateProjectionMatrix();
  }

  // Before the next frame of the browser, however often it is asked for.
  draw() {
    if (this.request) return;
    this.request = requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    cancelAnimationFrame(this.request);
    this.request = 0;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const panel of this.panels()) {
      const area = [panel.x * width, (1 - panel.y - panel.height) * height, panel.width * width, panel.height * height];
      this.renderer.setViewport(...area);
      this.renderer.setScissor(...area);
      this.aim(panel, width, height);
      panel.scene.openTowards(this.camera);
      this.renderer.render(panel.scene.scene, this.camera);
    }
  }

  // Until what was drawn is there.
  wait() {
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  // What is seen at a place of the canvas, in parts of it: {scene, kind, index} or null. Draws the numbers of the
  // triangles into one pixel.
  pick(x, y) {
    const panel = this.panels().find((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height);
    if (!panel) return null;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    this.aim(panel, width, height);
    panel.scene.openTowards(this.camera); // the last frame may have been drawn before the camera or the section moved
    this.camera.setViewOffset(panel.width * width, panel.height * height, (x - panel.x) * width, (y - panel.y) * height,
      1, 1);
    this.renderer.setScissorTest(false);
    this.renderer.setRenderTarget(this.target);
    this.renderer.clear();
    const scene = panel.scene, parts = [["face", scene.boundary], ["section", scene.section], ["cell", scene.around]];
    const hidden = scene.scene.children.filter((object) => object.visible);
    hidden.forEach((object) => { object.visible = false; });
    let first = 1;
    const ranges = [];
    for (const [kind, object] of parts) {
      if (!object || !hidden.includes(object)) continue;
      const own = object.material;
      object.visible = true;
      object.material = this.numbering;
      this.numbering.uniforms.plane.value = own.uniforms.plane.value;
      this.numbering.uniforms.first.value = first;
      this.numbering.uniformsNeedUpdate = true;
      this.renderer.render(scene.scene, this.camera);
      object.visible = false;
      object.material = own;
      ranges.push({kind, first});
      first += object.geometry.attributes.position.count / 3;
    }
    hidden.forEach((object) => { object.visible = true; });
    const pixel = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.target, 0, 0, 1, 1, pixel);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    const number = pixel[0] + 256 * pixel[1] + 65536 * pixel[2] + 16777216 * pixel[3];
    const range = ranges.reverse().find((r) => number >= r.first);
    if (!range) return null;
    const index = number - range.first;
    if (range.kind === "face") return {scene, kind: "face", index};
    return {scene, kind: "cell", index: range.kind === "section" ? scene.sectionData.cell[index] : scene.aroundCell};
  }
}
