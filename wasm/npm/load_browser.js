import {start} from "./csrbf.js";

// While it is loaded where the server says that it is application/wasm; else afterwards.
async function compile(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`csrbf: ${response.url} could not be loaded: ${response.status}`);
  if (response.headers.get("Content-Type")?.startsWith("application/wasm")) return WebAssembly.compileStreaming(response);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** The function load() of a module: `create` starts it, `address` is that of its bytes. */
export function loader(create, address) {
  let compiled;
  return async ({wasm} = {}) => {
    if (wasm instanceof WebAssembly.Module) return start(wasm, create);
    if (wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm)) return start(await WebAssembly.compile(wasm), create);
    if (wasm !== undefined) return start(await compile(wasm), create);
    compiled ??= compile(address);
    return start(await compiled, create);
  };
}
