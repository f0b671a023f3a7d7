// The surface, its points and lines and the cut, drawn by three.js with shaders of our own (shaders.js).

import * as THREE from "three";

import {parse} from "../colors.js";
import {capCounter, capMesh} from "./cap.js";
import {coarseTriangles} from "./coarse.js";
import {allEdges, boxEdges, creaseEdges} from "./edges.js";
import {LINE_FRAGMENT, LINE_VERTEX, POINT_FRAGMENT, POINT_VERTEX, SURFACE_FRAGMENT, SURFACE_VERTEX} from "./shaders.js";
import {colorUniforms, number, stopsTexture} from "./uniforms.js";

const LARGE = 1e6; // triangles, from which a coarse level is drawn while the picture moves
const NO_CUT = [0, 0, 0, 1];

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
    this.extraColor = number(new THREE.Vector3(...parse("#c2410c")));
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
    this.remove(this.front, this.back, this.wires, ...(this.counters || []));
    this.front = this.back = this.wires = this.counters = this.coarse = null;
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
    const counter = this.add(capCounter(geometry, side, this.shared.cut), 3);
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
      uniforms: {color, opacity: number(opacity), cut: this.shared.cut, perspective: this.shared.perspective},
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
    this.remove(this.wires);
    this.wires = null;
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
    for (const {value} of Object.values(this.cap ? this.cap.material.uniforms : {})) if (value && value.isTexture) value.dispose();
    this.cap = plane && this.mesh ? this.add(capMesh(plane, fill, this.shared.inside), 4) : null;
    this.updateCounters();
  }

  updateCounters() {
    for (const counter of this.counters || []) counter.visible = Boolean(this.cap);
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
    uniforms.stops.value = stopsTexture(stops);
  }

  setTheme({inside, line, box}) {
    this.shared.inside.value.set(...inside);
    this.lineColor.value.set(...line);
    this.boxColor.value.set(...box);
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
