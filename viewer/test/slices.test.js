import assert from "node:assert/strict";
import {test} from "node:test";

import {LABELS} from "../src/colors.js";
import {drawContour, seedColor} from "../src/slices/overlay.js";
import {HOLE, holesMask, holesOfMask, Seeds, seedsOfTable, seedTable} from "../src/slices/seeds.js";
import {labelEdges, labelSteps, orientation, physical, planeOf, svgLines} from "../src/slices/voxels.js";

test("voxels have places, and seeds are written as the program reads them", () => {
  const look = {kind: "volume", origin: [10, 20, 30], spacing: [1, 2, 3], direction: [1, 0, 0, 0, 1, 0, 0, 0, 1], size: [4, 4, 4]};
  assert.deepEqual(physical([1, 1, 1], look), [11, 22, 33]);
  assert.equal(seedTable(new Map([["1,1,1", 2], ["0,0,0", 1]]), look), "x,y,z,label\n11,22,33,2\n10,20,30,1\n");
  assert.equal(seedTable(new Map([["3,0,0", 1]]), {...look, kind: "image"}), "x,y,label\n13,20,1\n");
  assert.deepEqual([0, 1, 2].map(planeOf), [[1, 2], [0, 2], [0, 1]]);
});

test("the table of seeds gives them back", () => {
  const turned = [0, -1, 0, 1, 0, 0, 0, 0, 1];
  for (const [kind, direction, size] of [["volume", turned, [4, 5, 6]], ["image", [1, 0, 0, 0, 1, 0, 0, 0, 1], [4, 5, 1]]]) {
    const look = {kind, origin: [-3.25, 20, 7], spacing: [0.7, 0.7, 2.5], direction, size};
    const last = size[2] - 1;
    const seeds = new Map([[`3,0,${last}`, 2], [`0,4,0`, 1]]);
    assert.deepEqual([...seedsOfTable(seedTable(seeds, look), look)], [...seeds]);
    assert.deepEqual([...seedsOfTable(`head\n1e3,0${kind === "volume" ? ",0" : ""},1\n`, look)], []); // of another image
  }
});

test("the mask of holes gives them back", () => {
  const look = {kind: "volume", size: [4, 3, 2]};
  const holes = new Map([["3,0,0", HOLE], ["1,2,1", HOLE]]);
  const mask = holesMask(holes, look);
  assert.deepEqual([...mask.slice(-24)].flatMap((value, i) => (value ? [i] : [])), [3, 21]);
  assert.deepEqual([...holesOfMask(mask, look)], [...holes]);
  assert.equal(holesOfMask(mask, {kind: "volume", size: [3, 4, 2]}).size, 0);
  assert.match(new TextDecoder().decode(holesMask(new Map(), {kind: "image", size: [4, 3, 1]})), /dimension: 2\nsizes: 4 3\n/);
});

test("strokes of seeds are taken back and made again", () => {
  const seeds = new Seeds();
  for (const voxel of ["0,0,0", "1,0,0"]) {
    seeds.begin();
    seeds.set(voxel, 1);
  }
  seeds.step(-1);
  assert.deepEqual([[...seeds.keys()], seeds.canStep(-1), seeds.canStep(1)], [["0,0,0"], true, true]);
  seeds.step(-1);
  seeds.step(1);
  seeds.step(1);
  assert.deepEqual([[...seeds.keys()], seeds.canStep(1)], [["0,0,0", "1,0,0"], false]);
  seeds.settle();
  assert.equal(seeds.canStep(-1), false);
});

test("seeds have the colour of their label, those of the outside none of a label", () => {
  assert.deepEqual([2, 3].map(seedColor), LABELS.slice(0, 2)); // brushes of the labels 1 and 2
  assert.ok(!LABELS.includes(seedColor(1)));
});

test("edges run between pixels of different labels", () => {
  assert.deepEqual(labelEdges([0, 1, 0, 1], 2, 2), [0.5, -0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5]);
  assert.deepEqual(labelEdges([1, 1, 1, 1], 2, 2), []);
});

// ---- plots

test("contours in a file .svg are lines in pixels, closed where they say so", () => {
  const svg = '<svg viewBox="-0.5 -0.5 4 3"><path fill="none" d="\nM0 0L2 0 2 3Z\nM4 4L6 1e1"/></svg>';
  assert.deepEqual(svgLines(svg, {spacing: [2, 1, 1]}), [0, 0, 1, 0, 1, 0, 1, 3, 1, 3, 0, 0, 2, 4, 3, 10]);
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

test("labels of a coarse copy lie where its voxels are", () => {
  // Every 17th of 512 voxels: the last of the 32 is between two of these.
  const [image, coarse] = [[512, 1], [32, 17]].map(([n, h]) => ({size: [n, n, 1], spacing: [0.5 * h, 0.5 * h, 1]}));
  assert.deepEqual(labelSteps(image, coarse), [17, 17, 1]);
  assert.deepEqual(labelSteps(image, {...image, spacing: [1, 1, 1]}), [1, 1, 1]);
  const places = [];
  const context = {beginPath() {}, stroke() {}, lineTo() {}, moveTo: (...place) => places.push(place)};
  const at = {toX: (u) => u, toY: (v) => v};
  drawContour(context, at, {lines: null, labels: {values: [0, 1], width: 2, height: 1}}, [17, 17]);
  assert.deepEqual(places[0], [8.5, -8.5]);
});
