// Starts what is interactive in a report or notebook: pictures in space, and values under the cursor in plots. The page of
// the studio without a server has this script too, for its own picture and for the reports that are saved from it.

import {picture} from "./decode.js";
import {watchPlots} from "./hover.js";
import {watchSeries} from "./film.js";
import {View} from "./space/view.js";

globalThis.csrbfView = View;

for (const figure of document.querySelectorAll("figure.surface")) {
  const still = figure.querySelector(".stage"); // a picture, shown until the view works and when it cannot go on
  const why = figure.querySelector(".why-still");
  try {
    const data = JSON.parse(figure.querySelector("script.surface-data").textContent);
    figure.view = new View(figure, {name: document.title.split(" ")[0] || "view"});
    figure.classList.add("live");
    if (still) still.hidden = true;
    figure.view.show(picture(data));
    figure.view.draw();
    // Browsers draw some sixteen views at a time; the oldest one becomes a still picture again.
    figure.view.canvas.addEventListener("webglcontextlost", () => {
      figure.classList.remove("live");
      if (still) still.hidden = false;
      figure.view.stage.hidden = true;
      why.textContent = "A still picture: the browser draws no more views at a time. Reload the page to turn it.";
    });
  } catch (error) {
    figure.classList.remove("live");
    why.textContent = `No interactive view here: ${error.message}`;
  }
}
watchSeries(document);
watchPlots(document);
