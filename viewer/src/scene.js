// The surface, its points and lines and the cut, drawn by three.js with custom shaders: the light comes from the viewer,
// so that every side is lit, and the part beyond the cut is discarded. What a closed surface holds is capped: where a
// pixel of the plane of the cut sees more backs than fronts (counted in the stencil buffer), it is inside.

import * as THREE from "three";

import {palette, parse} from "./colors.js";
import {coarseTriangles} from "./coarse.js";
import {across} from "./section.js";

const SURFACE_VERTEX = `
attribute vec3 tint;
attribute float value;
varying vec3 vTint, vNormal, vEye, vPlace;
varying float vValue;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vTint = tint;
  vValue = value;
  vNormal = normalMatrix * normal;
  vEye = eye.xyz;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
}`;

// A value below 0 stands for none. Lines of equal value are one pixel wide.
const COLOR_OF_VALUE = `
uniform sampler2D stops;
uniform vec3 plain, missing;
uniform float mode, levels;
vec3 colorOf(vec3 tint, float value) {
  if (mode < 0.5) return plain;
  if (mode < 1.5) return tint;
  if (value < -0.001) return missing;
  vec3 color = texture2D(stops, vec2(clamp(value, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  if (levels > 0.0) {
    float at = value * levels;
    float step = fwidth(at);  // where it is constant there is no line
    float off = step > 1e-5 ? abs(fract(at - 0.5) - 0.5) / step : 2.0;
    color = mix(vec3(0.08), color, 0.35 + 0.65 * smoothstep(0.6, 1.4, off));
  }
  return color;
}`;

// The weights of ambient light, light from above, key light, light from the viewer and gloss were chosen by eye.
const SURFACE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 inside;
uniform float opacity, twoSided, orthographic;
varying vec3 vTint, vNormal, vEye, vPlace;
varying float vValue;
${COLOR_OF_VALUE}
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  vec3 toViewer = orthographic > 0.5 ? vec3(0.0, 0.0, 1.0) : normalize(-vEye);
  vec3 n = normalize(vNormal);
  if (twoSided > 0.5 && dot(n, toViewer) < 0.0) n = -n;
  float facing = dot(n, toViewer);
  if (!gl_FrontFacing && twoSided < 0.5) {
    gl_FragColor = vec4(inside * (0.72 + 0.28 * abs(facing)), opacity);
    return;
  }
  vec3 key = normalize(vec3(-0.35, 0.55, 0.8));
  float light = 0.50 + 0.07 * n.y + 0.36 * max(dot(n, key), 0.0) + 0.10 * max(facing, 0.0);
  float gloss = pow(max(dot(n, normalize(key + toViewer)), 0.0), 40.0);
  gl_FragColor = vec4(min(colorOf(vTint, vValue) * light + vec3(0.07 * gloss), 1.0), opacity);
}`;

// Points are drawn 0.004 half diagonals nearer, so that the surface they lie on does not hide them.
const POINT_VERTEX = `
attribute vec3 tint;
attribute float value;
uniform float size, perspective;
varying vec3 vTint, vPlace;
varying float vValue;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  eye.xyz += perspective > 0.5 ? -0.004 * normalize(eye.xyz) : vec3(0.0, 0.0, 0.004);
  vTint = tint;
  vValue = value;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
  gl_PointSize = max(perspective > 0.5 ? size / -eye.z : size, 1.0);
}`;

const POINT_FRAGMENT = `
uniform vec4 cut;
uniform float opacity, rim;
varying vec3 vTint, vPlace;
varying float vValue;
${COLOR_OF_VALUE}
void main() {
  float radius = length(gl_PointCoord - 0.5);
  if (dot(cut.xyz, vPlace) > cut.w || radius > 0.5) discard;
  gl_FragColor = vec4(colorOf(vTint, vValue) * (radius > 0.36 ? rim : 1.0), opacity);
}`;

const LINE_VERTEX = `
varying vec3 vPlace;
void main() {
  vPlace = position;
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * eye;
  gl_Position.z -= 0.0005 * gl_Position.w;
}`;

const LINE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 color;
uniform float opacity;
varying vec3 vPlace;
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  gl_FragColor = vec4(color, opacity);
}`;

