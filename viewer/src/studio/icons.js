// Icons of the page, drawn in 16 x 16 units.

import {icon, plainButton} from "../dom.js";

export const ICONS = {
  undo: "M6 3 3 6l3 3M3 6h6a4 4 0 0 1 0 8H6",
  redo: "M10 3l3 3-3 3M13 6H7a4 4 0 0 0 0 8h3",
  remove: "M4 4l8 8M12 4l-8 8",
  save: "M8 2v8M5 7l3 3 3-3M3 13h10",
  open: "M2 4h4l1.5 2H14v7H2z",
};

/** Icons of files by their kind. */
export const SHAPES = {
  points: "M4 5h0M8 3h0M12 6h0M5 10h0M9 8h0M11 12h0M6 13h0",
  mesh: "M8 2 2 12h12zM5 7h6M8 12 5 7M8 12l3-5",
  table: "M2 3h12v10H2zM2 6.5h12M2 10h12M6.5 3v10",
  image: "M2 3h12v10H2zM2 11l4-4 3 3 2-2 3 3",
  volume: "M8 2l6 3v6l-6 3-6-3V5zM2 5l6 3 6-3M8 8v6",
  function: "M2 12c3 0 3-8 6-8s3 8 6 8",
  surface: "M8 2.5a5.5 5.5 0 1 0 0 11 5.5 5.5 0 1 0 0-11M2.5 8c3 2 8 2 11 0",
  other: "M4 2h6l3 3v9H4zM10 2v3h3",
};

/** A button with an icon only, whose title says what it does. */
export function iconButton(name, title, path, pressed) {
  const button = plainButton(name, pressed, {title, className: "icon-button"}, icon(path));
  button.setAttribute("aria-label", title);
  return button;
}
