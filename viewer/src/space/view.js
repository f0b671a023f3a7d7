// A picture in space to turn, cut, colour and measure: canvas, what is written on it, and its controls. Reports and the
// studio show the same.

import {Vector3} from "three";

import {MAPS, placesOnScale} from "../colors.js";
import {frame} from "../decode.js";
import {element, oncePerFrame, save} from "../dom.js";
import {DEFAULT_COLORS, guessUp} from "../look.js";
import {counted} from "../ticks.js";
import {addControls, PLAIN} from "./controls.js";
import {listen} from "./gestures.js";
import {press} from "./keys.js";
import {linkTo, readLink} from "./link.js";
import {Orbit} from "./orbit.js";
import {axisMap, drawOverlay, gizmoEnds} from "./overlay.js";
import {describe, measured, pick} from "./probe.js";
import {Scene} from "./scene.js";
import {areaOf, section, valueAt} from "./section.js";
import {THEMES} from "./themes.js";

const AXES = {x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1)};
const BEYOND_BOX = 1.001; // scales the depth of the cut, so that rounding spares nothing at its ends
const ROOM_FOR_SCALES = 1.06; // of the box: numbers and names stand beside it
const ROOM_FOR_NAMES = 75; // pixels on either side, for the same
const MOST_HOVERED = 400000; // triangles that are searched whenever the cursor moves
const REST = 200; // milliseconds without movement, after which a large mesh is drawn in full
const GIZMO_REACH = 10; // pixels around the end of an axis
const FIRST = {
  color: PLAIN, map: "own", points: false, surface: true, edges: "none", opacity: 1, isolines: 0, pointSize: 1,
  pointOpacity: 1, cut: "none", depth: 0.5, box: true, exaggeration: 1, orthographic: false, measure: "none", lines: true,
};
// Parts of the state whose controls take them as they are.
const SHOWN_AS_THEY_ARE = ["color", "points", "lines", "cut", "map", "isolines", "surface", "edges", "pointSize", "box", "orthographic", "measure", "exaggeration"];

export class View {
  /**
   * @param {HTMLElement} host where stage and controls go
   * @param {{free?: () => boolean, name?: string}} options free: whether the page does not scroll; name: of saved pictures
   */
  constructor(host, {free = () => false, name = "view"} = {}) {
    this.host = host;
    this.name = name;
    this.canvas = element("canvas", {tabIndex: 0});
    this.canvas.setAttribute("role", "img");
    this.overlay = element("canvas", {className: "overlay"});
    this.readout = element("div", {className: "readout", hidden: true});
    this.stage = element("div", {className: "stage"}, this.canvas, this.overlay, this.readout);
    this.row = element("div", {className: "controls"});
    this.orbit = new Orbit("z");
    this.scene = new Scene(this.canvas, this.orbit);
    host.prepend(this.stage, this.row);
    this.state = {...FIRST};
    this.measure = {kind: "none", places: [], text: ""};
    this.theme = window.matchMedia("(prefers-color-scheme: dark)");
    this.changed = oncePerFrame(() => this.draw());
    this.hover = oncePerFrame(() => this.probe());
    this.controls = addControls(this);
    listen(this.canvas, this.orbit, {
      free,
      changed: () => this.moved(),
      clicked: (x, y) => this.clicked(x, y),
      hovered: (x, y) => ((this.cursor = [x, y]), this.hover()),
      left: () => ((this.cursor = null), this.probe()),
      pressed: (key) => press(this, key),
    });
    this.theme.addEventListener("change", () => this.picture && this.recolor());
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    window.addEventListener("beforeprint", () => this.draw());
  }

  // Large meshes are coarse while they move.
  moved() {
    this.tell(null); // what was under the cursor
    if (this.scene.showCoarse(true)) {
      clearTimeout(this.rest);
      this.rest = setTimeout(() => {
        this.scene.showCoarse(false);
        this.changed();
      }, REST);
    }
    this.changed();
  }

  get colors() {
    return THEMES[this.theme.matches ? "dark" : "light"];
  }

