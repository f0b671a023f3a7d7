import createModule from "./csrbf_surfaces.js";
import {loader} from "./load.js";
import {read} from "./read_browser.js";

export const load = loader(createModule, new URL("./csrbf_surfaces.wasm.lzma", import.meta.url), read);
export {Csrbf, Model} from "./csrbf.js";
