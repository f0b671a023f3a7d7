// The cap of a cut. What a closed surface holds is capped: where a pixel of the plane of the cut sees more backs than
// fronts (counted in the stencil buffer), it is inside.

import * as THREE from "three";

import {across} from "./section.js";
import {CAP_FRAGMENT, CAP_VERTEX, COUNT_FRAGMENT, COUNT_VERTEX} from "./shaders.js";
import {number, stopsTexture, texture} from "./uniforms.js";

const SAMPLES = 192; // of the function along each side
const REACH = 1.02; // of the plane, in half diagonals of the data
export const LEVELS_ON_CAP = 12;

/** Counts the backs (THREE.BackSide), or takes the fronts from it, of what the cut leaves. */
export function capCounter(geometry, side, cut) {
  const material = new THREE.ShaderMaterial({
    vertexShader: COUNT_VERTEX,
    fragmentShader: COUNT_FRAGMENT,
    uniforms: {cut},
    side,
    depthWrite: false,
    depthTest: false,
    colorWrite: false,
    stencilWrite: true,
    stencilFunc: THREE.AlwaysStencilFunc,
  });
  const step = side === THREE.BackSide ? THREE.IncrementWrapStencilOp : THREE.DecrementWrapStencilOp;
  material.stencilZPass = material.stencilZFail = material.stencilFail = step;
  return new THREE.Mesh(geometry, material);
}

// The values on the plane, from the corner (-1, -1) on, as a texture.
function valuesTexture(values, corner) {
  const bytes = new Uint8Array(4 * SAMPLES * SAMPLES);
  const place = (i) => (2 * (i + 0.5)) / SAMPLES - 1;
  for (let j = 0, k = 0; j < SAMPLES; ++j)
    for (let i = 0; i < SAMPLES; ++i, k += 4) {
      const value = values(...corner(place(i), place(j)));
      bytes[k] = Math.round(255 * Math.min(Math.max(Number.isFinite(value) ? value : 0.5, 0), 1));
      bytes[k + 3] = 255;
    }
  return texture(bytes, SAMPLES, SAMPLES);
}

/**
 * The plane of the cut, drawn where it is inside.
 * @param {{normal: number[], offset: number}} plane
 * @param {{values: (x: number, y: number, z: number) => number, stops: string[]}|null} fill its colours; null: those of `inside`
 * @param {{value: THREE.Vector3}} inside
 */
export function capMesh({normal, offset}, fill, inside) {
  const [u, v] = across(normal);
  const corner = (s, t) => normal.map((n, a) => n * offset + REACH * (s * u[a] + t * v[a]));
  const geometry = new THREE.BufferGeometry();
  const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
  const positions = new Float32Array(corners.flatMap(([s, t]) => corner(s, t)));
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("place", new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const material = new THREE.ShaderMaterial({
    vertexShader: CAP_VERTEX,
    fragmentShader: CAP_FRAGMENT,
    uniforms: {
      values: number(fill && valuesTexture(fill.values, corner)),
      stops: number(fill && stopsTexture(fill.stops)),
      mode: number(fill ? 1 : 0),
      levels: number(LEVELS_ON_CAP),
      inside,
    },
    side: THREE.DoubleSide,
    stencilWrite: true,
    stencilRef: 0,
    stencilFunc: THREE.NotEqualStencilFunc,
  });
  material.stencilZPass = material.stencilZFail = material.stencilFail = THREE.ZeroStencilOp;
  return new THREE.Mesh(geometry, material);
}
