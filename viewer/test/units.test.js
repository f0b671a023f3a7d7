import assert from "node:assert/strict";
import {test} from "node:test";

import * as colors from "../src/colors.js";
import * as decode from "../src/decode.js";
import {checkEngine} from "../src/engine.js";
import {events} from "../src/engine_native.js";
import {corners, valueUnder} from "../src/hover.js";
import {decodeLook, decodeNpy, guessUp, pictureOf} from "../src/look.js";
import {aboutAxis, Orbit} from "../src/orbit.js";
import {blend, pickPoint, pickTriangle} from "../src/pick.js";
import {allEdges, creaseEdges} from "../src/scene.js";
import {coarseTriangles} from "../src/coarse.js";
import {across, areaOf, section, valueAt} from "../src/section.js";
import {labelEdges, orientation, physical, planeOf, seedTable, svgLines} from "../src/slices.js";
import {landscape, previewArgs} from "../src/studio/app.js";
import {roleFlags, usualRoles} from "../src/studio/columns.js";
import {sliderScale} from "../src/studio/options.js";
import {framesOf, isSeries, labelFiles, seriesOf} from "../src/studio/series.js";
import {commandLine, outputsOf, pythonLines, unused} from "../src/studio/tasks.js";
import {bytesText, counted, pretty, readable, roundStep, ticks} from "../src/ticks.js";
import {Vector3} from "three";

const base64 = (array) => Buffer.from(array.buffer).toString("base64");
const rotate = (q, v) => new Vector3(...v).applyQuaternion(q).toArray();
const near = (a, b, tolerance = 1e-12) => {
  assert.equal(a.length, b.length);
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < tolerance, `${a} and ${b}`));
};

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

test("rotations turn as the right hand does", () => {
  near(rotate(aboutAxis(new Vector3(0, 0, 1), Math.PI / 2), [1, 0, 0]), [0, 1, 0]);
});

test("the axis that is up points upwards in the picture", () => {
  for (const [axis, vector] of Object.entries({x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]})) {
    const orbit = new Orbit(axis);
    const [right, up] = rotate(orbit.rotation.clone().conjugate(), vector);
    assert.ok(Math.abs(right) < 1e-12 && up > 0.9, `${axis}: ${right} ${up}`);
  }
});

test("turning keeps the distance, and turning back leads back", () => {
  const orbit = new Orbit();
  const before = orbit.position;
  orbit.turn(0.7, 0);
  assert.ok(orbit.position.distanceTo(before) > 0.5);
  assert.ok(Math.abs(orbit.position.length() - orbit.distance) < 1e-12);
  orbit.turn(-0.7, 0);
  near(orbit.position.toArray(), before.toArray(), 1e-9);
});

test("the unit ball fits into pictures of any shape", () => {
  const orbit = new Orbit();
  for (const aspect of [0.4, 1, 2.5]) {
    orbit.aspect = aspect;
    const half = Math.atan(Math.tan((orbit.fieldOfView * Math.PI) / 360) * Math.min(1, aspect));
    assert.ok(Math.asin(1 / orbit.distance) <= half + 1e-12);
  }
});

test("the first view fills the picture, and nothing sticks out of it", () => {
  const orbit = new Orbit("z");
  orbit.aspect = 2;
  const corners = new Float32Array([-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].flatMap((z) => [0.8 * x, 0.4 * y, 0.3 * z]))));
  const ball = orbit.distance;
  orbit.fit(corners);
  assert.ok(orbit.distance < ball);
  const inverse = orbit.rotation.clone().conjugate();
  const slope = Math.tan((orbit.fieldOfView * Math.PI) / 360);
  for (let i = 0; i < corners.length; i += 3) {
    const [x, y, z] = rotate(inverse, [...corners.slice(i, i + 3)]);
    assert.ok(Math.max(Math.abs(x) / orbit.aspect, Math.abs(y)) < slope * (orbit.distance - z));
  }
});

test("zoom and pan stay within reach", () => {
  const orbit = new Orbit();
  for (let i = 0; i < 100; ++i) {
    orbit.zoom(0.5);
    orbit.pan(1, 1);
  }
  assert.ok(orbit.distance > 0.1);
  orbit.target.toArray().forEach((value) => assert.ok(Math.abs(value) <= 2));
});

