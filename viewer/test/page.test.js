import assert from "node:assert/strict";
import {test} from "node:test";

import * as colors from "../src/colors.js";
import * as decode from "../src/decode.js";
import {corners, valueUnder} from "../src/hover.js";
import {decodeLook, decodeNpy, guessUp, pictureOf} from "../src/look.js";
import {bytesText, counted, pretty, readable, roundStep, ticks} from "../src/ticks.js";
import {near} from "./helpers.js";

const base64 = (array) => Buffer.from(array.buffer).toString("base64");

test("stored places become places in the box, whose diagonal is 2", () => {
  const {center, scale, halfSides} = decode.frame([1, 2, 3], [4, 6, 15]);
  near(center, [2.5, 4, 9]);
  assert.equal(scale, 2 / 13);
  near(halfSides, [3 / 13, 4 / 13, 12 / 13]);
  const places = decode.positions(base64(new Uint16Array([0, 65535, 0, 65535, 0, 65535])), halfSides);
  near([...places], [-3 / 13, 4 / 13, -12 / 13, 3 / 13, -4 / 13, 12 / 13], 1e-6);
});

test("a box without extent does not divide by zero", () => {
  assert.ok(Number.isFinite(decode.frame([1, 1, 1], [1, 1, 1]).scale));
});

test("normals have length one", () => {
  const normals = decode.normals(base64(new Int8Array([127, 0, 0, -50, 60, 70])));
  near([...normals.slice(0, 3)], [1, 0, 0]);
  assert.ok(Math.abs(Math.hypot(...normals.slice(3)) - 1) < 1e-6);
});

test("colours run through the stops, and missing values have no place on the scale", () => {
  const stops = ["#000000", "#ff0000", "#ffffff"];
  near(colors.at(stops, 0), [0, 0, 0]);
  near(colors.at(stops, 0.25), [0.5, 0, 0]);
  near(colors.at(stops, 0.5), [1, 0, 0]);
  near(colors.at(stops, 2), [1, 1, 1]);
  near([...colors.placesOnScale([0, 5, 10, 20, NaN], 0, 10)], [0, 0.5, 1, 1, -1]);
  near([...colors.placesOnScale([3, 3], 3, 3)], [0.5, 0.5]);
  assert.deepEqual([...colors.palette(stops, 3)], [0, 0, 0, 255, 255, 0, 0, 255, 255, 255, 255, 255]);
});

test("a few extreme values do not set the range", () => {
  const values = Array.from({length: 1000}, (_, i) => i);
  values[7] = 1e9;
  values[8] = NaN;
  const [lo, hi] = colors.robustRange(values);
  assert.ok(lo >= 0 && lo < 20 && hi > 970 && hi < 1000);
  assert.deepEqual(colors.robustRange([NaN]), [0, 1]);
  assert.deepEqual(colors.robustRange([2, 2]), [1.5, 2.5]);
});

test("stored values become values of the scale", () => {
  near([...decode.values(base64(new Uint8Array([0, 127, 254])), -1, 1)], [-1, 0, 1], 1e-6);
  assert.ok(Number.isNaN(decode.values(base64(new Uint8Array([255])), 0, 1)[0]));
});

