// What a plane cuts out of a mesh, and values of a grid on a plane.

/**
 * Segments in which the plane normal . x = offset meets triangles, all with the inside on the same hand.
 * @returns {Float32Array} x, y, z of both ends of each
 */
export function section(positions, triangles, normal, offset) {
  const [nx, ny, nz] = normal;
  const height = new Float32Array(positions.length / 3);
  for (let i = 0, k = 0; i < height.length; ++i, k += 3)
    height[i] = nx * positions[k] + ny * positions[k + 1] + nz * positions[k + 2] - offset;
  const ends = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
    const above = (height[a] > 0) + (height[b] > 0) + (height[c] > 0);
    if (above === 0 || above === 3) continue;
    // From the edge that rises through the plane to the one that falls.
    for (const rising of [true, false])
      for (const [p, q] of [[a, b], [b, c], [c, a]]) {
        if (height[p] > 0 === height[q] > 0 || height[q] > 0 !== rising) continue;
        const s = height[p] / (height[p] - height[q]);
        for (let k = 0; k < 3; ++k) ends.push(positions[3 * p + k] + s * (positions[3 * q + k] - positions[3 * p + k]));
      }
  }
  return new Float32Array(ends);
}

/** The area inside closed segments of a section: half the sum of cross products, along the normal. */
export function areaOf(ends, normal) {
  let sum = 0;
  for (let i = 0; i + 5 < ends.length; i += 6) {
    const [ax, ay, az, bx, by, bz] = ends.subarray(i, i + 6);
    sum += normal[0] * (ay * bz - az * by) + normal[1] * (az * bx - ax * bz) + normal[2] * (ax * by - ay * bx);
  }
  return Math.abs(sum) / 2;
}

/** Two unit vectors that span the plane. */
export function across(normal) {
  const [x, y, z] = normal;
  const other = Math.abs(x) < 0.6 ? [1, 0, 0] : [0, 1, 0];
  const dot = x * other[0] + y * other[1] + z * other[2];
  const u = other.map((value, a) => value - dot * normal[a]);
  const length = Math.hypot(...u);
  u.forEach((value, a) => (u[a] = value / length));
  return [u, [y * u[2] - z * u[1], z * u[0] - x * u[2], x * u[1] - y * u[0]]];
}

/** The value of a grid over the box ±halfSides (x fastest), linear between its nodes; NaN outside. */
export function valueAt(grid, halfSides, x, y, z) {
  const place = [x, y, z];
  const [first, part] = [[0, 0, 0], [0, 0, 0]];
  for (let a = 0; a < 3; ++a) {
    const n = grid.size[a];
    const at = halfSides[a] > 0 ? ((place[a] / halfSides[a] + 1) / 2) * (n - 1) : 0;
    if (!(at > -1e-6 && at < n - 1 + 1e-6)) return NaN;
    first[a] = Math.min(Math.max(Math.floor(at), 0), Math.max(n - 2, 0));
    part[a] = n > 1 ? at - first[a] : 0;
  }
  const [nx, ny] = grid.size;
  let sum = 0;
  for (let corner = 0; corner < 8; ++corner) {
    let weight = 1;
    const index = [0, 0, 0];
    for (let a = 0; a < 3; ++a) {
      const upper = (corner >> a) & 1;
      weight *= upper ? part[a] : 1 - part[a];
      index[a] = first[a] + upper;
    }
    if (weight > 0) sum += weight * grid.values[index[0] + nx * (index[1] + ny * index[2])];
  }
  return sum;
}
