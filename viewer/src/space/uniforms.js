// What shaders are given.

import {DataTexture, LinearFilter, RGBAFormat, Vector3} from "three";

import {palette} from "../colors.js";

export const number = (value) => ({value});

export function texture(bytes, width, height) {
  const result = new DataTexture(bytes, width, height, RGBAFormat);
  result.magFilter = result.minFilter = LinearFilter;
  result.needsUpdate = true;
  return result;
}

/** The colours of a scale. */
export const stopsTexture = (stops) => texture(palette(stops), 256, 1);

/** How values are coloured: uniforms that surface and points share the shape of. */
export function colorUniforms() {
  return {
    stops: number(stopsTexture(["#000000", "#ffffff"])),
    plain: number(new Vector3(0.8, 0.8, 0.8)),
    missing: number(new Vector3(0.7, 0.7, 0.7)),
    mode: number(0),
    levels: number(0),
  };
}