  /**
   * @param {object} picture see decode.js and look.js
   * @param {{keep?: boolean}} how keep: camera and settings, where they still apply
   */
  show(picture, {keep = false} = {}) {
    const before = this.picture;
    this.picture = picture;
    this.frame = frame(picture.low, picture.high);
    const {halfSides} = this.frame;
    this.scene.setMesh(picture.mesh);
    this.scene.setTwoSided(Boolean(picture.axisRanges)); // a landscape has no inside, and is seen from above
    this.orbit.above = picture.axisRanges ? 32 : 15;
    this.scene.setPoints(picture.points);
    this.scene.setLines(picture.lines || null);
    if (!picture.colors) picture.colors = DEFAULT_COLORS;
    this.guess = picture.up || guessUp((picture.points || picture.mesh || {}).positions, halfSides);
    this.controls.color.fill(this.colorNames());
    this.canvas.setAttribute("aria-label", this.description());
    this.offerControls();
    this.clearMeasure();
    if (keep && before) {
      // The same quantity, where there is one; the usual colours where a surface is new.
      const {color} = this.state;
      const named = before.scales[color] ? picture.scales.findIndex((scale) => scale.name === before.scales[color].name) : -1;
      this.set({color: named >= 0 ? String(named) : before.scales.length > 0 && Boolean(before.mesh) === Boolean(picture.mesh) && color === PLAIN ? PLAIN : this.usualColor(), range: null});
    } else {
      this.reset();
    }
    this.resize();
  }

  // What there is nothing of has no controls.
  offerControls() {
    const {mesh, points, lines, scales} = this.picture;
    const offered = [
      [points && mesh, "points"], [lines, "lines"], [mesh || points, "cut"], [scales.length > 0, "map", "low", "high", "isolines"],
      [points, "pointSize", "pointOpacity"], [mesh, "surface", "opacity", "edges"],
    ];
    for (const [thing, ...names] of offered) for (const name of names) this.controls[name].node.hidden = !thing;
  }

  description() {
    const {mesh, points} = this.picture;
    const what = mesh ? `A surface of ${counted(mesh.triangles.length / 3, "triangle")}` : counted((points ? points.positions.length : 0) / 3, "point");
    return `${what}. Arrow keys turn it, with Shift they move it; plus and minus zoom, 0 resets the view.`;
  }

  colorNames() {
    const own = [this.picture.mesh, this.picture.points].some((thing) => thing && thing.tint);
    return [[PLAIN, "plain colour"], ...(own ? [["own", "as in the file"]] : []), ...this.picture.scales.map((scale, i) => [String(i), scale.name])];
  }

  usualColor() {
    const {shown, scales} = this.picture;
    if (scales[shown]) return String(shown);
    return this.colorNames().some(([value]) => value === "own") ? "own" : PLAIN;
  }

  scaleNamed(value) {
    return this.picture.scales[value] || null;
  }

  reset() {
    this.restoring = true;
    this.state = {...FIRST};
    this.turnUp(this.guess);
    this.restoring = false;
    const asked = new URLSearchParams(window.location.hash.slice(1));
    const up = asked.get("up");
    if (up in AXES) this.turnUp(up);
    this.set({color: this.usualColor(), exaggeration: this.picture.exaggeration || 1});
    if (asked.has("view") && !this.restored) {
      this.restored = true;
      this.restore(asked);
    }
  }

  turnUp(axis) {
    this.orbit.reset(axis);
    this.fit();
    this.controls.up.set(axis);
    if (this.picture) this.scene.setExaggeration("xyz".indexOf(axis), this.state.exaggeration);
    this.changed();
  }

  fit() {
    const thing = this.picture && (this.picture.mesh || this.picture.points);
    if (!thing) return;
    if (!this.state.box) return this.orbit.fit(thing.positions);
    const corners = [];
    const {halfSides} = this.frame;
    const heights = "xyz".indexOf(this.orbit.up);
    for (let i = 0; i < 8; ++i)
      for (let a = 0; a < 3; ++a)
        corners.push(((i >> a) & 1 ? 1 : -1) * halfSides[a] * ROOM_FOR_SCALES * (a === heights ? this.state.exaggeration : 1));
    return this.orbit.fit(corners);
  }

  lookFrom(axis) {
    this.orbit.lookFrom(axis);
    this.changed();
  }

