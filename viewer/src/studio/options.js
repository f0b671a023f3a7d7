// Controls for the flags of a command, made from the program's own definitions.

import {element} from "../dom.js";
import {FILES, HIDDEN, MAIN, SLIDERS} from "./commands.js";

const VALUE = "=value"; // stands for "a number" in a choice of words
const label = (name) => {
  const words = name.replace(/^--/, "").replace(/-/g, " ");
  return words[0].toUpperCase() + words.slice(1);
};
let count = 0;

/** Slider positions 0 to 1000 and values. */
export function sliderScale({lo, hi, log, whole, step}) {
  const round = (value) => {
    if (whole) return Math.round(value);
    if (step) return Number((Math.round(value / step) * step).toPrecision(6));
    return Number(value.toPrecision(2));
  };
  return {
    toValue: (place) => round(log ? lo * (hi / lo) ** (place / 1000) : lo + ((hi - lo) * place) / 1000),
    toPlace: (value) => Math.round(1000 * Math.min(Math.max(log ? Math.log(value / lo) / Math.log(hi / lo) : (value - lo) / (hi - lo), 0), 1)),
  };
}

/** The words that a flag takes, without placeholders such as L; [] where it takes anything. */
const wordsOf = (flag) => flag.words;
const takesNumber = (flag) => !flag.onlyWords && (flag.words.length > 0 ? /\|[A-Z]/.test(flag.value) : true);

function describe(node, flag) {
  node.title = flag.what + (flag.shownDefault ? ` (default: ${flag.shownDefault})` : "");
}

function row(flag, ...controls) {
  const id = `flag-${++count}`;
  const first = controls[0];
  first.id = id;
  const result = element("div", {className: "flag", dataset: {flag: flag.name}}, element("label", {htmlFor: id}, label(flag.name)), element("div", {className: "value"}, ...controls));
  describe(result, flag);
  return result;
}

/**
 * The control of a flag.
 * @param {import("../engine.js").Flag} flag
 * @param {{get: () => string|true|undefined, set: (value: string|true|undefined, moving: boolean) => void,
 *   items: (kinds: string[]) => string[]}} bound its value, undefined where it is not given
 */
export function flagControl(flag, {get, set, items}) {
  const given = get();
  if (flag.value === "") {
    const box = element("input", {type: "checkbox", name: flag.name, checked: given === true});
    box.addEventListener("change", () => set(box.checked ? true : undefined, false));
    return row(flag, box);
  }
  const kinds = FILES[flag.name];
  if (kinds) {
    const names = items(kinds);
    const select = element("select", {name: flag.name}, element("option", {value: ""}, "none"), ...names.map((name) => element("option", {value: name}, name)));
    select.value = names.includes(given) ? given : "";
    select.addEventListener("change", () => set(select.value || undefined, false));
    return row(flag, select);
  }
  const range = SLIDERS[flag.name];
  const words = wordsOf(flag);
  if (flag.onlyWords || (words.length > 0 && !range && !takesNumber(flag))) return row(flag, wordChoice(flag, words, given, set));
  if (range) return sliderRow(flag, words, range, given, set);
  const text = element("input", {type: "text", name: flag.name, placeholder: flag.shownDefault || flag.value, value: given === undefined ? "" : String(given)});
  text.addEventListener("change", () => set(text.value.trim() || undefined, false));
  return row(flag, text);
}

function wordChoice(flag, words, given, set) {
  const usual = words.includes(flag.shownDefault) ? flag.shownDefault : "";
  const select = element("select", {name: flag.name}, ...(usual ? [] : [element("option", {value: ""}, flag.shownDefault || "default")]),
    ...words.map((word) => element("option", {value: word}, word)));
  select.value = given === undefined ? usual : given;
  select.addEventListener("change", () => set(select.value === usual ? undefined : select.value, false));
  return select;
}

// "auto", "none" or a number: a choice with a slider beside it.
function sliderRow(flag, words, range, given, set) {
  const scale = sliderScale(range);
  const usual = flag.shownDefault || "default";
  const options = [...new Set([words.includes(usual) ? usual : "", ...words])];
  const select = element("select", {name: flag.name},
    ...options.map((word) => element("option", {value: word}, word || (Number.isFinite(Number(usual)) ? `${usual} (default)` : "auto"))),
    element("option", {value: VALUE}, "value"));
  const isNumber = given !== undefined && Number.isFinite(Number(given));
  select.value = isNumber ? VALUE : given === undefined ? options[0] : given;
  const start = isNumber ? Number(given) : range.start;
  const slider = element("input", {type: "range", min: 0, max: 1000, step: 1, name: `${flag.name}-slider`, value: scale.toPlace(start)});
  slider.setAttribute("aria-label", label(flag.name));
  const number = element("input", {type: "number", step: "any", name: `${flag.name}-number`, value: start});
  number.setAttribute("aria-label", `${label(flag.name)}, number`);
  const extra = element("div", {className: "sliding", hidden: select.value !== VALUE}, slider, number);
  select.addEventListener("change", () => {
    extra.hidden = select.value !== VALUE;
    set(select.value === VALUE ? number.value : select.value === options[0] ? undefined : select.value, false);
  });
  slider.addEventListener("input", () => {
    number.value = scale.toValue(Number(slider.value));
    set(number.value, true);
  });
  slider.addEventListener("change", () => set(number.value, false));
  number.addEventListener("change", () => {
    slider.value = scale.toPlace(Number(number.value));
    set(number.value, false);
  });
  const result = row(flag, select);
  result.append(extra);
  return result;
}

/**
 * All controls of a command: the main ones, and the others folded.
 * @param {import("../engine.js").Command} command
 * @param {Map<string, string|true>} values of the flags given
 * @param {(moving: boolean) => void} changed moving: a slider is held
 * @param {(kinds: string[]) => string[]} items names of the items of these kinds
 */
export function commandControls(command, values, changed, items, skip = new Set()) {
  const bind = (flag) => ({
    get: () => values.get(flag.name),
    set: (value, moving) => {
      if (value === undefined) values.delete(flag.name);
      else values.set(flag.name, value);
      changed(moving);
    },
    items,
  });
  const shown = command.flags.filter((flag) => !flag.common && !HIDDEN.has(flag.name) && !skip.has(flag.name));
  const main = MAIN[command.name] || [];
  const rank = (flag) => main.indexOf(flag.name);
  const first = shown.filter((flag) => rank(flag) >= 0).sort((a, b) => rank(a) - rank(b));
  const rest = shown.filter((flag) => rank(flag) < 0);
  const make = (flags) => flags.map((flag) => flagControl(flag, bind(flag)));
  const folded = rest.length
    ? element("details", {className: "more-flags"}, element("summary", {}, `${rest.length} more`), ...make(rest))
    : null;
  return element("div", {className: "flags"}, ...make(first), folded);
}
