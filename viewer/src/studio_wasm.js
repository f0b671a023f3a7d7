// The studio's page as static files, with the program in its workers (engine/wasm.js).

import {wasmEngine} from "./engine/wasm.js";
import {startStudio} from "./studio/app.js";

startStudio(wasmEngine({version: document.documentElement.dataset.version}));
