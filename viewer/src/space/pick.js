// What lies under the cursor: the first triangle that a ray meets, or the point nearest to it.

/**
 * @param {number[]} origin @param {number[]} direction of the ray
 * @param {(place: number[]) => boolean} [visible] leaves out what is cut away
 * @returns {{place: number[], vertices: number[], weights: number[], distance: number}|null}
 */
export function pickTriangle(positions, triangles, origin, direction, visible = () => true) {
  const [ox, oy, oz] = origin, [dx, dy, dz] = direction;
  let nearest = Infinity, found = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ax = positions[a], ay = positions[a + 1], az = positions[a + 2];
    const ux = positions[b] - ax, uy = positions[b + 1] - ay, uz = positions[b + 2] - az;
    const vx = positions[c] - ax, vy = positions[c + 1] - ay, vz = positions[c + 2] - az;
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det > -1e-20 && det < 1e-20) continue;
    const sx = ox - ax, sy = oy - ay, sz = oz - az;
    const u = (sx * px + sy * py + sz * pz) / det;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (dx * qx + dy * qy + dz * qz) / det;
    if (v < 0 || u + v > 1) continue;
    const distance = (vx * qx + vy * qy + vz * qz) / det;
    if (distance <= 0 || distance >= nearest) continue;
    const place = [ox + distance * dx, oy + distance * dy, oz + distance * dz];
    if (!visible(place)) continue;
    nearest = distance;
    found = {place, vertices: [triangles[t], triangles[t + 1], triangles[t + 2]], weights: [1 - u - v, u, v], distance};
  }
  return found;
}

/** The point whose direction from the origin differs least from that of the ray, at most by `slope`; nearer ones first. */
export function pickPoint(positions, origin, direction, slope, visible = () => true) {
  let best = Infinity, found = null;
  for (let i = 0; i < positions.length; i += 3) {
    const x = positions[i] - origin[0], y = positions[i + 1] - origin[1], z = positions[i + 2] - origin[2];
    const along = x * direction[0] + y * direction[1] + z * direction[2];
    if (along <= 0) continue;
    const off = Math.sqrt(Math.max(x * x + y * y + z * z - along * along, 0));
    const size = typeof slope === "function" ? slope(along) : slope * along;
    if (off > size) continue;
    const score = along + off; // the nearer of those under the cursor
    if (score >= best) continue;
    const place = [positions[i], positions[i + 1], positions[i + 2]];
    if (!visible(place)) continue;
    best = score;
    found = {place, index: i / 3, distance: along};
  }
  return found;
}

/** The mean of three values, normals or the like at the corners of a picked triangle. */
export function blend(found, values, components = 1) {
  return Array.from({length: components}, (_, c) =>
    found.vertices.reduce((sum, vertex, k) => sum + found.weights[k] * values[components * vertex + c], 0),
  );
}
