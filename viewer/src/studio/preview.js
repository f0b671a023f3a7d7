// Previews: a command on coarse inputs while its options change. The last change wins.

const LONG = 1500; // milliseconds after which a preview gives way to a newer one

/** The words of a command that runs on coarse inputs: no report, no further outputs, fewer cells. */
export function previewArgs({command, inputs, flags, outputs}) {
  const first = outputs.filter(([flag]) => flag === "-o");
  const most = {"--resolution": 64, "--center-spacing": Infinity};
  const kept = flags
    .filter(([flag]) => flag !== "--table")
    .map(([flag, value]) => [flag, flag in most && Number.isFinite(most[flag]) ? String(Math.min(Number(value) || most[flag], most[flag])) : value]);
  if (command === "reconstruct" && !kept.some(([flag]) => flag === "--resolution")) kept.push(["--resolution", "48"]);
  const has = (name) => kept.some(([flag]) => flag === name);
  // Patches of a given smoothing take seconds even for the coarse image.
  if (command === "inpaint" && has("--smoothing") && !has("--method") && !has("--kernel"))
    kept.push(["--method", "multilevel"], ["--kernel", "wendland-c2"]);
  // Labels keep the wider spacing of a coarse image.
  const renamed = first.map(([flag, name]) => [flag, command === "segment" || command === "inpaint" ? name.replace(/\.[^/]*$/, ".mha") : name]);
  return [...inputs, ...[...renamed, ...kept].flatMap(([flag, value]) => (value === true ? [flag] : [flag, String(value)]))];
}

export class Previews {
  #again = false;
  #start = 0;
  #abort = new AbortController();

  /**
   * @param {import("../engine/engine.js").Engine} engine
   * @param {{request: () => object, show: (command: string, made: string, seconds: number) => Promise<void>,
   *   failed: (error: Error) => void}} on request: the command as it stands (Task.request)
   */
  constructor(engine, on) {
    Object.assign(this, {engine, on});
    this.running = false;
  }

  cancel() {
    this.#abort.abort();
  }

  async run() {
    if (this.running) {
      this.#again = true;
      if (performance.now() - this.#start > LONG) this.cancel();
      return;
    }
    this.running = true;
    try {
      do {
        this.#again = false;
        await this.#once().catch((error) => {
          if (error.name !== "AbortError" && !this.#again) this.on.failed(error);
        });
      } while (this.#again);
    } finally {
      this.running = false;
    }
  }

  async #once() {
    this.#start = performance.now();
    this.#abort = new AbortController();
    const request = this.on.request();
    const made = await this.engine.run({command: request.command, args: previewArgs(request), preview: true}, undefined, this.#abort.signal);
    const first = made.items.find(({name}) => !/\.html$/.test(name));
    if (first) await this.on.show(request.command, first.name, (performance.now() - this.#start) / 1000);
  }
}
