// What the page shows of files and results: pictures in space, slices and reports.

import {View} from "csrbf-view";
import {decodeNpy, pictureOf, pictureOfColumns} from "../look.js";
import {Seeds} from "../slices/seeds.js";
import {Slices} from "../slices/slices.js";
import {svgLines} from "../slices/voxels.js";
import {counted} from "../ticks.js";
import {placesOf} from "./columns.js";
import {landscape} from "./landscape.js";
import {isWhole} from "./page.js";
import {showReport} from "./report.js";
import {contourFiles, frameReader, framesOf, labelFiles} from "./series.js";

const GRID = 96; // values of a function along each axis of a landscape

/** What a look is of, in words. */
export function describe(look) {
  switch (look.kind) {
    case "points": return counted(look.total, "point");
    case "mesh": return `${counted(look.total, "vertex", "vertices")}, ${counted(look.triangles.length / 3, "triangle")}`;
    case "table": return `${counted(look.total, "row")}, ${counted(look.columns.length, "column")}`;
    case "image": return `${look.size.slice(0, 2).join(" × ")} pixels`;
    case "volume": return `${look.size.join(" × ")} voxels`;
    default: return look.kind === "surface" ? "model of a surface" : "model of a function";
  }
}

const TAB_OF = {points: "space", mesh: "space", table: "space", image: "slices", volume: "slices"};

export class Stage {
  #view;

  /**
   * @param {import("./page.js").Page} page
   * @param {import("./files.js").Files} files
   * @param {{painted: () => void, drawing: (on: boolean) => void}} on seeds were painted; the program draws
   */
  constructor(page, files, on) {
    Object.assign(this, {page, files, on, engine: files.engine});
    this.slices = new Slices(page.panes.slices, {painted: () => on.painted(), free: isWhole});
    this.entry = null; // of the history, whose result is shown
    this.seeds = new Map(); // painted on images, by their names
    this.holes = new Map(); // likewise
  }

