// Edges of boxes and meshes, as pairs of indices.

const CREASE = Math.cos((30 * Math.PI) / 180); // faces that meet at more than that make an edge; chosen by hand
const MOST = 2 ** 32; // vertices: an edge is one number

/** The edges of a box as pairs of corners (a bit for each axis), without those of one corner. */
export function boxEdges(without) {
  const edges = [];
  for (let i = 0; i < 8; ++i)
    for (let a = 0; a < 3; ++a) {
      const other = i | (1 << a);
      if (other !== i && i !== without && other !== without) edges.push(i, other);
    }
  return new Uint16Array(edges);
}

// Calls visit(a, b, key, t) for each side of each triangle; the key is the same from both sides.
function eachSide(triangles, visit) {
  for (let t = 0; t < triangles.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k], b = triangles[t + ((k + 1) % 3)];
      visit(a, b, Math.min(a, b) * MOST + Math.max(a, b), t);
    }
}

/** Every edge of the triangles once. */
export function allEdges(triangles) {
  const seen = new Set();
  const edges = [];
  eachSide(triangles, (a, b, key) => {
    if (seen.has(key)) return;
    seen.add(key);
    edges.push(a, b);
  });
  return new Uint32Array(edges);
}

/** Edges whose faces meet at more than 30 degrees, and those with one face. */
export function creaseEdges(positions, triangles) {
  const normalOf = (t) => {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
    const u = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
    const v = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    return n.map((value) => value / length);
  };
  const faces = new Map();
  const edges = [];
  let n = null;
  eachSide(triangles, (a, b, key, t) => {
    if (!n || n.t !== t) n = Object.assign(normalOf(t), {t});
    const other = faces.get(key);
    if (!other) return void faces.set(key, n);
    faces.delete(key);
    if (n[0] * other[0] + n[1] * other[1] + n[2] * other[2] < CREASE) edges.push(a, b);
  });
  for (const key of faces.keys()) edges.push(Math.floor(key / MOST), key % MOST);
  return new Uint32Array(edges);
}
