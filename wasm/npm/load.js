import {compile} from "./compile.js";
import {start} from "./csrbf.js";

/**
 * The function load() of a module: `create` starts it, `address` is that of its bytes, `read` gives the bytes at an
 * address: by the means of browsers or of node.
 */
export function loader(create, address, read) {
  const isBytes = (given) => given instanceof ArrayBuffer || ArrayBuffer.isView(given);
  const moduleOf = async (given) => compile(isBytes(given) ? given : await read(given));
  let own;
  return async ({wasm} = {}) => {
    if (wasm instanceof WebAssembly.Module) return start(wasm, create);
    return start(await (wasm === undefined ? (own ??= moduleOf(address)) : moduleOf(wasm)), create);
  };
}