  /** The picture in space, made when it is first needed: it is what needs WebGL. */
  get view() {
    return (this.#view ??= new View(this.page.panes.space, {free: isWhole, name: "csrbf"}));
  }

  /** The axis that points upwards in the picture in space. */
  get up() {
    return this.#view ? this.#view.orbit.up : "z";
  }

  /** A file alone. `roles` of the columns of a table; `command`: what is chosen for the file. */
  async showItem(item, look, {roles, command}) {
    this.entry = null;
    if (look.kind in TAB_OF) this.page.offer(TAB_OF[look.kind]);
    await this.showInput(item, look, {roles, command});
  }

  /** A file in place of what a command made of it, with the same camera. */
  async showBefore(item, look, {roles, command}) {
    if (!(look.kind in TAB_OF)) return;
    this.page.showTab(TAB_OF[look.kind]);
    await this.showInput(item, look, {roles, command, keep: true, paintable: command === "segment" || command === "inpaint"});
  }

  async showInput(item, look, {roles, command, keep = false, paintable = true}) {
    switch (look.kind) {
      case "points":
      case "mesh":
        this.view.name = item.name;
        return this.view.show(pictureOf({[look.kind]: look}), {keep});
      case "table":
        return this.showTable(look, roles);
      case "image":
      case "volume":
        return command === "track" ? this.showFrames(item, look) : this.showImage(item.name, look, {keep, paintable, seeds: this.seedsOf(item.name, command)});
      default:
        return this.showModel(item.name, look.kind);
    }
  }

  /** Columns in the order of their roles span the picture; the value goes upwards. */
  showTable({columns}, roles) {
    const of = (role) => placesOf(columns, roles, role).map((i) => columns[i]);
    const axes = [...of("coordinate"), ...of("value")];
    const zero = {name: "", type: "float", values: new Float32Array(columns[0].values.length), range: [0, 0]};
    while (axes.length < 3) axes.splice(axes.length === 2 ? 1 : 0, 0, zero);
    this.view.show(pictureOfColumns(columns, axes.slice(0, 3)));
    const [value] = of("value");
    const scale = this.view.picture.scales.findIndex(({pointValues}) => value && pointValues === value.values);
    if (scale >= 0) this.view.set({color: String(scale)});
  }

  /** Whether seeds can be painted on what is shown. */
  get paints() {
    return this.page.tab === "slices" && this.slices.paintable;
  }

  /** What is painted on an image for a command, kept while others are looked at: seeds, or holes for inpaint. */
  seedsOf(name, command) {
    const painted = command === "inpaint" ? this.holes : this.seeds;
    if (!painted.has(name)) painted.set(name, new Seeds(painted === this.holes));
    return painted.get(name);
  }

  /** Slices of the file of that name; `more`: as Slices.show takes it. */
  showImage(name, look, more = {}) {
    this.page.nameTab("slices", look.kind === "volume" ? "Slices" : "Image");
    return this.slices.show(look, (...place) => this.engine.slice(name, ...place), {name, seeds: this.seedsOf(name), ...more});
  }

  /** An image with labels on it. */
  async showLabels(image, look, labels, more = {}) {
    const labelsLook = await this.engine.look(labels);
    await this.showImage(image, look, {keep: true, labels: (...place) => this.engine.slice(labels, ...place), labelsLook, name: labels, ...more});
  }

  /** The frames of a series, with the labels of each where they are known. */
  async showFrames(item, look, labels = [], contours = []) {
    const frames = framesOf(item, this.files.items, look);
    const known = labels.length > 0;
    this.page.nameTab("slices", "Frames");
    await this.slices.show(frames.look, frameReader(frames, this.engine), {
      name: item.name,
      frames: frames.count,
      keep: known,
      paintable: false,
      labels: known ? (axis, index, frame) => this.engine.slice(labels[frame], axis, index) : null,
      labelsLook: known ? await this.engine.look(labels[0]) : null,
      contours: contours.length > 0 ? (frame) => this.contour(contours[frame], frames.look) : null,
    });
    await this.slices.goToContour();
  }

  /** What is drawn of a contour in a file: a mesh in space, or lines. */
  async contour(name, look) {
    if (look.kind === "volume") {
      const mesh = await this.engine.look(name);
      return mesh.kind === "mesh" ? {contour: mesh} : {}; // nothing may be inside
    }
    return {lines: svgLines(await (await this.engine.download(name)).text(), look)};
  }

  /** A model, drawn by what the program makes of it. */
  async showModel(name, kind) {
    this.on.drawing(true);
    try {
      if (kind === "surface") {
        const made = await this.preview("polygonize", [name, "-o", "shown.ply"]);
        this.page.offer("space");
        this.view.show(pictureOf({mesh: await this.engine.look(made)}));
      } else if (!(await this.showFunction(name)))
        throw new Error("A function of more than three variables is drawn in the report of fit; evaluate writes its values.");
    } finally {
      this.on.drawing(false);
    }
  }

  /** Runs a command for what it writes only: the name of that. */
  async preview(command, args) {
    return (await this.engine.run({command, args, preview: true})).items[0].name;
  }

  /** A function of two variables is a landscape, one of three a volume; others are not shown: false. */
  async showFunction(name, {keep = false} = {}) {
    const {report: {result: info}} = await this.engine.run({command: "info", args: [name], preview: true});
    if (info.dimension === 2) {
      const made = await this.preview("evaluate", [name, "-o", "shown.npy", "--grid", `${GRID},${GRID}`]);
      const grid = decodeNpy(await (await this.engine.download(made)).arrayBuffer());
      this.page.offer("space");
      this.view.show(landscape(grid, info), {keep});
    } else if (info.dimension === 3) {
      const made = await this.preview("evaluate", [name, "-o", "shown.mha", "--grid", "64,64,64"]);
      const look = await this.engine.look(made);
      this.page.offer("slices");
      await this.showImage(made, look, {name, keep, paintable: false});
    } else return false;
    return true;
  }

  /** What a command made on coarse inputs: the file `made`. */
  async showPreview(command, item, made) {
    const look = await this.files.look(item.name);
    if (command === "reconstruct" || command === "polygonize") {
      const mesh = await this.engine.look(made);
      const points = look.kind === "points" ? look : null;
      this.page.offer("space");
      this.view.show(pictureOf({mesh, points}, points && {low: Array.from(points.low), high: Array.from(points.high)}), {keep: true});
    } else if (command === "fit") {
      await this.showFunction(made.replace("preview:", ""), {keep: true});
    } else if (command === "segment") {
      this.page.offer("slices", ...(this.entry ? ["report"] : []));
      await this.showLabels(item.name, look, made);
    } else if (command === "inpaint") {
      // The coarse image has the unit of the one that it stands for.
      const {unit, patient, kind, spacing} = look;
      const coarse = {...(await this.engine.look(made)), patient, unit: unit || (kind === "image" && spacing[0] === 1 ? "pixels" : undefined)};
      await this.showImage(made, coarse, {name: item.name, paintable: false});
    }
  }

  /** The result of a command. */
  async showEntry(entry, keep) {
    const isOther = !this.entry || this.entry.command !== entry.command;
    this.entry = entry;
    const {command, item, made, report} = entry;
    const pictures = report ? report.pictures : [];
    const sliced = ["segment", "track", "inpaint", "render"].includes(command);
    const inSpace = pictures.length > 0 || ["polygonize", "curvature", "estimate-normals", "combine"].includes(command);
    const tabs = [...(sliced ? ["slices"] : []), ...(inSpace ? ["space"] : []), ...(report ? ["report"] : [])];
    if (tabs.length > 0) this.page.offer(...tabs);
    if (tabs.length > 0 && isOther) this.page.showTab(tabs[0]);
    const first = made.items.length > 0 ? made.items[0].name : "";
    if (pictures.length > 0) {
      this.view.name = item.name;
      this.view.show(pictures[0], {keep});
    } else if (command === "combine") {
      await this.showModel(first, "surface");
      this.page.offer(...tabs);
    } else if (inSpace) {
      const look = await this.files.look(first);
      this.view.show(pictureOf({[look.kind]: look}), {keep});
    }
    if (command === "segment") await this.showSegments(entry);
    else if (command === "track") await this.showFrames(item, await this.files.look(item.name), labelFiles(made.items), contourFiles(made.items));
    else if (sliced) await this.showImage(first, await this.files.look(first), {keep: command === "inpaint", paintable: false});
    if (report) showReport(this.page.panes.report, report);
  }

  // Labels with their contour: the mesh of a volume, the lines of an image.
  async showSegments({item, made}) {
    const named = (pattern) => (made.items.find(({name}) => pattern.test(name)) || {}).name;
    const look = await this.files.look(item.name);
    const drawn = named(/-contour.*\.(svg|ply)$/);
    await this.showLabels(item.name, look, named(/-labels.*(?<!\.html)$/), drawn ? await this.contour(drawn, look) : {});
    await this.slices.goToContour();
  }
}
