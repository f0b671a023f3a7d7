// Colours of values on a scale of evenly spaced stops, "#rrggbb" each.

/** Byte that stands for "no value" in the data of reports. */
export const MISSING = 255;

// Sequential maps rise evenly in lightness and keep their order for people with any red-green colour blindness:
// viridis and cividis (CC0), batlow by F. Crameri (MIT), grey. The program's own are in the data of a page.
export const MAPS = {
  viridis: "#440154 #482878 #3e4a89 #31688e #26828e #1f9e89 #35b779 #6ece58 #b5de2b #fde725".split(" "),
  cividis: "#00224e #123570 #3b496c #575d6d #707173 #8a8678 #a59c74 #c3b369 #e1cc55 #fee838".split(" "),
  batlow: "#011959 #103f60 #1c5a62 #3c6d56 #687b3e #9d892b #d29343 #f8a17b #fdb7bc #faccfa".split(" "),
  grey: ["#101010", "#f4f4f4"],
};

/** Colours of labels and regions, told apart also without red or green; after P. Tol's "bright" scheme. */
export const LABELS = "#4477aa #ee6677 #228833 #ccbb44 #66ccee #aa3377 #ee8866 #997700 #bbbbbb #114477".split(" ");

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

/** Colours stored in bytes: red, green, blue, red, ... */
export function ofBytes(bytes) {
  return Float32Array.from(bytes, (byte) => byte / 255);
}

/** The stops as `count` colours of four bytes each, for a texture. */
export function palette(stops, count = 256) {
  const result = new Uint8Array(4 * count);
  for (let i = 0; i < count; ++i) {
    at(stops, i / (count - 1)).forEach((value, c) => (result[4 * i + c] = Math.round(255 * value)));
    result[4 * i + 3] = 255;
  }
  return result;
}

/** Places of values on a scale, 0 to 1; -1 where there is none. */
export function placesOnScale(values, lo, hi) {
  const result = new Float32Array(values.length);
  const factor = hi > lo ? 1 / (hi - lo) : 0;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i];
    result[i] = Number.isFinite(value) ? (factor ? Math.min(Math.max((value - lo) * factor, 0), 1) : 0.5) : -1;
  }
  return result;
}

/** The range of the values without the `share` at each end: a few extreme ones do not set it. */
export function robustRange(values, share = 0.01) {
  const stride = Math.max(1, Math.floor(values.length / 100000));
  const finite = [];
  for (let i = 0; i < values.length; i += stride) if (Number.isFinite(values[i])) finite.push(values[i]);
  if (finite.length === 0) return [0, 1];
  finite.sort((a, b) => a - b);
  const at = (p) => finite[Math.round(p * (finite.length - 1))];
  const [lo, hi] = [at(share), at(1 - share)];
  if (hi > lo) return [lo, hi];
  return finite[finite.length - 1] > finite[0] ? [finite[0], finite[finite.length - 1]] : [lo - 0.5, lo + 0.5];
}
