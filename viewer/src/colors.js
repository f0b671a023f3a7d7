// Colours of values on a scale of evenly spaced stops, "#rrggbb" each.

/** Byte that stands for "no value". */
export const MISSING = 255;

/** Red, green, blue in [0, 1] of "#rrggbb". */
export function parse(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16) / 255);
}

/** Colour at t in [0, 1] between the stops. */
export function at(stops, t) {
  const place = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
  const first = Math.min(Math.floor(place), stops.length - 2);
  const [a, b] = [parse(stops[first]), parse(stops[first + 1])];
  return a.map((value, c) => value + (place - first) * (b[c] - value));
}

/** Colours of values that were stored in bytes, 0 to 254 from the lower to the upper end of the scale. */
export function colorsOf(values, stops, missing) {
  const table = Array.from({length: 256}, (_, i) => (i === MISSING ? missing : at(stops, i / 254)));
  const result = new Float32Array(3 * values.length);
  for (let i = 0; i < values.length; ++i) result.set(table[values[i]], 3 * i);
  return result;
}

/** Colours stored in bytes: red, green, blue, red, ... */
export function ofBytes(bytes) {
  return Float32Array.from(bytes, (byte) => byte / 255);
}

/** The same colour `count` times. */
export function uniform(count, color) {
  const result = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) result.set(color, 3 * i);
  return result;
}
