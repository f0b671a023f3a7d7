import assert from "node:assert/strict";
import {test} from "node:test";

import {checkEngine} from "../src/engine/engine.js";
import {events} from "../src/engine/native.js";

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
