import createModule from "./csrbf_module.js";
import {loader} from "./load_node.js";

export const load = loader(createModule, new URL("./csrbf_module.wasm", import.meta.url));
export {Csrbf, Model} from "./csrbf.js";
