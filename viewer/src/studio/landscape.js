// A function of two variables as a picture in space.

import {robustRange} from "../colors.js";
import {DEFAULT_COLORS} from "../look.js";

const HEIGHT = 0.35; // of the picture, in its longest side
const MOST_UNEQUAL = 3; // times as long, from which axes are drawn equally long: they have different units
const OUTERMOST = 0.02; // of the values, at either end
const FAR_BEYOND = 1.5; // the whole range, in that of the others

function rangeOf(values) {
  let lo = Infinity, hi = -Infinity;
  for (const value of values) if (Number.isFinite(value)) [lo, hi] = [Math.min(lo, value), Math.max(hi, value)];
  return [lo, hi];
}

// A function may rise steeply where it extrapolates, which would leave one colour to the rest.
function colorRange(name, values, [lo, hi]) {
  const inner = robustRange(values, OUTERMOST);
  if (hi - lo < FAR_BEYOND * (inner[1] - inner[0])) return {title: name, lo, hi};
  return {title: `${name} (colours of all but the outermost ${200 * OUTERMOST} %)`, lo: inner[0], hi: inner[1]};
}

/** Values on a grid as a surface: heights are values, scaled to be visible. */
export function landscape({shape, values}, info) {
  const [rows, columns] = shape;
  const data = Float32Array.from(values, Number);
  const [lo, hi] = rangeOf(data);
  const sides = [0, 1].map((a) => info.bounds.hi[a] - info.bounds.lo[a]);
  const longest = Math.max(...sides);
  const drawn = sides.map((side) => (longest / side > MOST_UNEQUAL ? 1 : side / longest));
  const half = [...drawn, HEIGHT].map((side) => side / 2);
  const scale = 2 / Math.hypot(...half.map((side) => 2 * side));
  const positions = new Float32Array(3 * rows * columns);
  const triangles = [];
  for (let j = 0; j < rows; ++j)
    for (let i = 0; i < columns; ++i) {
      const k = j * columns + i;
      positions[3 * k] = scale * half[0] * ((2 * i) / (columns - 1) - 1);
      positions[3 * k + 1] = scale * half[1] * ((2 * j) / (rows - 1) - 1);
      positions[3 * k + 2] = scale * half[2] * (hi > lo ? (2 * (data[k] - lo)) / (hi - lo) - 1 : 0);
      if (i + 1 < columns && j + 1 < rows) triangles.push(k, k + 1, k + columns + 1, k, k + columns + 1, k + columns);
    }
  const name = (info.values || ["value"])[0];
  return {
    low: half.map((side) => -side),
    high: half,
    up: "z",
    unit: "",
    axes: [...(info.coordinates || ["x", "y"]), name],
    axisRanges: [...[0, 1].map((a) => [info.bounds.lo[a], info.bounds.hi[a]]), [lo, hi]],
    colors: DEFAULT_COLORS,
    shown: "0",
    mesh: {positions, normals: null, triangles: new Uint32Array(triangles), tint: null},
    points: null,
    scales: [{name, ...colorRange(name, data, [lo, hi]), map: "sequential", values: data, pointValues: null}],
    inside: null,
  };
}