const CAP_VERTEX = `
attribute vec2 place;
varying vec2 vPlace;
void main() {
  vPlace = place;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// On the cap the function is shown with lines at even steps.
const CAP_FRAGMENT = `
uniform sampler2D values, stops;
uniform float mode, levels;
uniform vec3 inside;
varying vec2 vPlace;
void main() {
  if (mode < 0.5) { gl_FragColor = vec4(inside, 1.0); return; }
  float value = texture2D(values, vPlace).r;
  vec3 color = texture2D(stops, vec2(clamp(value, 0.0, 1.0) * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb;
  float at = value * levels;
  float step = fwidth(at);
  // Beyond the end of the scale the colour is constant, and has no lines.
  float off = step > 1e-5 && at < levels - 0.5 ? abs(fract(at - 0.5) - 0.5) / step : 2.0;
  gl_FragColor = vec4(mix(color * 0.72, color, smoothstep(0.5, 1.3, off)), 1.0);
}`;

const LARGE = 1e6; // triangles, from which a coarse level is drawn while the picture moves
const NO_CUT = [0, 0, 0, 1];
const COUNT_FRAGMENT = `
uniform vec4 cut;
varying vec3 vPlace;
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  gl_FragColor = vec4(0.0);
}`;
const COUNT_VERTEX = `
varying vec3 vPlace;
void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const CREASE = Math.cos((30 * Math.PI) / 180); // faces that meet at more than that make an edge; chosen by hand
const SAMPLES_ON_CAP = 192; // of the function along each side of the cap
export const LEVELS_ON_CAP = 12;

const number = (value) => ({value});

function texture(bytes, width, height) {
  const result = new THREE.DataTexture(bytes, width, height, THREE.RGBAFormat);
  result.magFilter = result.minFilter = THREE.LinearFilter;
  result.needsUpdate = true;
  return result;
}

/** How values are coloured: uniforms that surface and points share the shape of. */
function colorUniforms() {
  return {
    stops: number(texture(palette(["#000000", "#ffffff"]), 256, 1)),
    plain: number(new THREE.Vector3(0.8, 0.8, 0.8)),
    missing: number(new THREE.Vector3(0.7, 0.7, 0.7)),
    mode: number(0),
    levels: number(0),
  };
}

export class Scene {
  /** orbit: the camera. Throws without WebGL 2. */
  constructor(canvas, orbit) {
    this.canvas = canvas;
    this.orbit = orbit;
    const context = canvas.getContext("webgl2", {alpha: true, antialias: true, stencil: true, preserveDrawingBuffer: true});
    if (!context) throw new Error("this browser has no WebGL 2");
    this.renderer = new THREE.WebGLRenderer({canvas, context, antialias: true, alpha: true, stencil: true});
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.sortObjects = true;
    this.perspective = new THREE.PerspectiveCamera(orbit.fieldOfView, 1, 0.005, 100);
    this.orthographic = new THREE.OrthographicCamera(-1, 1, 1, -1, -50, 100);
    this.scene = new THREE.Scene();
    this.root = new THREE.Group();
    this.scene.add(this.root);
    this.shared = {
      cut: number(new THREE.Vector4(...NO_CUT)),
      inside: number(new THREE.Vector3(0.6, 0.6, 0.6)),
      orthographic: number(0),
      perspective: number(1),
    };
    this.surfaceLook = {...colorUniforms(), opacity: number(1), twoSided: number(0)};
    this.pointLook = {...colorUniforms(), opacity: number(1), rim: number(0.45), size: number(1)};
    this.lineColor = number(new THREE.Vector3(0.2, 0.2, 0.2));
    this.boxColor = number(new THREE.Vector3(0.6, 0.6, 0.6));
    this.extraColor = number(new THREE.Vector3(0.8, 0.2, 0.1));
    this.pointScale = 1;
    this.cap = null;
  }

  get camera() {
    return this.orbit.orthographic ? this.orthographic : this.perspective;
  }

  add(object, order = 0) {
    object.frustumCulled = false;
    object.renderOrder = order;
    this.root.add(object);
    return object;
  }

  remove(...objects) {
    for (const object of objects) {
      if (!object) continue;
      this.root.remove(object);
      if (object.geometry && !object.keepsGeometry) object.geometry.dispose();
    }
  }

  /** @param {{positions: Float32Array, normals: Float32Array|null, triangles: ArrayLike<number>}|null} mesh */
  setMesh(mesh) {
    this.remove(this.front, this.back, this.wires, this.creases, ...(this.counters || []));
    this.front = this.back = this.wires = this.creases = this.counters = this.coarse = null;
    this.mesh = mesh;
    if (!mesh) return;
    const geometry = this.geometry(mesh.positions, mesh.tint);
    this.full = new THREE.BufferAttribute(mesh.triangles, 1);
    geometry.setIndex(this.full);
    if (mesh.normals) geometry.setAttribute("normal", new THREE.BufferAttribute(mesh.normals, 3));
    else geometry.computeVertexNormals();
    mesh.normals = mesh.normals || geometry.attributes.normal.array;
    this.surface = geometry;
    this.coarse = mesh.triangles.length > 3 * LARGE ? new THREE.BufferAttribute(coarseTriangles(mesh.positions, mesh.triangles), 1) : null;
    const material = (side) =>
      new THREE.ShaderMaterial({
        vertexShader: SURFACE_VERTEX,
        fragmentShader: SURFACE_FRAGMENT,
        uniforms: {...this.surfaceLook, cut: this.shared.cut, inside: this.shared.inside, orthographic: this.shared.orthographic},
        side,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      });
    this.front = this.add(new THREE.Mesh(geometry, material(THREE.DoubleSide)), 2);
    this.back = this.add(new THREE.Mesh(geometry, material(THREE.BackSide)), 1);
    this.back.keepsGeometry = true;
    this.counters = [THREE.BackSide, THREE.FrontSide].map((side) => this.addCounter(geometry, side));
    this.setOpacity(this.surfaceLook.opacity.value);
    this.updateCounters();
  }

  /** Whether the coarse level of a large mesh is drawn, as while the picture moves; false where there is none. */
  showCoarse(on) {
    if (!this.coarse) return false;
    this.surface.setIndex(on ? this.coarse : this.full);
    return true;
  }

  addCounter(geometry, side) {
    const material = new THREE.ShaderMaterial({
      vertexShader: COUNT_VERTEX,
      fragmentShader: COUNT_FRAGMENT,
      uniforms: {cut: this.shared.cut},
      side,
      depthWrite: false,
      depthTest: false,
      colorWrite: false,
      stencilWrite: true,
      stencilFunc: THREE.AlwaysStencilFunc,
    });
    const step = side === THREE.BackSide ? THREE.IncrementWrapStencilOp : THREE.DecrementWrapStencilOp;
    material.stencilZPass = material.stencilZFail = material.stencilFail = step;
    const counter = this.add(new THREE.Mesh(geometry, material), 3);
    counter.keepsGeometry = true;
    counter.visible = false;
    return counter;
  }

  /** @param {{positions: Float32Array}|null} points */
  setPoints(points) {
    this.remove(this.cloud);
    this.cloud = null;
    this.points = points;
    if (!points) return;
    this.cloud = this.add(
      new THREE.Points(
        this.geometry(points.positions, points.tint),
        new THREE.ShaderMaterial({
          vertexShader: POINT_VERTEX,
          fragmentShader: POINT_FRAGMENT,
          uniforms: {...this.pointLook, cut: this.shared.cut, perspective: this.shared.perspective},
        }),
      ),
      2,
    );
  }

  /** Lines of the data, such as ridges: positions and pairs of indices. */
  setLines(lines) {
    this.remove(this.extra);
    this.extra = lines && this.addLines(lines.positions, lines.edges, this.extraColor, 4);
  }

  addLines(positions, edges, color, order, opacity = 1) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    if (edges) geometry.setIndex(new THREE.BufferAttribute(edges, 1));
    const material = new THREE.ShaderMaterial({
      vertexShader: LINE_VERTEX,
      fragmentShader: LINE_FRAGMENT,
      uniforms: {color, opacity: number(opacity), cut: this.shared.cut},
      transparent: opacity < 1,
    });
    return this.add(new THREE.LineSegments(geometry, material), order);
  }

  geometry(positions, tint) {
    const count = positions.length / 3;
    const result = new THREE.BufferGeometry();
    result.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    result.setAttribute("tint", new THREE.BufferAttribute(tint || new Float32Array(3 * count), 3));
    result.setAttribute("value", new THREE.BufferAttribute(new Float32Array(count), 1));
    return result;
  }

  /** The box of the data, as lines. */
  setBox(halfSides, shown) {
    this.remove(this.box);
    this.box = null;
    if (!shown) return;
    const corners = new Float32Array(24);
    for (let i = 0; i < 8; ++i) for (let a = 0; a < 3; ++a) corners[3 * i + a] = ((i >> a) & 1 ? 1 : -1) * halfSides[a];
    this.box = this.addLines(corners, boxEdges(0), this.boxColor, 0, 0.7);
    this.box.material.uniforms.cut = number(new THREE.Vector4(...NO_CUT));
  }

  /** Edges of triangles ("all"), edges where faces meet at an angle ("creases"), or none. */
  setEdges(kind) {
    this.remove(this.wires, this.creases);
    this.wires = this.creases = null;
    if (!this.mesh || kind === "none") return;
    const edges = kind === "all" ? allEdges(this.mesh.triangles) : creaseEdges(this.mesh.positions, this.mesh.triangles);
    this.wires = this.addLines(this.mesh.positions, edges, this.lineColor, 3, kind === "all" ? 0.35 : 0.9);
  }

  /** Wireframe: hides the surface itself. */
  setSurfaceShown(shown) {
    for (const object of [this.front, this.back]) if (object) object.visible = shown;
    if (this.back) this.back.visible = shown && this.surfaceLook.opacity.value < 1;
  }

  /** Both sides of an open surface look the same; of a closed one the inside has a colour of its own. */
  setTwoSided(twoSided) {
    this.surfaceLook.twoSided.value = twoSided ? 1 : 0;
  }

  setOpacity(opacity) {
    this.surfaceLook.opacity.value = opacity;
    if (!this.front) return;
    const clear = opacity < 1;
    for (const object of [this.front, this.back]) {
      object.material.transparent = clear;
      object.material.depthWrite = !clear;
    }
    this.front.material.side = clear ? THREE.FrontSide : THREE.DoubleSide;
    this.back.visible = clear;
    this.front.material.needsUpdate = true;
  }

  setPointStyle(shown, pixels, opacity) {
    this.pointScale = pixels;
    this.pointLook.opacity.value = opacity;
    if (!this.cloud) return;
    this.cloud.visible = shown;
    this.cloud.material.transparent = opacity < 1;
    this.cloud.material.depthWrite = opacity === 1;
    this.updatePointSize();
  }

  /**
   * Discards the part beyond the plane normal . x = offset; null: nothing. `fill`: colours of the cap, or null.
   * @param {{normal: number[], offset: number}|null} plane
   * @param {{values: (x: number, y: number, z: number) => number, stops: string[]}|null} fill
   */
  setCut(plane, fill) {
    this.shared.cut.value.set(...(plane ? [...plane.normal, plane.offset] : NO_CUT));
    this.remove(this.cap);
    this.cap = plane && this.mesh ? this.makeCap(plane, fill) : null;
    this.updateCounters();
  }

  updateCounters() {
    for (const counter of this.counters || []) counter.visible = Boolean(this.cap);
  }

  makeCap({normal, offset}, fill) {
    const [u, v] = across(normal);
    const reach = 1.02;
    const corner = (s, t) => normal.map((n, a) => n * offset + reach * (s * u[a] + t * v[a]));
    const geometry = new THREE.BufferGeometry();
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    const positions = new Float32Array(corners.flatMap(([s, t]) => corner(s, t)));
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("place", new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const uniforms = {
      values: number(null),
      stops: number(null),
      mode: number(fill ? 1 : 0),
      levels: number(LEVELS_ON_CAP),
      inside: this.shared.inside,
    };
    if (fill) {
      const n = SAMPLES_ON_CAP;
      const bytes = new Uint8Array(4 * n * n);
      for (let j = 0, k = 0; j < n; ++j)
        for (let i = 0; i < n; ++i, k += 4) {
          const value = fill.values(...corner((2 * (i + 0.5)) / n - 1, (2 * (j + 0.5)) / n - 1));
          bytes[k] = Math.round(255 * Math.min(Math.max(Number.isFinite(value) ? value : 0.5, 0), 1));
          bytes[k + 3] = 255;
        }
      uniforms.values.value = texture(bytes, n, n);
      uniforms.stops.value = texture(palette(fill.stops), 256, 1);
    }
    const material = new THREE.ShaderMaterial({
      vertexShader: CAP_VERTEX,
      fragmentShader: CAP_FRAGMENT,
      uniforms,
      side: THREE.DoubleSide,
      stencilWrite: true,
      stencilRef: 0,
      stencilFunc: THREE.NotEqualStencilFunc,
    });
    material.stencilZPass = material.stencilZFail = material.stencilFail = THREE.ZeroStencilOp;
    return this.add(new THREE.Mesh(geometry, material), 4);
  }

  /**
   * @param {{values: Float32Array|null, stops: string[]|null, plain: number[], missing: number[], own: boolean,
   *   levels: number}} look values on the scale, 0 to 1, or null for one colour; own: the colours of the file
   */
  setSurfaceColors(look) {
    if (this.mesh) this.setColors(this.surface, this.surfaceLook, look);
  }

  setPointColors(look) {
    if (this.cloud) this.setColors(this.cloud.geometry, this.pointLook, look);
  }

  setColors(geometry, uniforms, {values, stops, plain, missing, own, levels = 0}) {
    uniforms.mode.value = values ? 2 : own ? 1 : 0;
    uniforms.levels.value = levels;
    uniforms.plain.value.set(...plain);
    uniforms.missing.value.set(...missing);
    if (!values) return;
    geometry.setAttribute("value", new THREE.BufferAttribute(values, 1));
    uniforms.stops.value.dispose();
    uniforms.stops.value = texture(palette(stops), 256, 1);
  }

  setTheme({inside, line, box, extra}) {
    this.shared.inside.value.set(...inside);
    this.lineColor.value.set(...line);
    this.boxColor.value.set(...box);
    this.extraColor.value.set(...(extra || parse("#c2410c")));
  }

  /** Lengths along an axis of the data are drawn that many times as long. */
  setExaggeration(axis, factor) {
    this.root.scale.set(1, 1, 1);
    this.root.scale["xyz"[axis]] = factor;
    this.root.updateMatrixWorld(true);
  }

  resize(width = this.canvas.clientWidth, height = this.canvas.clientHeight, ratio = Math.min(window.devicePixelRatio || 1, 2)) {
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.size = [width, height, ratio];
    this.perspective.aspect = this.orbit.aspect = width / height;
    this.perspective.updateProjectionMatrix();
    this.updatePointSize();
  }

  // Dots with room between them, for points on a surface about as large as the unit ball; limits chosen by eye.
  updatePointSize() {
    if (!this.points || !this.size) return;
    const [, height, ratio] = this.size;
    const dot = Math.min(Math.max(0.9 / Math.sqrt(this.points.positions.length / 3), 0.004), 0.022) * this.pointScale;
    const perspective = (dot * height * ratio) / (2 * this.orbit.slope);
    this.pointLook.size.value = this.orbit.orthographic ? perspective / this.orbit.distance : perspective;
    this.pointLook.rim.value = perspective / this.orbit.distance > 5 ? 0.45 : 0.85;
  }

  place() {
    const camera = this.camera;
    camera.quaternion.copy(this.orbit.rotation);
    camera.position.copy(this.orbit.position);
    if (this.orbit.orthographic) {
      const half = this.orbit.halfHeight;
      Object.assign(camera, {left: -half * this.orbit.aspect, right: half * this.orbit.aspect, top: half, bottom: -half});
      camera.updateProjectionMatrix();
    }
    camera.updateMatrixWorld(true);
    this.shared.orthographic.value = this.orbit.orthographic ? 1 : 0;
    this.shared.perspective.value = this.orbit.orthographic ? 0 : 1;
    this.updatePointSize();
  }

  // The three edges of the box that meet nearest to the viewer are left out: they would cross the data.
  hideNearEdges() {
    if (!this.box) return;
    const toViewer = new THREE.Vector3(0, 0, 1).applyQuaternion(this.orbit.rotation).toArray();
    const nearest = toViewer.reduce((corner, value, a) => corner | (value > 0 ? 1 << a : 0), 0);
    if (this.nearest === nearest && this.box.nearest === nearest) return;
    this.nearest = this.box.nearest = nearest;
    this.box.geometry.setIndex(new THREE.BufferAttribute(boxEdges(nearest), 1));
  }

  draw() {
    this.place();
    this.hideNearEdges();
    this.renderer.render(this.scene, this.camera);
  }

  /** Where a place of the data appears: pixels from the top left corner, and whether it is before the camera. */
  project(place) {
    const at = new THREE.Vector3(...place).applyMatrix4(this.root.matrixWorld);
    const depth = at.clone().applyMatrix4(this.camera.matrixWorldInverse).z;
    at.project(this.camera);
    const [width, height] = this.size;
    return {x: ((at.x + 1) / 2) * width, y: ((1 - at.y) / 2) * height, visible: this.orbit.orthographic || depth < 0};
  }

  /** The ray of the data under a pixel. */
  ray(x, y) {
    const [width, height] = this.size;
    const [sx, sy] = [(2 * x) / width - 1, 1 - (2 * y) / height];
    const near = new THREE.Vector3(sx, sy, -1).unproject(this.camera);
    const far = new THREE.Vector3(sx, sy, 1).unproject(this.camera);
    const {scale} = this.root;
    const origin = near.divide(scale), direction = far.divide(scale).sub(origin);
    return {origin: origin.toArray(), direction: direction.normalize().toArray()};
  }
}

// The edges of a box as pairs of corners (a bit for each axis), without those of one corner.
function boxEdges(without) {
  const edges = [];
  for (let i = 0; i < 8; ++i)
    for (let a = 0; a < 3; ++a) {
      const other = i | (1 << a);
      if (other !== i && i !== without && other !== without) edges.push(i, other);
    }
  return new Uint16Array(edges);
}

/** Every edge of the triangles once. */
export function allEdges(triangles) {
  const seen = new Set();
  const edges = [];
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k], b = triangles[t + ((k + 1) % 3)];
      const key = Math.min(a, b) * 4294967296 + Math.max(a, b);
      if (seen.has(key)) continue;
      seen.add(key);
      edges.push(a, b);
    }
  return new Uint32Array(edges);
}

/** Edges whose faces meet at more than 30 degrees, and those with one face. */
export function creaseEdges(positions, triangles) {
  const normalOf = (t) => {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
    const u = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
    const v = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    return n.map((value) => value / length);
  };
  const faces = new Map();
  const edges = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const n = normalOf(t);
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k], b = triangles[t + ((k + 1) % 3)];
      const key = Math.min(a, b) * 4294967296 + Math.max(a, b);
      const other = faces.get(key);
      if (!other) faces.set(key, n);
      else {
        faces.delete(key);
        if (n[0] * other[0] + n[1] * other[1] + n[2] * other[2] < CREASE) edges.push(a, b);
      }
    }
  }
  for (const key of faces.keys()) edges.push(Math.floor(key / 4294967296), key % 4294967296);
  return new Uint32Array(edges);
}