  // The side facing the viewer is removed, to show the inside. The plane stays when the surface is rotated.
  startCut(axis) {
    const toViewer = AXES.z.clone().applyQuaternion(this.orbit.rotation);
    if (axis === "view") this.cutNormal = toViewer.toArray();
    else if (axis in AXES) this.cutNormal = AXES[axis].clone().multiplyScalar(AXES[axis].dot(toViewer) < 0 ? -1 : 1).toArray();
    this.set({cut: axis});
  }

  set(change) {
    const before = this.state;
    this.state = {...this.state, ...change};
    const {points, cut, depth, surface, edges, opacity, pointSize, pointOpacity, box, orthographic, lines} = this.state;
    const c = this.controls;
    for (const name of SHOWN_AS_THEY_ARE) c[name].set(this.state[name]);
    c.depth.set(100 * depth);
    c.depth.node.hidden = cut === "none";
    c.opacity.set(Math.round(100 * opacity));
    c.pointOpacity.set(Math.round(100 * pointOpacity));
    if (before.measure !== this.state.measure) this.clearMeasure();
    if (before.exaggeration !== this.state.exaggeration && this.picture) this.fit();
    this.orbit.orthographic = orthographic;
    if (this.restoring || !this.picture) return;
    this.scene.setPointStyle(points || !this.picture.mesh, pointSize, pointOpacity);
    this.scene.setOpacity(opacity);
    this.scene.setSurfaceShown(surface);
    if (this.scene.extra) this.scene.extra.visible = lines;
    if (before.edges !== edges || this.edgesOf !== this.picture) this.scene.setEdges(edges);
    this.edgesOf = this.picture;
    this.scene.setBox(this.frame.halfSides, box);
    this.scene.setExaggeration("xyz".indexOf(this.orbit.up), this.state.exaggeration);
    this.scene.setCut(cut === "none" ? null : this.plane(depth), cut === "none" ? null : this.fill());
    if (this.scene.cap) this.scene.cap.visible = surface && opacity === 1;
    this.recolor();
    this.hover();
  }

  // depth 0 keeps nothing of the box, 1 all of it.
  plane(depth) {
    const reach = this.cutNormal.reduce((sum, value, a) => sum + Math.abs(value) * this.frame.halfSides[a], 0);
    return {normal: this.cutNormal, offset: reach * (2 * depth - 1) * BEYOND_BOX};
  }

  /** Colours of the function on the cut, where the picture holds its values. */
  fill() {
    const {inside} = this.picture;
    if (!inside) return null;
    const {lo, hi} = inside;
    return {values: (...place) => (valueAt(inside, this.frame.halfSides, ...place) - lo) / (hi - lo), stops: this.stopsOfCap()};
  }

  stopsOfCap() {
    const {inside, colors} = this.picture;
    return inside.lo < 0 ? colors.diverging : colors.sequential;
  }

  stopsOf(scale) {
    if (this.state.map !== "own") return MAPS[this.state.map];
    return this.picture.colors[scale.map] || DEFAULT_COLORS[scale.map];
  }

  recolor() {
    const {plain, missing, point, inside, line, box} = this.colors;
    const {mesh, points, inside: within} = this.picture;
    const scale = this.scaleNamed(this.state.color);
    const [lo, hi] = this.state.range || (scale ? [scale.lo, scale.hi] : [0, 1]);
    this.controls.low.set(scale ? Number(lo.toPrecision(6)) : "");
    this.controls.high.set(scale ? Number(hi.toPrecision(6)) : "");
    const stops = scale ? this.stopsOf(scale) : null;
    const look = (thing, values) => ({
      stops,
      missing,
      own: this.state.color === "own" && Boolean(thing && thing.tint),
      values: scale && values(scale) ? placesOnScale(values(scale), lo, hi) : null,
    });
    this.scene.setSurfaceColors({...look(mesh, ({values}) => values), plain, levels: this.state.isolines});
    this.scene.setPointColors({...look(points, ({pointValues}) => pointValues), plain: point, levels: 0});
    this.scene.setTheme({inside, line, box});
    this.legends = scale ? [{title: scale.title, stops, lo, hi}] : [];
    if (this.state.cut !== "none" && within && mesh && this.scene.cap && this.scene.cap.visible)
      this.legends.push({title: `On the cut: ${within.title}`, lo: within.lo, hi: within.hi, stops: this.stopsOfCap()});
    this.changed();
  }

