// Seeds painted on an image: labels by voxel, "x,y,z". Strokes can be undone.

import {physical, voxelOf} from "./voxels.js";

export class Seeds extends Map {
  #earlier = [];
  #later = [];

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
