// The worker behind wasm.js: the program itself, compiled to WebAssembly, with its files in memory. It works on one
// call at a time; whoever wants it to stop ends the worker.

const FOLDERS = {work: "/work", preview: "/preview"};
const REPORT = "/report.json";

let program;
let line = () => {}; // takes a line of standard output
let errors = [];

const pathOf = (name) => (name.startsWith("preview:") ? `${FOLDERS.preview}/${name.slice(8)}` : `${FOLDERS.work}/${name}`);

async function start(compiled, script) {
  const {default: createProgram} = await import(script);
  const instantiateWasm = (imports, receive) => {
    WebAssembly.instantiate(compiled, imports).then(receive);
    return {};
  };
  program = await createProgram({
    instantiateWasm,
    print: (text) => line(text),
    printErr: (text) => errors.push(text),
    noExitRuntime: true,
  });
  for (const folder of Object.values(FOLDERS)) program.FS.mkdir(folder);
}

/** What a function of bind_program.cpp returns: its JSON, with "bytes". */
function answerOf(name, types, values) {
  const answer = program.ccall(`csrbf_${name}`, "number", types, values) >>> 0;
  try {
    const {arrays = [], error, ...result} = JSON.parse(program.UTF8ToString(program._csrbf_text(answer)));
    if (error !== undefined) throw new Error(error);
    for (const {name, address, count} of arrays) result[name] = program.HEAPU8.slice(address, address + count);
    return result;
  } finally {
    program._csrbf_release(answer);
  }
}

/** The files in a folder and in those below it, by their paths from there, with what changes when they are written. */
function snapshot(folder, below = "", found = new Map()) {
  for (const entry of program.FS.readdir(`${folder}/${below}`)) {
    if (entry === "." || entry === "..") continue;
    const name = below + entry;
    const {mode, ino, mtime, size} = program.FS.stat(`${folder}/${name}`);
    if (program.FS.isDir(mode)) snapshot(folder, `${name}/`, found);
    else found.set(name, `${ino} ${mtime.getTime()} ${size}`);
  }
  return found;
}

/** The program writes the form of progress that 3D Slicer reads: stages, and parts of them that are done. */
function progressReader(output, progress) {
  let stage = "";
  return (text) => {
    const element = /^<(filter-[a-z]+)>(.*)<\/\1>$/.exec(text);
    if (element && element[1] === "filter-name") progress((stage = element[2]), 0);
    else if (element && element[1] === "filter-progress") progress(stage, Number(element[2]));
    else if (!/^<\/?filter-/.test(text)) output.push(text);
  };
}

function failure() {
  const said = errors.filter((text) => !text.includes(": warning: ")).join("\n");
  return said.replace(/^csrbf[^:]*: /, "") || "the command ended without a message";
}

/** Arguments that name files, with the names of coarse copies. */
function coarse(args, names) {
  return args.map((arg) => {
    const name = names.find((each) => arg === each || arg.endsWith(`:${each}`));
    if (!name) return arg;
    const copy = answerOf("coarse", ["string", "string"], [pathOf(name), FOLDERS.preview]).name;
    return arg.slice(0, arg.length - name.length) + copy;
  });
}

function run({command, args, preview, names}, progress) {
  const folder = preview ? FOLDERS.preview : FOLDERS.work;
  const words = preview ? coarse(args, names) : args;
  const before = snapshot(folder);
  const output = [];
  errors = [];
  line = progressReader(output, progress);
  const begin = performance.now();
  const all = JSON.stringify([command, ...words, "--job", REPORT]);
  const status = program.ccall("csrbf_run", "number", ["string", "string"], [folder, all]);
  const result = {status, seconds: (performance.now() - begin) / 1000};
  if (status !== 0) return {...result, error: failure()};
  result.summary = `${output.join("\n")}\n`;
  result.report = JSON.parse(program.FS.readFile(REPORT, {encoding: "utf8"}));
  result.written = [];
  for (const [name, state] of snapshot(folder)) {
    if (before.get(name) === state) continue;
    const item = preview ? `preview:${name}` : name;
    result.written.push({name: item, bytes: program.FS.readFile(`${folder}/${name}`), ...describe(item)});
  }
  return result;
}

const describe = (name) => answerOf("describe", ["string"], [pathOf(name)]);

const CALLS = {
  start: ({compiled, script}) => start(compiled, script),
  usage() {
    const output = [];
    line = (text) => output.push(text);
    program.ccall("csrbf_run", "number", ["string", "string"], ["/", '["--print-usage"]']);
    return JSON.parse(output.join("\n"));
  },
  put({name, bytes}) {
    const path = pathOf(name);
    program.FS.mkdirTree(path.slice(0, path.lastIndexOf("/")));
    program.FS.writeFile(path, bytes, {canOwn: true});
  },
  remove({name}) {
    const {exists} = program.FS.analyzePath(pathOf(name));
    if (exists) program.FS.unlink(pathOf(name));
  },
  describe: ({name}) => describe(name),
  look: ({name, most}) => answerOf("look", ["string", "number"], [pathOf(name), most]).bytes.buffer,
  slice: ({name, axis, index, frame}) => answerOf("slice", ["string", "number", "number", "number"], [pathOf(name), axis, index, frame]).bytes.buffer,
  run,
};

const buffersOf = (result) => {
  if (result instanceof ArrayBuffer) return [result];
  return (result?.written || []).map(({bytes}) => bytes.buffer);
};

self.onmessage = async ({data: {id, call, ...given}}) => {
  try {
    const result = await CALLS[call](given, (stage, part) => self.postMessage({id, progress: [stage, part]}));
    self.postMessage({id, result}, buffersOf(result));
  } catch (error) {
    self.postMessage({id, error: error.message || String(error)});
  }
};
