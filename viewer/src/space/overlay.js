// What is written on a picture in space: the scales of its box, the axes, a scale bar, the colour scale, measurements.
// Everything goes through a CanvasRenderingContext2D, so that a saved picture has it as well.

import {Vector3} from "three";

import {readable, roundStep, ticks} from "../ticks.js";

const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif';
const TICK = 5; // pixels
const TICK_GAP = 70; // pixels between ticks, about
const MARGIN = 16; // pixels from the border of the picture
const GIZMO = 26; // length of the axes in the corner, pixels
const NARROW = 480; // pixels, below which numbers of the box reach into the corners
const FEW = 40; // pixels of an axis, from which it has two numbers at least
const AXIS_COLORS = {light: ["#b3261e", "#1e7d32", "#1f5fbf"], dark: ["#ff8a80", "#7ddc86", "#82b1ff"]};

/** Where axis a of the data is at a place of the scene, and back. */
export function axisMap(picture, frame, a) {
  const half = frame.halfSides[a];
  const [lo, hi] = picture.axisRanges ? picture.axisRanges[a] : [picture.low[a], picture.high[a]];
  return {
    lo,
    hi,
    toData: (s) => (half > 0 ? lo + ((s / half + 1) / 2) * (hi - lo) : lo),
    toScene: (value) => (hi > lo ? half * ((2 * (value - lo)) / (hi - lo) - 1) : 0),
  };
}

function text(context, words, x, y, {align = "center", color, size = 12, weight = "", halo = null}) {
  context.font = `${weight} ${size}px ${FONT}`;
  context.textAlign = align;
  context.textBaseline = "middle";
  if (halo) {
    context.lineWidth = 3;
    context.lineJoin = "round";
    context.strokeStyle = halo;
    context.strokeText(words, x, y);
  }
  context.fillStyle = color;
  context.fillText(words, x, y);
}

