import assert from "node:assert/strict";
import {test} from "node:test";

import * as colors from "../src/colors.js";
import * as decode from "../src/decode.js";
import {aboutAxis, Orbit} from "../src/orbit.js";
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

test("colours run through the stops, and missing values have their own", () => {
  const stops = ["#000000", "#ff0000", "#ffffff"];
  near(colors.at(stops, 0), [0, 0, 0]);
  near(colors.at(stops, 0.25), [0.5, 0, 0]);
  near(colors.at(stops, 0.5), [1, 0, 0]);
  near(colors.at(stops, 2), [1, 1, 1]);
  const of = colors.colorsOf(new Uint8Array([0, 127, 254, colors.MISSING]), stops, [0.2, 0.4, 0.6]);
  near([...of], [0, 0, 0, 1, 0, 0, 1, 1, 1, 0.2, 0.4, 0.6], 1e-6);
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
