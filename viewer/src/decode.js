// Decodes the data of a surface, which app/page/surface_view.cpp encodes, into typed arrays.

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
