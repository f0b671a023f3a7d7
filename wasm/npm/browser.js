import {start} from "./csrbf.js";

let compiled;

// While it is loaded where the server says that it is application/wasm; else afterwards.
async function compile(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`csrbf: ${response.url} could not be loaded: ${response.status}`);
  if (response.headers.get("Content-Type")?.startsWith("application/wasm")) return WebAssembly.compileStreaming(response);
  return WebAssembly.compile(await response.arrayBuffer());
}

export async function load({wasm} = {}) {
  if (wasm instanceof WebAssembly.Module) return start(wasm);
  if (wasm instanceof ArrayBuffer || ArrayBuffer.isView(wasm)) return start(await WebAssembly.compile(wasm));
  if (wasm !== undefined) return start(await compile(wasm));
  compiled ??= compile(new URL("./csrbf_module.wasm", import.meta.url));
  return start(await compiled);
}

export {Csrbf, Model} from "./csrbf.js";
