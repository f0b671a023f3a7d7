// Slices of images and volumes: grey values or colours, labels and contours on top, seeds painted with the mouse.

import {button, choice, element, oncePerFrame, panel, save, slider, toggle} from "./dom.js";
import {LABELS, MAPS, parse, at as colorAt} from "./colors.js";
import {readable, roundStep} from "./ticks.js";
import {section} from "./section.js";
import {player} from "./series.js";

const AXES = ["x", "y", "z"];
const MOST_KEPT = 64; // slices

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

/** Rows "x,y[,z],label" of painted voxels in physical coordinates, as --seeds takes them. */
export function seedTable(seeds, look) {
  const dimension = look.kind === "volume" ? 3 : 2;
  const rows = [dimension === 3 ? "x,y,z,label" : "x,y,label"];
  for (const [key, label] of seeds) {
    const voxel = key.split(",").map(Number);
    rows.push([...physical(voxel, look).slice(0, dimension).map((value) => Number(value.toPrecision(9))), label].join(","));
  }
  return rows.join("\n") + "\n";
}

/** The physical place of a voxel. */
export function physical(voxel, {origin, spacing, direction}) {
  return [0, 1, 2].map((r) => origin[r] + [0, 1, 2].reduce((sum, c) => sum + direction[3 * r + c] * spacing[c] * voxel[c], 0));
}

// A canvas for every stride-th pixel of a slice, and where the pixels of the canvas are in the slice.
function thinned({width, height}, stride) {
  const canvas = element("canvas", {width: Math.ceil(width / stride), height: Math.ceil(height / stride)});
  return {canvas, places: (n) => (stride === 1 ? n : stride * ((n % canvas.width) + width * Math.floor(n / canvas.width)))};
}

