// Slices of images and volumes: grey values or colours, labels and contours on top, seeds painted with the mouse.

import {robustRange} from "../colors.js";
import {element, oncePerFrame} from "../dom.js";
import {readable} from "../ticks.js";
import {addControls, BRUSHES, HOLE_BRUSHES} from "./controls.js";
import {listen} from "./gestures.js";
import {drawContour, drawLetters, drawScaleBar, drawSeeds, seedColor} from "./overlay.js";
import {paintImage, paintLabels} from "./pictures.js";
import {Seeds} from "./seeds.js";
import {indexAt, labelSteps, meshLines, middleOf, orientation, physical, planeOf} from "./voxels.js";

const MOST_KEPT = 64; // slices
const [LEAST_ZOOM, MOST_ZOOM] = [0.2, 60];

export class Slices {
  /**
   * @param {HTMLElement} host
   * @param {{painted?: () => void, free?: () => boolean}} on painted: seeds are others; free: whether the page does not
   *   scroll, so that wheel and one finger are for the picture
   */
  constructor(host, {painted = () => {}, free = () => true} = {}) {
    this.host = host;
    Object.assign(this, {painted, free});
    this.canvas = element("canvas", {tabIndex: 0, className: "slice"});
    this.canvas.setAttribute("role", "img");
    this.readout = element("div", {className: "readout", hidden: true});
    this.stage = element("div", {className: "stage flat"}, this.canvas, this.readout);
    this.row = element("div", {className: "controls"});
    host.append(this.stage, this.row);
    this.theme = window.matchMedia("(prefers-color-scheme: dark)");
    this.theme.addEventListener("change", () => this.draw());
    this.seeds = new Seeds();
    this.cursor = null;
    this.changed = oncePerFrame(() => this.draw());
    this.state = {axis: 2, index: 0, frame: 0, labels: 0.4, contour: true, low: 0, high: 1, map: "grey", brush: 0, size: 5, zoom: 1, shift: [0, 0]};
    this.kept = new Map();
    this.controls = addControls(this);
    listen(this);
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  /**
   * @param {object} look of the image
   * @param {(axis: number, index: number, frame: number) => Promise<object>} read a slice of it
   * @param {{labels?: (axis: number, index: number) => Promise<object>, labelsLook?: object, contour?: object|null, lines?: number[]|null,
   *   keep?: boolean, name?: string, paintable?: boolean, seeds?: Seeds, frames?: number}} more labels: slices of a label
   *   image; contour: a mesh in physical coordinates; lines: that of a picture, as of svgLines; contours: either of a frame,
   *   (frame) => Promise<{contour} or {lines}>; seeds: labels of painted voxels
   */
  show(look, read, {labels = null, labelsLook = null, contour = null, lines = null, contours = null, keep = false, name = "", paintable = true, seeds = new Seeds(), frames = look.frames || 1} = {}) {
    const same = keep && this.look && this.look.size.every((n, a) => n === look.size[a]);
    Object.assign(this, {look, read, readLabels: labels, labelsLook: labelsLook || look, contour, outline: lines, contours, name, paintable, seeds, frames});
    this.steps = labelSteps(look, this.labelsLook);
    this.kept.clear();
    const flat = look.kind === "image";
    for (const control of [this.controls.axis, this.controls.index]) control.node.hidden = flat;
    for (const control of [this.controls.play, this.controls.frame]) control.node.hidden = frames < 2;
    if (this.playing && frames < 2) this.controls.play.button.click();
    this.state.frame = same ? Math.min(this.state.frame, frames - 1) : 0;
    this.controls.labels.node.hidden = !labels;
    this.controls.contour.node.hidden = !labels && !contour;
    this.controls.painting.node.hidden = !paintable;
    this.controls.brush.fill(seeds.areHoles ? HOLE_BRUSHES : BRUSHES);
    if (!paintable || (seeds.areHoles && this.state.brush === 1)) this.state.brush = 0;
    this.controls.map.node.hidden = look.components >= 3; // colours are shown as they are
    if (!same) {
      this.image = this.labels = this.lines = null;
      this.hasWindow = false;
      this.state = {...this.state, axis: 2, index: Math.floor(look.size[2] / 2), zoom: 1, shift: [0, 0], low: 0, high: 1, brush: 0};
    }
    this.canvas.setAttribute("aria-label", `Slice of an image of ${look.size.join(" × ")} voxels. Page up and down go through the slices.`);
    this.setLimits();
    return this.load();
  }

  setLimits() {
    const input = this.controls.index.node.querySelector("input");
    input.max = this.look.size[this.state.axis] - 1;
    this.controls.index.set(this.state.index);
    this.controls.frame.node.querySelector("input").max = this.frames - 1;
    this.controls.frame.set(this.state.frame);
    this.controls.axis.set(String(this.state.axis));
    this.controls.brush.set(String(this.state.brush));
    this.showBrush();
  }

  turn(axis) {
    this.state.axis = axis;
    this.state.index = Math.floor(this.look.size[axis] / 2);
    Object.assign(this.state, {zoom: 1, shift: [0, 0]});
    this.setLimits();
    return this.load();
  }

  go(index) {
    this.state.index = Math.min(Math.max(Math.round(index), 0), this.look.size[this.state.axis] - 1);
    this.controls.index.set(this.state.index);
    return this.load();
  }

  /** The slice through the middle of the contour, where the one that is shown has nothing of it. */
  goToContour() {
    if (!this.contour || (this.lines && this.lines.length > 0)) return undefined;
    const best = Math.round(indexAt(middleOf(this.contour), this.state.axis, this.look));
    return best === this.state.index ? undefined : this.go(best);
  }

  goToFrame(frame) {
    this.state.frame = frame;
    this.controls.frame.set(frame);
    return this.load();
  }

  set(change) {
    Object.assign(this.state, change);
    this.controls.low.set(100 * this.state.low);
    this.controls.high.set(100 * this.state.high);
    this.showBrush();
    this.changed();
  }

  /** The value at a part of the range of the image. */
  valueAt(part) {
    const [lo, hi] = this.look.range;
    return lo + part * (hi - lo);
  }

  // Black and white of the first slice: a few extreme values, such as metal in a CT scan, do not make the rest grey.
  setWindow() {
    this.hasWindow = true;
    const [lo, hi] = this.look.range;
    const {values} = this.image;
    const isFlat = !(hi > lo) || values.every((value) => value === values[0]);
    if (isFlat || this.look.type === "uint8" || this.look.components >= 3) return this.set({low: 0, high: 1});
    const [low, high] = robustRange(values, 0.002).map((value) => (value - lo) / (hi - lo));
    return this.set({low, high});
  }

  /** As it was at first. */
  reset() {
    this.setWindow();
    this.set({zoom: 1, shift: [0, 0]});
  }

  // What fingers and the mouse do: the page scrolls under a finger where it is narrow, unless that paints.
  showBrush() {
    const {brush} = this.state;
    this.canvas.style.cursor = brush === 0 ? "grab" : "crosshair";
    this.canvas.style.touchAction = this.free() || brush !== 0 ? "none" : "pan-y";
    this.controls.brush.node.querySelector("select").style.boxShadow = brush > 0 ? `inset 5px 0 ${seedColor(brush)}` : "";
  }

  zoom(factor, [px, py]) {
    const zoom = Math.min(Math.max(this.state.zoom * factor, LEAST_ZOOM), MOST_ZOOM);
    // What is there stays there.
    const middle = [this.stage.clientWidth / 2, this.stage.clientHeight / 2];
    const shift = [px, py].map((at, a) => at - middle[a] - ((at - middle[a] - this.state.shift[a]) * zoom) / this.state.zoom);
    return this.set({zoom, shift});
  }

  async slice(kind, read, axis, index) {
    const {frame} = this.state;
    const key = `${kind} ${axis} ${index} ${frame}`;
    if (!this.kept.has(key)) {
      if (this.kept.size > MOST_KEPT) this.kept.delete(this.kept.keys().next().value);
      this.kept.set(key, read(axis, index, frame));
    }
    return this.kept.get(key);
  }

  async load() {
    const {axis, index} = this.state;
    const turn = (this.turnOf = (this.turnOf || 0) + 1);
    const labelIndex = Math.min(Math.round(index / this.steps[axis]), this.labelsLook.size[axis] - 1);
    try {
      const [image, labels, drawn] = await Promise.all([
        this.slice("image", this.read, axis, index),
        this.readLabels ? this.slice("labels", this.readLabels, axis, labelIndex) : null,
        this.contours ? this.slice("contour", (_axis, _index, frame) => this.contours(frame), 0, 0) : null,
      ]);
      if (turn !== this.turnOf) return; // a later one was asked for
      if (drawn) Object.assign(this, {contour: drawn.contour || null, outline: drawn.lines || null});
      this.image = image;
      this.labels = labels;
      if (!this.hasWindow) this.setWindow();
      this.lines = this.contour ? meshLines(this.contour, axis, index, this.look) : this.outline;
      this.draw();
    } catch (error) {
      if (turn === this.turnOf) throw error;
    }
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.canvas.width = this.stage.clientWidth * ratio;
    this.canvas.height = this.stage.clientHeight * ratio;
    this.changed();
  }

  // From pixels of the image to those of the canvas (in units of the page): scale along both axes and the corner.
  placement() {
    const [u, v] = planeOf(this.state.axis);
    const {spacing} = this.look;
    const {width, height} = this.image;
    const [w, h] = [width * spacing[u], height * spacing[v]];
    const fit = Math.min(this.stage.clientWidth / w, this.stage.clientHeight / h) * 0.94 * this.state.zoom;
    const [across, down] = orientation(this.look, this.state.axis);
    const [sx, sy] = [fit * spacing[u], fit * spacing[v]];
    const x0 = (this.stage.clientWidth - width * sx) / 2 + this.state.shift[0];
    const y0 = (this.stage.clientHeight - height * sy) / 2 + this.state.shift[1];
    const signs = [across, down].map(({reversed}) => (reversed ? -1 : 1));
    const from = [across.reversed ? x0 + width * sx : x0, down.reversed ? y0 + height * sy : y0];
    const to = (a, scale) => (voxel) => from[a] + signs[a] * (voxel + 0.5) * scale;
    const back = (a, scale) => (pixel) => (signs[a] * (pixel - from[a])) / scale - 0.5;
    return {sx, sy, x0, y0, width, height, fit, from, signs, ends: [across.ends, down.ends], toX: to(0, sx), toY: to(1, sy), fromX: back(0, sx), fromY: back(1, sy)};
  }

  // Pixels are coloured again only when they, or their colours, are others.
  remembered(name, key, paint) {
    const kept = this[name];
    if (kept && kept.key.every((part, i) => part === key[i])) return kept.canvas;
    this[name] = {key, canvas: paint()};
    return this[name].canvas;
  }

  draw() {
    if (!this.image || this.canvas.width === 0 || this.stage.clientWidth === 0) return; // not seen
    const context = this.canvas.getContext("2d");
    const ratio = this.canvas.width / (this.stage.clientWidth || 1);
    const at = this.placement();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.stage.clientWidth, this.stage.clientHeight);
    context.imageSmoothingEnabled = at.sx < 3;
    // Two pixels of a large image for one of the screen.
    const strideOf = ({width}) => Math.max(1, Math.floor((0.5 * width) / (at.width * Math.max(at.sx, at.sy) * ratio)));
    // A pixel of the slice stands for `steps` of the image, the first one for the image's first and what is around it.
    const put = (slice, picture, opacity, steps) => {
      const [su, sv] = [at.sx, at.sy].map((s, a) => s * steps[a] * strideOf(slice));
      context.save();
      context.globalAlpha = opacity;
      context.translate(...at.from);
      context.scale(...at.signs);
      context.drawImage(picture, (at.sx * (1 - steps[0])) / 2, (at.sy * (1 - steps[1])) / 2, picture.width * su, picture.height * sv);
      context.restore();
    };
    const steps = planeOf(this.state.axis).map((a) => this.steps[a]);
    const {low, high, map, labels} = this.state;
    const stride = strideOf(this.image);
    put(this.image, this.remembered("picture", [this.image, this.look, low, high, map, stride], () => paintImage(this.image, this.look.range, this.state, stride)), 1, [1, 1]);
    context.save();
    context.beginPath();
    context.rect(at.x0, at.y0, at.width * at.sx, at.height * at.sy);
    context.clip();
    if (this.labels && labels > 0) {
      const strideOfLabels = strideOf(this.labels);
      put(this.labels, this.remembered("labelPicture", [this.labels, strideOfLabels], () => paintLabels(this.labels, strideOfLabels)), labels, steps);
    }
    if (this.state.contour) drawContour(context, at, this, steps);
    context.restore();
    drawSeeds(context, at, this);
    drawScaleBar(context, at, this);
    drawLetters(context, at, this);
    this.probe();
  }

