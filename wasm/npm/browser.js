import createModule from "./csrbf_module.js";
import {loader} from "./load.js";
import {read} from "./read_browser.js";

export const load = loader(createModule, new URL("./csrbf_module.wasm.lzma", import.meta.url), read);
export {Csrbf, Model} from "./csrbf.js";
