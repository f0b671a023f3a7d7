import {readFile} from "node:fs/promises";

import {start} from "./csrbf.js";

/** The function load() of a module: `create` starts it, `address` is that of its bytes. */
export function loader(create, address) {
  let compiled;
  return async ({wasm} = {}) => {
    if (wasm instanceof WebAssembly.Module) return start(wasm, create);
    if (wasm !== undefined)
      return start(await WebAssembly.compile(wasm instanceof Uint8Array || wasm instanceof ArrayBuffer ? wasm : await readFile(wasm)), create);
    compiled ??= WebAssembly.compile(await readFile(address));
    return start(await compiled, create);
  };
}