  voxelAt(px, py) {
    const at = this.placement();
    const [u, v] = planeOf(this.state.axis);
    const voxel = [0, 0, 0];
    voxel[this.state.axis] = this.state.index;
    voxel[u] = Math.round(at.fromX(px));
    voxel[v] = Math.round(at.fromY(py));
    return voxel[u] >= 0 && voxel[v] >= 0 && voxel[u] < at.width && voxel[v] < at.height ? voxel : null;
  }

  /** Tells what is under the cursor. */
  probe() {
    const voxel = this.image && this.cursor && this.voxelAt(...this.cursor);
    this.readout.hidden = !voxel;
    if (!voxel) return;
    const [u, v] = planeOf(this.state.axis);
    const {values, components, width} = this.image;
    const at = components * (voxel[v] * width + voxel[u]);
    const value = Array.from({length: components}, (_, c) => readable(values[at + c])).join(", ");
    const place = physical(voxel, this.look).slice(0, this.look.kind === "volume" ? 3 : 2).map((p) => readable(p, 5)).join(", ");
    let words = `voxel ${voxel.slice(0, this.look.kind === "volume" ? 3 : 2).join(", ")}  ·  at ${place}${this.look.unit ? " " + this.look.unit : ""}  ·  value ${value}`;
    if (this.labels) {
      const [column, row] = [u, v].map((a) => Math.min(Math.round(voxel[a] / this.steps[a]), this.labelsLook.size[a] - 1));
      const label = this.labels.values[this.labels.components * (row * this.labels.width + column)];
      words += `  ·  label ${label}`;
    }
    this.readout.textContent = words;
  }

  paint(px, py) {
    const center = this.voxelAt(px, py);
    if (!center) return;
    const [u, v] = planeOf(this.state.axis);
    const r = this.state.size / 2;
    for (let dv = -Math.ceil(r); dv <= r; ++dv)
      for (let du = -Math.ceil(r); du <= r; ++du) {
        if (du * du + dv * dv > r * r) continue;
        const voxel = [...center];
        voxel[u] += du;
        voxel[v] += dv;
        if (voxel[u] < 0 || voxel[v] < 0 || voxel[u] >= this.image.width || voxel[v] >= this.image.height) continue;
        if (this.state.brush < 0) this.seeds.delete(voxel.join(","));
        else this.seeds.set(voxel.join(","), this.state.brush);
      }
    this.changed();
  }

  clearSeeds() {
    this.seeds.begin();
    this.seeds.clear();
    this.changed();
    this.painted();
  }

  /** Takes back what was painted last (-1), or paints it again (1). */
  stepSeeds(by) {
    this.seeds.step(by);
    this.changed();
    this.painted();
  }
}
