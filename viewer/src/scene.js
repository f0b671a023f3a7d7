// The surface and its points, drawn by three.js with custom shaders: the light comes from the viewer, so that every
// side is lit, and the part beyond the cut is discarded.

import * as THREE from "three";

const SURFACE_VERTEX = `
attribute vec3 tint;
varying vec3 vTint, vNormal, vEye, vPlace;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vTint = tint;
  vNormal = normalMatrix * normal;
  vEye = eye.xyz;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
}`;

// The weights of ambient light, light from above, key light, light from the viewer and gloss were chosen by eye.
const SURFACE_FRAGMENT = `
uniform vec4 cut;
uniform vec3 inside;
varying vec3 vTint, vNormal, vEye, vPlace;
void main() {
  if (dot(cut.xyz, vPlace) > cut.w) discard;
  vec3 toViewer = normalize(-vEye);
  vec3 n = normalize(vNormal);
  float facing = dot(n, toViewer);
  if (!gl_FrontFacing) {
    gl_FragColor = vec4(inside * (0.72 + 0.28 * abs(facing)), 1.0);
    return;
  }
  vec3 key = normalize(vec3(-0.35, 0.55, 0.8));
  float light = 0.50 + 0.07 * n.y + 0.36 * max(dot(n, key), 0.0) + 0.10 * max(facing, 0.0);
  float gloss = pow(max(dot(n, normalize(key + toViewer)), 0.0), 40.0);
  gl_FragColor = vec4(min(vTint * light + vec3(0.07 * gloss), 1.0), 1.0);
}`;

// Points are drawn 0.004 half diagonals nearer, so that the surface they lie on does not hide them.
const POINT_VERTEX = `
attribute vec3 tint;
uniform float size;
varying vec3 vTint, vPlace;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  eye.xyz -= 0.004 * normalize(eye.xyz);
  vTint = tint;
  vPlace = position;
  gl_Position = projectionMatrix * eye;
  gl_PointSize = size / -eye.z;
}`;

const POINT_FRAGMENT = `
uniform vec4 cut;
varying vec3 vTint, vPlace;
void main() {
  float radius = length(gl_PointCoord - 0.5);
  if (dot(cut.xyz, vPlace) > cut.w || radius > 0.5) discard;
  gl_FragColor = vec4(vTint * (radius > 0.38 ? 0.4 : 1.0), 1.0);
}`;

const NO_CUT = [0, 0, 0, 1];

export class Scene {
  /** surface: positions, normals, triangles; points: positions or null; orbit: the camera. Throws without WebGL. */
  constructor(canvas, surface, points, orbit) {
    this.canvas = canvas;
    this.orbit = orbit;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.renderer.setClearColor(0x000000, 0);
    this.camera = new THREE.PerspectiveCamera(orbit.fieldOfView, 1, 0.01, 100);
    this.scene = new THREE.Scene();
    this.cut = {value: new THREE.Vector4(...NO_CUT)};
    this.inside = {value: new THREE.Vector3(0.6, 0.6, 0.6)};
    this.pointSize = {value: 1};

    this.surface = geometry(surface.positions);
    this.surface.setAttribute("normal", new THREE.BufferAttribute(surface.normals, 3));
    this.surface.setIndex(new THREE.BufferAttribute(surface.triangles, 1));
    const material = new THREE.ShaderMaterial({
      vertexShader: SURFACE_VERTEX,
      fragmentShader: SURFACE_FRAGMENT,
      uniforms: {cut: this.cut, inside: this.inside},
      side: THREE.DoubleSide,
    });
    this.add(new THREE.Mesh(this.surface, material));
    if (!points) return;
    this.points = geometry(points.positions);
    this.cloud = new THREE.Points(
      this.points,
      new THREE.ShaderMaterial({
        vertexShader: POINT_VERTEX,
        fragmentShader: POINT_FRAGMENT,
        uniforms: {cut: this.cut, size: this.pointSize},
      }),
    );
    this.cloud.visible = false;
    this.add(this.cloud);
  }

  add(object) {
    object.frustumCulled = false;
    this.scene.add(object);
  }

  /** Discards the part beyond the plane normal . x = offset; null: nothing. */
  setCut(plane) {
    this.cut.value.set(...(plane ? [...plane.normal.toArray(), plane.offset] : NO_CUT));
  }

  setColors(surface, points, inside) {
    this.surface.setAttribute("tint", new THREE.BufferAttribute(surface, 3));
    if (points) this.points.setAttribute("tint", new THREE.BufferAttribute(points, 3));
    this.inside.value.set(...inside);
  }

  showPoints(shown) {
    if (this.cloud) this.cloud.visible = shown;
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = this.orbit.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.points) return;
    // Dots with room between them, for points on a surface about as large as the unit ball; limits chosen by eye.
    const dot = Math.min(Math.max(0.9 / Math.sqrt(this.points.attributes.position.count), 0.007), 0.022);
    this.pointSize.value = (dot * height * ratio) / (2 * Math.tan((this.orbit.fieldOfView * Math.PI) / 360));
  }

  draw() {
    this.camera.quaternion.copy(this.orbit.rotation);
    this.camera.position.copy(this.orbit.position);
    this.renderer.render(this.scene, this.camera);
  }
}

function geometry(positions) {
  const result = new THREE.BufferGeometry();
  result.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  result.setAttribute("tint", new THREE.BufferAttribute(new Float32Array(positions.length), 3));
  return result;
}
