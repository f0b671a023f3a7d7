// A coarse level of a large mesh, to be drawn while it moves.

const CELLS = 192; // along the longest side of the box: some 100,000 to 200,000 triangles, each a few pixels large

/**
 * Triangles between fewer of the same vertices: the first one in each cell of a grid stands for all in it. Closed
 * surfaces stay closed.
 * @param {Float32Array} positions @param {ArrayLike<number>} triangles
 */
export function coarseTriangles(positions, triangles, cells = CELLS) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], positions[i]);
    high[i % 3] = Math.max(high[i % 3], positions[i]);
  }
  const side = Math.max(...low.map((lo, a) => high[a] - lo)) / cells || 1;
  const counts = low.map((lo, a) => 1 + Math.floor((high[a] - lo) / side));
  const first = new Int32Array(counts[0] * counts[1] * counts[2]).fill(-1);
  const of = new Uint32Array(positions.length / 3);
  for (let v = 0, i = 0; v < of.length; ++v, i += 3) {
    const [x, y, z] = [0, 1, 2].map((a) => Math.floor((positions[i + a] - low[a]) / side));
    const cell = x + counts[0] * (y + counts[1] * z);
    if (first[cell] < 0) first[cell] = v;
    of[v] = first[cell];
  }
  const kept = new Uint32Array(triangles.length);
  let n = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = of[triangles[t]], b = of[triangles[t + 1]], c = of[triangles[t + 2]];
    if (a === b || b === c || c === a) continue;
    kept[n] = a;
    kept[n + 1] = b;
    kept[n + 2] = c;
    n += 3;
  }
  return kept.slice(0, n);
}
