// Looks: what an engine sends of an item to be drawn (Look in engine.js), as bytes and as a picture in space.

import {frame} from "./decode.js";
import {robustRange} from "./colors.js";

const TYPES = {f4: Float32Array, f8: Float64Array, u4: Uint32Array, u1: Uint8Array};
const ALIGNMENT = 8;
// Those of reports.
const SEQUENTIAL = "#202463 #03417d #00608f #007e97 #009c95 #00b68b #6bcc7a #b2dd67 #f5ea5c".split(" ");
const DIVERGING = "#1f68bc #548acf #84acdf #b6ceec #eeeeee #eac0b7 #da9586 #c66b58 #ae3f29".split(" ");
export const DEFAULT_COLORS = {sequential: SEQUENTIAL, diverging: DIVERGING};

const aligned = (size) => Math.ceil(size / ALIGNMENT) * ALIGNMENT;

/** Reads the bytes of a look or slice: size of the header, the header in JSON, arrays that it lists. */
export function decodeLook(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  let at = aligned(4 + size);
  const arrays = {};
  for (const {name, type, count} of header.arrays || []) {
    arrays[name] = new TYPES[type](buffer, at, count);
    at = aligned(at + arrays[name].byteLength);
  }
  const {arrays: _listed, columns, ...look} = header;
  const columnsOf = (columns || []).map(({array, ...column}) => ({...column, values: arrays[array]}));
  for (const name of Object.keys(arrays)) if (!name.startsWith("column")) look[name] = arrays[name];
  return {...look, columns: columnsOf};
}

/** Columns that are colours are one; the others become scales. */
function scalesOf(columns, key) {
  const hidden = new Set(["red", "green", "blue", "alpha", "x", "y", "z", "nx", "ny", "nz"]);
  return columns
    .filter((column) => !hidden.has(column.name.toLowerCase()))
    .map((column) => {
      const [lo, hi] = robustRange(column.values);
      const diverging = lo < 0 && hi > 0 && /curvature|^k[12]$|difference|residual/.test(column.name);
      const limit = Math.max(Math.abs(lo), Math.abs(hi));
      return {
        name: column.name.replace(/_/g, " "),
        title: column.name.replace(/_/g, " "),
        lo: diverging ? -limit : lo,
        hi: diverging ? limit : hi,
        map: diverging ? "diverging" : "sequential",
        values: key === "mesh" ? column.values : null,
        pointValues: key === "points" ? column.values : null,
      };
    });
}

function scaled(positions, shift, factor) {
  const result = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; ++i) result[i] = (positions[i] + shift[i % 3]) * factor;
  return result;
}

/** Colours of points or vertices that the file has, 0 to 1; null when it has none. */
function ownColors(columns) {
  const channels = ["red", "green", "blue"].map((name) => columns.find((column) => column.name.toLowerCase() === name));
  if (channels.some((channel) => !channel)) return null;
  const result = new Float32Array(3 * channels[0].values.length);
  channels.forEach((channel, c) => channel.values.forEach((value, i) => (result[3 * i + c] = value / 255)));
  return result;
}

/**
 * Looks at points and meshes as one picture in space, in the box of the first one unless `box` is given.
 * @param {{mesh?: object, points?: object}} looks
 */
export function pictureOf({mesh, points}, box) {
  const first = mesh || points;
  const {low, high} = box || {low: Array.from(first.low), high: Array.from(first.high)};
  const {center, scale} = frame(low, high);
  const place = (look) => {
    const shift = center.map((c, a) => (look.low[a] + look.high[a]) / 2 - c);
    return {positions: scaled(look.positions, shift, scale), tint: ownColors(look.columns)};
  };
  return {
    low,
    high,
    up: null,
    unit: first.unit || "",
    axes: ["x", "y", "z"],
    colors: DEFAULT_COLORS,
    shown: "plain",
    mesh: mesh ? {...place(mesh), normals: mesh.normals || null, triangles: mesh.triangles} : null,
    points: points ? {...place(points), normals: points.normals || null} : null,
    scales: [...(mesh ? scalesOf(mesh.columns, "mesh") : []), ...(points ? scalesOf(points.columns, "points") : [])],
    inside: null,
  };
}

/** Points from three columns of a table, with the others as colours. */
export function pictureOfColumns(columns, chosen) {
  const count = chosen[0].values.length;
  const axes = chosen.map((column) => column.range);
  const sides = axes.map(([lo, hi]) => hi - lo);
  // Axes of different units are drawn equally long.
  const longest = Math.max(...sides) || 1;
  const factors = sides.map((side) => (side > 0 && longest / side > 3 ? longest / side : 1));
  const low = axes.map(([lo], a) => lo * factors[a]);
  const high = axes.map(([, hi], a) => hi * factors[a]);
  const {center, scale} = frame(low, high);
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i)
    for (let a = 0; a < 3; ++a) positions[3 * i + a] = (chosen[a].values[i] * factors[a] - center[a]) * scale;
  return {
    low,
    high,
    up: "z",
    unit: "",
    axes: chosen.map((column) => column.name),
    axisRanges: axes,
    colors: DEFAULT_COLORS,
    shown: "plain",
    mesh: null,
    points: {positions, tint: null},
    scales: scalesOf(columns, "points"),
    inside: null,
  };
}

const NPY = {f8: Float64Array, f4: Float32Array, i4: Int32Array, u1: Uint8Array, i8: BigInt64Array, u2: Uint16Array};

/** A .npy file: {shape, values}. */
export function decodeNpy(buffer) {
  const view = new DataView(buffer);
  const long = view.getUint8(6) > 1;
  const size = long ? view.getUint32(8, true) : view.getUint16(8, true);
  const start = (long ? 12 : 10) + size;
  const head = new TextDecoder("latin1").decode(new Uint8Array(buffer, long ? 12 : 10, size));
  const type = head.match(/'descr':\s*'[<|]([a-z]\d)'/);
  const shape = head.match(/'shape':\s*\(([^)]*)\)/);
  if (!type || !shape || !NPY[type[1]]) throw new Error("this array cannot be drawn");
  const copy = buffer.slice(start);
  return {shape: shape[1].split(",").filter((s) => s.trim()).map(Number), values: new NPY[type[1]](copy)};
}

/** The axis that probably points upwards: the one at whose lower end the data stand flat; else z. */
export function guessUp(positions, halfSides) {
  if (!positions || positions.length < 300) return "z";
  const stride = Math.max(1, Math.floor(positions.length / 3 / 20000));
  const band = 0.015; // of the side; chosen by hand
  const best = {axis: "z", lead: 0};
  for (let a = 0; a < 3; ++a) {
    if (halfSides[a] < 0.02) return "xyz"[a]; // a sheet
    let low = 0, high = 0, count = 0;
    for (let i = a; i < positions.length; i += 3 * stride, ++count) {
      if (positions[i] < -halfSides[a] * (1 - 2 * band)) ++low;
      else if (positions[i] > halfSides[a] * (1 - 2 * band)) ++high;
    }
    const lead = (low - high) / count;
    if (low > 3 * high && lead > 0.02 && lead > 1.5 * best.lead) Object.assign(best, {axis: "xyz"[a], lead});
  }
  return best.axis;
}
