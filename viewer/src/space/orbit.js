// Position and orientation of the camera: a rotation (THREE.Quaternion), a distance and the point it looks at
// (THREE.Vector3).

import {Matrix4, Quaternion, Vector3} from "three";

const TURN_PER_RADIUS = 2.2; // radians for a drag over half the height of the picture; chosen by hand
const FILLED = 0.86; // part of the picture that the surface fills in the first view; the rest is a margin
const LEAST_FILLED = 0.4; // of the width, however narrow the picture is
const LEAST_OF_BALL = 0.7; // of the distance that shows the unit ball: a rotated surface may need more room
const NEAREST = 0.03; // zoom, relative to the first view: close to the surface
const FARTHEST = 40; // zoom, relative to the first view: the surface is a few pixels large
const LARGEST_SHIFT = 2; // of the target along each axis, in half diagonals: the surface stays within reach

const X = new Vector3(1, 0, 0);
const Y = new Vector3(0, 1, 0);
const Z = new Vector3(0, 0, 1);

const radians = (degrees) => (degrees * Math.PI) / 180;

/** The rotation by an angle about a unit vector, by the right-hand rule. */
export function aboutAxis(axis, angle) {
  return new Quaternion().setFromAxisAngle(axis, angle);
}

// The rotation from the camera's own axes (y up, looking along -z) to a view from the front and above (degrees), for
// each axis that may point upwards.
function start(up, above) {
  const toUp = {
    x: aboutAxis(Z, -Math.PI / 2).multiply(aboutAxis(Y, Math.PI / 2)),
    y: new Quaternion(),
    z: aboutAxis(X, Math.PI / 2),
  }[up];
  const [azimuth, elevation] = [25, above].map(radians);
  return toUp.multiply(aboutAxis(Y, azimuth)).multiply(aboutAxis(X, -elevation));
}

export class Orbit {
  constructor(up = "z") {
    this.aspect = 1;
    this.fieldOfView = 30;
    this.orthographic = false;
    this.seen = null;
    this.filled = FILLED; // less across narrow pictures, for what is written beside
    this.above = 15; // degrees of the first view over the horizon
    this.reset(up);
  }

  reset(up = this.up) {
    this.up = up;
    this.rotation = start(up, this.above);
    this.target = new Vector3();
    this.zoomed = 1;
  }

  // Half the height of the picture at distance 1.
  get slope() {
    return Math.tan(radians(this.fieldOfView) / 2);
  }

  /** Distance of the camera from its target: what fit() measured fills the picture, however narrow it is. */
  get distance() {
    const ball = 1 / Math.sin(Math.atan(this.slope * Math.min(1, this.aspect)));
    if (!this.seen) return ball * this.zoomed;
    const [right, up, near] = this.seen;
    const needed = near + Math.max(up / FILLED, right / this.aspect / this.filled) / this.slope;
    return Math.min(Math.max(needed, LEAST_OF_BALL * ball), (ball * FILLED) / this.filled) * this.zoomed;
  }

  /** Leaves free a share of the width of the picture on either side. */
  leaveRoom(share) {
    this.filled = Math.min(FILLED, Math.max(1 - 2 * share, LEAST_FILLED));
  }

  /** Measures the extent of points (x, y, z, x, ...) in the unit ball in the first view of the current axis. */
  fit(positions) {
    const rows = [X, Y, Z].map((axis) => axis.clone().applyQuaternion(this.rotation));
    this.seen = rows.map((row, a) => {
      let most = 0;
      for (let i = 0; i < positions.length; i += 3) {
        const along = row.x * positions[i] + row.y * positions[i + 1] + row.z * positions[i + 2];
        most = Math.max(most, a < 2 ? Math.abs(along) : along);
      }
      return most;
    });
  }

  get position() {
    return new Vector3(0, 0, this.distance).applyQuaternion(this.rotation).add(this.target);
  }

  /** Looks against an axis ("x", "-x", ...) of the data: from its positive end for "x". */
  lookFrom(axis) {
    const name = axis.slice(-1);
    const from = {x: X, y: Y, z: Z}[name].clone().multiplyScalar(axis.startsWith("-") ? -1 : 1);
    const up = {x: X, y: Y, z: Z}[this.up];
    const upwards = Math.abs(from.dot(up)) > 0.9 ? (this.up === "z" ? Y : Z) : up;
    const right = upwards.clone().cross(from).normalize();
    this.rotation.setFromRotationMatrix(new Matrix4().makeBasis(right, from.clone().cross(right), from));
  }

  /** The view as numbers, and back. */
  get state() {
    const {x, y, z, w} = this.rotation;
    return [x, y, z, w, ...this.target.toArray(), this.zoomed];
  }
  set state([x, y, z, w, tx, ty, tz, zoomed]) {
    if (![x, y, z, w, tx, ty, tz, zoomed].every(Number.isFinite)) return;
    this.rotation.set(x, y, z, w).normalize();
    this.target.set(tx, ty, tz).clampScalar(-LARGEST_SHIFT, LARGEST_SHIFT);
    this.zoomed = Math.min(Math.max(zoomed, NEAREST), FARTHEST);
  }

  /** Half the height of what an orthographic picture shows: as much as the other one at the target. */
  get halfHeight() {
    return this.distance * this.slope;
  }

  /** Rotates the surface by a drag, in units of half the height of the picture. */
  turn(right, down) {
    const [azimuth, elevation] = [right, down].map((drag) => -drag * TURN_PER_RADIUS);
    this.rotation.multiply(aboutAxis(Y, azimuth).multiply(aboutAxis(X, elevation))).normalize();
  }

  /** Moves the surface by a drag, in units of half the height of the picture. */
  pan(right, down) {
    const reach = this.distance * this.slope;
    const step = new Vector3(-right * reach, down * reach, 0).applyQuaternion(this.rotation);
    this.target.add(step).clampScalar(-LARGEST_SHIFT, LARGEST_SHIFT);
  }

  /** factor < 1: nearer. */
  zoom(factor) {
    this.zoomed = Math.min(Math.max(this.zoomed * factor, NEAREST), FARTHEST);
  }
}
