// Rotates, moves and zooms an Orbit by mouse, touch and keyboard.

import {Pointers} from "../pointers.js";

const KEY_STEP = 0.1; // drag per key press, in units of half the height of the picture; chosen by hand
const ZOOM_STEP = 1.15; // factor per key press; chosen by hand
const LONGEST_SCROLL = 100; // pixels of one wheel event that count: mice and touchpads differ
const ZOOM_PER_PIXEL = 0.002; // logarithm of the factor: a notch of a wheel zooms by 1.22 at most
const CLICK_REACH = 5; // pixels that a click may move

/**
 * @param {HTMLElement} canvas
 * @param {import("./orbit.js").Orbit} orbit
 * @param {{changed: () => void, clicked: (x: number, y: number) => void, hovered: (x: number, y: number) => void,
 *   left: () => void, pressed: (key: string) => boolean, free: () => boolean}} on what to call; `free`: whether the
 *   page does not scroll, so that wheel and one finger are for the picture at once
 */
export function listen(canvas, orbit, on) {
  const pointers = new Pointers();
  let start = null, moved = 0, active = false;

  const half = () => canvas.clientHeight / 2 || 1;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  // One finger scrolls the page until the picture was tapped; two always turn it.
  const activate = (now) => {
    active = now || on.free();
    canvas.style.touchAction = active ? "none" : "pan-y";
  };
  activate(false);
  document.addEventListener("pointerdown", (event) => {
    if (event.target !== canvas) activate(false);
  });
  window.addEventListener("resize", () => activate(false));

  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({preventScroll: true});
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event);
    start = place(event);
    moved = 0;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event)) {
      if (event.pointerType !== "touch") on.hovered(...place(event));
      return;
    }
    const {way, factor} = pointers.move(event);
    moved += Math.hypot(...way);
    const [right, down] = way.map((pixels) => pixels / half());
    if (pointers.count > 1 || event.shiftKey || event.buttons & 6) orbit.pan(right, down);
    else orbit.turn(right, down);
    orbit.zoom(1 / factor);
    on.changed();
  });
  canvas.addEventListener("pointerup", (event) => {
    const alone = pointers.count === 1;
    pointers.delete(event);
    if (!alone || moved > CLICK_REACH || !start) return;
    if (event.pointerType === "touch") activate(true);
    on.clicked(...start);
  });
  canvas.addEventListener("pointercancel", (event) => pointers.delete(event));
  canvas.addEventListener("pointerleave", () => on.left());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());

  // The wheel scrolls the page until the picture was clicked; pinching on a touchpad sets ctrlKey.
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!on.free() && document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      orbit.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), LONGEST_SCROLL) * ZOOM_PER_PIXEL));
      on.changed();
    },
    {passive: false},
  );

  const keys = {
    ArrowLeft: [-1, 0],
    ArrowRight: [1, 0],
    ArrowUp: [0, -1],
    ArrowDown: [0, 1],
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key in keys) {
      const [right, down] = keys[event.key].map((way) => way * KEY_STEP);
      if (event.shiftKey) orbit.pan(right, down);
      else orbit.turn(right, down);
    } else if (event.key === "+" || event.key === "=") orbit.zoom(1 / ZOOM_STEP);
    else if (event.key === "-") orbit.zoom(ZOOM_STEP);
    else if (event.key === "0" || event.key === "Home") orbit.reset();
    else if (event.key === "Escape" && !on.free()) {
      activate(false);
      canvas.blur();
      on.pressed("Escape");
    } else if (!on.pressed(event.key)) return;
    event.preventDefault();
    on.changed();
  });
}
