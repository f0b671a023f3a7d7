// What the page knows about commands beyond their own definitions: which ones suit which files, which flags matter most
// and which range a slider has, how results are named. Names, values and meanings of flags come from the program.

/** Commands for each kind of item, the usual one first. */
export const COMMANDS = {
  points: ["reconstruct", "fit", "estimate-normals", "info"],
  mesh: ["render", "compare", "reconstruct", "info"],
  table: ["fit", "reconstruct", "info"],
  image: ["segment", "track", "inpaint", "compare", "info"],
  volume: ["segment", "track", "inpaint", "compare", "info"],
  function: ["evaluate", "polygonize", "info"],
  surface: ["polygonize", "curvature", "combine", "render", "info"],
  other: [],
};

/** Operations of combine. */
export const OPERATIONS = ["union", "intersection", "difference", "blend", "complement"];

/** Kinds of the other file of a command with two, combine or compare. */
export const COMPANIONS = {surface: ["surface"], mesh: ["mesh", "points"], image: ["image"], volume: ["volume"]};

/** Flags shown at once; the others are folded. */
export const MAIN = {
  reconstruct: ["--smoothing", "--resolution", "--tolerance", "--sharp", "--trim", "--normals", "--method"],
  "estimate-normals": ["--neighbors", "--orient"],
  polygonize: ["--resolution", "--level", "--method"],
  render: ["--view", "--up", "--size", "--color"],
  curvature: ["--resolution"],
  combine: ["--radius", "--sharpness", "--blending"],
  fit: ["--coordinates", "--values", "--smoothing", "--method", "--kernel", "--tolerance", "--loss"],
  evaluate: ["--grid", "--bounds", "--gradient", "--standard-deviation"],
  inpaint: ["--mask", "--missing", "--smoothing", "--method"],
  track: ["--regions", "--smoothness", "--mode", "--init", "--sweeps", "--persistence", "--motion"],
  segment: ["--regions", "--smoothness", "--energy", "--center-spacing", "--mode", "--init", "--mask", "--objects", "--min-size"],
};

/** Sliders: from, to, and whether they step by factors. */
export const SLIDERS = {
  "--smoothing": {lo: 1e-6, hi: 1e2, log: true, start: 1e-2},
  "--resolution": {lo: 16, hi: 512, log: true, whole: true, start: 96},
  "--tolerance": {lo: 1e-5, hi: 1e-1, log: true, start: 1e-3},
  "--trim": {lo: 1, hi: 20, step: 0.5, start: 4},
  "--level": {lo: -1, hi: 1, step: 0.01, start: 0},
  "--radius": {lo: 1e-3, hi: 1, log: true, start: 0.05},
  "--sharpness": {lo: 1, hi: 10, step: 0.5, start: 3},
  "--regions": {lo: 2, hi: 8, step: 1, whole: true, start: 3},
  "--smoothness": {lo: 0, hi: 20, step: 0.5, start: 2},
  "--center-spacing": {lo: 1, hi: 16, step: 0.5, start: 4},
  "--min-size": {lo: 1, hi: 500, log: true, whole: true, start: 10},
  "--neighbors": {lo: 6, hi: 60, step: 1, whole: true, start: 12},
  "--degree": {lo: 0, hi: 8, step: 1, whole: true, start: 1},
};

/** Values that flags have at first, where the command needs one. */
export const FIRST = {evaluate: [["--grid", "100"]]};

/** Flags that the page sets itself. */
export const HIDDEN = new Set(["--output", "--report", "--model", "--contour", "--preview", "--seeds", "--table", "--refine", "--tile-folder",
  "--tile-share", "--slices-are-frames", "--help", "--version"]);

/** Flags whose value is a file of the studio; which kinds may be chosen. */
export const FILES = {"--mask": ["image", "volume"], "--like": ["image", "volume"], "--points": ["table", "points"]};

/** Commands that are quick on coarse inputs, and are run on these while a slider moves. */
export const PREVIEWED = new Set(["reconstruct", "fit", "segment", "inpaint", "polygonize"]);

const stem = (name) => name.replace(/^preview:/, "").replace(/(\.[a-z]+)?\.gz$|\.[^.]+$/i, "");
const WRITTEN_IMAGES = [".png", ".pgm", ".tif", ".tiff", ".nii", ".nii.gz", ".nrrd", ".mha", ".npy", ".vti"];
/** The extension of an image as it can be written. */
export const imageExtension = (name) => WRITTEN_IMAGES.find((extension) => name.toLowerCase().endsWith(extension)) || ".nii.gz";

/**
 * Files that a command writes, as flags.
 * @param {string} command @param {{name: string, kind: string}} item what it works on
 * @param {(name: string) => string} free makes a name unused
 */
export function outputsOf(command, item, free) {
  // Of frames the name without their numbers.
  const base = command === "track" ? stem(item.name).replace(/[-_ ]?\d+$/, "") || stem(item.name) : stem(item.name);
  const surface = {points: "-surface", table: "-surface"}[item.kind] || "";
  const outputs = {
    reconstruct: [["-o", `${base}${surface || "-surface"}.ply`], ["--model", `${base}.csrbf`]],
    "estimate-normals": [["-o", `${base}-normals.ply`]],
    polygonize: [["-o", `${base}-mesh.ply`]],
    render: [["-o", `${base}.png`]],
    curvature: [["-o", `${base}-curvature.ply`], ["--ridges", `${base}-ridges.ply`]],
    combine: [["-o", `${base}-combined.csrbf`]],
    fit: [["-o", `${base}.csrbf`]],
    evaluate: [["-o", `${base}-values.npy`]],
    inpaint: [["-o", `${base}-filled${imageExtension(item.name)}`]],
    segment: [
      ["-o", `${base}-labels${imageExtension(item.name)}`],
      ["--contour", item.kind === "volume" ? `${base}-contour.ply` : `${base}-contour.svg`],
    ],
    track: [["-o", `${base}-track`]],
    compare: [],
    info: [],
  }[command];
  const all = [...(outputs || []), ["--report", `${base}-${command}.html`]];
  return all.map(([flag, name]) => [flag, free(name)]);
}

/** A name that is not taken: with a number where it is. */
export function unused(name, taken) {
  const dot = name.includes(".") ? name.indexOf(".") : name.length;
  const [first, rest] = [name.slice(0, dot), name.slice(dot)];
  let result = name;
  for (let i = 2; taken.has(result); ++i) result = `${first}-${i}${rest}`;
  return result;
}

/** The file for what is painted on an image: of no other image, and none that was there before. */
export function seedsFile({name, kind}, items, command) {
  const isShared = items.some((other) => other.name !== name && other.kind === kind && stem(other.name) === stem(name));
  const given = new Set(items.filter(({made}) => !made).map((item) => item.name));
  return unused(`${isShared ? name : stem(name)}${command === "inpaint" ? "-holes.nrrd" : "-seeds.csv"}`, given);
}

const PLAIN = /^[\w./:,=+@%-]+$/;

/** A word of a command line, quoted where a shell needs it. */
export const shellWord = (word) => (PLAIN.test(word) ? word : `'${word.replace(/'/g, "'\\''")}'`);

export const commandLine = (command, args) => ["csrbf", command, ...args].map(shellWord).join(" ");
