import {readFile} from "node:fs/promises";

import createModule from "./csrbf_surfaces.js";
import {loader} from "./load.js";

export const load = loader(createModule, new URL("./csrbf_surfaces.wasm.lzma", import.meta.url), readFile);
export {Csrbf, Model} from "./csrbf.js";
