// Frames of track: several images in the order of their names, an image with a time axis, or one whose third axis is time.

const pattern = (name) => name.replace(/\d+/g, "#");

/** The images that belong to the same series as `item`, in the order of the numbers in their names. */
export function seriesOf(item, items) {
  const belongs = (other) => other.kind === item.kind && other.made === item.made && !other.name.includes("/") && pattern(other.name) === pattern(item.name);
  return items.filter(belongs).sort((a, b) => a.name.localeCompare(b.name, "en", {numeric: true}));
}

/** Whether these files, opened together, are most likely a series. */
export function isSeries(items) {
  return items.length > 2 && items.every(({kind, name}) => (kind === "image" || kind === "volume") && pattern(name) === pattern(items[0].name));
}

/** What of an item is a frame: names of files, or frames of one; flags that track needs for it. */
export function framesOf(item, items, look) {
  const files = seriesOf(item, items).map(({name}) => name);
  if (files.length > 1) return {files, count: files.length, flags: [], look};
  const inFile = (look && look.frames) || 1;
  if (inFile > 1 || item.kind === "image") return {files: [item.name], count: inFile, flags: [], look};
  const [width, height, count] = look ? look.size : [1, 1, 1];
  return {files: [item.name], count, flags: [["--slices-are-frames", true]], look: {...look, kind: "image", size: [width, height, 1]}};
}

/** Reads slices of frames: (axis, index, frame) => slice. */
export function frameReader({files, flags}, engine) {
  if (files.length > 1) return (axis, index, frame) => engine.slice(files[frame], axis, index);
  if (flags.length > 0) return (axis, index, frame) => engine.slice(files[0], 2, frame);
  return (axis, index, frame) => engine.slice(files[0], axis, index, frame);
}

/** What contours of such frames are written to. */
export const contourExtension = ({kind}) => (kind === "volume" ? "ply" : "svg");

/** The contours of track among what it wrote, frame by frame. */
export function contourFiles(items) {
  return items.map(({name}) => name).filter((name) => /\/contours_\d+\./.test(name)).sort();
}

/** The label images of track among what it wrote, frame by frame. */
export function labelFiles(items) {
  return items.map(({name}) => name).filter((name) => /\/labels_\d+\./.test(name)).sort();
}
