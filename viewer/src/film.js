// Frames as a film: a pace to play them at, and those of a report, all below each other in a page without scripts, one at a
// time with a slider here.

import {button, element, slider} from "./dom.js";

const PER_SECOND = 8; // frames; slow enough to follow a contour

/** Calls `step` at the pace of a film until it is called again; returns whether it runs. */
export function player(step) {
  let timer = null;
  return () => {
    if (timer) clearInterval(timer);
    timer = timer ? null : setInterval(step, 1000 / PER_SECOND);
    return Boolean(timer);
  };
}

/** Makes the series below a node interactive. */
export function watchSeries(root) {
  for (const series of root.querySelectorAll(".series")) {
    const frames = [...series.querySelectorAll("figure")];
    if (frames.length < 2 || series.classList.contains("live")) continue;
    let shown = 0;
    const show = (i) => {
      shown = (i + frames.length) % frames.length;
      frames.forEach((frame, k) => (frame.hidden = k !== shown));
      control.set(shown);
    };
    const number = (i) => frames[i].dataset.frame || String(i);
    const control = slider("Frame", "frame", {lo: 0, hi: frames.length - 1, step: 1, value: 0, shown: number}, show);
    const play = player(() => show(shown + 1));
    const start = button("Play", "play", (event) => (event.currentTarget.textContent = play() ? "Pause" : "Play"));
    series.append(element("div", {className: "controls"}, start.node, control.node));
    series.classList.add("live");
    show(0);
  }
}
