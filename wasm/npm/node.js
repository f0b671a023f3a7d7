import {readFile} from "node:fs/promises";

import {start} from "./csrbf.js";

let compiled;

export async function load({wasm} = {}) {
  if (wasm instanceof WebAssembly.Module) return start(wasm);
  if (wasm !== undefined) return start(await WebAssembly.compile(wasm instanceof Uint8Array || wasm instanceof ArrayBuffer ? wasm : await readFile(wasm)));
  compiled ??= WebAssembly.compile(await readFile(new URL("./csrbf_module.wasm", import.meta.url)));
  return start(await compiled);
}

export {Csrbf, Model} from "./csrbf.js";
