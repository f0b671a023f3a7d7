// Slices as pixels: grey values, colours or labels.

import {LABELS, MAPS, parse, at as colorAt} from "../colors.js";
import {element} from "../dom.js";

// Every stride-th pixel of a slice as a picture; paint(data, k, i) writes that of index i at data[k] and behind.
function painted({width, height}, stride, paint) {
  const canvas = element("canvas", {width: Math.ceil(width / stride), height: Math.ceil(height / stride)});
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(canvas.width, canvas.height);
  for (let v = 0, k = 0; v < canvas.height; ++v)
    for (let u = 0; u < canvas.width; ++u, k += 4) paint(pixels.data, k, stride * (v * width + u));
  context.putImageData(pixels, 0, 0);
  return canvas;
}

/** An image, from black at `low` to white at `high` of its range, by a map of colours. */
export function paintImage(image, range, {low, high, map}, stride) {
  const {values, components} = image;
  const [from, to] = [low, high].map((part) => range[0] + part * (range[1] - range[0]));
  const factor = to !== from ? 255 / (to - from) : 0;
  const table = Array.from({length: 256}, (_, i) => (map === "grey" ? [i, i, i] : colorAt(MAPS[map], i / 255).map((c) => 255 * c)));
  const place = (value) => Math.min(Math.max((value - from) * factor, 0), 255);
  return painted(image, stride, (data, k, i) => {
    const value = values[components * i];
    const color = table[Math.round(place(value)) || 0];
    for (let c = 0; c < 3; ++c) data[k + c] = components >= 3 ? place(values[components * i + c]) : color[c];
    data[k + 3] = value === value ? 255 : 60; // less where there is none
  });
}

/** Labels from 1 on; label 0 is clear. */
export function paintLabels(labels, stride) {
  const {values, components} = labels;
  const colors = LABELS.map((color) => parse(color).map((c) => 255 * c));
  return painted(labels, stride, (data, k, i) => {
    const label = values[components * i];
    if (!(label > 0)) return;
    const color = colors[(Math.round(label) - 1) % colors.length];
    for (let c = 0; c < 3; ++c) data[k + c] = color[c];
    data[k + 3] = 255;
  });
}
