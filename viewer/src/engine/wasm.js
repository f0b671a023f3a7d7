// The engine of the studio as static files: the program runs in workers of the page, compiled to WebAssembly, and files
// stay in the page. One worker runs commands, the other one looks into files and makes previews, so that neither waits for
// the other. A command is cancelled by ending its worker. There are two programs, the smaller one with the commands about
// surfaces (wasm/run_surfaces.cpp); the larger one is loaded when another command is first wanted.

import {checkEngine, EngineError} from "./engine.js";
import {compile} from "csrbf-compile";
import {decodeLook} from "../look.js";

const LARGEST = 512 * 2 ** 20; // bytes of a file: the memory of a page ends at 4 GB, and work takes several times the file
const MOST_POINTS = 2e6; // of a look
const VIEWER = "/* csrbf_viewer.js */"; // where reports have the script that draws surfaces

/** Commands of the smaller program. */
const ABOUT_SURFACES = new Set(["reconstruct", "estimate-normals", "polygonize", "render", "curvature", "combine", "compare"]);

/** A worker with a program, begun again after it was ended. It holds copies of the items that were put into it. */
class Program {
  #binary;
  #address;
  #worker;
  #calls = new Map();
  #next = 0;
  #held = new Set();
  #last = Promise.resolve();

  /** @param {{script: string, compiled: () => Promise<WebAssembly.Module>}} binary @param {string|URL} address of the worker */
  constructor(binary, address) {
    this.#binary = binary;
    this.#address = address;
  }

  get isRunning() {
    return Boolean(this.#worker);
  }

  async #begin() {
    const compiled = await this.#binary.compiled();
    this.#worker = new Worker(this.#address, {type: "module"});
    this.#worker.onmessage = ({data: {id, progress, error, result}}) => {
      const call = this.#calls.get(id);
      if (!call) return;
      if (progress) return void call.progress(...progress);
      this.#calls.delete(id);
      if (error === undefined) call.resolve(result);
      else call.reject(new EngineError(error));
    };
    this.#worker.onerror = (event) => this.end(new EngineError(event.message || "The program could not be loaded."));
    return this.#send("start", {compiled, script: this.#binary.script});
  }

  #send(call, given = {}, transfer = [], progress = () => {}) {
    return new Promise((resolve, reject) => {
      const id = ++this.#next;
      this.#calls.set(id, {resolve, reject, progress});
      this.#worker.postMessage({id, call, ...given}, transfer);
    });
  }

  /** Ends what runs, which fails with `reason`. */
  end(reason) {
    this.#worker?.terminate();
    this.#worker = undefined;
    this.#held.clear();
    for (const {reject} of this.#calls.values()) reject(reason);
    this.#calls.clear();
  }

  forget(name) {
    if (!this.#held.delete(name) || !this.#worker) return;
    this.#send("remove", {name}).catch(() => {});
  }
  holds(name) {
    this.#held.add(name);
  }

  async #put(items) {
    for (const {name, blob} of items) {
      if (this.#held.has(name)) continue;
      const bytes = new Uint8Array(await blob.arrayBuffer());
      await this.#send("put", {name, bytes}, [bytes.buffer]);
      this.#held.add(name);
    }
  }

  /** A call that needs these items; calls are made one after the other. */
  call(name, given, items = [], progress, signal) {
    const stop = () => new DOMException("cancelled", "AbortError");
    const made = this.#last.then(async () => {
      if (signal?.aborted) throw stop();
      const abort = () => this.end(stop());
      signal?.addEventListener("abort", abort);
      try {
        if (!this.#worker) await this.#begin();
        await this.#put(items);
        return await this.#send(name, given, [], progress);
      } finally {
        signal?.removeEventListener("abort", abort);
      }
    });
    this.#last = made.catch(() => {});
    return made;
  }
}

/** A program beside the page, compiled when it is first wanted. */
function binary(address) {
  let compiled;
  return {script: String(address).replace(/\.wasm\.lzma$/, ".js"), compiled: () => (compiled ??= load(address))};
}

async function load(address) {
  const response = await fetch(address);
  if (!response.ok) throw new EngineError(`The program could not be loaded: ${response.status}`, response.status);
  return compile(await response.arrayBuffer());
}

const isNamed = (args, name) => args.some((arg) => arg === name || arg.endsWith(`:${name}`));

