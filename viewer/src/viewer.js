// A picture in space to turn, cut, colour and measure: canvas, what is written on it, and its controls. Reports and the
// studio show the same.

import {button, choice, copy, element, oncePerFrame, panel, save, slider, toggle} from "./dom.js";
import {MAPS, placesOnScale} from "./colors.js";
import {DEFAULT_COLORS, guessUp} from "./look.js";
import {axisMap, drawOverlay, gizmoEnds} from "./overlay.js";
import {frame} from "./decode.js";
import {listen} from "./gestures.js";
import {Orbit} from "./orbit.js";
import {blend, pickPoint, pickTriangle} from "./pick.js";
import {readable} from "./ticks.js";
import {LEVELS_ON_CAP, Scene} from "./scene.js";
import {areaOf, section, valueAt} from "./section.js";
import {Vector3} from "three";

const AXES = {x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1)};
const PLAIN = "plain";
const BEYOND_BOX = 1.001; // scales the depth of the cut, so that rounding spares nothing at its ends
const ROOM_FOR_SCALES = 1.06; // of the box: numbers and names stand beside it
const ROOM_FOR_NAMES = 75; // pixels on either side, for the same
const MOST_HOVERED = 400000; // triangles that are searched whenever the cursor moves
const REST = 200; // milliseconds without movement, after which a large mesh is drawn in full
const GIZMO_REACH = 10; // pixels around the end of an axis
const KEYS = [
  ["drag, arrows", "turn"],
  ["Shift + drag, right button, Shift + arrows", "move"],
  ["scroll, pinch, + and −", "zoom"],
  ["0", "first view"],
  ["x, y, z (Shift: from the other side)", "look along an axis"],
  ["p, e, b, a", "points, edges, box, isolines"],
  ["o", "perspective or orthographic"],
  ["c", "cut, facing you"],
  ["m, n", "measure a distance, an angle"],
  ["Escape", "end measuring"],
  ["f", "full screen"],
  ["s", "save a picture"],
];

/** Light and dark colours of the picture. */
const THEMES = {
  light: {
    missing: [0.76, 0.77, 0.79], plain: [0.86, 0.82, 0.76], point: [0.1, 0.32, 0.6], inside: [0.42, 0.55, 0.66],
    line: [0.13, 0.16, 0.2], box: [0.55, 0.59, 0.65],
    palette: {dark: false, axis: "#8b95a3", text: "#4a5463", strong: "#1b2330", halo: "rgba(247,248,250,.85)", ground: "#ffffff", measure: "#b4420a"},
  },
  dark: {
    missing: [0.36, 0.38, 0.42], plain: [0.78, 0.74, 0.69], point: [0.45, 0.72, 0.95], inside: [0.3, 0.42, 0.52],
    line: [0.05, 0.06, 0.08], box: [0.42, 0.46, 0.52],
    palette: {dark: true, axis: "#667081", text: "#aab4c2", strong: "#e4e8ee", halo: "rgba(27,32,40,.85)", ground: "#14181e", measure: "#f0924c"},
  },
};

const FIRST = {
  color: PLAIN, map: "own", points: false, surface: true, edges: "none", opacity: 1, isolines: 0, pointSize: 1,
  pointOpacity: 1, cut: "none", depth: 0.5, box: true, exaggeration: 1, orthographic: false, measure: "none", lines: true,
};

export class View {
  /**
   * @param {HTMLElement} host where stage and controls go
   * @param {{free?: boolean, name?: string}} options free: the page does not scroll; name: of saved pictures
   */
  constructor(host, {free = false, name = "view"} = {}) {
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
    this.addControls();
    listen(this.canvas, this.orbit, {
      free,
      changed: () => this.moved(),
      clicked: (x, y) => this.clicked(x, y),
      hovered: (x, y) => ((this.cursor = [x, y]), this.hover()),
      left: () => ((this.cursor = null), (this.readout.hidden = true)),
      pressed: (key) => this.pressed(key),
    });
    this.theme.addEventListener("change", () => this.picture && this.recolor());
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    window.addEventListener("beforeprint", () => this.draw());
  }

