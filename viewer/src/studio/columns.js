// Which columns of a table are coordinates, values and weights.

import {element} from "../dom.js";
import {readable} from "../ticks.js";

const ROLES = [["coordinate", "coordinate"], ["value", "value"], ["weight", "weight"], ["", "unused"]];
const FIRST = 4; // values of a column that are shown

/** The roles that the program takes by default: the last column is the value, all others are coordinates. */
export function usualRoles(columns) {
  const last = columns.findLastIndex(isNumeric);
  return columns.map((column, i) => (isNumeric(column) ? (i === last ? "value" : "coordinate") : ""));
}

const isNumeric = ({values}) => !values.every((value) => Number.isNaN(value));
// Names of places eastward and northward, which come in pairs: n alone is a number of samples.
const PLACES = [[["x"], ["y"]], [["lon", "long", "lng", "longitude"], ["lat", "latitude"]], [["east", "easting"], ["north", "northing"]], [["e"], ["n"]]];
const [EASTWARD, NORTHWARD] = [0, 1].map((k) => new Set(PLACES.flatMap((pair) => pair[k])));
const FURTHER = new Set(["z", "depth", "time"]); // coordinates where another column is left for the value
const FILLERS = new Set(["loc", "pos", "coord", "coordinate", "utm", "point", "deg", "dd", "m", "wgs84"]);
const NUMBER_OF_ROW = /^(|#|(f|o|object|sample|station|point|site|well|row)?[ _.-]?(id|no|nr|num|number|index)|idx|row|unnamed: 0|.*[ _.-]id)$/;
const UNCERTAINTY = /^(.*[ _.-])?(sigma|sd|std|stdev|stddev|stderr|se|err|error|unc|uncertainty|var|variance)([ _.-].*)?$/;

// A name without its unit, in lower case: "Lon [deg]" is lon.
const plain = ({name}) => name.toLowerCase().replace(/[([].*/, "").trim();
// What is left of it without words that places have beside the axis: "X_coord" and "Xloc" are x.
const axisOf = (column) => plain(column).split(/[ _.-]+/).filter((word) => !FILLERS.has(word)).join(" ").replace(/^([xyz])(loc|pos|coord|utm)$/, "$1");

/**
 * The roles that names of columns suggest: those of eastward and northward places are the coordinates, and the last one
 * that neither numbers the rows nor is an uncertainty is the value. Without such names the usual ones.
 */
export function guessedRoles(columns) {
  const usual = usualRoles(columns);
  const axes = columns.map(axisOf);
  const left = [...columns.keys()].filter((i) => usual[i] && ![NUMBER_OF_ROW, UNCERTAINTY].some((names) => names.test(plain(columns[i]))));
  const pairs = PLACES.map((pair) => pair.map((names) => left.find((i) => names.includes(axes[i]))));
  const [east, north] = pairs.find((pair) => !pair.includes(undefined)) || [];
  if (east === undefined || left.length < 3) return usual;
  const places = left.filter((i) => i === east || i === north || FURTHER.has(axes[i]));
  const coordinates = new Set(places.length < left.length ? places : [east, north]);
  const value = left.findLast((i) => !coordinates.has(i));
  return columns.map((_, i) => (coordinates.has(i) ? "coordinate" : i === value ? "value" : ""));
}

/** The places of the columns of a role: as in the file, but eastward before northward. */
export function placesOf(columns, roles, role) {
  const places = roles.flatMap((given, i) => (given === role ? [i] : []));
  const [first, second] = places;
  const turned = role === "coordinate" && places.length > 1 && NORTHWARD.has(axisOf(columns[first])) && EASTWARD.has(axisOf(columns[second]));
  return turned ? [second, first, ...places.slice(2)] : places;
}

/** Flags for roles; none where they are the usual ones. */
export function roleFlags(columns, roles) {
  const usual = usualRoles(columns);
  const [coordinates, values, weights] = ["coordinate", "value", "weight"].map((role) => placesOf(columns, roles, role));
  const inOrder = coordinates.every((place, i) => i === 0 || place > coordinates[i - 1]);
  if (inOrder && roles.every((role, i) => role === usual[i]) && usual.every((role) => role !== "")) return [];
  const isClear = ({name}) => /^[^,]+$/.test(name) && columns.filter((other) => other.name === name).length === 1;
  const names = (places) => places.map((i) => (isClear(columns[i]) ? columns[i].name : String(i + 1))).join(",");
  return [["--coordinates", names(coordinates)], ["--values", names(values)], ["--weights", names(weights.slice(0, 1))]].filter(([, value]) => value);
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

/** The columns that flags name, by name or number; without them the last one is the value, and all others coordinates. */
export function rolesOfFlags(names, flags) {
  const place = (word) => (names.includes(word) ? names.indexOf(word) : Number(word) - 1);
  const [given, values, weights] = ["--coordinates", "--values", "--weights"].map((flag) => (flags.get(flag) || "").split(",").filter(Boolean).map(place));
  const free = names.map((_, i) => i).filter((i) => !given.includes(i) && !values.includes(i) && !weights.includes(i));
  if (values.length === 0 && free.length > 0) values.push(free.pop());
  return {coordinates: given.length > 0 ? given : free, values, weights};
}
