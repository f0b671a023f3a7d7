import createModule from "./csrbf_surfaces.js";
import {loader} from "./load_node.js";

export const load = loader(createModule, new URL("./csrbf_surfaces.wasm", import.meta.url));
export {Csrbf, Model} from "./csrbf.js";
