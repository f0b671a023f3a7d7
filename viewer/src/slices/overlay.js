// What is drawn over a slice: contours, seeds, a scale bar, and which way the patient lies. `at` is where the pixels of the
// slice are on the stage (Slices.placement).

import {LABELS} from "../colors.js";
import {readable, roundStep} from "../ticks.js";
import {labelEdges, planeOf} from "./voxels.js";

const FONT = 'system-ui, "Segoe UI", sans-serif';
const OUTSIDE = "#f4f4f4"; // seeds of label 0, which has no colour of its own

/** Letters of the sides of the patient. */
export function drawLetters(context, {ends: [across, down]}, {stage, look}) {
  if (!across || look.kind !== "volume") return;
  const {clientWidth: width, clientHeight: height} = stage;
  context.font = `600 13px ${FONT}`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 4;
  const style = getComputedStyle(stage);
  [context.strokeStyle, context.fillStyle] = [style.backgroundColor, style.color];
  for (const [letter, x, y] of [[across[0], 14, height / 2], [across[1], width - 14, height / 2], [down[0], width / 2, 14], [down[1], width / 2, height - 14]]) {
    context.strokeText(letter, x, y);
    context.fillText(letter, x, y);
  }
  context.textBaseline = "alphabetic";
}

/** The lines of a contour, or where there are none the borders between labels, of which one stands for `steps` pixels. */
export function drawContour(context, at, {lines, labels}, steps) {
  const between = (!lines || lines.length === 0) && labels;
  const ends = between ? labelEdges(labels.values, labels.width, labels.height) : lines;
  if (!ends) return;
  const [su, sv] = between ? steps : [1, 1];
  const place = (i) => [at.toX(ends[i] * su), at.toY(ends[i + 1] * sv)];
  const draw = (color, width) => {
    context.beginPath();
    for (let i = 0; i < ends.length; i += 4) {
      context.moveTo(...place(i));
      context.lineTo(...place(i + 2));
    }
    context.strokeStyle = color;
    context.lineWidth = width;
    context.lineJoin = context.lineCap = "round";
    context.stroke();
  };
  draw("rgba(0,0,0,.55)", 3);
  draw("#ffd166", 1.5);
}

/** The colour of seeds: that of the label painted over the image. @param {number} brush the label and one */
export const seedColor = (brush) => (brush === 1 ? OUTSIDE : LABELS[(brush - 2) % LABELS.length]);

/** Seeds on this slice: brushes by voxel, "x,y,z". Dark around them, to be seen on their own label. */
export function drawSeeds(context, at, {seeds, state: {axis, index}}) {
  const [u, v] = planeOf(axis);
  const here = [...seeds].map(([key, brush]) => [key.split(",").map(Number), brush]).filter(([voxel]) => voxel[axis] === index);
  for (const edge of [1.5, 0.3]) // squares overlap a little, or seams are seen between them
    for (const [voxel, brush] of here) {
      const [x, y] = [at.toX(voxel[u] - 0.5 * at.signs[0]), at.toY(voxel[v] - 0.5 * at.signs[1])];
      context.fillStyle = edge > 1 ? "rgba(0,0,0,.8)" : seedColor(brush);
      context.fillRect(x - edge, y - edge, at.sx + 2 * edge, at.sy + 2 * edge);
    }
}

/** A length in the corner of the picture, or of the stage where the picture goes beyond it. */
export function drawScaleBar(context, at, {look, stage}) {
  const length = roundStep(100 / at.fit, 1);
  const pixels = length * at.fit;
  const plain = look.kind === "image" && look.spacing[0] === 1 ? "pixels" : "(units of the file)";
  const text = `${readable(length, 3)} ${look.unit || plain}`;
  const right = Math.min(stage.clientWidth, at.x0 + at.width * at.sx) - 20;
  const [x, y] = [right - pixels, Math.min(stage.clientHeight, at.y0 + at.height * at.sy) - 18];
  context.font = `11px ${FONT}`;
  context.textAlign = "right";
  const style = getComputedStyle(stage);
  const width = Math.max(pixels, context.measureText(text).width);
  context.fillStyle = style.backgroundColor;
  context.globalAlpha = 0.85;
  context.beginPath();
  context.roundRect(right - width - 8, y - 21, width + 16, 31, 6);
  context.fill();
  context.globalAlpha = 1;
  context.fillStyle = style.color;
  context.fillRect(x, y, pixels, 2);
  context.fillText(text, right, y - 6);
}