/** "scan.ply", or "scan-2.ply" when that is taken. */
function freshName(name, taken) {
  const plain = name.replace(/[/\\:\u0000-\u001f\u007f]/g, "_").replace(/^[.-]+/, "") || "file";
  const dot = plain.indexOf(".");
  const [stem, extension] = dot > 0 ? [plain.slice(0, dot), plain.slice(dot)] : [plain, ""];
  let fresh = plain;
  for (let i = 2; taken.has(fresh); ++i) fresh = `${stem}-${i}${extension}`;
  return fresh;
}

/**
 * @param {{surfaces?: string|URL, program?: string|URL, worker?: string|URL, viewer?: string|URL, version?: string}} [where]
 *   addresses of the two programs, of the worker, and of the script of reports; beside the page by default
 * @returns {Promise<import("./engine.js").Engine>}
 */
export async function wasmEngine({surfaces = "csrbf_surfaces.wasm.lzma", program = "csrbf_program.wasm.lzma", worker = "csrbf_worker.js", viewer = "csrbf_viewer.js", version = ""} = {}) {
  const binaries = [surfaces, program].map((address) => binary(new URL(address, document.baseURI)));
  await binaries[0].compiled();
  const [commands, previews] = [0, 1].map(() => binaries.map((each) => new Program(each, worker)));
  const programs = [...commands, ...previews];
  // The smaller one where it will do and the larger one is not there anyway.
  const oneOf = ([small, large], command) => (large.isRunning || (command && !ABOUT_SURFACES.has(command)) ? large : small);
  const items = new Map(); // name: {item, blob}, previews too
  let usage;

  const known = (name) => {
    const found = items.get(name);
    if (!found) throw new EngineError(`there is no file ${name}`, 404);
    return {name, blob: found.blob};
  };
  const forget = (name) => {
    for (const each of programs) each.forget(name);
  };
  const keep = (name, blob, made, {kind, problem}) => {
    const item = {name, kind, bytes: blob.size, made, ...(problem ? {problem} : {})};
    items.set(name, {item, blob});
    return item;
  };
  const add = async (name, blob, made) => keep(name, blob, made, await oneOf(previews).call("describe", {name}, [{name, blob}]));

  return checkEngine({
    name: "wasm",
    version,
    largest: LARGEST,

    commands: () => (usage ??= oneOf(previews).call("usage", {})),
    files: async () => [...items.values()].map(({item}) => item).filter(({name}) => !name.startsWith("preview:")),

    async open(file, name, progress = () => {}) {
      if (file.size > LARGEST)
        throw new EngineError(`${name} is larger than ${LARGEST / 2 ** 20} MB; csrbf studio on this machine takes larger ones`, 413);
      const item = await add(freshName(name, items), file, false);
      progress(1);
      return item;
    },
    async write(name, text) {
      const found = items.get(name);
      if (found && !found.item.made) throw new EngineError(`${name} was there before`, 409);
      forget(name);
      return add(name, new Blob([text]), true);
    },
    look: async (name, most = MOST_POINTS) => decodeLook(await oneOf(previews).call("look", {name, most}, [known(name)])),
    slice: async (name, axis, index, frame = 0) =>
      decodeLook(await oneOf(previews).call("slice", {name, axis, index, frame}, [known(name)])),
    async download(name) {
      const {blob} = known(name);
      if (!/\.html?$/.test(name)) return blob;
      const page = await blob.text();
      if (!page.includes(VIEWER)) return blob;
      const script = await (await fetch(viewer)).text();
      return new Blob([page.replace(VIEWER, () => script)], {type: "text/html"});
    },
    async remove(name) {
      forget(name);
      items.delete(name);
    },

    async run({command, args, preview = false}, progress = () => {}, signal) {
      const names = [...items.keys()].filter((name) => isNamed(args, name)).sort((a, b) => b.length - a.length);
      const runner = oneOf(preview ? previews : commands, command);
      const {written, ...done} = await runner.call("run", {command, args, preview, names}, names.map(known), progress, signal);
      if (done.status !== 0) throw new EngineError(done.error, done.status);
      const results = written.map(({name, bytes, ...description}) => {
        for (const each of programs) if (each !== runner) each.forget(name);
        runner.holds(name);
        return keep(name, new Blob([bytes]), true, description);
      });
      const page = results.find((item) => /\.html?$/.test(item.name));
      return {...done, items: results, page: page && page.name};
    },
  });
}