test("steps of axes are round, and ticks lie within", () => {
  assert.equal(roundStep(10, 5), 2);
  assert.equal(roundStep(0.9, 4), 0.2);
  assert.deepEqual(ticks(0, 1, 4).map((t) => t.text), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
  assert.deepEqual(ticks(-1e7, 1e7, 2).map((t) => t.text), ["−1×10⁷", "0", "1×10⁷"]);
  assert.deepEqual(ticks(5400000, 5400100, 2).map((t) => t.text), ["5,400,000", "5,400,050", "5,400,100"]);
  assert.deepEqual(ticks(5.4e6, 5.45e6, 2).map((t) => t.text), ["5,400,000", "5,420,000", "5,440,000"]);
  assert.deepEqual(ticks(1, 1), []);
  assert.deepEqual(ticks(NaN, 2), []);
});

test("numbers read as people write them", () => {
  assert.equal(readable(52980), "52,980");
  assert.equal(readable(0.07531, 3), "0.0753");
  assert.equal(readable(-3.2e-6, 2), "−3.2×10⁻⁶");
  assert.equal(readable(1234.5678, 6), "1234.57");
  assert.equal(readable(NaN), "–");
  assert.equal(readable(0), "0");
  assert.equal(pretty("1e+9"), "1×10⁹");
  assert.equal(bytesText(1234567), "1.23 MB");
  assert.equal(bytesText(12), "12 B");
  assert.equal(counted(1, "point"), "1 point");
  assert.equal(counted(2000, "vertex", "vertices"), "2,000 vertices");
});

// ---- geometry

test("what stands on a flat base has its axis up", () => {
  const positions = [];
  for (let i = 0; i < 3000; ++i) {
    const [a, b] = [(i * 0.618) % 1, (i * 0.414) % 1];
    if (i % 4 === 0) positions.push(2 * a - 1, -1, 2 * b - 1);
    else positions.push((1 - b) * Math.cos(6.28 * a), 2 * b - 1, (1 - b) * Math.sin(6.28 * a));
  }
  assert.equal(guessUp(new Float32Array(positions), [1, 1, 1]), "y");
  assert.equal(guessUp(new Float32Array(6), [1, 1, 1]), "z");
});

// ---- data

function lookBytes(header, arrays) {
  const text = new TextEncoder().encode(JSON.stringify({...header, arrays: arrays.map(({name, type, values}) => ({name, type, count: values.length}))}));
  const pad = (n) => Math.ceil(n / 8) * 8;
  const size = arrays.reduce((sum, {values}) => sum + pad(values.byteLength), pad(4 + text.length));
  const buffer = new ArrayBuffer(size);
  new DataView(buffer).setUint32(0, text.length, true);
  new Uint8Array(buffer, 4).set(text);
  let at = pad(4 + text.length);
  for (const {values} of arrays) {
    new Uint8Array(buffer, at).set(new Uint8Array(values.buffer));
    at += pad(values.byteLength);
  }
  return buffer;
}

test("looks are read, and become pictures in the box of the data", () => {
  const buffer = lookBytes({kind: "points", total: 2, low: [10, 0, 0], high: [14, 3, 0], columns: [{name: "height", array: "column0", range: [1, 2]}]}, [
    {name: "positions", type: "f4", values: new Float32Array([-2, -1.5, 0, 2, 1.5, 0])},
    {name: "column0", type: "f4", values: new Float32Array([1, 2])},
  ]);
  const look = decodeLook(buffer);
  assert.deepEqual([look.kind, look.total, look.columns[0].name], ["points", 2, "height"]);
  const picture = pictureOf({points: look});
  near([...picture.points.positions], [-0.8, -0.6, 0, 0.8, 0.6, 0], 1e-6);
  assert.equal(picture.scales[0].name, "height");
  const shifted = pictureOf({points: look}, {low: [12, 1.5, 0], high: [16, 4.5, 0]});
  near([...shifted.points.positions], [-1.6, -1.2, 0, 0, 0, 0], 1e-6);
});

test("arrays of numpy are read", () => {
  const head = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }".padEnd(117) + "\n";
  const bytes = new Uint8Array(10 + head.length + 48);
  bytes.set([0x93, 78, 85, 77, 80, 89, 1, 0, head.length & 255, head.length >> 8]);
  bytes.set(new TextEncoder().encode(head), 10);
  bytes.set(new Uint8Array(new Float64Array([1, 2, 3, 4, 5, 6]).buffer), 10 + head.length);
  const array = decodeNpy(bytes.buffer);
  assert.deepEqual(array.shape, [2, 3]);
  assert.deepEqual([...array.values], [1, 2, 3, 4, 5, 6]);
});

const PLOT = {x: [0, 10, 50, 400, "distance"], y: [0, 100, 20, 200, "points"]};

test("bars, maps and curves tell their values", () => {
  const bars = valueUnder({...PLOT, bars: [5, 7]}, 150, 100, []);
  assert.equal(bars.text, "0 to 5: 5 points");
  assert.equal(bars.x, 150);
  assert.match(valueUnder({...PLOT, map: {columns: 2, rows: 2, lo: 0, hi: 254, label: "depth", cells: [1, 2, 3, 255]}}, 449, 219, []).text, /depth 2$/);
  assert.match(valueUnder({...PLOT, map: {columns: 2, rows: 2, lo: 0, hi: 254, label: "depth", cells: [1, 2, 3, 255]}}, 449, 21, []).text, /no value$/);
  const series = [corners("M50 220L450 20")];
  assert.equal(valueUnder(PLOT, 448, 24, series).text, "distance: 10, points: 100");
  assert.equal(valueUnder(PLOT, 250, 100, series), null);
  assert.equal(valueUnder(PLOT, 10, 10, series), null);
  assert.deepEqual(corners("M1 2h0M3.5 -4h0"), [[1, 2], [3.5, -4]]);
});

// ---- the studio

test("numbers of an axis are grouped where they are long", () => {
  assert.deepEqual(ticks(0, 20000, 2).map(({text}) => text), ["0", "10,000", "20,000"]);
  assert.deepEqual(ticks(-5000, 5000, 2).map(({text}) => text), ["−5000", "0", "5000"]);
});
