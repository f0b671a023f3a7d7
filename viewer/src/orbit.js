// Where the camera stands: a rotation, a distance and the point it looks at. All vectors and quaternions are arrays;
// quaternions are [x, y, z, w].

const TURN_PER_RADIUS = 2.2; // radians for a drag over half the height of the picture
const FILLED = 0.86; // of the picture, in the first view
const LEAST_OF_BALL = 0.7; // turned surfaces may need more room than in the first view
const NEAREST = 0.15;
const FARTHEST = 40;

export function multiply(a, b) {
  const [ax, ay, az, aw] = a;
  const [bx, by, bz, bw] = b;
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

export function aboutAxis(axis, angle) {
  const s = Math.sin(angle / 2);
  return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)];
}

export function rotate(q, v) {
  const [x, y, z] = multiply(multiply(q, [...v, 0]), [-q[0], -q[1], -q[2], q[3]]);
  return [x, y, z];
}

// The turn from the camera's own axes (y up, looking along -z) to a view from above the front, for each axis that may
// point upwards.
function start(up) {
  const toUp = {
    x: multiply(aboutAxis([0, 0, 1], -Math.PI / 2), aboutAxis([0, 1, 0], Math.PI / 2)),
    y: [0, 0, 0, 1],
    z: aboutAxis([1, 0, 0], Math.PI / 2),
  }[up];
  const [azimuth, elevation] = [25, 15].map((degrees) => (degrees * Math.PI) / 180);
  return multiply(toUp, multiply(aboutAxis([0, 1, 0], azimuth), aboutAxis([1, 0, 0], -elevation)));
}

export class Orbit {
  constructor(up = "z") {
    this.aspect = 1;
    this.fieldOfView = 30;
    this.seen = null;
    this.reset(up);
  }

  reset(up = this.up) {
    this.up = up;
    this.rotation = start(up);
    this.target = [0, 0, 0];
    this.zoomed = 1;
  }

  /** Distance of the camera from its target: what fit() saw fills the picture, however narrow. */
  get distance() {
    const slope = Math.tan((this.fieldOfView * Math.PI) / 360);
    const ball = 1 / Math.sin(Math.atan(slope * Math.min(1, this.aspect)));
    if (!this.seen) return ball * this.zoomed;
    const [right, up, near] = this.seen;
    const needed = near + Math.max(up, right / this.aspect) / (FILLED * slope);
    return Math.min(Math.max(needed, LEAST_OF_BALL * ball), ball) * this.zoomed;
  }

  /** Takes note of how far points (x, y, z, x, ...) in the unit ball reach in the first view of the current axis. */
  fit(positions) {
    const rows = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotate(this.rotation, axis));
    this.seen = rows.map((row, a) => {
      let most = 0;
      for (let i = 0; i < positions.length; i += 3) {
        const along = row[0] * positions[i] + row[1] * positions[i + 1] + row[2] * positions[i + 2];
        most = Math.max(most, a < 2 ? Math.abs(along) : along);
      }
      return most;
    });
  }

  get position() {
    const [x, y, z] = rotate(this.rotation, [0, 0, this.distance]);
    return [x + this.target[0], y + this.target[1], z + this.target[2]];
  }

  /** Turns the surface with a drag by so many halves of the height of the picture. */
  turn(right, down) {
    const [azimuth, elevation] = [right, down].map((drag) => -drag * TURN_PER_RADIUS);
    const q = multiply(this.rotation, multiply(aboutAxis([0, 1, 0], azimuth), aboutAxis([1, 0, 0], elevation)));
    const length = Math.hypot(...q);
    this.rotation = q.map((value) => value / length);
  }

  /** Moves the surface with a drag by so many halves of the height of the picture. */
  pan(right, down) {
    const reach = this.distance * Math.tan((this.fieldOfView * Math.PI) / 360);
    const step = rotate(this.rotation, [-right * reach, down * reach, 0]);
    this.target = this.target.map((value, a) => Math.min(Math.max(value + step[a], -2), 2));
  }

  /** factor < 1: nearer. */
  zoom(factor) {
    this.zoomed = Math.min(Math.max(this.zoomed * factor, NEAREST), FARTHEST);
  }
}