  resize() {
    this.scene.resize();
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.overlay.width = this.canvas.clientWidth * ratio;
    this.overlay.height = this.canvas.clientHeight * ratio;
    this.orbit.leaveRoom(this.state.box ? ROOM_FOR_NAMES / (this.canvas.clientWidth || 1) : 0);
    this.changed();
  }

  /** How far axis a of the data points to the right, upwards and towards the viewer. */
  directionOnScreen(a) {
    return AXES["xyz"[a]].clone().applyQuaternion(this.orbit.rotation.clone().conjugate()).toArray();
  }

  draw() {
    if (!this.picture || !this.scene.size) return;
    this.scene.draw();
    const context = this.overlay.getContext("2d");
    const ratio = this.overlay.width / (this.canvas.clientWidth || 1);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    drawOverlay(context, this, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /** Coordinates of the data at a place of the scene. */
  toData(place) {
    return place.map((value, a) => axisMap(this.picture, this.frame, a).toData(value));
  }

  probe() {
    if (!this.cursor || !this.picture) return this.tell(null);
    const {mesh} = this.picture;
    const busy = mesh && mesh.triangles.length / 3 > MOST_HOVERED;
    return this.tell(busy ? null : pick(this, ...this.cursor));
  }

  /** Tells the place and the value of what was picked; null: nothing. */
  tell(found) {
    this.readout.hidden = !found;
    if (found) this.readout.textContent = describe(this, found);
  }

  clicked(x, y) {
    const {ends} = gizmoEnds(this, this.canvas.clientWidth, this.canvas.clientHeight);
    const end = [...ends].reverse().find((e) => Math.hypot(e.x - x, e.y - y) < GIZMO_REACH);
    if (end) return this.lookFrom(end.name);
    const found = pick(this, x, y);
    if (this.state.measure === "none") return this.tell(found);
    if (!found) return undefined;
    const needed = this.state.measure === "angle" ? 3 : 2;
    if (this.measure.places.length >= needed) this.clearMeasure();
    this.measure.places.push(found.place);
    if (this.measure.places.length === needed) this.measure.text = measured(this, this.measure.places);
    this.changed();
    return undefined;
  }

  clearMeasure() {
    this.measure = {kind: this.state.measure, places: [], text: ""};
    this.changed();
  }

  /** Area of what the cut goes through, in the unit of the data squared; NaN without a cut. */
  cutArea() {
    if (this.state.cut === "none" || !this.picture.mesh) return NaN;
    const {normal, offset} = this.plane(this.state.depth);
    const ends = section(this.picture.mesh.positions, this.picture.mesh.triangles, normal, offset);
    return areaOf(ends, normal) / this.frame.scale ** 2;
  }

  fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else if (this.host.requestFullscreen) this.host.requestFullscreen();
  }

  /** The picture with everything on it, any number of pixels wide. */
  async takePicture(width, clear = false) {
    const [shownWidth, shownHeight] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const ratio = width / shownWidth;
    this.scene.showCoarse(false);
    this.scene.resize(shownWidth, shownHeight, ratio);
    this.scene.draw();
    const result = element("canvas", {width: Math.round(width), height: Math.round(shownHeight * ratio)});
    const context = result.getContext("2d");
    if (!clear) {
      context.fillStyle = getComputedStyle(this.stage).backgroundColor;
      context.fillRect(0, 0, result.width, result.height);
    }
    context.drawImage(this.canvas, 0, 0, result.width, result.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawOverlay(context, this, shownWidth, shownHeight);
    this.resize();
    this.draw();
    return new Promise((done) => result.toBlob(done, "image/png"));
  }

  async savePicture(width, clear = false) {
    save(await this.takePicture(Math.min(Math.max(width || 1600, 64), 8192), clear), `${this.name}.png`);
  }

  /** An address that opens the page with this view. */
  link() {
    return linkTo(this);
  }

  /** Shows what the words of an address say. */
  restore(words) {
    const {orbit, cutNormal, change} = readLink(words, this.colorNames().map(([name]) => name));
    this.orbit.state = orbit;
    if (cutNormal) this.cutNormal = cutNormal;
    this.set(change);
  }
}
