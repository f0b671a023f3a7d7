// Where the voxels of slices are: the axes of a slice, places in space, and the lines on it.

import {difference, dot} from "../vectors.js";
import {section} from "../space/section.js";

/** The axes of a slice across `axis`: to the right and down or up. */
export const planeOf = (axis) => [axis === 0 ? 1 : 0, axis === 2 ? 1 : 2];

/**
 * How both axes of a slice are shown: reversed, and in patient space the letters at its left and right, its top and
 * bottom. As the pictures of reports: z points upwards, and the patient's left is on the right, the front on top.
 */
export function orientation({patient}, axis) {
  return planeOf(axis).map((a, k) => {
    if (!patient) return {reversed: k === 1 && axis !== 2, ends: null};
    const along = [0, 1, 2].map((r) => patient[3 * r + a]);
    const main = along.reduce((best, value, r) => (Math.abs(value) > Math.abs(along[best]) ? r : best), 0);
    const reversed = (along[main] > 0) === (main === 2 && k === 1);
    const letters = ["RL", "AP", "IS"][main];
    return {reversed, ends: along[main] > 0 === reversed ? [letters[1], letters[0]] : [letters[0], letters[1]]};
  });
}

/** How many voxels of an image one of its labels stands for along each axis: more than 1 for those of a coarse copy, whose
 *  first voxel has the place of the image's first. */
export function labelSteps(look, labelsLook) {
  return look.size.map((n, a) => (labelsLook.size[a] === n ? 1 : labelsLook.spacing[a] / look.spacing[a]));
}

/** Segments between the pixels of different labels, as pairs of corners (u, v) in pixels. */
export function labelEdges(values, width, height) {
  const ends = [];
  const get = (x, y) => values[y * width + x];
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      if (x + 1 < width && get(x, y) !== get(x + 1, y)) ends.push(x + 0.5, y - 0.5, x + 0.5, y + 0.5);
      if (y + 1 < height && get(x, y) !== get(x, y + 1)) ends.push(x - 0.5, y + 0.5, x + 0.5, y + 0.5);
    }
  return ends;
}

/** The lines of a contour in a file .svg, as pairs of places (u, v) in pixels of the image. */
export function svgLines(text, {spacing}) {
  const ends = [];
  for (const [, path] of text.matchAll(/ d="([^"]*)"/g))
    for (const line of path.split("M").slice(1)) {
      const places = (line.match(/-?[\d.]+(?:e[-+]?\d+)?/g) || []).map((word, i) => Number(word) / spacing[i % 2]);
      if (line.includes("Z")) places.push(places[0], places[1]);
      for (let i = 2; i < places.length; i += 2) ends.push(...places.slice(i - 2, i + 2));
    }
  return ends;
}

/** The physical place of a voxel. */
export function physical(voxel, {origin, spacing, direction}) {
  return [0, 1, 2].map((r) => origin[r] + [0, 1, 2].reduce((sum, c) => sum + direction[3 * r + c] * spacing[c] * voxel[c], 0));
}

const AXES = [0, 1, 2];
const column = (direction, axis) => AXES.map((r) => direction[3 * r + axis]);

/** The middle of a mesh's box, which its positions are relative to. */
export const middleOf = ({low, high}) => low.map((lo, a) => (lo + high[a]) / 2);

/** The index along an axis, not rounded, of the slice through a place. */
export function indexAt(place, axis, {origin, spacing, direction}) {
  return dot(column(direction, axis), difference(place, origin)) / spacing[axis];
}

/** The voxel at a place. */
export const voxelOf = (place, look) => AXES.map((axis) => Math.round(indexAt(place, axis, look)));

/** The contour finer than voxels: where a mesh meets the plane of a slice, as pairs of places (u, v) in pixels. */
export function meshLines(mesh, axis, index, look) {
  const normal = column(look.direction, axis);
  const middle = middleOf(mesh);
  const offset = dot(normal, difference(physical(AXES.map((a) => (a === axis ? index : 0)), look), middle));
  const ends = section(mesh.positions, mesh.triangles, normal, offset + 1e-6 * look.spacing[axis]);
  const result = [];
  for (let i = 0; i < ends.length; i += 3) {
    const place = AXES.map((a) => ends[i + a] + middle[a]);
    for (const across of planeOf(axis)) result.push(indexAt(place, across, look));
  }
  return result;
}
