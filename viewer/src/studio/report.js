// Reports of commands, taken apart: the pictures in space go to the stage, the rest becomes the tab "Report".

import {picture} from "../decode.js";
import {element} from "../dom.js";
import {watchPlots} from "../hover.js";
import {watchSeries} from "../film.js";

/** What a report holds. */
export function parseReport(html) {
  const page = new DOMParser().parseFromString(html, "text/html");
  const pictures = [...page.querySelectorAll("figure.surface script.surface-data")].map((script) => picture(JSON.parse(script.textContent)));
  for (const figure of page.querySelectorAll("figure.surface")) (figure.closest(".panel") || figure).remove();
  const facts = [...page.querySelectorAll(".facts > div")].map((div) => [div.querySelector("dd").textContent, div.querySelector("dt").textContent]);
  const warnings = [...page.querySelectorAll("#warnings li")].map((li) => li.textContent);
  const parts = [".facts", "#warnings", ".summary", ".panels", "#options", "#results", "#time-and-memory"]
    .map((selector) => page.querySelector(selector))
    .filter((part, i, all) => part && !all.some((other) => other && other !== part && other.contains(part)));
  return {pictures, facts, warnings, parts};
}

/** The parts of a report as they stand on the page. */
export function showReport(host, report) {
  const nodes = report.parts.map((part) => document.importNode(part, true));
  for (const node of nodes) {
    if (node.matches("section") && node.id !== "warnings") {
      const title = node.querySelector("h2");
      const folded = element("details", {className: "folded"}, element("summary", {}, title ? title.textContent : ""));
      if (title) title.remove();
      folded.append(...node.childNodes);
      node.replaceChildren(folded);
    }
  }
  host.replaceChildren(...nodes);
  watchSeries(host);
  watchPlots(host);
}
