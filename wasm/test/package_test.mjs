// Run in a project in which the package is installed.

import assert from "node:assert/strict";
import {execFileSync} from "node:child_process";
import {readFile, writeFile} from "node:fs/promises";
import {createRequire} from "node:module";
import {test} from "node:test";

import {load} from "csrbf";
import {load as loadSurfaces} from "csrbf/surfaces";

const csrbf = await load();

function sphere(count) {
  const points = new Float64Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * i + 1) / count, r = Math.sqrt(1 - z * z);
    points.set([r * Math.cos(2.4 * i), r * Math.sin(2.4 * i), z], 3 * i);
  }
  return points;
}

test("a sphere is reconstructed, closed and on its points", () => {
  const {positions, triangles, normals, report, model} = csrbf.reconstruct(sphere(1000), {resolution: 24, model: true});
  assert.ok(report.maxDistance < 1e-4);
  assert.equal(normals.length, positions.length);
  for (let i = 0; i < positions.length; i += 3) assert.ok(Math.abs(Math.hypot(...positions.subarray(i, i + 3)) - 1) < 1e-3);
  assert.equal(triangles.length / 3, 2 * (positions.length / 3) - 4); // genus 0
  assert.ok(model.evaluate([0, 0, 0])[0] > 0 && model.evaluate([0, 0, 1.5])[0] < 0);
  const finer = csrbf.polygonize(model, {resolution: 40});
  assert.ok(finer.triangles.length > triangles.length);
  const again = csrbf.readModel(model.toBytes());
  assert.deepEqual(again.evaluate([0.3, 0.2, 0.1]), model.evaluate([0.3, 0.2, 0.1]));
  model.delete();
  assert.throws(() => model.evaluate([0, 0, 0]), /deleted/);
});

test("surfaces alone are the same in the smaller module", async () => {
  const surfaces = await loadSurfaces();
  const options = {resolution: 24, model: true};
  const [all, few] = [csrbf, surfaces].map((each) => each.reconstruct(sphere(1000), options));
  assert.deepEqual(few.positions, all.positions);
  assert.deepEqual(few.triangles, all.triangles);
  assert.deepEqual(few.model.gradient([0.9, 0.1, 0.2]), all.model.gradient([0.9, 0.1, 0.2]));
  assert.deepEqual(few.model.bounds, all.model.bounds);
  assert.ok(surfaces.polygonize(few.model, {resolution: 40}).triangles.length > few.triangles.length);
  assert.throws(() => surfaces.fit([[0], [1]], [1, 2]), /import from "csrbf"/);
});

// A cube without a part of its top: there, single precision decides where the surface is, and edges are kinks.
test("a mesh is the program's", {skip: process.env.CSRBF_PROGRAM ? false : "no program for this system in build/"}, async () => {
  const points = [], normals = [];
  const turn = ([x, y, z]) => [(2 * x - y + 2 * z) / 3, (2 * x + 2 * y - z) / 3, (-x + 2 * y + 2 * z) / 3].map(Math.fround);
  for (let axis = 0; axis < 3; ++axis)
    for (const side of [-1, 1])
      for (let i = 0; i < 900; ++i) {
        const u = (2 * (i % 30) + 1) / 30 - 1 + 0.01 * Math.sin(i);
        const v = (2 * Math.floor(i / 30) + 1) / 30 - 1 + 0.01 * Math.cos(7 * i);
        if (axis == 2 && side == 1 && Math.hypot(u - 0.3, v) < 0.4) continue;
        points.push(turn([0, 1, 2].map((k) => [side, u, v][(k - axis + 3) % 3])));
        normals.push(turn([0, 1, 2].map((k) => (k == axis ? side : 0))));
      }
  await writeFile("points.xyz", points.map((p, i) => [...p, ...normals[i]].join(" ")).join("\n") + "\n");
  execFileSync(process.env.CSRBF_PROGRAM, ["reconstruct", "points.xyz", "-o", "mesh.obj", "--quiet"]);
  const lines = (await readFile("mesh.obj", "utf8")).split("\n").map((line) => line.split(" "));
  const vertices = lines.filter(([kind]) => kind === "v").flatMap((words) => words.slice(1, 4).map(Number));
  const corners = lines.filter(([kind]) => kind === "f").flatMap((words) => words.slice(1).map((word) => parseInt(word) - 1));
  const {positions, triangles} = csrbf.reconstruct(points, {normals});
  assert.equal(positions.length, vertices.length);
  assert.equal(triangles.length, corners.length); // the diagonals of flat squares and the order are by rounding
  let farthest = 0;
  for (let i = 0; i < positions.length; i += 3) {
    let nearest = Infinity;
    for (let j = 0; j < vertices.length; j += 3)
      nearest = Math.min(nearest, Math.max(...[0, 1, 2].map((k) => Math.abs(positions[i + k] - vertices[j + k]))));
    farthest = Math.max(farthest, nearest);
  }
  assert.ok(farthest < 1e-9 * Math.sqrt(12), `${farthest}`);
});

