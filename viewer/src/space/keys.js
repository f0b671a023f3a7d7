// What keys do to a picture in space, besides turning and moving it (gestures.js).

import {LEVELS_ON_CAP} from "./cap.js";

/** All keys, for people. */
export const KEYS = [
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

const flip = (name) => (view) => view.set({[name]: !view.state[name]});
const measure = (kind) => (view) => view.set({measure: view.state.measure === kind ? "none" : kind});

const ACTIONS = {
  p: flip("points"),
  e: (view) => view.set({edges: {none: "creases", creases: "all", all: "none"}[view.state.edges]}),
  b: flip("box"),
  a: (view) => view.set({isolines: view.state.isolines ? 0 : LEVELS_ON_CAP}),
  o: flip("orthographic"),
  c: (view) => view.startCut(view.state.cut === "none" ? "view" : "none"),
  m: measure("distance"),
  n: measure("angle"),
  f: (view) => view.fullScreen(),
  s: (view) => view.savePicture(1600),
  Escape: (view) => view.set({measure: "none"}),
  ...Object.fromEntries(["x", "y", "z"].flatMap((axis) => [
    [axis, (view) => view.lookFrom(axis)],
    [axis.toUpperCase(), (view) => view.lookFrom(`-${axis}`)],
  ])),
};

/** Does what a key stands for; false for none. */
export function press(view, key) {
  if (!Object.hasOwn(ACTIONS, key)) return false;
  ACTIONS[key](view);
  return true;
}
