// The engine behind `csrbf studio`: asks the program that serves the page. All addresses are relative to that of the page,
// whose path is the token without which nothing is answered.

import {checkEngine, EngineError} from "./engine.js";
import {decodeLook} from "../look.js";

const path = (name) => encodeURIComponent(name);

async function refusal(response) {
  let message = `the studio answered ${response.status}`;
  try {
    message = (await response.json()).error || message;
  } catch {
    // not JSON: the status says enough
  }
  return new EngineError(message, response.status);
}

async function ask(address, options = {}) {
  let response;
  try {
    response = await fetch(address, {cache: "no-store", ...options});
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new EngineError("The studio does not answer any more. Was the program ended? Start csrbf studio again.");
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

/** The events of a text/event-stream as [name, data] pairs. */
export async function* events(body) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const {done, value} = await reader.read();
    if (done) return;
    text += value;
    for (let end = text.indexOf("\n\n"); end >= 0; end = text.indexOf("\n\n")) {
      const lines = text.slice(0, end).split("\n");
      text = text.slice(end + 2);
      const part = (name) => lines.filter((line) => line.startsWith(`${name}: `)).map((line) => line.slice(name.length + 2)).join("\n");
      if (part("event")) yield [part("event"), JSON.parse(part("data"))];
    }
  }
}

// fetch() does not tell how much of an upload is done.
function upload(address, file, progress) {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("PUT", address);
    request.upload.onprogress = (event) => progress(event.loaded / (event.total || 1));
    request.onload = () => {
      let answer = {};
      try {
        answer = JSON.parse(request.responseText);
      } catch {
        answer = {error: `the studio answered ${request.status}`};
      }
      if (request.status === 200) resolve(answer);
      else reject(new EngineError(answer.error, request.status));
    };
    request.onerror = () => reject(new EngineError("The file could not be sent: it is too large, or the studio was ended."));
    request.send(file);
  });
}

/** @returns {Promise<import("./engine.js").Engine>} */
export async function nativeEngine() {
  const session = await (await ask("api/session")).json();
  return checkEngine({
    name: "native",
    version: session.version,
    largest: session.largest,
    folder: session.folder,

    commands: async () => (await ask("api/commands")).json(),
    files: async () => (await (await ask("api/session")).json()).files,

    async open(file, name, progress = () => {}) {
      if (file.size > session.largest)
        throw new EngineError(`${name} is larger than this studio takes; csrbf studio --largest SIZE allows more`, 413);
      return upload(`api/files/${path(name)}`, file, progress);
    },
    write: async (name, text) => (await ask(`api/files/${path(name)}?replace=1`, {method: "PUT", body: text})).json(),
    look: async (name, most) => {
      const response = await ask(`api/look/${path(name)}${most ? `?most=${most}` : ""}`);
      return decodeLook(await response.arrayBuffer());
    },
    slice: async (name, axis, index, frame = 0) =>
      decodeLook(await (await ask(`api/look/${path(name)}?axis=${axis}&index=${index}&frame=${frame}`)).arrayBuffer()),
    download: async (name) => (await ask(`api/files/${path(name)}`)).blob(),
    remove: async (name) => void (await ask(`api/files/${path(name)}`, {method: "DELETE"})),

    // Closing the connection ends the command.
    async run({command, args, preview = false}, progress = () => {}, signal) {
      const response = await ask("api/run", {
        method: "POST",
        headers: {"Content-Type": "application/json"},
        body: JSON.stringify({command, args, preview}),
        signal,
      });
      for await (const [name, data] of events(response.body)) {
        if (name === "progress") progress(data.stage, data.fraction);
        if (name !== "done") continue;
        if (data.status !== 0) throw new EngineError(data.error, data.status);
        const page = data.items.find((item) => /\.html?$/.test(item.name));
        return {...data, page: page && page.name};
      }
      throw new EngineError("The studio was ended while it worked.");
    },
  });
}