test("a function is fitted, with its gradient", () => {
  const points = [], values = [];
  for (let x = 0; x <= 1; x += 0.05) for (let y = 0; y <= 1; y += 0.05) points.push([x, y]), values.push(x * x + y);
  const model = csrbf.fit(points, values);
  assert.equal(model.dimension, 2);
  assert.ok(Math.abs(model.evaluate([[0.52, 0.31]])[0] - (0.52 ** 2 + 0.31)) < 1e-4);
  const [dx, dy] = model.gradient([0.52, 0.31]);
  assert.ok(Math.abs(dx - 1.04) < 1e-2 && Math.abs(dy - 1) < 1e-2);
  assert.throws(() => model.polygonize(), {name: "InvalidInput"});
  model.delete();
});

test("an image is segmented", () => {
  const side = 64, image = new Uint8Array(side * side);
  for (let y = 0; y < side; ++y) for (let x = 0; x < side; ++x) image[side * y + x] = Math.hypot(x - 30, y - 25) < 12 ? 200 : 50;
  const {labels, lines, measures, objects} = csrbf.segment(image, [side, side], {objects: true});
  assert.equal(labels[side * 25 + 30], 1);
  assert.equal(labels[0], 0);
  assert.equal(lines.length, 3);
  assert.ok(Math.abs(measures[0].area - Math.PI * 144) < 20);
  assert.equal(objects.length, 1);
});

test("errors have the message of the library, and the module goes on", () => {
  assert.throws(() => csrbf.fit([[0], [1]], [1, 2], {kernel: "nope"}), {name: "InvalidInput", message: /wendland-c2/});
  assert.throws(() => csrbf.reconstruct(sphere(100), {smoothness: 1}), {name: "InvalidInput", message: /no such option/});
  assert.throws(() => csrbf.reconstruct([1, 2]), TypeError);
  assert.throws(() => csrbf.reconstruct(sphere(500), {progress: () => false}), {name: "Cancelled"});
  const own = new Error("mine");
  assert.throws(() => csrbf.reconstruct(sphere(500), {progress() { throw own; }}), own);
  assert.throws(() => csrbf.fit(new Float64Array(8), [1, 2], {dimension: 4}), {name: "InvalidInput", message: /1 to 3/});
});

test("bytes are unpacked, and damaged ones refused", async () => {
  const packed = await readFile(createRequire(import.meta.url).resolve("csrbf/surfaces.wasm.lzma"));
  const {triangles} = (await loadSurfaces({wasm: packed})).reconstruct(sphere(200), {resolution: 12});
  assert.ok(triangles.length > 0);
  await assert.rejects(loadSurfaces({wasm: packed.subarray(0, packed.length / 2)}), /damaged/);
  await assert.rejects(loadSurfaces({wasm: new TextEncoder().encode("<!doctype html>".repeat(9))}), /damaged/);
});
