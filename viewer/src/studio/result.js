// The result of a command beside the picture: what it says, and the files that it wrote.

import {element, icon, plainButton} from "../dom.js";
import {bytesText, counted, readable} from "../ticks.js";
import {ICONS} from "./icons.js";
import {contourFiles, labelFiles} from "./series.js";

const MOST_FACTS = 4;
const BESIDES = new Set(["time", "peak memory"]); // facts that are not about the result

/** @param {HTMLElement} section @param {object} entry of the history @param {import("./files.js").Files} files @returns {number} of warnings */
export function showResult(section, {made, report, command}, files) {
  const told = report ? report.facts.filter(([, what]) => !BESIDES.has(what)) : [];
  const facts = told.slice(0, MOST_FACTS).map(([value, what]) => element("div", {}, element("dd", {}, value), element("dt", {}, what)));
  const warnings = report && report.warnings.length ? report.warnings : made.report.warnings || [];
  const each = made.items.filter(({name}) => name.includes("/") && !name.endsWith("/measures.csv")); // of frames
  const downloads = made.items.filter((item) => !each.includes(item)).map(({name, bytes}) =>
    plainButton("download", () => files.download(name), {dataset: {name}}, icon(ICONS.save), ` ${name} `, element("span", {className: "size"}, bytesText(bytes))));
  section.hidden = false;
  section.replaceChildren(element("h2", {}, "Result"), element("p", {className: "quiet"}, `${command} took ${readable(made.seconds, 2)} s`),
    facts.length ? element("dl", {className: "facts"}, ...facts) : element("pre", {className: "summary-lines"}, made.summary || ""),
    warnings.length ? element("ul", {className: "warning-list"}, ...warnings.map((text) => element("li", {}, text))) : "",
    element("div", {className: "downloads"}, ...downloads,
      ...framesButton("frames", labelFiles(each), "label image", files), ...framesButton("contours", contourFiles(each), "contour", files)));
  return warnings.length;
}

// Files of frames are saved together, one of each.
function framesButton(what, names, noun, files) {
  if (names.length === 0) return [];
  const saveAll = async () => {
    for (const name of names) await files.download(name);
  };
  return [plainButton(`download-${what}`, saveAll, {}, icon(ICONS.save), ` ${counted(names.length, noun)}`)];
}
