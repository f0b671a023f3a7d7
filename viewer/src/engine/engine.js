// What does the work behind the studio's page: the *engine*. The page knows nothing but this interface. There are two:
// `native` (native.js) asks the program `csrbf studio` over HTTP; another one may run the library itself in a
// worker. An engine is a plain object with the methods of Engine; checkEngine() says what one lacks.
//
// An engine keeps *items*: files by name, those that were opened and those that commands wrote. A command of the engine
// is the program's command of that name: it takes the same arguments and flags and reads and writes items instead of
// files. So what the page shows as command line is what is run.

/**
 * A file that the engine keeps.
 * @typedef {object} Item
 * @property {string} name as on the command line: "scan.ply"; unique
 * @property {Kind} kind what is in it
 * @property {number} bytes its size
 * @property {number} [written] when, in milliseconds: another number for another content
 * @property {boolean} made whether a command wrote it (else it was opened)
 * @property {string} [problem] why it cannot be read; its kind is then "other"
 */

/**
 * points: places in space, perhaps with normals and values; also those of a table with three columns or more.
 * mesh: triangles. table: rows of numbers that are not places (two columns, or names other than x, y, z).
 * image: one slice of numbers. volume: several slices. function: a model of `fit` or `segment`.
 * surface: a model of `reconstruct` or `combine`. other: anything else, to download only.
 * @typedef {"points"|"mesh"|"table"|"image"|"volume"|"function"|"surface"|"other"} Kind
 */

/**
 * A flag of a command, as the program declares it (`csrbf --print-usage` prints all of them as JSON).
 * @typedef {object} Flag
 * @property {string} name with its dashes: "--smoothing"
 * @property {string} value form of its value: "auto|none|L", "N", "FILE"; empty: it takes none
 * @property {string[]} words values that are literal words: auto and none above
 * @property {boolean} onlyWords it takes nothing else
 * @property {string} lowest,highest bounds of a number, or empty
 * @property {boolean} common one that every command has
 * @property {boolean} required
 * @property {string} what what it does
 * @property {string} shownDefault what happens without it, or empty
 */

/**
 * @typedef {object} Command
 * @property {string} name "reconstruct"
 * @property {string} what one line
 * @property {string} example a command line
 * @property {{name: string, what: string}[]} arguments positional ones, in order
 * @property {Flag[]} flags
 */

/**
 * What can be drawn of an item, in typed arrays. Which members there are depends on `kind`.
 * @typedef {object} Look
 * @property {Kind} kind of these data: points, mesh, table, image or volume
 * @property {number} total how many points, vertices or rows the item has; `positions` may hold fewer, evenly chosen
 * @property {Float64Array} [low],[high] box of the item (points, mesh): positions are relative to its centre
 * @property {Float32Array} [positions] x, y, z of points or vertices, minus the centre of the box
 * @property {Float32Array} [normals] as many; or absent
 * @property {Uint32Array} [triangles] three vertices each (mesh)
 * @property {Column[]} columns values of points, vertices or rows: properties of the file, columns of a table
 * @property {string} [separator] of the cells of a table: "," ";" tab, or " " for any blanks and tabs
 * @property {number} [firstLine] of its rows, from 1
 * @property {boolean} [namesInComment] the line before has the names behind #
 * @property {number[]} [size] voxels along x, y, z (image, volume)
 * @property {number[]} [spacing],[origin] of the voxels; centre of the first
 * @property {number[]} [direction] nine numbers, by rows: the axes of the voxels
 * @property {number} [components] values per voxel
 * @property {number} [frames] of an image with a time axis
 * @property {string} [type] "uint8", "float32", ...
 * @property {number[]} [range] lowest and highest value
 * @property {string} [unit] of lengths, where the file says: "mm"
 * @property {number[]} [patient] of images in patient space: the direction in left, posterior, superior, by rows
 */

/** @typedef {{name: string, type: string, values: Float32Array, range: number[]}} Column */

/**
 * One slice of an image or volume.
 * @typedef {object} Slice
 * @property {number} width,height along the two other axes, the lower one first: x and y across z
 * @property {Float32Array} values row by row, `components` for each voxel, first row at the lowest place
 * @property {number} components
 */

/**
 * A run of a command.
 * @typedef {object} Request
 * @property {string} command
 * @property {string[]} args what follows on the command line: ["scan.ply", "-o", "mesh.ply", "--smoothing", "none"]
 * @property {boolean} [preview] on coarse inputs (a few thousand points, some ten thousand voxels) instead of the items:
 *   fast, to be shown while somebody turns a knob. Its results are items, too, but files() does not list them.
 */

/**
 * @typedef {object} Result
 * @property {Item[]} items what the command wrote
 * @property {string} summary the lines that the program prints
 * @property {object} report the JSON of --report; `report.warnings` is a list of sentences
 * @property {string} [page] name of the item with the report as a page, when args asked for one (--report X.html)
 * @property {number} seconds from the request to the result
 */

/**
 * @typedef {object} Engine
 * @property {"native"|"wasm"} name
 * @property {string} version of csrbf
 * @property {number} largest bytes of a file that can be opened
 * @property {(() => Promise<Command[]>)} commands those that it can run, from the program's own definitions
 * @property {(() => Promise<Item[]>)} files all items, in the order in which they came
 * @property {((file: File|Blob, name: string, progress?: (part: number) => void) => Promise<Item>)} open keeps a file;
 *   changes the name when it is taken
 * @property {((name: string, most?: number) => Promise<Look>)} look at most `most` points, evenly chosen (default 2e6)
 * @property {((name: string, axis: 0|1|2, index: number, frame?: number) => Promise<Slice>)} slice
 * @property {((request: Request, progress?: (stage: string, part: number) => void, signal?: AbortSignal) =>
 *   Promise<Result>)} run throws EngineError with what the program says; after `signal` an AbortError. One run at a
 *   time: a second one waits, but a preview does not wait for a run that is not one.
 * @property {((name: string) => Promise<Blob>)} download
 * @property {((name: string) => Promise<void>)} remove forgets an item; files that the user had before are kept
 * @property {((name: string, text: string) => Promise<Item>)} write an item of text or bytes that the page makes, such
 *   as painted seeds; replaces one that it made before
 */

/** What the program says when it fails, and its exit status: 1 no result, 2 wrong usage or input. */
export class EngineError extends Error {
  constructor(message, status = 1) {
    super(message);
    this.name = "EngineError";
    this.status = status;
  }
}

const METHODS = ["commands", "files", "open", "look", "slice", "run", "download", "remove", "write"];

/** Throws a TypeError that names what an engine lacks. */
export function checkEngine(engine) {
  const missing = METHODS.filter((name) => typeof engine[name] !== "function");
  if (missing.length > 0) throw new TypeError(`an engine needs ${missing.join(", ")}`);
  return engine;
}