test("looking along an axis puts it towards the viewer and keeps the upward axis up", () => {
  for (const up of "xyz")
    for (const axis of ["x", "-x", "y", "-y", "z", "-z"]) {
      const orbit = new Orbit(up);
      orbit.lookFrom(axis);
      const direction = {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]}[axis.slice(-1)].map((v) => (axis[0] === "-" ? -v : v));
      near(rotate(orbit.rotation.clone().conjugate(), direction), [0, 0, 1], 1e-9);
      if (axis.slice(-1) === up) continue;
      const upward = {x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1]}[up];
      near(rotate(orbit.rotation.clone().conjugate(), upward), [0, 1, 0], 1e-9);
    }
});

test("a view is kept as numbers", () => {
  const orbit = new Orbit("z");
  orbit.turn(0.3, 0.2);
  orbit.zoom(0.5);
  orbit.pan(0.1, 0);
  const other = new Orbit("z");
  other.state = orbit.state;
  near(other.state, orbit.state, 1e-12);
  other.state = [NaN, 0, 0, 0, 0, 0, 0, 1];
  near(other.state, orbit.state, 1e-12);
});

// ---- numbers

test("steps of axes are round, and ticks lie within", () => {
  assert.equal(roundStep(10, 5), 2);
  assert.equal(roundStep(0.9, 4), 0.2);
  assert.deepEqual(ticks(0, 1, 4).map((t) => t.text), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
  assert.deepEqual(ticks(-1e7, 1e7, 2).map((t) => t.text), ["−1×10⁷", "0", "1×10⁷"]);
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

const CUBE = (() => {
  const positions = [];
  for (let i = 0; i < 8; ++i) positions.push(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  const quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return {positions: new Float32Array(positions), triangles: new Uint16Array(quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]))};
})();

test("a plane cuts a square out of a cube", () => {
  const ends = section(CUBE.positions, CUBE.triangles, [0, 0, 1], 0.25);
  assert.equal(ends.length % 6, 0);
  for (let i = 2; i < ends.length; i += 3) assert.ok(Math.abs(ends[i] - 0.25) < 1e-6);
  assert.ok(Math.abs(areaOf(ends, [0, 0, 1]) - 4) < 1e-5);
  assert.equal(section(CUBE.positions, CUBE.triangles, [0, 0, 1], 2).length, 0);
  const turn = (i) => [ends[i] * ends[i + 4] - ends[i + 1] * ends[i + 3] > 0]; // about the middle, always the same way
  for (let i = 6; i < ends.length; i += 6) assert.deepEqual(turn(i), turn(0));
  const slanted = Math.SQRT1_2;
  assert.ok(Math.abs(areaOf(section(CUBE.positions, CUBE.triangles, [slanted, slanted, 0], 0), [slanted, slanted, 0]) - 2 * 2 * Math.SQRT2) < 1e-4);
});

test("two vectors span the plane", () => {
  for (const normal of [[1, 0, 0], [0, 0, 1], [0.6, 0, 0.8]]) {
    const [u, v] = across(normal);
    const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
    near([dot(u, v), dot(u, normal), dot(v, normal), dot(u, u), dot(v, v)], [0, 0, 0, 1, 1], 1e-12);
  }
});

test("values of a grid are linear between its nodes", () => {
  const values = new Float32Array(3 * 4 * 5);
  const f = (x, y, z) => 1 + 2 * x - y + 3 * z;
  for (let k = 0; k < 5; ++k)
    for (let j = 0; j < 4; ++j) for (let i = 0; i < 3; ++i) values[i + 3 * (j + 4 * k)] = f(i - 1, (2 * j) / 3 - 1, k / 2 - 1);
  const grid = {size: [3, 4, 5], values};
  for (const place of [[0, 0, 0], [0.3, -0.7, 0.9], [1, 1, 1], [-1, -1, -1]])
    assert.ok(Math.abs(valueAt(grid, [1, 1, 1], ...place) - f(...place)) < 1e-5);
  assert.ok(Number.isNaN(valueAt(grid, [1, 1, 1], 1.1, 0, 0)));
});

test("the first triangle under a ray is picked, and what is cut away is not", () => {
  const found = pickTriangle(CUBE.positions, CUBE.triangles, [0.2, 0.3, 5], [0, 0, -1]);
  near(found.place, [0.2, 0.3, 1], 1e-6);
  near(blend(found, CUBE.positions, 3), [0.2, 0.3, 1], 1e-6);
  near(pickTriangle(CUBE.positions, CUBE.triangles, [0.2, 0.3, 5], [0, 0, -1], (p) => p[2] < 0).place, [0.2, 0.3, -1], 1e-6);
  assert.equal(pickTriangle(CUBE.positions, CUBE.triangles, [2, 0, 5], [0, 0, -1]), null);
  assert.equal(pickTriangle(CUBE.positions, CUBE.triangles, [0, 0, 5], [0, 0, 1]), null);
  assert.equal(pickPoint(CUBE.positions, [0.98, 0.97, 5], [0, 0, -1], 0.05).index, 7);
  assert.equal(pickPoint(CUBE.positions, [0, 0, 5], [0, 0, -1], 0.05), null);
});

test("a cube has 18 edges, 12 of them creases", () => {
  assert.equal(allEdges(CUBE.triangles).length / 2, 18);
  assert.equal(creaseEdges(CUBE.positions, CUBE.triangles).length / 2, 12);
  assert.equal(creaseEdges(CUBE.positions, CUBE.triangles.slice(0, 6)).length / 2, 4); // the border of one face
});

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

test("events of a stream arrive whole, however they are cut", async () => {
  const text = ': alive\n\nevent: progress\ndata: {"stage":"fit"}\n\nevent: done\ndata: {"status":0}\n\n';
  for (const size of [1, 7, 1000]) {
    const parts = text.match(new RegExp(`[^]{1,${size}}`, "g")).map((part) => new TextEncoder().encode(part));
    const stream = new ReadableStream({start: (controller) => (parts.forEach((part) => controller.enqueue(part)), controller.close())});
    const seen = [];
    for await (const event of events(stream)) seen.push(event);
    assert.deepEqual(seen, [["progress", {stage: "fit"}], ["done", {status: 0}]]);
  }
});

test("an engine that lacks a method is refused by name", () => {
  assert.throws(() => checkEngine({commands: () => []}), /files, open/);
});

// ---- slices

test("voxels have places, and seeds are written as the program reads them", () => {
  const look = {kind: "volume", origin: [10, 20, 30], spacing: [1, 2, 3], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1], size: [4, 4, 4]};
  assert.deepEqual(physical([1, 1, 1], look), [11, 22, 33]);
  assert.equal(seedTable(new Map([["1,1,1", 2], ["0,0,0", 1]]), look), "x,y,z,label\n11,22,33,2\n10,20,30,1\n");
  assert.equal(seedTable(new Map([["3,0,0", 1]]), {...look, kind: "image"}), "x,y,label\n13,20,1\n");
  assert.deepEqual([0, 1, 2].map(planeOf), [[1, 2], [0, 2], [0, 1]]);
});

test("edges run between pixels of different labels", () => {
  assert.deepEqual(labelEdges([0, 1, 0, 1], 2, 2), [0.5, -0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5]);
  assert.deepEqual(labelEdges([1, 1, 1, 1], 2, 2), []);
});

// ---- plots

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

test("sliders keep their values", () => {
  for (const range of [{lo: 1e-6, hi: 100, log: true}, {lo: 16, hi: 512, log: true, whole: true}, {lo: 0, hi: 20, step: 0.5}]) {
    const scale = sliderScale(range);
    assert.equal(scale.toValue(0), range.lo);
    assert.equal(scale.toValue(1000), range.hi);
    for (const place of [200, 500, 900]) assert.ok(Math.abs(scale.toPlace(scale.toValue(place)) - place) < 25);
  }
});

test("command lines are quoted as a shell needs it", () => {
  assert.equal(commandLine("fit", ["a b.csv", "-o", "f.csrbf", "--values", "it's"]), "csrbf fit 'a b.csv' -o f.csrbf --values 'it'\\''s'");
});

test("names that are taken get a number", () => {
  assert.equal(unused("a.nii.gz", new Set(["a.nii.gz", "a-2.nii.gz"])), "a-3.nii.gz");
  assert.equal(unused("a.ply", new Set()), "a.ply");
  assert.deepEqual(outputsOf("segment", {name: "head.nii.gz", kind: "volume"}, (name) => name),
    [["-o", "head-labels.nii.gz"], ["--contour", "head-contour.ply"], ["--report", "head-segment.html"]]);
  assert.deepEqual(outputsOf("reconstruct", {name: "scan.ply", kind: "points"}, (name) => name),
    [["-o", "scan-surface.ply"], ["--model", "scan.csrbf"], ["--report", "scan-reconstruct.html"]]);
});

test("columns have roles, and flags only where these are not the usual ones", () => {
  const column = (name, values = [1, 2]) => ({name, values});
  const columns = [column("x"), column("y"), column("depth"), column("note", [NaN, NaN])];
  assert.deepEqual(usualRoles(columns), ["coordinate", "coordinate", "value", ""]);
  assert.deepEqual(roleFlags(columns.slice(0, 3), ["coordinate", "coordinate", "value"]), []);
  assert.deepEqual(roleFlags(columns, ["coordinate", "value", "weight", ""]), [["--coordinates", "x"], ["--values", "y"], ["--weights", "depth"]]);
});

test("previews write the first output only, with few cells", () => {
  const request = {command: "reconstruct", inputs: ["a.ply"], flags: [["--smoothing", "0.1"], ["--resolution", "400"]], outputs: [["-o", "m.ply"], ["--model", "m.csrbf"], ["--report", "r.html"]]};
  assert.deepEqual(previewArgs(request), ["a.ply", "-o", "m.ply", "--smoothing", "0.1", "--resolution", "64"]);
  assert.deepEqual(previewArgs({...request, command: "segment", inputs: ["a.png"], flags: [["--objects", true]], outputs: [["-o", "a-labels.png"]]}),
    ["a.png", "-o", "a-labels.mha", "--objects"]);
  // Patches of a given smoothing would take seconds.
  const inpaint = {command: "inpaint", inputs: ["a.png"], flags: [["--smoothing", "0.1"]], outputs: [["-o", "b.png"]]};
  assert.deepEqual(previewArgs(inpaint).slice(3), ["--smoothing", "0.1", "--method", "multilevel", "--kernel", "wendland-c2"]);
  assert.deepEqual(previewArgs({...inpaint, flags: [["--smoothing", "0.1"], ["--kernel", "cubic"]]}).slice(3), ["--smoothing", "0.1", "--kernel", "cubic"]);
});

test("the same in Python", () => {
  const lines = pythonLines({command: "reconstruct", inputs: ["scan.ply"], flags: [["--smoothing", "0.01"], ["--resolution", "64"], ["--method", "composite"]], outputs: [["-o", "m.ply"], ["--model", "m.csrbf"]]});
  assert.deepEqual(lines, ["import csrbf", "", 'cloud = csrbf.read_points("scan.ply")',
    'surface = csrbf.reconstruct(cloud, cloud.normals, smoothing=0.01, method="composite")', 'surface.polygonize(resolution=64).save("m.ply")', 'surface.save("m.csrbf")']);
  const fit = pythonLines({command: "fit", inputs: ["s.txt"], flags: [["--coordinates", "x,y"], ["--loss", "student"]], outputs: [["-o", "f.csrbf"]], columns: {coordinates: [0, 1], values: [2], weights: [3], named: true}});
  assert.ok(fit.includes('table = np.genfromtxt("s.txt", skip_header=1)'));
  assert.ok(fit.includes('f = csrbf.fit(table[:, [0, 1]], table[:, 2], weights=table[:, 3], loss="student")'), fit.join("\n"));
});

test("a function on a grid becomes a landscape within its box", () => {
  const picture = landscape({shape: [2, 3], values: [0, 1, 2, 3, 4, 5]}, {bounds: {lo: [0, 0], hi: [2, 1]}, coordinates: ["x", "y"], values: ["depth"]});
  assert.deepEqual(picture.axes, ["x", "y", "depth"]);
  assert.deepEqual(picture.axisRanges, [[0, 2], [0, 1], [0, 5]]);
  const {halfSides} = decode.frame(picture.low, picture.high);
  picture.mesh.positions.forEach((value, i) => assert.ok(Math.abs(value) <= halfSides[i % 3] + 1e-6));
  assert.equal(picture.mesh.triangles.length / 3, 4);
});

test("coarse levels of closed surfaces are closed, and lie within a cell", () => {
  const n = 60, positions = new Float32Array(3 * n * n), triangles = [];
  for (let j = 0, v = 0; j < n; ++j)
    for (let i = 0; i < n; ++i, ++v) {
      const [a, b] = [(2 * Math.PI * i) / n, (2 * Math.PI * j) / n];
      positions.set([(2 + Math.cos(b)) * Math.cos(a), (2 + Math.cos(b)) * Math.sin(a), Math.sin(b)], 3 * v);
      const right = j * n + ((i + 1) % n), up = ((j + 1) % n) * n;
      triangles.push(v, right, up + ((i + 1) % n), v, up + ((i + 1) % n), up + i);
    }
  const coarse = coarseTriangles(positions, triangles, 16);
  assert.ok(coarse.length > 900 && coarse.length < triangles.length / 3, String(coarse.length));
  const count = new Map(); // edges in one direction less those in the other
  for (let t = 0; t < coarse.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = coarse[t + k], b = coarse[t + ((k + 1) % 3)];
      const [key, sign] = a < b ? [`${a} ${b}`, 1] : [`${b} ${a}`, -1];
      count.set(key, (count.get(key) || 0) + sign);
    }
  assert.ok([...count.values()].every((value) => value === 0));
});

test("files with numbered names are a series, in the order of the numbers", () => {
  const image = (name, more = {}) => ({name, kind: "image", made: false, ...more});
  const items = ["f_10.png", "f_2.png", "f_1.png"].map((name) => image(name));
  const all = [...items, image("other.png"), image("f_3.png", {made: true})];
  assert.deepEqual(seriesOf(items[0], all).map(({name}) => name), ["f_1.png", "f_2.png", "f_10.png"]);
  assert.ok(isSeries(items));
  assert.ok(!isSeries(items.slice(1)));
  assert.ok(!isSeries([...items, image("other.png")]));
  assert.equal(framesOf(items[1], all, {}).count, 3);
  const volume = {name: "v.mha", kind: "volume", made: false};
  const {count, flags, look} = framesOf(volume, [volume], {kind: "volume", size: [4, 5, 6], frames: 1});
  assert.deepEqual([count, flags, look.size, look.kind], [6, [["--slices-are-frames", true]], [4, 5, 1], "image"]);
  assert.equal(framesOf(volume, [volume], {size: [4, 5, 6], frames: 9}).count, 9);
  assert.deepEqual(labelFiles([{name: "v-track/labels_0001.mha"}, {name: "v-track/measures.csv"}, {name: "v-track/labels_0000.mha"}]),
    ["v-track/labels_0000.mha", "v-track/labels_0001.mha"]);
});

test("contours in a file .svg are lines in pixels, closed where they say so", () => {
  const svg = '<svg viewBox="-0.5 -0.5 4 3"><path fill="none" d="\nM0 0L2 0 2 3Z\nM4 4L6 1e1"/></svg>';
  assert.deepEqual(svgLines(svg, {spacing: [2, 1, 1]}), [0, 0, 1, 0, 1, 0, 1, 3, 1, 3, 0, 0, 2, 4, 3, 10]);
});

test("numbers of an axis are grouped where they are long", () => {
  assert.deepEqual(ticks(0, 20000, 2).map(({text}) => text), ["0", "10,000", "20,000"]);
  assert.deepEqual(ticks(-5000, 5000, 2).map(({text}) => text), ["−5000", "0", "5000"]);
});

test("slices show the patient's left on the right, the front on top and the head upwards", () => {
  const shown = (patient, axis) => orientation({patient}, axis).map(({reversed, ends}) => [reversed, ends && ends.join("")]);
  const [right, left] = [[1, 0, 0, 0, 1, 0, 0, 0, 1], [-1, 0, 0, 0, -1, 0, 0, 0, 1]];
  assert.deepEqual(shown(right, 2), [[false, "RL"], [false, "AP"]]);
  assert.deepEqual(shown(left, 2), [[true, "RL"], [true, "AP"]]); // as many .nii.gz
  assert.deepEqual(shown(left, 1), [[true, "RL"], [true, "SI"]]);
  assert.deepEqual(shown(right, 0), [[false, "AP"], [true, "SI"]]);
  assert.deepEqual(shown(undefined, 2), [[false, null], [false, null]]);
  assert.deepEqual(shown(undefined, 0), [[false, null], [true, null]]);
});

test("narrow pictures leave room for the names of axes", () => {
  const orbit = new Orbit();
  orbit.aspect = 0.9;
  orbit.fit([1, 0, 0, -1, 0, 0]);
  const wide = orbit.distance;
  orbit.leaveRoom(0.2);
  assert.ok(orbit.distance > 1.3 * wide);
  orbit.leaveRoom(0);
  assert.equal(orbit.distance, wide);
});
