// What is under the cursor, in words, and what was measured between places.

import {readable} from "../ticks.js";
import {difference, dot} from "../vectors.js";
import {blend, pickPoint, pickTriangle} from "./pick.js";
import {valueAt} from "./section.js";

const REACH = 6; // pixels around a point

/** What is under a pixel: a place of the surface or of the cap, or a point; null for nothing. */
export function pick(view, x, y) {
  const {state, scene, orbit, picture: {mesh, points}} = view;
  const {origin, direction} = scene.ray(x, y);
  const plane = state.cut === "none" ? null : view.plane(state.depth);
  const visible = (p) => !plane || p[0] * plane.normal[0] + p[1] * plane.normal[1] + p[2] * plane.normal[2] <= plane.offset;
  const surface = mesh && state.surface ? pickTriangle(mesh.positions, mesh.triangles, origin, direction, visible) : null;
  const cap = plane && scene.cap && scene.cap.visible ? pickCap(view, plane, origin, direction, surface) : null;
  if (cap) return cap;
  const shown = points && (state.points || !mesh);
  if (!shown || surface) return surface && {...surface, kind: "surface"};
  const reach = (REACH * 2 * (orbit.orthographic ? orbit.halfHeight : orbit.slope)) / view.canvas.clientHeight;
  const point = pickPoint(points.positions, origin, direction, orbit.orthographic ? () => reach : reach, visible);
  return point && {...point, kind: "point"};
}

// The plane of the cut, where it is inside of the surface: a ray from there against the normal leaves it through a back.
function pickCap({picture: {mesh, inside}, frame}, plane, origin, direction, surface) {
  const facing = dot(direction, plane.normal);
  if (facing >= 0) return null;
  const distance = (plane.offset - dot(origin, plane.normal)) / facing;
  if (distance <= 0 || (surface && surface.distance < distance)) return null;
  const place = origin.map((value, a) => value + distance * direction[a]);
  const beyond = pickTriangle(mesh.positions, mesh.triangles, place, direction);
  if (!beyond || dot(blend(beyond, mesh.normals, 3), direction) < 0) return null;
  return {kind: "cap", place, value: inside ? valueAt(inside, frame.halfSides, ...place) : NaN};
}

/** Position, normal and value of what was picked. */
export function describe(view, found) {
  const {axes, unit, mesh, inside, axisRanges} = view.picture;
  const parts = view.toData(found.place).map((value, a) => `${axes[a]} ${readable(value, 5)}`);
  if (unit && !axisRanges) parts[2] += ` ${unit}`;
  const tell = (name, value) => Number.isFinite(value) && parts.push(`${name} ${readable(value)}`);
  const scale = view.scaleNamed(view.state.color);
  if (found.kind === "surface") {
    const normal = blend(found, mesh.normals, 3);
    const length = Math.hypot(...normal) || 1;
    if (!axisRanges) parts.push(`normal ${normal.map((value) => readable(value / length, 2)).join(", ")}`);
    if (scale && scale.values) tell(scale.name, blend(found, scale.values)[0]);
  } else if (found.kind === "cap") {
    if (inside) tell(inside.title, found.value);
  } else if (scale && scale.pointValues) {
    tell(scale.name, scale.pointValues[found.index]);
  }
  return parts.join("  ·  ");
}

/** The distance between two places of the scene, or the angle at the second of three, as text. */
export function measured(view, places) {
  const data = places.map((place) => view.toData(place));
  if (places.length === 2) {
    const {unit} = view.picture;
    return readable(Math.hypot(...difference(data[0], data[1])), 4) + (unit ? ` ${unit}` : "");
  }
  const [u, v] = [difference(data[0], data[1]), difference(data[2], data[1])];
  const cosine = dot(u, v) / (Math.hypot(...u) * Math.hypot(...v));
  return `${((Math.acos(Math.min(1, Math.max(-1, cosine))) * 180) / Math.PI).toFixed(1)}°`;
}
