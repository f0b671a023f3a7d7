// The controls of slices.

import {button, choice, element, panel, save, slider, toggle} from "../dom.js";
import {player} from "../film.js";
import {readable} from "../ticks.js";
import {HOLE} from "./seeds.js";

const MAPS = ["grey", "viridis", "cividis", "batlow"];
/** What the mouse does: brushes of seeds, and of holes. */
export const HOLE_BRUSHES = [["0", "move"], [String(HOLE), "paint holes"], ["-1", "erase"]];
export const BRUSHES = [["0", "move"], ["1", "outside (0)"], ["2", "inside (1)"], ["3", "label 2"], ["4", "label 3"], ["-1", "erase"]];

/** Controls by the part of the state that they show, put into the row of the slices. @param {import("./slices.js").Slices} slices */
export function addControls(slices) {
  const whole = {lo: 0, hi: 0, step: 1, value: 0, shown: String};
  const percent = (change) => (n) => slices.set(change(n / 100));
  const valueAt = (n) => (slices.look ? readable(slices.valueAt(n / 100), 3) : "");
  const c = {
    axis: choice("Across", "axis", ["x", "y", "z"].map((a, i) => [String(i), a]), "2", (axis) => slices.turn(Number(axis))),
    index: slider("Slice", "slice", whole, (index) => slices.go(index)),
    frame: slider("Frame", "frame", whole, (frame) => slices.goToFrame(frame)),
    labels: slider("Labels", "labels", {lo: 0, hi: 100, step: 1, value: 40, shown: (n) => `${n} %`}, percent((labels) => ({labels}))),
    contour: toggle("Contour", "contour", (contour) => slices.set({contour}), true),
    low: slider("Black", "black", {lo: 0, hi: 100, step: 0.5, value: 0, shown: valueAt}, percent((low) => ({low}))),
    high: slider("White", "white", {lo: 0, hi: 100, step: 0.5, value: 100, shown: valueAt}, percent((high) => ({high}))),
    map: choice("Colours", "slice-map", MAPS.map((map) => [map, map]), "grey", (map) => slices.set({map})),
    brush: choice("Mouse", "brush", BRUSHES, "0", (brush) => slices.set({brush: Number(brush)})),
    size: slider("Brush", "brush-size", {lo: 1, hi: 40, step: 1, value: 5, shown: (n) => `${n} px`}, (size) => slices.set({size})),
    clear: button("Clear", "clear-seeds", () => slices.clearSeeds()),
    reset: button("Reset", "reset-slice", () => slices.reset()),
    picture: button("Save PNG", "slice-picture", () => slices.canvas.toBlob((blob) => save(blob, `${slices.name || "slice"}.png`))),
  };
  const play = player(() => slices.goToFrame((slices.state.frame + 1) % slices.frames));
  c.play = button("Play", "play", () => {
    slices.playing = play();
    c.play.button.textContent = slices.playing ? "Pause" : "Play";
  });
  c.painting = {node: element("div", {className: "group"}, c.brush.node, c.size.node, c.clear.node)};
  slices.row.append(c.play.node, c.frame.node, c.axis.node, c.index.node, c.labels.node, c.contour.node,
    panel("Window", "window", c.low.node, c.high.node, c.map.node).node, c.painting.node, c.reset.node, c.picture.node);
  return c;
}
