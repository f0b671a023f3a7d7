// Starts an interactive view in every figure of the page that contains a surface.

import {button, choice, Legend, slider, toggle} from "./controls.js";
import * as colors from "./colors.js";
import * as decode from "./decode.js";
import {listen} from "./gestures.js";
import {Orbit} from "./orbit.js";
import {Scene} from "./scene.js";
import {Vector3} from "three";

const AXES = {x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1)};
const PLAIN = "plain";
const OWN = "own"; // colours that come with the surface
const BEYOND_BOX = 1.001; // scales the depth of the cut, so that rounding spares nothing at its ends

class View {
  constructor(figure, data) {
    this.figure = figure;
    this.data = data;
    const {halfSides} = decode.frame(data.low, data.high);
    this.halfSides = halfSides;
    this.canvas = figure.querySelector("canvas");
    this.orbit = new Orbit(upAxis(data.up));
    this.surface = {
      positions: decode.positions(data.positions, halfSides),
      normals: decode.normals(data.normals),
      triangles: decode.shorts(data.triangles),
    };
    this.points = data.points ? {positions: decode.positions(data.points.positions, halfSides)} : null;
    this.tints = data.tints ? colors.ofBytes(decode.bytes(data.tints)) : null;
    this.pointTints = data.points && data.points.tints ? colors.ofBytes(decode.bytes(data.points.tints)) : null;
    this.scales = data.scales.map((scale) => ({
      ...scale,
      values: decode.bytes(scale.values),
      pointValues: scale.point_values ? decode.bytes(scale.point_values) : null,
    }));
    this.scene = new Scene(this.canvas, this.surface, this.points, this.orbit);
    this.theme = window.matchMedia("(prefers-color-scheme: dark)");
    this.canvas.addEventListener("webglcontextlost", () => this.stop());
    this.addControls();
    this.reset();
    listen(this.canvas, this.orbit, () => this.changed());
    this.theme.addEventListener("change", () => this.recolor());
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    window.addEventListener("beforeprint", () => this.draw());
    this.resize();
    figure.classList.add("live");
    this.resize();
    this.draw();
  }

  addControls() {
    const own = this.tints || this.pointTints ? [[OWN, "its own"]] : [];
    const names = [[PLAIN, "plain"], ...own, ...this.scales.map((scale, i) => [String(i), scale.name])];
    const cuts = [["none", "none"], ["x", "across x"], ["y", "across y"], ["z", "across z"], ["view", "facing you"]];
    const ups = Object.keys(AXES).map((axis) => [axis, axis]);
    this.legend = new Legend();
    this.controls = {
      color: choice("Colour", "color", names, PLAIN, (value) => this.set({color: value})),
      points: this.points && toggle("Points", "points", (shown) => this.set({points: shown})),
      cut: choice("Cut", "cut", cuts, "none", (axis) => this.startCut(axis)),
      depth: slider("Where", "depth", (depth) => this.set({depth})),
      up: choice("Up", "up", ups, this.orbit.up, (axis) => this.turnUp(axis)),
      reset: button("Reset", "reset", () => this.reset()),
    };
    const row = this.figure.querySelector(".controls");
    row.append(...Object.values(this.controls).flatMap((control) => (control ? [control.node] : [])));
    this.figure.querySelector(".stage").append(this.legend.node);
  }

  reset() {
    this.turnUp(upAxis(this.data.up));
    if (this.controls.up) this.controls.up.set(this.orbit.up);
    const cloudAlone = this.surface.triangles.length === 0;
    this.set({color: this.controls.color ? this.data.shown : PLAIN, points: cloudAlone, cut: "none", depth: 0.5});
  }

  turnUp(axis) {
    this.orbit.reset(axis);
    this.orbit.fit(this.surface.positions);
    this.changed();
  }

  // The side facing the viewer is removed, to show the inside. The plane stays when the surface is rotated.
  startCut(axis) {
    const toViewer = AXES.z.clone().applyQuaternion(this.orbit.rotation);
    if (axis === "view") this.cutNormal = toViewer;
    else if (axis in AXES) this.cutNormal = AXES[axis].clone().multiplyScalar(AXES[axis].dot(toViewer) < 0 ? -1 : 1);
    this.set({cut: axis});
  }

  set(change) {
    this.state = {...this.state, ...change};
    const {color, points, cut, depth} = this.state;
    if (this.controls.color) this.controls.color.set(color);
    if (this.controls.points) this.controls.points.set(points);
    this.controls.cut.set(cut);
    this.controls.depth.set(depth, cut !== "none");
    this.scene.showPoints(points);
    this.scene.setCut(cut === "none" ? null : this.plane(depth));
    this.recolor();
  }

  // depth 0 keeps nothing of the box, 1 all of it.
  plane(depth) {
    const reach = this.cutNormal.toArray().reduce((sum, value, a) => sum + Math.abs(value) * this.halfSides[a], 0);
    return {normal: this.cutNormal, offset: reach * (2 * depth - 1) * BEYOND_BOX};
  }

  recolor() {
    const dark = this.theme.matches;
    const missing = dark ? [0.36, 0.38, 0.42] : [0.72, 0.73, 0.75];
    const plain = dark ? [0.78, 0.74, 0.69] : [0.86, 0.82, 0.76];
    const pointColor = dark ? [0.45, 0.72, 0.95] : [0.1, 0.32, 0.6];
    const scale = this.scales[this.state.color];
    const stops = scale && this.data.colors[scale.map];
    const count = this.surface.positions.length / 3;
    const own = this.state.color === OWN;
    let tint = scale ? colors.colorsOf(scale.values, stops, missing) : colors.uniform(count, plain);
    if (own && this.tints) tint = this.tints;
    let pointTint = null;
    if (this.points) {
      const n = this.points.positions.length / 3;
      const values = scale && scale.pointValues;
      pointTint = values ? colors.colorsOf(values, stops, missing) : colors.uniform(n, pointColor);
      if (own && this.pointTints) pointTint = this.pointTints;
    }
    this.scene.setColors(tint, pointTint, dark ? [0.3, 0.42, 0.52] : [0.42, 0.55, 0.66]);
    this.legend.show(scale, stops);
    this.changed();
  }

  resize() {
    this.scene.resize();
    this.changed();
  }

  // Browsers draw some sixteen views at a time; the oldest one becomes a still picture again.
  stop() {
    this.figure.classList.remove("live");
    this.figure.querySelector(".why-still").textContent =
      "A still picture: the browser draws no more views at a time. Reload the page to turn it.";
  }

  changed() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.waiting = false;
    this.scene.draw();
  }
}

// The URL may set the axis that points upwards: report.html#up=y.
function upAxis(preferred) {
  const asked = new URLSearchParams(window.location.hash.slice(1)).get("up");
  return asked in AXES ? asked : preferred;
}

for (const figure of document.querySelectorAll("figure.surface")) {
  const data = JSON.parse(figure.querySelector("script.surface-data").textContent);
  try {
    figure.view = new View(figure, data);
  } catch (error) {
    figure.classList.remove("live");
    figure.querySelector(".why-still").textContent = `No interactive view here: ${error.message}`;
  }
}
