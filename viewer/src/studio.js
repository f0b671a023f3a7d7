// The studio's page: files on the left, what is done with them below, the picture on the right, and the command that
// makes the same at the bottom. It knows engines only by their interface (engine.js).

import {nativeEngine} from "./engine_native.js";
import {Studio} from "./studio/app.js";
import {element} from "./dom.js";

(async () => {
  try {
    const studio = new Studio(document.body, await nativeEngine());
    window.studio = studio;
    await studio.start();
  } catch (error) {
    document.body.append(element("p", {className: "fatal"}, error.message));
    throw error;
  }
})();
