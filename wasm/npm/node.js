import {readFile} from "node:fs/promises";

import createModule from "./csrbf_module.js";
import {loader} from "./load.js";

export const load = loader(createModule, new URL("./csrbf_module.wasm.lzma", import.meta.url), readFile);
export {Csrbf, Model} from "./csrbf.js";
