// Moves, zooms, paints and leafs through slices by mouse, touch and keyboard.

import {Pointers} from "../pointers.js";

const AXES = ["x", "y", "z"];
const PIXELS_PER_DAB = 3; // along a stroke of the brush
const ZOOM_PER_PIXEL = 0.002; // logarithm of the factor, of the wheel

/** @param {import("./slices.js").Slices} slices */
export function listen(slices) {
  const {canvas} = slices;
  const pointers = new Pointers();
  let from = null;
  let isStroke = false;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (!slices.image) return;
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event);
    from = place(event);
    if (isStroke) {
      // A second finger: both move the picture, and the first one did not mean to paint.
      isStroke = false;
      slices.seeds.step(-1);
      slices.changed();
    } else if (slices.state.brush !== 0 && pointers.count === 1) {
      isStroke = true;
      slices.seeds.begin();
      slices.paint(...from);
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!slices.image) return;
    const now = (slices.cursor = place(event));
    if (!pointers.has(event)) {
      slices.probe();
      return;
    }
    const {way, factor} = pointers.move(event);
    if (isStroke) {
      const stroke = now.map((value, a) => value - from[a]);
      const steps = Math.ceil(Math.hypot(...stroke) / PIXELS_PER_DAB) || 1;
      for (let i = 1; i <= steps; ++i) slices.paint(...from.map((value, a) => value + (stroke[a] * i) / steps));
    } else {
      slices.set({shift: slices.state.shift.map((value, a) => value + way[a])});
      const [x, y] = pointers.middle();
      if (factor !== 1) slices.zoom(factor, place({clientX: x, clientY: y}));
    }
    from = now;
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      pointers.delete(event);
      if (!isStroke) return;
      isStroke = false;
      slices.painted();
    });
  canvas.addEventListener("pointerleave", () => {
    slices.cursor = null;
    slices.probe();
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!slices.free() && document.activeElement !== canvas && !event.ctrlKey) return undefined;
      event.preventDefault();
      if (!event.ctrlKey && slices.look.kind !== "image") return slices.go(slices.state.index + Math.sign(event.deltaY));
      return slices.zoom(Math.exp(-event.deltaY * ZOOM_PER_PIXEL), place(event));
    },
    {passive: false},
  );
  canvas.addEventListener("keydown", (event) => {
    const steps = {PageUp: 1, PageDown: -1, ArrowUp: 1, ArrowDown: -1};
    const axis = AXES.indexOf(event.key);
    if (event.key in steps) slices.go(slices.state.index + steps[event.key]);
    else if (axis >= 0 && slices.look.kind === "volume") slices.turn(axis);
    else if (event.key === "0") slices.set({zoom: 1, shift: [0, 0]});
    else if (event.key === "+" || event.key === "-") slices.set({zoom: slices.state.zoom * (event.key === "+" ? 1.2 : 1 / 1.2)});
    else return;
    event.preventDefault();
  });
}