export class Slices {
  /**
   * @param {HTMLElement} host
   * @param {{painted?: () => void}} on called when seeds change
   */
  constructor(host, {painted = () => {}} = {}) {
    this.host = host;
    this.painted = painted;
    this.canvas = element("canvas", {tabIndex: 0, className: "slice"});
    this.canvas.setAttribute("role", "img");
    this.readout = element("div", {className: "readout", hidden: true});
    this.stage = element("div", {className: "stage flat"}, this.canvas, this.readout);
    this.row = element("div", {className: "controls"});
    host.append(this.stage, this.row);
    this.theme = window.matchMedia("(prefers-color-scheme: dark)");
    this.theme.addEventListener("change", () => this.draw());
    this.seeds = new Map();
    this.changed = oncePerFrame(() => this.draw());
    this.state = {axis: 2, index: 0, frame: 0, labels: 0.4, contour: true, low: 0, high: 1, map: "grey", brush: 0, size: 5, zoom: 1, shift: [0, 0]};
    this.kept = new Map();
    this.addControls();
    this.listen();
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  addControls() {
    const brushes = [["0", "move"], ["1", "outside (0)"], ["2", "inside (1)"], ["3", "label 2"], ["4", "label 3"], ["-1", "erase"]];
    const shown = (i) => String(i);
    const c = {
      axis: choice("Across", "axis", AXES.map((a, i) => [String(i), a]), "2", (axis) => this.turn(Number(axis))),
      index: slider("Slice", "slice", {lo: 0, hi: 0, step: 1, value: 0, shown}, (index) => this.go(index)),
      frame: slider("Frame", "frame", {lo: 0, hi: 0, step: 1, value: 0, shown}, (frame) => this.goToFrame(frame)),
      labels: slider("Labels", "labels", {lo: 0, hi: 100, step: 1, value: 40, shown: (n) => `${n} %`}, (n) => this.set({labels: n / 100})),
      contour: toggle("Contour", "contour", (contour) => this.set({contour}), true),
      low: slider("Black", "black", {lo: 0, hi: 100, step: 0.5, value: 0}, (n) => this.set({low: n / 100})),
      high: slider("White", "white", {lo: 0, hi: 100, step: 0.5, value: 100}, (n) => this.set({high: n / 100})),
      map: choice("Colours", "slice-map", ["grey", "viridis", "cividis", "batlow"].map((m) => [m, m]), "grey", (map) => this.set({map})),
      brush: choice("Mouse", "brush", brushes, "0", (brush) => this.set({brush: Number(brush)})),
      size: slider("Brush", "brush-size", {lo: 1, hi: 40, step: 1, value: 5, shown: (n) => `${n} px`}, (size) => this.set({size})),
    };
    this.controls = c;
    const play = player(() => this.goToFrame((this.state.frame + 1) % this.frames));
    c.play = button("Play", "play", () => {
      this.playing = play();
      c.play.button.textContent = this.playing ? "Pause" : "Play";
    });
    const clear = element("button", {type: "button", name: "clear-seeds"}, "Clear seeds");
    clear.addEventListener("click", () => this.clearSeeds());
    const reset = element("button", {type: "button", name: "reset-slice"}, "Reset");
    reset.addEventListener("click", () => this.set({zoom: 1, shift: [0, 0], low: 0, high: 1}));
    const picture = element("button", {type: "button", name: "slice-picture"}, "Save PNG");
    picture.addEventListener("click", () => this.canvas.toBlob((blob) => save(blob, `${this.name || "slice"}.png`)));
    this.paintingControls = element("div", {className: "group"}, c.brush.node, c.size.node, element("div", {className: "control"}, clear));
    this.row.append(c.play.node, c.frame.node, c.axis.node, c.index.node, c.labels.node, c.contour.node,
      panel("Window", "window", c.low.node, c.high.node, c.map.node).node, this.paintingControls,
      element("div", {className: "control"}, reset), element("div", {className: "control"}, picture));
  }

  /**
   * @param {object} look of the image
   * @param {(axis: number, index: number, frame: number) => Promise<object>} read a slice of it
   * @param {{labels?: (axis: number, index: number) => Promise<object>, labelsLook?: object, contour?: object|null, lines?: number[]|null,
   *   keep?: boolean, name?: string, paintable?: boolean, frames?: number}} more labels: slices of a label image; contour: a mesh in
   *   physical coordinates; lines: that of a picture, as of svgLines
   */
  show(look, read, {labels = null, labelsLook = null, contour = null, lines = null, keep = false, name = "", paintable = true, frames = look.frames || 1} = {}) {
    const same = keep && this.look && this.look.size.every((n, a) => n === look.size[a]);
    Object.assign(this, {look, read, readLabels: labels, labelsLook: labelsLook || look, contour, outline: lines, name, frames});
    this.kept.clear();
    const flat = look.kind === "image";
    for (const control of [this.controls.axis, this.controls.index]) control.node.hidden = flat;
    for (const control of [this.controls.play, this.controls.frame]) control.node.hidden = frames < 2;
    if (this.playing && frames < 2) this.controls.play.button.click();
    this.state.frame = same ? Math.min(this.state.frame, frames - 1) : 0;
    this.controls.labels.node.hidden = !labels;
    this.controls.contour.node.hidden = !labels && !contour;
    this.paintingControls.hidden = !paintable;
    if (!same) {
      this.seeds.clear();
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
    const {axis, index} = this.state;
    if (!this.contour || (this.lines && this.lines.length > 0)) return undefined;
    const {origin, spacing, direction, size} = this.look;
    const middle = this.contour.low.map((lo, a) => (lo + this.contour.high[a]) / 2 - origin[a]);
    const along = [0, 1, 2].reduce((sum, r) => sum + direction[3 * r + axis] * middle[r], 0) / spacing[axis];
    const best = Math.min(Math.max(Math.round(along), 0), size[axis] - 1);
    return best === index ? undefined : this.go(best);
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
    this.canvas.style.cursor = this.state.brush === 0 ? "grab" : "crosshair";
    this.changed();
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
    const scale = this.labelsLook.size[axis] / this.look.size[axis];
    const labelIndex = Math.min(Math.floor(index * scale), this.labelsLook.size[axis] - 1);
    try {
      const [image, labels] = await Promise.all([
        this.slice("image", this.read, axis, index),
        this.readLabels ? this.slice("labels", this.readLabels, axis, labelIndex) : null,
      ]);
      if (turn !== this.turnOf) return; // a later one was asked for
      this.image = image;
      this.labels = labels;
      this.lines = this.contourLines();
      this.draw();
    } catch (error) {
      if (turn === this.turnOf) throw error;
    }
  }

  // The sub-voxel contour: where the mesh meets the plane of the slice, in pixels.
  contourLines() {
    const {axis, index} = this.state;
    const [u, v] = planeOf(axis);
    const {origin, spacing, direction} = this.look;
    if (!this.contour) return this.outline;
    const normal = [0, 1, 2].map((r) => direction[3 * r + axis]);
    const place = physical([0, 1, 2].map((a) => (a === axis ? index : 0)), this.look);
    const middle = this.contour.low.map((lo, a) => (lo + this.contour.high[a]) / 2);
    const offset = normal.reduce((sum, n, a) => sum + n * (place[a] - middle[a]), 0);
    const ends = section(this.contour.positions, this.contour.triangles, normal, offset + 1e-6 * spacing[axis]);
    const result = [];
    for (let i = 0; i < ends.length; i += 3) {
      const p = [0, 1, 2].map((a) => ends[i + a] + middle[a] - origin[a]);
      for (const axisOf of [u, v]) result.push([0, 1, 2].reduce((sum, r) => sum + direction[3 * r + axisOf] * p[r], 0) / spacing[axisOf]);
    }
    return result;
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

  paintPicture(stride) {
    const {values, components} = this.image;
    const {canvas, places} = thinned(this.image, stride);
    const context = canvas.getContext("2d");
    const pixels = context.createImageData(canvas.width, canvas.height);
    const [lo, hi] = this.look.range;
    const from = lo + this.state.low * (hi - lo), to = lo + this.state.high * (hi - lo);
    const factor = to !== from ? 255 / (to - from) : 0;
    const stops = MAPS[this.state.map];
    const table = Array.from({length: 256}, (_, i) => (this.state.map === "grey" ? [i, i, i] : colorAt(stops, i / 255).map((c) => 255 * c)));
    const place = (value) => Math.min(Math.max((value - from) * factor, 0), 255);
    for (let n = 0, k = 0; k < pixels.data.length; ++n, k += 4) {
      const i = places(n), value = values[components * i];
      const grey = table[Math.round(place(value)) || 0];
      for (let c = 0; c < 3; ++c) pixels.data[k + c] = components >= 3 ? place(values[components * i + c]) : grey[c];
      pixels.data[k + 3] = value === value ? 255 : 60; // less where there is none
    }
    context.putImageData(pixels, 0, 0);
    return canvas;
  }

  paintLabels(stride) {
    const {values, components} = this.labels;
    const colors = LABELS.map(parse);
    const {canvas, places} = thinned(this.labels, stride);
    const context = canvas.getContext("2d");
    const pixels = context.createImageData(canvas.width, canvas.height);
    for (let i = 0; 4 * i < pixels.data.length; ++i) {
      const label = values[components * places(i)];
      if (!(label > 0)) continue;
      const color = colors[(Math.round(label) - 1) % colors.length];
      for (let c = 0; c < 3; ++c) pixels.data[4 * i + c] = 255 * color[c];
      pixels.data[4 * i + 3] = 255;
    }
    context.putImageData(pixels, 0, 0);
    return canvas;
  }

  draw() {
    if (!this.image || this.canvas.width === 0) return;
    const context = this.canvas.getContext("2d");
    const ratio = this.canvas.width / (this.stage.clientWidth || 1);
    const at = this.placement();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.stage.clientWidth, this.stage.clientHeight);
    context.imageSmoothingEnabled = at.sx < 3;
    // Two pixels of a large image for one of the screen.
    const strideOf = ({width}) => Math.max(1, Math.floor((0.5 * width) / (at.width * Math.max(at.sx, at.sy) * ratio)));
    const put = (slice, picture, opacity) => {
      const [sx, sy] = [(at.width * at.sx) / slice.width, (at.height * at.sy) / slice.height].map((s) => s * strideOf(slice));
      context.save();
      context.globalAlpha = opacity;
      context.translate(...at.from);
      context.scale(...at.signs);
      context.drawImage(picture, 0, 0, picture.width * sx, picture.height * sy);
      context.restore();
    };
    const {low, high, map, labels} = this.state;
    const stride = strideOf(this.image);
    put(this.image, this.remembered("picture", [this.image, this.look, low, high, map, stride], () => this.paintPicture(stride)), 1);
    if (this.labels && labels > 0) {
      const strideOfLabels = strideOf(this.labels);
      put(this.labels, this.remembered("labelPicture", [this.labels, strideOfLabels], () => this.paintLabels(strideOfLabels)), labels);
    }
    if (this.state.contour) this.drawContour(context, at);
    this.drawSeeds(context, at);
    this.drawScaleBar(context, at);
    this.drawLetters(context, at);
  }

  // Which way the patient lies.
  drawLetters(context, {ends: [across, down]}) {
    if (!across || this.look.kind !== "volume") return;
    const {clientWidth: width, clientHeight: height} = this.stage;
    context.font = '600 13px system-ui, "Segoe UI", sans-serif';
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineWidth = 4;
    const style = getComputedStyle(this.stage);
    [context.strokeStyle, context.fillStyle] = [style.backgroundColor, style.color];
    for (const [letter, x, y] of [[across[0], 14, height / 2], [across[1], width - 14, height / 2], [down[0], width / 2, 14], [down[1], width / 2, height - 14]]) {
      context.strokeText(letter, x, y);
      context.fillText(letter, x, y);
    }
    context.textBaseline = "alphabetic";
  }

  drawContour(context, at) {
    let ends = this.lines, scale = [1, 1];
    if ((!ends || ends.length === 0) && this.labels) {
      ends = labelEdges(this.labels.values, this.labels.width, this.labels.height);
      scale = [at.width / this.labels.width, at.height / this.labels.height];
    }
    if (!ends) return;
    const draw = (color, width) => {
      context.beginPath();
      for (let i = 0; i < ends.length; i += 4) {
        context.moveTo(at.toX((ends[i] + 0.5) * scale[0] - 0.5), at.toY((ends[i + 1] + 0.5) * scale[1] - 0.5));
        context.lineTo(at.toX((ends[i + 2] + 0.5) * scale[0] - 0.5), at.toY((ends[i + 3] + 0.5) * scale[1] - 0.5));
      }
      context.strokeStyle = color;
      context.lineWidth = width;
      context.lineJoin = context.lineCap = "round";
      context.stroke();
    };
    draw("rgba(0,0,0,.55)", 3);
    draw("#ffd166", 1.5);
  }

  drawSeeds(context, at) {
    const {axis, index} = this.state;
    const [u, v] = planeOf(axis);
    for (const [key, label] of this.seeds) {
      const voxel = key.split(",").map(Number);
      if (voxel[axis] !== index) continue;
      context.fillStyle = label === 1 ? "#38bdf8" : LABELS[(label - 1) % LABELS.length];
      context.fillRect(at.toX(voxel[u] - 0.5 * at.signs[0]), at.toY(voxel[v] - 0.5 * at.signs[1]), at.sx, at.sy);
    }
  }

  drawScaleBar(context, at) {
    const length = roundStep(100 / at.fit, 1);
    const pixels = length * at.fit;
    const plain = this.look.kind === "image" && this.look.spacing[0] === 1 ? "pixels" : "(units of the file)";
    const text = `${readable(length, 3)} ${this.look.unit || plain}`;
    // In the corner of the picture, or of the stage where the picture goes beyond it.
    const right = Math.min(this.stage.clientWidth, at.x0 + at.width * at.sx) - 20;
    const [x, y] = [right - pixels, Math.min(this.stage.clientHeight, at.y0 + at.height * at.sy) - 18];
    context.font = '11px system-ui, "Segoe UI", sans-serif';
    context.textAlign = "right";
    const style = getComputedStyle(this.stage);
    const width = Math.max(pixels, context.measureText(text).width);
    context.fillStyle = style.backgroundColor;
    context.globalAlpha = 0.85;
    context.beginPath();
    context.roundRect(x + pixels - width - 8, y - 21, width + 16, 31, 6);
    context.fill();
    context.globalAlpha = 1;
    context.fillStyle = style.color;
    context.fillRect(x, y, pixels, 2);
    context.fillText(text, x + pixels, y - 6);
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

  probe(px, py) {
    const voxel = this.image && this.voxelAt(px, py);
    this.readout.hidden = !voxel;
    if (!voxel) return;
    const [u, v] = planeOf(this.state.axis);
    const {values, components, width} = this.image;
    const at = components * (voxel[v] * width + voxel[u]);
    const value = Array.from({length: components}, (_, c) => readable(values[at + c])).join(", ");
    const place = physical(voxel, this.look).slice(0, this.look.kind === "volume" ? 3 : 2).map((p) => readable(p, 5)).join(", ");
    let words = `voxel ${voxel.slice(0, this.look.kind === "volume" ? 3 : 2).join(", ")}  ·  at ${place}${this.look.unit ? " " + this.look.unit : ""}  ·  value ${value}`;
    if (this.labels) {
      const scale = this.labels.width / width;
      const label = this.labels.values[this.labels.components * (Math.floor(voxel[v] * scale) * this.labels.width + Math.floor(voxel[u] * scale))];
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
    this.seeds.clear();
    this.changed();
    this.painted();
  }

  seedText() {
    return seedTable(this.seeds, this.look);
  }

  listen() {
    const {canvas} = this;
    let from = null;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (!this.image) return;
      canvas.focus({preventScroll: true});
      canvas.setPointerCapture(event.pointerId);
      from = place(event);
      if (this.state.brush !== 0) this.paint(...from);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!this.image) return;
      const now = place(event);
      if (!from) return this.probe(...now);
      if (this.state.brush !== 0) {
        const steps = Math.ceil(Math.hypot(now[0] - from[0], now[1] - from[1]) / 3) || 1;
        for (let i = 1; i <= steps; ++i) this.paint(from[0] + ((now[0] - from[0]) * i) / steps, from[1] + ((now[1] - from[1]) * i) / steps);
      } else {
        this.state.shift = this.state.shift.map((value, a) => value + now[a] - from[a]);
        this.changed();
      }
      from = now;
      return undefined;
    });
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, () => {
        if (from && this.state.brush !== 0) this.painted();
        from = null;
      });
    canvas.addEventListener("pointerleave", () => (this.readout.hidden = true));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        if (event.ctrlKey || this.look.kind === "image") {
          const zoom = Math.min(Math.max(this.state.zoom * Math.exp(-event.deltaY * 0.002), 0.2), 60);
          const [x, y] = place(event);
          const [cx, cy] = [this.stage.clientWidth / 2, this.stage.clientHeight / 2];
          const factor = zoom / this.state.zoom;
          this.state.shift = [x - cx - (x - cx - this.state.shift[0]) * factor, y - cy - (y - cy - this.state.shift[1]) * factor];
          this.set({zoom});
        } else this.go(this.state.index + Math.sign(event.deltaY));
      },
      {passive: false},
    );
    canvas.addEventListener("keydown", (event) => {
      const steps = {PageUp: 1, PageDown: -1, ArrowUp: 1, ArrowDown: -1};
      const axis = AXES.indexOf(event.key);
      if (event.key in steps) this.go(this.state.index + steps[event.key]);
      else if (axis >= 0 && this.look.kind === "volume") this.turn(axis);
      else if (event.key === "0") this.set({zoom: 1, shift: [0, 0]});
      else if (event.key === "+" || event.key === "-") this.set({zoom: this.state.zoom * (event.key === "+" ? 1.2 : 1 / 1.2)});
      else return;
      event.preventDefault();
    });
  }
}
