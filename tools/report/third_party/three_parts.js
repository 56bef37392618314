// SPDX-License-Identifier: GPL-3.0-or-later
// What the page uses of three.js; bundle.sh makes one script of it.
export {
  BufferAttribute, BufferGeometry, DataTexture, GLSL3, LineSegments, Mesh, NearestFilter, PerspectiveCamera, Points,
  Scene, ShaderMaterial, Vector3, Vector4, WebGLRenderTarget, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