  // Large meshes are coarse while they move.
  moved() {
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
    for (const [name, thing] of [["points", picture.points && picture.mesh], ["lines", picture.lines], ["cut", picture.mesh || picture.points]])
      this.controls[name].node.hidden = !thing;
    // What there is nothing of has no controls.
    for (const [names, thing] of [[["map", "low", "high", "isolines"], picture.scales.length > 0], [["pointSize", "pointOpacity"], picture.points], [["surface", "opacity", "edges"], picture.mesh]])
      for (const name of names) this.controls[name].node.hidden = !thing;
    this.clearMeasure();
    if (keep && before) {
      // The same quantity, where there is one; the usual colours where a surface is new.
      const {color} = this.state;
      const named = before.scales[color] ? picture.scales.findIndex((scale) => scale.name === before.scales[color].name) : -1;
      this.set({color: named >= 0 ? String(named) : Boolean(before.mesh) === Boolean(picture.mesh) && color === PLAIN ? PLAIN : this.usualColor(), range: null});
    } else {
      this.reset();
    }
    this.resize();
  }

  description() {
    const {mesh, points} = this.picture;
    const what = mesh ? `A surface of ${(mesh.triangles.length / 3).toLocaleString("en")} triangles` : `${((points ? points.positions.length : 0) / 3).toLocaleString("en")} points`;
    return `${what}. Arrow keys turn it, with Shift they move it; plus and minus zoom, 0 resets the view.`;
  }

