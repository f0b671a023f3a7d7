import assert from "node:assert/strict";
import {test} from "node:test";

import {Vector3} from "three";

import {coarseTriangles} from "../src/space/coarse.js";
import {allEdges, creaseEdges} from "../src/space/edges.js";
import {aboutAxis, Orbit} from "../src/space/orbit.js";
import {withoutOverlaps} from "../src/space/overlay.js";
import {blend, pickPoint, pickTriangle} from "../src/space/pick.js";
import {across, areaOf, section, valueAt} from "../src/space/section.js";
import {near} from "./helpers.js";

const rotate = (q, v) => new Vector3(...v).applyQuaternion(q).toArray();

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

test("labels that would run into each other are left out, evenly", () => {
  const labels = (gap) => [0, 1, 2, 3, 4].map((i) => ({text: String(i), x: gap * i, y: i, width: 40}));
  const shown = (gap) => withoutOverlaps(labels(gap)).map(({text}) => text).join("");
  assert.deepEqual([shown(50), shown(40), shown(15), shown(0)], ["01234", "024", "04", "0"]);
});
