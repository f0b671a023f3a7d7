import assert from "node:assert/strict";

/** Whether arrays of numbers are equal within a tolerance. */
export function near(a, b, tolerance = 1e-12) {
  assert.equal(a.length, b.length);
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < tolerance, `${a} and ${b}`));
}