  colorNames() {
    const own = (this.picture.mesh && this.picture.mesh.tint) || (this.picture.points && this.picture.points.tint);
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

  addControls() {
    const cuts = [["none", "no cut"], ["x", "across x"], ["y", "across y"], ["z", "across z"], ["view", "facing you"]];
    const percent = (value) => `${Math.round(value)} %`;
    const c = {
      color: choice("Colour", "color", [[PLAIN, "plain colour"]], PLAIN, (color) => this.set({color, range: null})),
      points: toggle("Points", "points", (points) => this.set({points})),
      lines: toggle("Lines", "lines", (lines) => this.set({lines}), true),
      cut: choice("Cut", "cut", cuts, "none", (axis) => this.startCut(axis)),
      depth: slider("Where", "depth", {value: 50}, (depth) => this.set({depth: depth / 100})),
      map: choice("Colours", "map", [["own", "default"], ...Object.keys(MAPS).map((map) => [map, map])], "own", (map) => this.set({map})),
      low: this.rangeField("from", "low"),
      high: this.rangeField("to", "high"),
      isolines: slider("Isolines", "isolines", {lo: 0, hi: 40, step: 1, value: 0, shown: (n) => (n ? String(n) : "none")}, (isolines) => this.set({isolines})),
      surface: toggle("Surface", "surface", (surface) => this.set({surface}), true),
      opacity: slider("Opacity", "opacity", {lo: 5, hi: 100, step: 1, value: 100, shown: percent}, (opacity) => this.set({opacity: opacity / 100})),
      edges: choice("Edges", "edges", [["none", "none"], ["creases", "creases"], ["all", "triangles"]], "none", (edges) => this.set({edges})),
      pointSize: slider("Point size", "point-size", {lo: 0.2, hi: 4, step: 0.1, value: 1, shown: (n) => `${n} ×`}, (pointSize) => this.set({pointSize})),
      pointOpacity: slider("Point opacity", "point-opacity", {lo: 5, hi: 100, step: 1, value: 100, shown: percent}, (opacity) => this.set({pointOpacity: opacity / 100})),
      box: toggle("Box with scales", "box", (box) => this.set({box}), true),
      exaggeration: slider("Heights", "exaggeration", {lo: 0.2, hi: 10, step: 0.1, value: 1, shown: (n) => `${n} ×`}, (exaggeration) => this.set({exaggeration})),
      up: choice("Up", "up", Object.keys(AXES).map((axis) => [axis, axis]), "z", (axis) => this.turnUp(axis)),
      orthographic: toggle("Orthographic", "orthographic", (orthographic) => this.set({orthographic})),
      reset: button("Reset", "reset", () => this.reset()),
      measure: choice("Measure", "measure", [["none", "no ruler"], ["distance", "a distance"], ["angle", "an angle"]], "none", (measure) => this.set({measure})),
      link: button("Copy link", "link", (event) => copy(this.link(), event.target)),
      full: button("Full screen", "full", () => this.fullScreen()),
    };
    this.controls = c;
    const from = element("div", {className: "buttons"}, ...["x", "-x", "y", "-y", "z", "-z"].map((axis) =>
      button(axis.replace("-", "−"), `from-${axis}`, () => this.lookFrom(axis)).button));
    const keys = element("dl", {className: "keys"}, ...KEYS.flatMap(([key, what]) => [element("dt", {}, key), element("dd", {}, what)]));
    this.row.append(
      c.color.node, c.points.node, c.lines.node, c.cut.node, c.depth.node,
      c.measure.node,
      panel("Show", "show", c.map.node, element("div", {className: "pair"}, c.low.node, c.high.node), c.isolines.node,
        c.surface.node, c.opacity.node, c.edges.node, c.pointSize.node, c.pointOpacity.node, c.box.node).node,
      panel("View", "view", c.up.node, c.orthographic.node, c.exaggeration.node, element("div", {className: "control"}, element("label", {}, "From"), from),
        c.full.node).node,
      panel("Save", "picture", ...this.pictureControls(), c.link.node).node,
      c.reset.node,
      panel("?", "keys", keys).node,
    );
  }

  rangeField(text, which) {
    const input = element("input", {type: "number", name: `range-${which}`, step: "any"});
    input.addEventListener("change", () => {
      const scale = this.scaleNamed(this.state.color);
      if (!scale) return;
      const range = this.state.range || [scale.lo, scale.hi];
      const value = input.value === "" ? (which === "low" ? scale.lo : scale.hi) : Number(input.value);
      this.set({range: which === "low" ? [value, range[1]] : [range[0], value]});
    });
    return {node: element("label", {className: "control"}, text + " ", input), set: (value) => (input.value = value)};
  }

  pictureControls() {
    const width = element("input", {type: "number", name: "picture-width", min: 64, max: 8192, value: 1600});
    const clear = element("input", {type: "checkbox", name: "picture-clear"});
    const take = button("Save PNG", "picture-save", () => this.savePicture(Number(width.value), clear.checked));
    return [
      element("label", {className: "control"}, "Width ", width, " pixels"),
      element("label", {className: "control"}, clear, " without background"),
      take.node,
    ];
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
    const {color, points, cut, depth, surface, edges, opacity, pointSize, pointOpacity, box, orthographic, lines} = this.state;
    const c = this.controls;
    for (const name of ["color", "points", "lines", "cut", "map", "isolines", "surface", "edges", "pointSize", "box", "orthographic", "measure", "exaggeration"])
      c[name].set(this.state[name]);
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
    this.recolor(color);
  }

  // depth 0 keeps nothing of the box, 1 all of it.
  plane(depth) {
    const reach = this.cutNormal.reduce((sum, value, a) => sum + Math.abs(value) * this.frame.halfSides[a], 0);
    return {normal: this.cutNormal, offset: reach * (2 * depth - 1) * BEYOND_BOX};
  }

  /** Colours of the function on the cut, where the picture holds its values. */
  fill() {
    const {inside, colors} = this.picture;
    if (!inside) return null;
    const {halfSides} = this.frame;
    return {
      values: (x, y, z) => (valueAt(inside, halfSides, x, y, z) - inside.lo) / (inside.hi - inside.lo),
      stops: inside.lo < 0 ? colors.diverging : colors.sequential,
    };
  }

  stopsOf(scale) {
    if (this.state.map !== "own") return MAPS[this.state.map];
    return this.picture.colors[scale.map] || DEFAULT_COLORS[scale.map];
  }

  recolor() {
    const {plain, missing, point, inside, line, box} = this.colors;
    const scale = this.scaleNamed(this.state.color);
    const own = this.state.color === "own";
    const [lo, hi] = this.state.range || (scale ? [scale.lo, scale.hi] : [0, 1]);
    this.controls.low.set(scale ? Number(lo.toPrecision(6)) : "");
    this.controls.high.set(scale ? Number(hi.toPrecision(6)) : "");
    const stops = scale ? this.stopsOf(scale) : null;
    const look = {stops, missing, own, levels: this.state.isolines};
    const places = (values) => (values ? placesOnScale(values, lo, hi) : null);
    this.scene.setSurfaceColors({...look, plain, own: own && Boolean(this.picture.mesh && this.picture.mesh.tint), values: scale && places(scale.values)});
    this.scene.setPointColors({...look, levels: 0, plain: point, own: own && Boolean(this.picture.points && this.picture.points.tint), values: scale && places(scale.pointValues)});
    this.scene.setTheme({inside, line, box});
    const {inside: within, mesh, colors} = this.picture;
    this.legends = scale ? [{title: scale.title, stops, lo, hi}] : [];
    if (this.state.cut !== "none" && within && mesh && this.scene.cap && this.scene.cap.visible)
      this.legends.push({title: `On the cut: ${within.title}`, lo: within.lo, hi: within.hi, stops: within.lo < 0 ? colors.diverging : colors.sequential});
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

  drawOverlay(context, width, height) {
    const {exaggeration} = this.state;
    const middle = this.scene.project(this.orbit.target.toArray());
    const right = new Vector3(1, 0, 0).applyQuaternion(this.orbit.rotation).add(this.orbit.target).toArray();
    const beside = this.scene.project(right.map((value, a) => value / this.scene.root.scale["xyz"[a]]));
    const target = this.orbit.target.toArray().map((value, a) => value / this.scene.root.scale["xyz"[a]]);
    const center = this.scene.project(target);
    drawOverlay(context, {
      view: this,
      picture: this.picture,
      frame: this.frame,
      width,
      height,
      project: (place) => this.scene.project(place),
      palette: this.colors.palette,
      up: this.orbit.up,
      axesShown: this.state.box,
      legends: this.legends,
      measure: this.measure,
      orthographic: this.orbit.orthographic,
      pixelsPerUnit: middle.visible ? Math.hypot(beside.x - center.x, beside.y - center.y) : 0,
      note: exaggeration === 1 ? "" : `heights × ${exaggeration}`,
    });
  }

  draw() {
    if (!this.picture || !this.scene.size) return;
    this.scene.draw();
    const context = this.overlay.getContext("2d");
    const ratio = this.overlay.width / (this.canvas.clientWidth || 1);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.overlay.width, this.overlay.height);
    this.drawOverlay(context, this.canvas.clientWidth, this.canvas.clientHeight);
  }

  /** What is under a pixel: a place of the surface or a point; null for nothing. */
  pick(x, y) {
    const {mesh, points} = this.picture;
    const {origin, direction} = this.scene.ray(x, y);
    const plane = this.state.cut === "none" ? null : this.plane(this.state.depth);
    const visible = (p) => !plane || p[0] * plane.normal[0] + p[1] * plane.normal[1] + p[2] * plane.normal[2] <= plane.offset;
    const surface = mesh && this.state.surface ? pickTriangle(mesh.positions, mesh.triangles, origin, direction, visible) : null;
    const capped = plane && this.scene.cap && this.scene.cap.visible ? this.pickCap(plane, origin, direction, surface) : null;
    if (capped) return capped;
    const shown = points && (this.state.points || !mesh);
    if (!shown || surface) return surface && {...surface, kind: "surface"};
    const pixel = this.orbit.orthographic ? (2 * this.orbit.halfHeight) / this.canvas.clientHeight : (2 * this.orbit.slope) / this.canvas.clientHeight;
    const reach = 6 * pixel;
    const point = pickPoint(points.positions, origin, direction, this.orbit.orthographic ? () => reach : reach, visible);
    return point && {...point, kind: "point"};
  }

  // The plane of the cut, where it is inside of the surface: a ray from there against the normal leaves it through a back.
  pickCap(plane, origin, direction, surface) {
    const facing = direction.reduce((sum, value, a) => sum + value * plane.normal[a], 0);
    if (facing >= 0) return null;
    const distance = (plane.offset - origin.reduce((sum, value, a) => sum + value * plane.normal[a], 0)) / facing;
    if (distance <= 0 || (surface && surface.distance < distance)) return null;
    const place = origin.map((value, a) => value + distance * direction[a]);
    const {mesh, inside} = this.picture;
    const beyond = pickTriangle(mesh.positions, mesh.triangles, place, direction);
    if (!beyond) return null;
    const normal = blend(beyond, mesh.normals, 3);
    if (normal.reduce((sum, value, a) => sum + value * direction[a], 0) < 0) return null;
    return {kind: "cap", place, value: inside ? valueAt(inside, this.frame.halfSides, ...place) : NaN};
  }

  toData(place) {
    return place.map((value, a) => axisMap(this.picture, this.frame, a).toData(value));
  }

  probe() {
    if (!this.cursor || !this.picture) return;
    const {mesh} = this.picture;
    const busy = mesh && mesh.triangles.length / 3 > MOST_HOVERED;
    const found = busy ? null : this.pick(...this.cursor);
    this.readout.hidden = !found;
    if (found) this.readout.textContent = this.describe(found);
  }

  /** Position, normal and value of what was picked. */
  describe(found) {
    const data = this.toData(found.place);
    const {axes, unit, mesh, inside} = this.picture;
    const parts = data.map((value, a) => `${axes[a]} ${readable(value, 5)}`);
    if (unit && !this.picture.axisRanges) parts[2] += ` ${unit}`;
    const scale = this.scaleNamed(this.state.color);
    if (found.kind === "surface") {
      const normal = blend(found, mesh.normals, 3);
      const length = Math.hypot(...normal) || 1;
      if (!this.picture.axisRanges) parts.push(`normal ${normal.map((value) => readable(value / length, 2)).join(", ")}`);
      const value = scale && scale.values ? blend(found, scale.values)[0] : NaN;
      if (Number.isFinite(value)) parts.push(`${scale.name} ${readable(value)}`);
    } else if (found.kind === "cap") {
      if (Number.isFinite(found.value)) parts.push(`${inside.title} ${readable(found.value)}`);
    } else {
      const value = scale && scale.pointValues ? scale.pointValues[found.index] : NaN;
      if (Number.isFinite(value)) parts.push(`${scale.name} ${readable(value)}`);
    }
    return parts.join("  ·  ");
  }

  clicked(x, y) {
    const {ends} = gizmoEnds(this, this.canvas.clientWidth, this.canvas.clientHeight);
    const end = [...ends].reverse().find((e) => Math.hypot(e.x - x, e.y - y) < GIZMO_REACH);
    if (end) return this.lookFrom(end.name);
    const found = this.pick(x, y);
    if (this.state.measure === "none") {
      this.readout.hidden = !found;
      if (found) this.readout.textContent = this.describe(found);
      return undefined;
    }
    if (!found) return undefined;
    const needed = this.state.measure === "angle" ? 3 : 2;
    if (this.measure.places.length >= needed) this.clearMeasure();
    this.measure.places.push(found.place);
    if (this.measure.places.length === needed) this.measure.text = this.measured();
    this.changed();
    return undefined;
  }

  measured() {
    const data = this.measure.places.map((place) => this.toData(place));
    const difference = (p, q) => p.map((value, a) => value - q[a]);
    if (this.state.measure === "distance") {
      const length = Math.hypot(...difference(data[0], data[1]));
      return readable(length, 4) + (this.picture.unit ? ` ${this.picture.unit}` : "");
    }
    const [u, v] = [difference(data[0], data[1]), difference(data[2], data[1])];
    const dot = u.reduce((sum, value, a) => sum + value * v[a], 0) / (Math.hypot(...u) * Math.hypot(...v));
    return `${((Math.acos(Math.min(1, Math.max(-1, dot))) * 180) / Math.PI).toFixed(1)}°`;
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

  pressed(key) {
    const flip = (name) => this.set({[name]: !this.state[name]});
    const actions = {
      p: () => flip("points"),
      e: () => this.set({edges: {none: "creases", creases: "all", all: "none"}[this.state.edges]}),
      b: () => flip("box"),
      a: () => this.set({isolines: this.state.isolines ? 0 : LEVELS_ON_CAP}),
      o: () => flip("orthographic"),
      c: () => this.startCut(this.state.cut === "none" ? "view" : "none"),
      m: () => this.set({measure: this.state.measure === "distance" ? "none" : "distance"}),
      n: () => this.set({measure: this.state.measure === "angle" ? "none" : "angle"}),
      f: () => this.fullScreen(),
      s: () => this.savePicture(1600),
      Escape: () => this.set({measure: "none"}),
    };
    for (const axis of "xyz") {
      actions[axis] = () => this.lookFrom(axis);
      actions[axis.toUpperCase()] = () => this.lookFrom("-" + axis);
    }
    if (!(key in actions)) return false;
    actions[key]();
    return true;
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
    this.drawOverlay(context, shownWidth, shownHeight);
    this.resize();
    this.draw();
    return new Promise((done) => result.toBlob(done, "image/png"));
  }

  async savePicture(width, clear = false) {
    save(await this.takePicture(Math.min(Math.max(width || 1600, 64), 8192), clear), `${this.name}.png`);
  }

  /** An address that opens the page with this view. */
  link() {
    const {color, points, cut, depth, edges, orthographic, opacity, exaggeration, isolines} = this.state;
    const words = new URLSearchParams(window.location.hash.slice(1));
    const put = (name, value, usual) => (value === usual ? words.delete(name) : words.set(name, String(value)));
    words.set("up", this.orbit.up);
    words.set("view", this.orbit.state.map((value) => Number(value.toPrecision(5))).join(","));
    words.set("color", color);
    put("points", points, false);
    put("edges", edges, "none");
    put("ortho", orthographic, false);
    put("opacity", opacity, 1);
    put("heights", exaggeration, 1);
    put("isolines", isolines, 0);
    put("cut", cut === "none" ? "" : [...this.cutNormal.map((v) => Number(v.toPrecision(5))), depth].join(","), "");
    return `${window.location.href.split("#")[0]}#${words}`;
  }

  restore(words) {
    this.orbit.state = words.get("view").split(",").map(Number);
    const change = {color: this.colorNames().some(([value]) => value === words.get("color")) ? words.get("color") : PLAIN, points: words.get("points") === "true", orthographic: words.get("ortho") === "true"};
    if (["creases", "all"].includes(words.get("edges"))) change.edges = words.get("edges");
    const number = (name, lo, hi) => (words.has(name) && Number(words.get(name)) >= lo && Number(words.get(name)) <= hi ? Number(words.get(name)) : null);
    for (const [name, key, lo, hi] of [["opacity", "opacity", 0.05, 1], ["heights", "exaggeration", 0.2, 10], ["isolines", "isolines", 0, 40]])
      if (number(name, lo, hi) !== null) change[key] = number(name, lo, hi);
    const cut = (words.get("cut") || "").split(",").map(Number);
    if (cut.length === 4 && cut.every(Number.isFinite)) {
      this.cutNormal = cut.slice(0, 3);
      Object.assign(change, {cut: "view", depth: cut[3]});
    }
    this.set(change);
  }
}
