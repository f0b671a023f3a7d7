// Which columns of a table are coordinates, values and weights.

import {element} from "../dom.js";
import {readable} from "../ticks.js";

const ROLES = [["coordinate", "coordinate"], ["value", "value"], ["weight", "weight"], ["", "unused"]];
const FIRST = 4; // values of a column that are shown

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

/** The columns with a choice of roles and their first values: a row for each, so that any number of them can be read. */
export function columnsChooser(look, roles, changed) {
  const rows = look.columns.map((column, i) => {
    const select = element("select", {name: `role-${i}`}, ...ROLES.map(([value, text]) => element("option", {value}, text)));
    select.setAttribute("aria-label", `Role of the column ${column.name}`);
    select.value = roles[i];
    select.addEventListener("change", () => {
      roles[i] = select.value;
      changed();
    });
    const isText = column.values.every((value) => Number.isNaN(value));
    const first = isText ? "no numbers" : Array.from(column.values.slice(0, FIRST), (value) => (Number.isNaN(value) ? "–" : readable(value, 4))).join(", ");
    return element("tr", {}, element("th", {scope: "row", title: column.name}, column.name), element("td", {className: "role"}, select),
      element("td", {className: "first", title: first}, first));
  });
  return element("div", {className: "columns-chooser"}, element("table", {}, element("tbody", {}, ...rows)),
    element("p", {className: "quiet"}, `The first of ${look.total.toLocaleString("en")} rows.`));
}
