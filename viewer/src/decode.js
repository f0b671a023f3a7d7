// Decodes the data of a picture in space, which app/report/surface_view.cpp encodes, into typed arrays.

import {MISSING, ofBytes} from "./colors.js";

/** Bytes of base64 text. */
export function bytes(text) {
  const binary = atob(text);
  const result = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) result[i] = binary.charCodeAt(i);
  return result;
}

/** Little-endian unsigned 16-bit numbers of base64 text. */
export function shorts(text) {
  return new Uint16Array(bytes(text).buffer);
}

/** The map from the box of the data to the scene: the box is centred and its diagonal becomes 2. */
export function frame(low, high) {
  const sides = low.map((lo, a) => high[a] - lo);
  const scale = 2 / (Math.hypot(...sides) || 1);
  return {center: low.map((lo, a) => lo + sides[a] / 2), scale, halfSides: sides.map((side) => (side * scale) / 2)};
}

/** Scene coordinates of points that were stored as fractions of the box, 65535 being its upper end. */
export function positions(text, halfSides) {
  const stored = shorts(text);
  const result = new Float32Array(stored.length);
  for (let i = 0; i < stored.length; ++i) result[i] = halfSides[i % 3] * ((2 * stored[i]) / 65535 - 1);
  return result;
}

/** Unit vectors that were stored in three signed bytes each. */
export function normals(text) {
  const stored = new Int8Array(bytes(text).buffer);
  const result = new Float32Array(stored.length);
  for (let i = 0; i < stored.length; i += 3) {
    const length = Math.hypot(stored[i], stored[i + 1], stored[i + 2]) || 1;
    for (let a = 0; a < 3; ++a) result[i + a] = stored[i + a] / length;
  }
  return result;
}

/** Values stored in bytes, 0 to 254 from the lower to the upper end of a scale; NaN where there is none. */
export function values(text, lo, hi) {
  const stored = bytes(text);
  const result = new Float32Array(stored.length);
  for (let i = 0; i < stored.length; ++i) result[i] = stored[i] === MISSING ? NaN : lo + ((hi - lo) * stored[i]) / 254;
  return result;
}

/**
 * The picture that a report holds, as View takes it (space/view.js).
 * @param {object} data the JSON of the report
 */
export function picture(data) {
  const box = frame(data.low, data.high);
  const scales = data.scales.map((scale) => ({
    name: scale.name,
    title: scale.title,
    lo: scale.lo,
    hi: scale.hi,
    map: scale.map,
    values: values(scale.values, scale.lo, scale.hi),
    pointValues: scale.point_values ? values(scale.point_values, scale.lo, scale.hi) : null,
  }));
  return {
    low: data.low,
    high: data.high,
    up: data.up,
    unit: data.unit || "",
    axes: data.axes || ["x", "y", "z"],
    axisRanges: data.axis_ranges || null,
    colors: data.colors,
    shown: data.shown,
    mesh: data.triangles
      ? {
          positions: positions(data.positions, box.halfSides),
          normals: normals(data.normals),
          triangles: shorts(data.triangles),
          tint: data.tints ? ofBytes(bytes(data.tints)) : null,
        }
      : null,
    points: data.points
      ? {
          positions: positions(data.points.positions, box.halfSides),
          tint: data.points.tints ? ofBytes(bytes(data.points.tints)) : null,
        }
      : null,
    lines: data.lines
      ? {positions: positions(data.lines.positions, box.halfSides), edges: shorts(data.lines.edges)}
      : null,
    scales,
    inside: data.inside && {
      size: data.inside.size,
      lo: data.inside.lo,
      hi: data.inside.hi,
      title: data.inside.title,
      values: values(data.inside.values, data.inside.lo, data.inside.largest),
    },
  };
}