function line(context, from, to, color, width = 1) {
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

// One number alone does not say how long an axis is.
function atLeastTwo(lo, hi, count) {
  let marks = ticks(lo, hi, count);
  for (let more = 3; marks.length < 2 && more < 6; ++more) marks = ticks(lo, hi, more);
  return marks;
}

// The four edges along axis a, as pairs of corners of the box (+-1 each).
function edgesAlong(a) {
  const [b, c] = [0, 1, 2].filter((axis) => axis !== a);
  const signs = [-1, 1];
  return signs.flatMap((sb) =>
    signs.map((sc) => {
      const corner = (s) => {
        const place = [0, 0, 0];
        place[a] = s;
        place[b] = sb;
        place[c] = sc;
        return place;
      };
      return [corner(-1), corner(1)];
    }),
  );
}

// The edge of the outline that is lowest in the picture, or leftmost for the upright axis.
function edgeToLabel(a, halfSides, project, upright) {
  const points = (edge) => edge.map((corner) => project(corner.map((s, k) => s * halfSides[k])));
  const center = project([0, 0, 0]);
  let best = null, bestScore = -Infinity;
  for (const edge of edgesAlong(a)) {
    const [from, to] = points(edge);
    if (!from.visible || !to.visible) return null;
    const middle = {x: (from.x + to.x) / 2, y: (from.y + to.y) / 2};
    const away = Math.hypot(middle.x - center.x, middle.y - center.y);
    const score = (upright ? -(middle.x - center.x) : middle.y - center.y) + 0.25 * away;
    if (score > bestScore) [best, bestScore] = [{edge, from, to, middle, center}, score];
  }
  return best;
}

/** Labels along an axis: all, or every second, fourth, ... where they would run into each other. */
export function withoutOverlaps(labels) {
  for (let step = 1; ; step *= 2) {
    const kept = labels.filter((_, i) => i % step === 0);
    const overlap = kept.some(({x, y, width}, i) => i > 0 && Math.abs(y - kept[i - 1].y) < 12 &&
      Math.abs(x - kept[i - 1].x) < (width + kept[i - 1].width) / 2 + 6);
    if (!overlap) return kept;
  }
}

function drawAxis(context, a, {picture, frame, project, palette, up, scaleBar, width}) {
  const found = edgeToLabel(a, frame.halfSides, project, "xyz"[a] === up);
  if (!found || frame.halfSides[a] === 0) return;
  const {edge, from, to, middle, center} = found;
  const length = Math.hypot(to.x - from.x, to.y - from.y);
  if (length < 24) return;
  const along = [(to.x - from.x) / length, (to.y - from.y) / length];
  let out = [-along[1], along[0]];
  if (out[0] * (middle.x - center.x) + out[1] * (middle.y - center.y) < 0) out = out.map((value) => -value);
  line(context, [from.x, from.y], [to.x, to.y], palette.axis);
  const map = axisMap(picture, frame, a);
  const align = out[0] > 0.4 ? "left" : out[0] < -0.4 ? "right" : "center";
  let widest = 0;
  const count = Math.max(1, Math.min(8, length / TICK_GAP));
  const marks = length > FEW ? atLeastTwo(map.lo, map.hi, count) : ticks(map.lo, map.hi, count);
  context.font = `11px ${FONT}`;
  const labels = marks.map((tick) => {
    const {x, y} = project(edge[0].map((s, k) => (k === a ? map.toScene(tick.value) : s * frame.halfSides[k])));
    line(context, [x, y], [x + TICK * out[0], y + TICK * out[1]], palette.axis);
    return {text: tick.text, x: x + 2.4 * TICK * out[0], y: y + 2.4 * TICK * out[1], width: context.measureText(tick.text).width};
  });
  for (const label of withoutOverlaps(labels)) {
    if (scaleBar && label.x > scaleBar.x - 24 && label.y > scaleBar.y - 26) continue;
    text(context, label.text, label.x, label.y, {align, color: palette.text, size: 11, halo: palette.halo});
    widest = Math.max(widest, align === "center" ? 12 : label.width);
  }
  const name = picture.axes[a] + (picture.unit && !picture.axisRanges ? ` (${picture.unit})` : "");
  const distance = 2.4 * TICK + widest + 12;
  const style = {align, color: palette.strong, size: 12, weight: "600", halo: palette.halo};
  context.font = `600 12px ${FONT}`;
  const x = middle.x + distance * out[0], size = context.measureText(name).width;
  const left = x - size * {left: 0, center: 0.5, right: 1}[align];
  if (left >= 2 && left + size <= width - 2) return text(context, name, x, middle.y + distance * out[1], style);
  // What does not fit beside the axis goes over its upper or below its lower end.
  const upright = "xyz"[a] === up, end = (from.y < to.y) === upright ? from : to;
  const at = Math.min(Math.max(end.x, size / 2 + 4), width - size / 2 - 4);
  return text(context, name, at, end.y + (upright ? -14 : 30), {...style, align: "center"});
}

/** The gizmo's axes: where their ends are on the picture, nearest last. Below; above where the picture is narrow. */
export function gizmoEnds(view, width, height) {
  const inset = MARGIN + GIZMO + 6;
  const center = [inset, width < NARROW ? inset + 20 : height - inset];
  const ends = [0, 1, 2].flatMap((a) =>
    [1, -1].map((sign) => {
      const [x, y, depth] = view.directionOnScreen(a);
      return {name: (sign < 0 ? "-" : "") + "xyz"[a], axis: a, sign, depth: sign * depth, x: center[0] + sign * GIZMO * x, y: center[1] - sign * GIZMO * y};
    }),
  );
  ends.sort((p, q) => p.depth - q.depth);
  return {center, ends};
}

function drawGizmo(context, view, width, height, palette) {
  const {center, ends} = gizmoEnds(view, width, height);
  const colors = AXIS_COLORS[palette.dark ? "dark" : "light"];
  for (const end of ends) {
    const color = colors[end.axis];
    context.globalAlpha = end.sign > 0 ? 1 : 0.45;
    if (end.sign > 0) line(context, center, [end.x, end.y], color, 2);
    context.beginPath();
    context.arc(end.x, end.y, end.sign > 0 ? 7.5 : 3.5, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
    context.globalAlpha = 1;
    if (end.sign > 0) text(context, "xyz"[end.axis], end.x, end.y + 0.5, {color: palette.ground, size: 10, weight: "700"});
  }
}

// Where the scale bar is and how long; none where axes have different units.
function placeScaleBar({picture, frame, pixelsPerUnit, width, height}) {
  if (picture.axisRanges || !(pixelsPerUnit > 0)) return null;
  const unit = pixelsPerUnit * frame.scale; // pixels per length of the data
  const length = roundStep(Math.min(110, width / 5) / unit, 1);
  const pixels = length * unit;
  return pixels > 10 && pixels < 400 ? {x: width - MARGIN - pixels, y: height - MARGIN, pixels, length} : null;
}

function drawScaleBar(context, {picture, scaleBar: {x, y, pixels, length}, palette, orthographic}) {
  line(context, [x, y], [x + pixels, y], palette.strong, 2);
  for (const end of [x, x + pixels]) line(context, [end, y - 4], [end, y + 1], palette.strong, 2);
  const words = readable(length, 3) + (picture.unit ? ` ${picture.unit}` : "") + (orthographic ? "" : " at the centre");
  text(context, words, x + pixels, y - 11, {align: "right", color: palette.text, size: 11, halo: palette.halo});
}

/** A colour scale at the right: title, bar, ticks. Returns where the next one begins. */
function drawLegend(context, legend, top, {width, palette}) {
  const barWidth = Math.min(200, Math.max(120, width * 0.3));
  const right = width - MARGIN, left = right - barWidth;
  let y = top;
  context.font = `12px ${FONT}`;
  const words = legend.title.split(" ");
  const rows = [""];
  for (const word of words) {
    const longer = rows[rows.length - 1] ? rows[rows.length - 1] + " " + word : word;
    if (context.measureText(longer).width > Math.min(barWidth * 1.75, width - 2 * MARGIN) && rows[rows.length - 1]) rows.push(word);
    else rows[rows.length - 1] = longer;
  }
  for (const row of rows) {
    text(context, row, right, y, {align: "right", color: palette.strong, size: 12, halo: palette.halo});
    y += 16;
  }
  const gradient = context.createLinearGradient(left, 0, right, 0);
  legend.stops.forEach((color, i) => gradient.addColorStop(i / (legend.stops.length - 1), color));
  context.fillStyle = gradient;
  context.fillRect(left, y - 4, barWidth, 9);
  context.strokeStyle = palette.axis;
  context.lineWidth = 0.5;
  context.strokeRect(left, y - 4, barWidth, 9);
  let free = left - barWidth; // from where there is room for a number
  for (const tick of atLeastTwo(legend.lo, legend.hi, barWidth > 160 ? 4 : 2)) {
    const x = left + (barWidth * (tick.value - legend.lo)) / (legend.hi - legend.lo);
    line(context, [x, y + 5], [x, y + 8], palette.axis);
    const half = context.measureText(tick.text).width / 2;
    const at = Math.min(Math.max(x, left), right - half + 2);
    if (at - half < free) continue;
    free = at + half + 5;
    text(context, tick.text, at, y + 16, {color: palette.text, size: 11, halo: palette.halo});
  }
  return y + 44;
}

/** Measured places: a path with its length, or an angle. */
function drawMeasure(context, {measure, project, palette}) {
  const places = measure.places.map(project);
  places.forEach((place, i) => {
    if (i > 0) line(context, [places[i - 1].x, places[i - 1].y], [place.x, place.y], palette.measure, 2);
  });
  for (const place of places) {
    context.beginPath();
    context.arc(place.x, place.y, 4, 0, 2 * Math.PI);
    context.fillStyle = palette.ground;
    context.fill();
    context.strokeStyle = palette.measure;
    context.lineWidth = 2;
    context.stroke();
  }
  if (!measure.text || places.length < 2) return;
  const at = measure.kind === "angle" ? places[1] : {x: (places[0].x + places[1].x) / 2, y: (places[0].y + places[1].y) / 2};
  context.font = `600 13px ${FONT}`;
  const width = context.measureText(measure.text).width + 16;
  context.fillStyle = palette.measure;
  context.beginPath();
  if (context.roundRect) context.roundRect(at.x - width / 2, at.y - 32, width, 22, 5);
  else context.rect(at.x - width / 2, at.y - 32, width, 22);
  context.fill();
  text(context, measure.text, at.x, at.y - 20.5, {color: palette.ground, size: 13, weight: "600"});
}

// Pixels per unit of length of the scene at the middle of the picture; 0 where that is behind the camera.
function pixelsPerUnit({scene, orbit}) {
  if (!scene.project(orbit.target.toArray()).visible) return 0;
  const project = (place) => scene.project(place.toArray().map((value, a) => value / scene.root.scale["xyz"[a]]));
  const right = new Vector3(1, 0, 0).applyQuaternion(orbit.rotation).add(orbit.target);
  const [middle, beside] = [project(orbit.target), project(right)];
  return Math.hypot(beside.x - middle.x, beside.y - middle.y);
}

/** @param {import("./view.js").View} view */
export function drawOverlay(context, view, width, height) {
  const {picture, frame, scene, orbit, state, legends = [], measure, colors: {palette}} = view;
  const shown = {picture, frame, width, height, palette, measure, up: orbit.up, orthographic: orbit.orthographic};
  shown.project = (place) => scene.project(place);
  shown.scaleBar = placeScaleBar({...shown, pixelsPerUnit: pixelsPerUnit(view)});
  if (state.box) for (let a = 0; a < 3; ++a) drawAxis(context, a, shown);
  drawGizmo(context, view, width, height, palette);
  if (shown.scaleBar) drawScaleBar(context, shown);
  legends.reduce((top, legend) => drawLegend(context, legend, top, shown), MARGIN + 6);
  if (measure.places.length > 0) drawMeasure(context, shown);
  if (state.exaggeration !== 1)
    text(context, `heights × ${state.exaggeration}`, MARGIN, MARGIN + 6, {align: "left", color: palette.text, size: 12, halo: palette.halo});
}
