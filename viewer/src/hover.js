// Values under the cursor in the plots of reports, and plots as files. app/report/drawing.cpp writes into each drawing
// where its axes are (data-plot), and what curves, bars and maps hold.

import {bytes} from "./decode.js";
import {element, save} from "./dom.js";
import {readable} from "./ticks.js";

const REACH = 24; // units of the drawing around the cursor in which a dot or curve counts

const svgElement = (name, attributes) => {
  const result = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) result.setAttribute(key, value);
  return result;
};

/** The corners of a path of M and L (absolute), as [x, y] pairs. */
export function corners(path) {
  const numbers = path.match(/-?[\d.]+/g) || [];
  if (!/h0/.test(path)) return Array.from({length: numbers.length / 2}, (_, i) => [Number(numbers[2 * i]), Number(numbers[2 * i + 1])]);
  // Dots are lines of length 0: "M12 34h0".
  return Array.from({length: Math.floor(numbers.length / 3)}, (_, i) => [Number(numbers[3 * i]), Number(numbers[3 * i + 1])]);
}

/** Places of a plot as values, from data-plot: {x: [lo, hi, left, width, label], y: [lo, hi, top, height, label]}. */
export function scaleOf(plot) {
  const [xlo, xhi, left, width] = plot.x, [ylo, yhi, top, height] = plot.y;
  return {
    toX: (px) => xlo + ((px - left) / width) * (xhi - xlo),
    toY: (py) => yhi - ((py - top) / height) * (yhi - ylo),
    toPixelX: (value) => left + ((value - xlo) / (xhi - xlo)) * width,
    toPixelY: (value) => top + ((yhi - value) / (yhi - ylo)) * height,
    inside: (px, py) => px >= left - 2 && px <= left + width + 2 && py >= top - 2 && py <= top + height + 2,
  };
}

/** What lies at a place of the drawing: text, and where to mark it; null for nothing. */
export function valueUnder(plot, px, py, series) {
  const scale = scaleOf(plot);
  if (!scale.inside(px, py)) return null;
  const named = (axis, value) => `${plot[axis][4] || axis}: ${readable(value)}`;
  if (plot.bars) {
    const part = (scale.toX(px) - plot.x[0]) / (plot.x[1] - plot.x[0]);
    const i = Math.min(Math.max(Math.floor(part * plot.bars.length), 0), plot.bars.length - 1);
    const width = (plot.x[1] - plot.x[0]) / plot.bars.length;
    const lo = plot.x[0] + i * width;
    return {
      text: `${readable(lo, 3)} to ${readable(lo + width, 3)}: ${plot.bars[i].toLocaleString("en")} ${plot.y[4] || ""}`,
      x: scale.toPixelX(lo + width / 2),
      y: scale.toPixelY(plot.bars[i]),
    };
  }
  if (plot.map) {
    const {columns, rows, lo, hi, cells, label} = plot.map;
    const at = (value, [from, to], n) => Math.min(Math.max(Math.round(((value - from) / (to - from)) * (n - 1)), 0), n - 1);
    const x = scale.toX(px), y = scale.toY(py);
    const cell = cells[at(y, plot.y, rows) * columns + at(x, plot.x, columns)];
    const value = cell === 255 ? "no value" : `${label || "value"} ${readable(lo + ((hi - lo) * cell) / 254, 3)}`;
    return {text: `${plot.x[4]} ${readable(x)}, ${plot.y[4]} ${readable(y)}: ${value}`, x: px, y: py};
  }
  let best = Infinity, found = null;
  for (const points of series)
    for (const [x, y] of points) {
      const distance = (x - px) ** 2 + 0.05 * (y - py) ** 2;
      if (distance < best) [best, found] = [distance, [x, y]];
    }
  if (!found || Math.abs(found[0] - px) > REACH) return null;
  return {text: `${named("x", scale.toX(found[0]))}, ${named("y", scale.toY(found[1]))}`, x: found[0], y: found[1]};
}

/** A drawing as a file of its own: with the styles that the page gives it. */
export function standalone(svg) {
  const copy = svg.cloneNode(true);
  copy.removeAttribute("data-plot");
  for (const hover of copy.querySelectorAll(".hover")) hover.remove();
  const kept = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "opacity", "fill-opacity", "font-size", "font-family", "text-anchor"];
  const [originals, copies] = [svg, copy].map((root) => [...root.querySelectorAll("*")].filter((e) => !e.closest(".hover")));
  originals.forEach((original, i) => {
    const style = getComputedStyle(original);
    copies[i].setAttribute("style", kept.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"));
  });
  copy.setAttribute("width", svg.viewBox.baseVal.width);
  copy.setAttribute("height", svg.viewBox.baseVal.height);
  return new XMLSerializer().serializeToString(copy);
}

function watch(svg) {
  const plot = JSON.parse(svg.dataset.plot);
  if (plot.map) plot.map.cells = bytes(plot.map.values);
  const series = [...svg.querySelectorAll("path.curve, path.dots, path.area")].map((path) => corners(path.getAttribute("d")));
  const mark = svgElement("circle", {class: "hover", r: 4, visibility: "hidden"});
  svg.append(mark);
  const tip = element("div", {className: "plot-tip", hidden: true});
  const frame = element("div", {className: "plot"});
  svg.replaceWith(frame);
  const saving = element("button", {type: "button", className: "plot-save", title: "Save this plot as SVG"}, "SVG");
  saving.addEventListener("click", () =>
    save(new Blob([standalone(svg)], {type: "image/svg+xml"}), `${(svg.getAttribute("aria-label") || "plot").slice(0, 40).replace(/[^\w]+/g, "-").toLowerCase()}.svg`));
  frame.append(svg, tip, saving);
  const hide = () => {
    tip.hidden = true;
    mark.setAttribute("visibility", "hidden");
  };
  svg.addEventListener("pointermove", (event) => {
    const matrix = svg.getScreenCTM();
    if (!matrix) return;
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    const found = valueUnder(plot, at.x, at.y, series);
    if (!found) return hide();
    mark.setAttribute("cx", found.x);
    mark.setAttribute("cy", found.y);
    mark.setAttribute("visibility", "visible");
    tip.textContent = found.text;
    tip.hidden = false;
    const box = frame.getBoundingClientRect();
    const place = new DOMPoint(found.x, found.y).matrixTransform(matrix);
    const half = tip.offsetWidth / 2;
    tip.style.left = `${Math.min(Math.max(place.x - box.left, half), box.width - half)}px`;
    tip.style.top = `${place.y - box.top - 12}px`;
    return undefined;
  });
  svg.addEventListener("pointerleave", hide);
}

/** Makes the plots in a part of the page tell their values. */
export function watchPlots(root) {
  for (const svg of root.querySelectorAll("svg[data-plot]")) watch(svg);
}
