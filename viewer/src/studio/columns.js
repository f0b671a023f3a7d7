// Which columns of a table are coordinates, values and weights.

import {element} from "../dom.js";
import {readable} from "../ticks.js";

const ROLES = [["coordinate", "coordinate"], ["value", "value"], ["weight", "weight"], ["", "unused"]];
const ROWS = 5;

/** The roles that the program takes by default: the last column is the value, all others are coordinates. */
export function usualRoles(columns) {
  const texts = columns.map((column) => column.values.every((value) => Number.isNaN(value)));
  const last = texts.lastIndexOf(false);
  return columns.map((_, i) => (texts[i] ? "" : i === last ? "value" : "coordinate"));
}

/** Flags for roles; none where they are the usual ones. */
export function roleFlags(columns, roles) {
  const usual = usualRoles(columns);
  if (roles.every((role, i) => role === usual[i]) && usual.every((role) => role !== "")) return [];
  const of = (role) => columns.filter((_, i) => roles[i] === role).map((column) => (/^[^,]+$/.test(column.name) ? column.name : String(columns.indexOf(column) + 1)));
  const flags = [["--coordinates", of("coordinate").join(",")], ["--values", of("value").join(",")]];
  if (of("weight").length) flags.push(["--weights", of("weight")[0]]);
  return flags.filter(([, value]) => value);
}

/** The table's first rows with a choice of roles above them. */
export function columnsChooser(look, roles, changed) {
  const head = look.columns.map((column, i) => {
    const select = element("select", {name: `role-${i}`}, ...ROLES.map(([value, text]) => element("option", {value}, text)));
    select.setAttribute("aria-label", `Role of the column ${column.name}`);
    select.value = roles[i];
    select.addEventListener("change", () => {
      roles[i] = select.value;
      changed();
    });
    return element("th", {}, element("div", {className: "column-name", title: column.name}, column.name), select);
  });
  const rows = Array.from({length: Math.min(ROWS, look.columns.length ? look.columns[0].values.length : 0)}, (_, r) =>
    element("tr", {}, ...look.columns.map((column) => element("td", {}, Number.isNaN(column.values[r]) ? "–" : readable(column.values[r], 6)))));
  return element("div", {className: "columns-chooser"},
    element("div", {className: "scroll"}, element("table", {}, element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...rows))),
    element("p", {className: "quiet"}, `The first rows of ${look.total.toLocaleString("en")}.`));
}
