// Moves, zooms, paints and leafs through slices by mouse, touch and keyboard.

const AXES = ["x", "y", "z"];
const PIXELS_PER_DAB = 3; // along a stroke of the brush
const ZOOM_PER_PIXEL = 0.002; // logarithm of the factor, of the wheel
const [LEAST, MOST] = [0.2, 60]; // zoom

/** @param {import("./slices.js").Slices} slices */
export function listen(slices) {
  const {canvas} = slices;
  let from = null;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const paints = () => slices.state.brush !== 0;
  canvas.addEventListener("pointerdown", (event) => {
    if (!slices.image) return;
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    from = place(event);
    if (paints()) slices.paint(...from);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!slices.image) return;
    const now = (slices.cursor = place(event));
    if (!from) return slices.probe();
    const way = now.map((value, a) => value - from[a]);
    if (paints()) {
      const steps = Math.ceil(Math.hypot(...way) / PIXELS_PER_DAB) || 1;
      for (let i = 1; i <= steps; ++i) slices.paint(...from.map((value, a) => value + (way[a] * i) / steps));
    } else slices.set({shift: slices.state.shift.map((value, a) => value + way[a])});
    from = now;
    return undefined;
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, () => {
      if (from && paints()) slices.painted();
      from = null;
    });
  canvas.addEventListener("pointerleave", () => {
    slices.cursor = null;
    slices.probe();
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const {state, stage, look} = slices;
      if (!event.ctrlKey && look.kind !== "image") return slices.go(state.index + Math.sign(event.deltaY));
      const zoom = Math.min(Math.max(state.zoom * Math.exp(-event.deltaY * ZOOM_PER_PIXEL), LEAST), MOST);
      // What is under the cursor stays there.
      const middle = [stage.clientWidth / 2, stage.clientHeight / 2];
      const shift = place(event).map((at, a) => at - middle[a] - ((at - middle[a] - state.shift[a]) * zoom) / state.zoom);
      return slices.set({zoom, shift});
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
