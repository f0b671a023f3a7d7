// The controls of a picture in space.

import {MAPS} from "../colors.js";
import {button, choice, copy, element, panel, slider, toggle} from "../dom.js";
import {KEYS} from "./keys.js";

export const PLAIN = "plain"; // the colour of what has no values
const CUTS = [["none", "no cut"], ["x", "across x"], ["y", "across y"], ["z", "across z"], ["view", "facing you"]];
const EDGES = [["none", "none"], ["creases", "creases"], ["all", "triangles"]];
const RULERS = [["none", "no ruler"], ["distance", "a distance"], ["angle", "an angle"]];
const SIDES = ["x", "-x", "y", "-y", "z", "-z"];

/** Controls by the part of the view's state that they show, put into its row. */
export function addControls(view) {
  const change = (name) => (value) => view.set({[name]: value});
  const percent = (value) => `${Math.round(value)} %`;
  const share = (text, name, key) =>
    slider(text, name, {lo: 5, hi: 100, step: 1, value: 100, shown: percent}, (value) => view.set({[key]: value / 100}));
  const times = (n) => `${n} ×`;
  const c = {
    color: choice("Colour", "color", [[PLAIN, "plain colour"]], PLAIN, (color) => view.set({color, range: null})),
    points: toggle("Points", "points", change("points")),
    lines: toggle("Lines", "lines", change("lines"), true),
    cut: choice("Cut", "cut", CUTS, "none", (axis) => view.startCut(axis)),
    depth: slider("Where", "depth", {value: 50}, (depth) => view.set({depth: depth / 100})),
    map: choice("Colours", "map", [["own", "default"], ...Object.keys(MAPS).map((map) => [map, map])], "own", change("map")),
    low: rangeField(view, "from", "low"),
    high: rangeField(view, "to", "high"),
    isolines: slider("Isolines", "isolines", {lo: 0, hi: 40, step: 1, value: 0, shown: (n) => (n ? String(n) : "none")}, change("isolines")),
    surface: toggle("Surface", "surface", change("surface"), true),
    opacity: share("Opacity", "opacity", "opacity"),
    edges: choice("Edges", "edges", EDGES, "none", change("edges")),
    pointSize: slider("Point size", "point-size", {lo: 0.2, hi: 4, step: 0.1, value: 1, shown: times}, change("pointSize")),
    pointOpacity: share("Point opacity", "point-opacity", "pointOpacity"),
    box: toggle("Box with scales", "box", change("box"), true),
    exaggeration: slider("Heights", "exaggeration", {lo: 0.2, hi: 10, step: 0.1, value: 1, shown: times}, change("exaggeration")),
    up: choice("Up", "up", ["x", "y", "z"].map((axis) => [axis, axis]), "z", (axis) => view.turnUp(axis)),
    orthographic: toggle("Orthographic", "orthographic", change("orthographic")),
    reset: button("Reset", "reset", () => view.reset()),
    measure: choice("Measure", "measure", RULERS, "none", change("measure")),
    link: button("Copy link", "link", (event) => copy(view.link(), event.target)),
    full: button("Full screen", "full", () => view.fullScreen()),
  };
  const from = SIDES.map((side) => button(side.replace("-", "−"), `from-${side}`, () => view.lookFrom(side)).button);
  const keys = KEYS.flatMap(([key, what]) => [element("dt", {}, key), element("dd", {}, what)]);
  view.row.append(
    c.color.node, c.points.node, c.lines.node, c.cut.node, c.depth.node, c.measure.node,
    panel("Show", "show", c.map.node, element("div", {className: "pair"}, c.low.node, c.high.node), c.isolines.node,
      c.surface.node, c.opacity.node, c.edges.node, c.pointSize.node, c.pointOpacity.node, c.box.node).node,
    panel("View", "view", c.up.node, c.orthographic.node, c.exaggeration.node,
      element("div", {className: "control"}, element("label", {}, "From"), element("div", {className: "buttons"}, ...from)), c.full.node).node,
    panel("Save", "picture", ...pictureControls(view), c.link.node).node,
    c.reset.node,
    panel("?", "keys", element("dl", {className: "keys"}, ...keys)).node,
  );
  return c;
}

// One end of the range of colours; empty: that of the scale.
function rangeField(view, text, which) {
  const input = element("input", {type: "number", name: `range-${which}`, step: "any"});
  input.addEventListener("change", () => {
    const scale = view.scaleNamed(view.state.color);
    if (!scale) return;
    const range = view.state.range || [scale.lo, scale.hi];
    const value = input.value === "" ? (which === "low" ? scale.lo : scale.hi) : Number(input.value);
    view.set({range: which === "low" ? [value, range[1]] : [range[0], value]});
  });
  return {node: element("label", {className: "control"}, text + " ", input), set: (value) => (input.value = value)};
}

function pictureControls(view) {
  const width = element("input", {type: "number", name: "picture-width", min: 64, max: 8192, value: 1600});
  const clear = element("input", {type: "checkbox", name: "picture-clear"});
  return [
    element("label", {className: "control"}, "Width ", width, " pixels"),
    element("label", {className: "control"}, clear, " without background"),
    button("Save PNG", "picture-save", () => view.savePicture(Number(width.value), clear.checked)).node,
  ];
}
