// What is painted on an image: brushes by voxel, "x,y,z". Seeds of labels for `segment`, or holes that `inpaint` fills.
// Strokes can be undone.

import {physical, voxelOf} from "./voxels.js";

export const HOLE = 2; // the brush that paints holes

export class Seeds extends Map {
  #earlier = [];
  #later = [];

  /** @param {boolean} areHoles in place of seeds */
  constructor(areHoles = false) {
    super();
    this.areHoles = areHoles;
  }

  /** Begins a stroke, which step(-1) takes back. */
  begin() {
    this.#earlier.push([...this]);
    this.#later = [];
  }

  canStep(by) {
    return (by < 0 ? this.#earlier : this.#later).length > 0;
  }

  /** Takes a stroke back (-1), or makes it again (1). */
  step(by) {
    const [from, to] = by < 0 ? [this.#earlier, this.#later] : [this.#later, this.#earlier];
    to.push([...this]);
    this.clear();
    for (const [voxel, label] of from.pop()) this.set(voxel, label);
  }

  /** From now on no stroke can be taken back. */
  settle() {
    this.#earlier = [];
    this.#later = [];
  }
}

/** Rows "x,y[,z],label" of painted voxels in physical coordinates, as --seeds takes them. */
export function seedTable(seeds, look) {
  const dimension = look.kind === "volume" ? 3 : 2;
  const rows = [dimension === 3 ? "x,y,z,label" : "x,y,label"];
  for (const [key, label] of seeds) {
    const voxel = key.split(",").map(Number);
    rows.push([...physical(voxel, look).slice(0, dimension).map((value) => Number(value.toPrecision(9))), label].join(","));
  }
  return rows.join("\n") + "\n";
}

/** The seeds of such a table that are in the image. */
export function seedsOfTable(text, look) {
  const seeds = new Seeds();
  for (const line of text.trim().split("\n").slice(1)) {
    const numbers = line.split(",").map(Number);
    const label = numbers.pop();
    const voxel = voxelOf(look.kind === "volume" ? numbers : [...numbers, look.origin[2]], look);
    if (Number.isInteger(label) && voxel.every((at, a) => at >= 0 && at < look.size[a])) seeds.set(voxel.join(","), label);
  }
  return seeds;
}

const maskHead = ({kind, size}) => {
  const sizes = kind === "volume" ? size : size.slice(0, 2);
  return `NRRD0004\ntype: uint8\ndimension: ${sizes.length}\nsizes: ${sizes.join(" ")}\nencoding: raw\n\n`;
};
const placeIn = ([nx, ny]) => (key) => {
  const [x, y, z] = key.split(",").map(Number);
  return (z * ny + y) * nx + x;
};

/** Painted holes as an image, 1 where they are, as --mask takes it. */
export function holesMask(holes, look) {
  const head = new TextEncoder().encode(maskHead(look));
  const bytes = new Uint8Array(head.length + look.size.reduce((product, n) => product * n));
  bytes.set(head);
  for (const place of [...holes.keys()].map(placeIn(look.size))) bytes[head.length + place] = 1;
  return bytes;
}

/** The holes of such an image; none where it is of another size. @param {Uint8Array} bytes */
export function holesOfMask(bytes, look) {
  const holes = new Seeds(true);
  const head = maskHead(look);
  if (new TextDecoder().decode(bytes.subarray(0, head.length)) !== head) return holes;
  const [nx, ny] = look.size;
  bytes.subarray(head.length).forEach((value, i) => value && holes.set([i % nx, Math.floor(i / nx) % ny, Math.floor(i / (nx * ny))].join(","), HOLE));
  return holes;
}
