// The studio's page as static files, with the program in its workers: see engine_wasm.js.

import {wasmEngine} from "./engine_wasm.js";
import {Studio} from "./studio/app.js";
import {element} from "./dom.js";

(async () => {
  try {
    const studio = new Studio(document.body, await wasmEngine({version: document.documentElement.dataset.version}));
    window.studio = studio;
    await studio.start();
  } catch (error) {
    document.body.append(element("p", {className: "fatal"}, error.message));
    throw error;
  }
})();
