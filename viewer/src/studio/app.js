// The studio: state, and what happens when something changes.

import {copy, element, icon, save} from "../dom.js";
import {decodeNpy, pictureOf, pictureOfColumns} from "../look.js";
import {Slices, svgLines} from "../slices.js";
import {bytesText, counted, readable} from "../ticks.js";
import {View} from "csrbf-view";
import {columnsChooser, roleFlags, usualRoles} from "./columns.js";
import {commandControls} from "./options.js";
import {parseReport, showReport} from "./report.js";
import {frameReader, framesOf, isSeries, labelFiles} from "./series.js";
import {commandLine, FIRST, outputsOf, PREVIEWED, pythonLines, TASKS, unused} from "./tasks.js";

const MOST_SHOWN = 400000; // points that are drawn
const OPERATIONS = ["union", "intersection", "difference", "blend", "complement"];
const COMPANIONS = {surface: ["surface"], mesh: ["mesh", "points"], image: ["image"], volume: ["volume"]}; // of combine, compare
const LONG_PREVIEW = 1500; // milliseconds after which a preview gives way to a newer one
const ICONS = {
  undo: "M6 3 3 6l3 3M3 6h6a4 4 0 0 1 0 8H6",
  redo: "M10 3l3 3-3 3M13 6H7a4 4 0 0 0 0 8h3",
  remove: "M4 4l8 8M12 4l-8 8",
  save: "M8 2v8M5 7l3 3 3-3M3 13h10",
  open: "M2 4h4l1.5 2H14v7H2z",
};
const SHAPES = {
  points: "M4 5h0M8 3h0M12 6h0M5 10h0M9 8h0M11 12h0M6 13h0",
  mesh: "M8 2 2 12h12zM5 7h6M8 12 5 7M8 12l3-5",
  table: "M2 3h12v10H2zM2 6.5h12M2 10h12M6.5 3v10",
  image: "M2 3h12v10H2zM2 11l4-4 3 3 2-2 3 3",
  volume: "M8 2l6 3v6l-6 3-6-3V5zM2 5l6 3 6-3M8 8v6",
  function: "M2 12c3 0 3-8 6-8s3 8 6 8",
  surface: "M8 2.5a5.5 5.5 0 1 0 0 11 5.5 5.5 0 1 0 0-11M2.5 8c3 2 8 2 11 0",
  other: "M4 2h6l3 3v9H4zM10 2v3h3",
};

const iconButton = (name, title, path, pressed) => {
  const button = element("button", {type: "button", name, title, className: "icon-button"}, icon(path));
  button.setAttribute("aria-label", title);
  button.addEventListener("click", pressed);
  return button;
};

export class Studio {
  constructor(body, engine) {
    this.engine = engine;
    this.items = [];
    this.values = {}; // of flags, by command
    this.looks = new Map();
    this.history = [];
    this.at = -1; // place in the history
    this.kindOfTask = null;
    this.operation = "union";
    this.build(body);
  }

  build(body) {
    this.files = element("ul", {className: "files"});
    this.chooser = element("input", {type: "file", multiple: true, hidden: true, name: "files"});
    this.chooser.addEventListener("change", () => this.openAll([...this.chooser.files]));
    this.drop = element("button", {type: "button", className: "drop", name: "open"}, icon(ICONS.open), element("span", {}, "Open or drop files"));
    this.drop.addEventListener("click", () => this.chooser.click());
    this.task = element("section", {className: "task"});
    this.result = element("section", {className: "result", hidden: true});
    this.undoButton = iconButton("undo", "Undo (Ctrl Z)", ICONS.undo, () => this.go(this.at - 1));
    this.redoButton = iconButton("redo", "Redo (Ctrl Shift Z)", ICONS.redo, () => this.go(this.at + 1));
    this.beforeButton = element("button", {type: "button", name: "before", title: "Show what was there before"}, "Before");
    this.beforeButton.addEventListener("click", () => this.showBefore(this.beforeButton.getAttribute("aria-pressed") !== "true"));
    this.title = element("div", {className: "title"});
    const tabs = [["space", "Space"], ["slices", "Slices"], ["report", "Report"]];
    this.tabs = element("div", {className: "tabs", hidden: true});
    this.tabs.setAttribute("role", "tablist");
    this.panes = {};
    for (const [name, text] of tabs) {
      const tab = element("button", {type: "button", name: `tab-${name}`, hidden: true, dataset: {tab: name}}, text);
      tab.setAttribute("role", "tab");
      tab.addEventListener("click", () => this.showTab(name));
      this.tabs.append(tab);
      this.panes[name] = element("div", {className: `pane ${name}`, hidden: true});
    }
    this.welcome = element("div", {className: "pane welcome"},
      element("h2", {}, "Drop a file, or click to open one"),
      element("p", {}, "A scan or point cloud becomes a closed surface, a table of samples a function, an image or volume is divided into regions or repaired."),
      element("p", {className: "quiet"}, "Points .ply .xyz .las .pcd · meshes .stl .obj .glb · tables .csv .npy · images .png .tif · volumes .nii.gz .nrrd .mha · models .csrbf. Nothing leaves this machine."));
    this.welcome.addEventListener("click", () => this.chooser.click());
    this.command = element("code", {className: "command-line"});
    this.python = element("pre", {className: "python", hidden: true});
    const copyCommand = element("button", {type: "button", name: "copy-command"}, "Copy");
    copyCommand.addEventListener("click", () => copy(this.command.textContent, copyCommand));
    const showPython = element("button", {type: "button", name: "python"}, "Python");
    showPython.setAttribute("aria-expanded", "false");
    showPython.addEventListener("click", () => {
      this.python.hidden = !this.python.hidden;
      showPython.setAttribute("aria-expanded", String(!this.python.hidden));
    });
    const copyPython = element("button", {type: "button", name: "copy-python"}, "Copy Python");
    copyPython.addEventListener("click", () => copy(this.python.textContent, copyPython));
    this.message = element("div", {className: "message", hidden: true});
    this.message.setAttribute("role", "status");
    this.message.addEventListener("click", () => this.say(""));
    const header = element("header", {className: "bar"}, element("h1", {}, "csrbf ", element("span", {}, "studio")), this.title,
      element("div", {className: "bar-buttons"}, this.beforeButton, this.undoButton, this.redoButton));
    const side = element("aside", {}, element("section", {}, element("h2", {}, "Files"), this.drop, this.chooser, this.files), this.task, this.result);
    const main = element("main", {}, this.tabs, element("div", {className: "panes"}, this.welcome, ...Object.values(this.panes)));
    const foot = element("footer", {}, element("div", {className: "line"}, this.command, copyCommand, showPython, copyPython), this.python);
    body.append(header, side, main, foot, this.message);
    this.listen(body);
    this.updateHistory();
  }

  listen(body) {
    for (const name of ["dragenter", "dragover"])
      body.addEventListener(name, (event) => {
        event.preventDefault();
        body.classList.add("dragging");
      });
    body.addEventListener("dragleave", (event) => {
      if (!event.relatedTarget) body.classList.remove("dragging");
    });
    body.addEventListener("drop", (event) => {
      event.preventDefault();
      body.classList.remove("dragging");
      this.openAll([...event.dataTransfer.files]);
    });
    window.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.matches("input[type=text], input[type=number]")) return;
      event.preventDefault();
      this.go(this.at + (event.shiftKey ? 1 : -1));
    });
  }

  async start() {
    [this.commands, this.items] = await Promise.all([this.engine.commands(), this.engine.files()]);
    this.commands = new Map(this.commands.map((command) => [command.name, command]));
    this.showFiles();
    const usable = this.items.filter((item) => item.kind !== "other");
    const asked = new URLSearchParams(window.location.hash.slice(1)).get("show");
    const first = usable.find((item) => item.name === asked) || usable[0];
    if (first) await this.select(first.name);
    else this.showTask();
  }

  // ---- files

  async openAll(files) {
    let last = null;
    const opened = [];
    for (const file of files) {
      try {
        this.say(`Opening ${file.name} …`);
        last = await this.engine.open(file, file.name.replace(/^[.-]+/, "").replace(/[:\\/]/g, "_"), (part) => this.say(`Opening ${file.name}: ${Math.round(100 * part)} %`));
        this.items.push(last);
        opened.push(last);
        if (last.problem) throw new Error(last.problem);
        this.say("");
      } catch (error) {
        this.complain(error);
      }
    }
    this.chooser.value = "";
    this.showFiles();
    if (!last || last.problem) return;
    if (isSeries(opened) && this.commands.has("track")) {
      [this.kindOfTask, this.task_] = [last.kind, "track"];
      last = opened[0];
    }
    await this.select(last.name);
  }

  showFiles() {
    // What track writes for each frame is shown on the stage.
    this.files.replaceChildren(...this.items.filter(({name}) => !name.includes("/")).map((item) => {
      const open = element("button", {type: "button", className: "file", title: `${item.name}: ${item.kind}, ${bytesText(item.bytes)}`, dataset: {name: item.name}},
        icon(SHAPES[item.kind] || SHAPES.other), element("span", {className: "name"}, item.name), element("span", {className: "size"}, bytesText(item.bytes)));
      if (item.name === (this.item && this.item.name)) open.setAttribute("aria-current", "true");
      open.addEventListener("click", () => (item.kind === "other" ? this.download(item.name) : this.select(item.name)));
      return element("li", {className: item.made ? "made" : ""}, open,
        iconButton("save-file", `Save ${item.name}`, ICONS.save, () => this.download(item.name)),
        iconButton("remove-file", `Remove ${item.name}`, ICONS.remove, () => this.remove(item.name)));
    }));
    const current = this.files.querySelector("[aria-current]");
    if (!current) return;
    const [row, all] = [current.getBoundingClientRect(), this.files.getBoundingClientRect()];
    this.files.scrollTop += Math.min(0, row.top - all.top) + Math.max(0, row.bottom - all.bottom);
  }

  async download(name) {
    try {
      save(await this.engine.download(name), name.replace(/^preview:/, "").replace(/\//g, "-"));
    } catch (error) {
      this.complain(error);
    }
  }

  async remove(name) {
    try {
      await this.engine.remove(name);
    } catch (error) {
      this.complain(error);
    }
    this.items = this.items.filter((item) => item.name !== name);
    this.looks.delete(name);
    const [next] = this.items.filter((item) => item.kind !== "other");
    if (this.item && this.item.name === name) {
      this.item = null;
      if (next) return this.select(next.name);
      this.title.textContent = "";
      this.result.hidden = this.tabs.hidden = true;
      this.welcome.hidden = false;
      this.showTask();
    }
    return this.showFiles();
  }

  find(name) {
    return this.items.find((item) => item.name === name);
  }

  async look(name) {
    if (!this.looks.has(name)) this.looks.set(name, await this.engine.look(name, MOST_SHOWN));
    return this.looks.get(name);
  }

  async select(name) {
    const item = (this.item = this.find(name));
    this.showFiles();
    this.roles = null;
    try {
      const look = await this.look(name);
      if (this.item !== item) return; // another one was selected since
      item.kind = look.kind;
      const {kind} = item;
      if (kind !== this.kindOfTask) this.task_ = TASKS[kind][0];
      this.kindOfTask = kind;
      this.showTitle(name, look);
      await this.showItem(item, look);
    } catch (error) {
      this.complain(error);
    }
    this.showTask();
    this.showFiles();
  }

  showTitle(name, look) {
    this.title.textContent = `${name} · ${this.describe(look)}`;
    // A reload, and links to a view, show the same file.
    if (new URLSearchParams(window.location.hash.slice(1)).get("show") !== name)
      window.history.replaceState(null, "", `#${new URLSearchParams({show: name})}`);
  }

  describe(look) {
    switch (look.kind) {
      case "points": return counted(look.total, "point");
      case "mesh": return `${counted(look.total, "vertex", "vertices")}, ${counted(look.triangles.length / 3, "triangle")}`;
      case "table": return `${counted(look.total, "row")}, ${counted(look.columns.length, "column")}`;
      case "image": return `${look.size.slice(0, 2).join(" × ")} pixels`;
      case "volume": return `${look.size.join(" × ")} voxels`;
      default: return look.kind === "surface" ? "model of a surface" : "model of a function";
    }
  }

  // ---- what the stage shows

  view() {
    if (!this.view_) this.view_ = new View(this.panes.space, {free: true, name: "csrbf"});
    return this.view_;
  }

  slices() {
    if (!this.slices_) this.slices_ = new Slices(this.panes.slices, {painted: () => this.seedsPainted()});
    return this.slices_;
  }

  /** Shows these tabs, of which the first is open. */
  offer(...names) {
    this.welcome.hidden = true;
    for (const tab of this.tabs.children) tab.hidden = !names.includes(tab.dataset.tab);
    this.tabs.hidden = names.length < 2;
    if (!names.includes(this.tab)) this.showTab(names[0]);
  }

  showTab(name) {
    this.tab = name;
    for (const [pane, node] of Object.entries(this.panes)) node.hidden = pane !== name;
    for (const tab of this.tabs.children) tab.setAttribute("aria-selected", String(tab.dataset.tab === name));
  }

  async showItem(item, look) {
    this.tab = null;
    this.shownResult = null;
    this.result.hidden = true;
    switch (look.kind) {
      case "points":
      case "mesh":
        this.offer("space");
        this.view().name = item.name;
        this.view().show(pictureOf({[look.kind]: look}));
        break;
      case "table":
        this.roles = usualRoles(look.columns);
        this.showTable(look);
        break;
      case "image":
      case "volume":
        this.offer("slices");
        if (this.task_ === "track") await this.showFrames(item, look);
        else await this.slices().show(look, (...place) => this.engine.slice(item.name, ...place), {name: item.name});
        break;
      default:
        await this.showModel(item, look);
    }
  }

  /** The frames of a series, with the labels of each where they are known. */
  async showFrames(item, look, labels = []) {
    const frames = framesOf(item, this.items, look);
    this.offer("slices", ...(this.shownResult ? ["report"] : []));
    const labelsLook = labels.length > 0 ? await this.engine.look(labels[0]) : null;
    await this.slices().show(frames.look, frameReader(frames, this.engine), {
      name: item.name,
      frames: frames.count,
      keep: labels.length > 0,
      paintable: false,
      labels: labels.length > 0 ? (axis, index, frame) => this.engine.slice(labels[frame], axis, index) : null,
      labelsLook,
    });
  }

  // Columns in the order of their roles span the picture; the value goes upwards.
  showTable(look) {
    const of = (role) => look.columns.filter((_, i) => this.roles[i] === role);
    const axes = [...of("coordinate"), ...of("value")];
    this.offer("space");
    const zero = {name: "", type: "float", values: new Float32Array(look.columns[0].values.length), range: [0, 0]};
    while (axes.length < 3) axes.splice(axes.length === 2 ? 1 : 0, 0, zero);
    this.view().show(pictureOfColumns(look.columns, axes.slice(0, 3)));
    const value = look.columns.indexOf(of("value")[0]);
    const scale = this.view().picture.scales.findIndex((s) => value >= 0 && s.pointValues === look.columns[value].values);
    if (scale >= 0) this.view().set({color: String(scale)});
  }

  // Models are drawn by what the program makes of them.
  async showModel(item, look) {
    this.working(true, "Drawing");
    try {
      if (look.kind === "surface") {
        const made = await this.engine.run({command: "polygonize", args: [item.name, "-o", "shown.ply"], preview: true});
        const mesh = await this.engine.look(made.items[0].name);
        this.offer("space");
        this.view().show(pictureOf({mesh}));
      } else {
        const report = await this.engine.run({command: "info", args: [item.name], preview: true});
        await this.showFunction(item.name, report.report.result, {});
      }
    } finally {
      this.working(false);
    }
  }

  // A function of two variables is a landscape, one of three a volume.
  async showFunction(name, info, {keep = false, points = null}) {
    const dimension = info.dimension;
    if (dimension === 2) {
      const n = 96;
      const made = await this.engine.run({command: "evaluate", args: [name, "-o", "shown.npy", "--grid", `${n},${n}`], preview: true});
      const blob = await this.engine.download(made.items[0].name);
      const grid = decodeNpy(await blob.arrayBuffer());
      this.offer("space");
      this.view().show(landscape(grid, info, points), {keep});
    } else if (dimension === 3) {
      const made = await this.engine.run({command: "evaluate", args: [name, "-o", "shown.mha", "--grid", "64,64,64"], preview: true});
      const look = await this.engine.look(made.items[0].name);
      this.offer("slices");
      await this.slices().show(look, (axis, index) => this.engine.slice(made.items[0].name, axis, index), {keep, paintable: false});
    } else {
      this.complain(new Error(`A function of ${counted(dimension, "variable")} is drawn in the report of fit; evaluate writes its values.`));
    }
  }

  // ---- the task

  showTask() {
    const {item} = this;
    if (!item) {
      this.task.replaceChildren();
      this.task.hidden = true;
      this.command.textContent = "";
      return;
    }
    this.task.hidden = false;
    const names = TASKS[item.kind].filter((name) => this.commands.has(name));
    const select = element("select", {name: "command"}, ...names.map((name) => element("option", {value: name}, name)));
    select.value = this.task_;
    select.addEventListener("change", () => {
      const tracked = this.task_ === "track";
      this.task_ = select.value;
      this.showTask();
      if (tracked !== (this.task_ === "track")) this.showItem(item, this.looks.get(item.name)).catch((error) => this.complain(error));
    });
    const command = this.commands.get(this.task_);
    const values = (this.values[this.task_] = this.values[this.task_] || new Map(FIRST[this.task_]));
    const skip = new Set(this.roles && this.task_ === "fit" ? ["--coordinates", "--values", "--weights"] : []);
    const controls = commandControls(command, values, (moving) => this.changed(moving), (kinds) => this.items.filter((i) => kinds.includes(i.kind) && i.name !== item.name).map((i) => i.name), skip);
    this.runButton = element("button", {type: "button", name: "run", className: "primary"}, "Run");
    this.runButton.addEventListener("click", () => this.run());
    this.cancelButton = element("button", {type: "button", name: "cancel", hidden: true}, "Cancel");
    this.cancelButton.addEventListener("click", () => this.cancel());
    const reset = element("button", {type: "button", name: "defaults"}, "Defaults");
    reset.addEventListener("click", () => {
      this.values[this.task_] = new Map(FIRST[this.task_]);
      this.showTask();
    });
    this.progress = element("progress", {max: 1, value: 0});
    this.stageText = element("span", {className: "quiet"});
    this.progressRow = element("div", {className: "progress", hidden: true}, this.progress, this.stageText);
    this.progressRow.setAttribute("aria-live", "polite");
    this.working(false);
    this.task.replaceChildren(element("h2", {}, "Command"), element("div", {className: "flag"}, select, element("p", {className: "quiet"}, `${command.what}.`)),
      ...this.extraInputs(), this.roles && this.task_ === "fit" ? columnsChooser(this.looks.get(item.name), this.roles, () => this.rolesChanged()) : "",
      controls, element("div", {className: "run-row"}, this.runButton, this.cancelButton, reset), this.progressRow);
    this.updateCommand();
  }

  // Commands with more than one input: the operation of combine, and the other file.
  extraInputs() {
    if (this.task_ !== "combine" && this.task_ !== "compare") return [];
    const kinds = COMPANIONS[this.item.kind];
    const names = this.items.filter((item) => kinds.includes(item.kind) && item.name !== this.item.name).map((item) => item.name);
    const rows = [];
    if (this.task_ === "combine") {
      const operation = element("select", {name: "operation"}, ...OPERATIONS.map((name) => element("option", {value: name}, name)));
      operation.value = this.operation;
      operation.addEventListener("change", () => {
        this.operation = operation.value;
        this.updateCommand();
      });
      rows.push(element("div", {className: "flag"}, element("label", {}, "Operation"), element("div", {className: "value"}, operation)));
    }
    const other = element("select", {name: "other"}, ...names.map((name) => element("option", {value: name}, name)));
    if (!names.includes(this.other)) this.other = names[0];
    other.value = this.other || "";
    other.addEventListener("change", () => {
      this.other = other.value;
      this.updateCommand();
    });
    rows.push(element("div", {className: "flag"}, element("label", {}, "With"), element("div", {className: "value"}, names.length ? other : "open another file first")));
    return rows;
  }

  rolesChanged() {
    this.showTable(this.looks.get(this.item.name));
    this.updateCommand();
  }

  inputs() {
    if (this.task_ === "combine") return [this.operation, this.item.name, ...(this.operation !== "complement" && this.other ? [this.other] : [])];
    if (this.task_ === "track") return framesOf(this.item, this.items, this.looks.get(this.item.name)).files;
    if (this.task_ === "compare") return [this.item.name, ...(this.other ? [this.other] : [])];
    return [this.item.name];
  }

  /** The command as it stands: parts, and the words of the command line. */
  request() {
    const taken = new Set(this.items.map((item) => item.name.split("/")[0]));
    const outputs = outputsOf(this.task_, this.item, (name) => {
      const free = unused(name, taken);
      taken.add(free);
      return free;
    });
    const flags = [...this.values[this.task_]];
    const look = this.looks.get(this.item.name);
    const isTable = this.roles && this.task_ === "fit";
    if (isTable) flags.unshift(...roleFlags(look.columns, this.roles));
    if (this.task_ === "track") flags.unshift(...framesOf(this.item, this.items, look).flags);
    if (this.task_ === "segment" && this.hasSeeds()) flags.push(["--seeds", this.seedsName()]);
    const inputs = this.inputs();
    const words = (pairs) => pairs.flatMap(([flag, value]) => (value === true ? [flag] : [flag, String(value)]));
    const places = (role) => this.roles.flatMap((r, i) => (r === role ? [i] : []));
    const columns = isTable ? {coordinates: places("coordinate"), values: places("value"), weights: places("weight"), names: look.columns.map(({name}) => name), named: look.columns.some((c, i) => c.name !== String(i + 1))} : undefined;
    return {command: this.task_, inputs, flags, outputs, columns, args: [...inputs, ...words(outputs), ...words(flags)]};
  }

  updateCommand() {
    if (!this.item || !this.task_) return;
    const request = this.request();
    this.command.textContent = commandLine(request.command, request.args);
    this.python.textContent = pythonLines(request).join("\n");
  }

  changed(moving) {
    this.updateCommand();
    if (PREVIEWED.has(this.task_)) this.preview();
    if (!moving && this.hasRun && this.hasRun === this.task_) this.run();
  }

  hasSeeds() {
    return Boolean(this.slices_ && this.slices_.seeds.size > 0);
  }

  seedsName() {
    return `${this.item.name.replace(/\..*$/, "")}-seeds.csv`;
  }

  async seedsPainted() {
    this.updateCommand();
    if (!this.hasSeeds()) return;
    try {
      const written = await this.engine.write(this.seedsName(), this.slices_.seedText());
      if (!this.find(written.name)) this.items.push(written);
      this.showFiles();
      const labels = new Set(this.slices_.seeds.values());
      if (labels.size > 1 && this.task_ === "segment") this.preview();
    } catch (error) {
      this.complain(error);
    }
  }

  // ---- previews: the last change wins

  async preview() {
    if (this.previewing) {
      this.previewAgain = true;
      if (performance.now() - this.previewStart > LONG_PREVIEW) this.previewAbort.abort();
      return;
    }
    this.previewing = true;
    try {
      do {
        this.previewAgain = false;
        this.previewStart = performance.now();
        this.previewAbort = new AbortController();
        const request = this.request();
        const args = previewArgs(request);
        try {
          const made = await this.engine.run({command: request.command, args, preview: true}, undefined, this.previewAbort.signal);
          this.previewSeconds = (performance.now() - this.previewStart) / 1000;
          if (!this.running) await this.showPreview(request.command, made);
        } catch (error) {
          if (error.name !== "AbortError" && !this.previewAgain) this.say(error.message, true);
        }
      } while (this.previewAgain);
    } finally {
      this.previewing = false;
    }
  }

  async showPreview(command, made) {
    const {item} = this;
    const first = made.items.find((i) => !/\.html$/.test(i.name));
    if (!first) return;
    const inputLook = await this.look(item.name);
    if (command === "reconstruct" || command === "polygonize") {
      const mesh = await this.engine.look(first.name);
      const points = inputLook.kind === "points" ? inputLook : null;
      this.offer("space");
      this.view().show(pictureOf({mesh, points}, points ? this.boxOf(points) : null), {keep: true});
    } else if (command === "fit") {
      await this.showFunction(first.name.replace("preview:", ""), (await this.engine.run({command: "info", args: [first.name.replace("preview:", "")], preview: true})).report.result, {keep: true});
    } else if (command === "segment") {
      await this.showLabels(item.name, inputLook, first.name, null);
    } else if (command === "inpaint") {
      // The coarse image has the unit of the one that it stands for.
      const {unit, patient, kind, spacing} = inputLook;
      const look = {...(await this.engine.look(first.name)), patient, unit: unit || (kind === "image" && spacing[0] === 1 ? "pixels" : undefined)};
      await this.slices().show(look, (axis, index) => this.engine.slice(first.name, axis, index), {keep: false, paintable: false});
    }
    this.say(`Preview on fewer samples, ${readable(this.previewSeconds, 2)} s`);
  }

  boxOf(look) {
    return {low: Array.from(look.low), high: Array.from(look.high)};
  }

  async showLabels(image, look, labels, contour, lines = null) {
    const labelsLook = await this.engine.look(labels);
    this.offer("slices", ...(contour ? ["space"] : []), ...(this.shownResult ? ["report"] : []));
    await this.slices().show(look, (axis, index) => this.engine.slice(image, axis, index), {
      keep: true,
      labels: (axis, index) => this.engine.slice(labels, axis, index),
      labelsLook,
      contour,
      lines,
      name: labels,
    });
  }

  // ---- runs

  async run() {
    if (this.running) {
      this.runAgain = true;
      this.cancel();
      return;
    }
    const request = this.request();
    // As it stands: files and options may be others when it ends.
    const entry = {command: request.command, item: this.item, values: new Map(this.values[request.command]), roles: this.roles && [...this.roles], line: this.command.textContent, request};
    let done = false;
    this.running = new AbortController();
    this.hasRun = request.command;
    this.working(true, "");
    try {
      if (this.previewAbort) this.previewAbort.abort();
      if (request.command === "segment" && this.hasSeeds()) await this.engine.write(this.seedsName(), this.slices_.seedText());
      const start = performance.now();
      const made = await this.engine.run({command: request.command, args: request.args}, (stage, part) => this.showProgress(stage, part), this.running.signal);
      made.seconds = (performance.now() - start) / 1000;
      for (const item of made.items) if (!this.find(item.name)) this.items.push(item);
      for (const item of made.items) this.looks.delete(item.name);
      const report = made.page ? parseReport(await (await this.engine.download(made.page)).text()) : null;
      Object.assign(entry, {made, report});
      this.history.splice(this.at + 1, Infinity, entry);
      this.at = this.history.length - 1;
      this.say("");
      done = true;
      if (this.item === entry.item) await this.showEntry(entry);
    } catch (error) {
      if (error.name === "AbortError") this.say("Cancelled. Nothing half-written is left.");
      else this.complain(error);
    } finally {
      this.running = null;
      this.working(false);
      this.showFiles();
      this.updateHistory();
      this.updateCommand();
      if (done && this.item !== entry.item) await this.go(this.at);
      else if (this.runAgain) this.run();
      this.runAgain = false;
    }
  }

  cancel() {
    if (this.running) this.running.abort();
  }

  // A command runs on while other files are looked at.
  working(on, stage = "") {
    const busy = on || Boolean(this.running);
    document.body.classList.toggle("working", busy);
    if (!this.runButton) return;
    this.runButton.hidden = busy;
    this.cancelButton.hidden = !busy;
    this.progressRow.hidden = !busy;
    if (busy) this.showProgress(stage, 0);
  }

  showProgress(stage, part) {
    this.stageText.textContent = stage ? `${stage}${part > 0 ? ` ${Math.round(100 * part)} %` : " …"}` : "starting …";
    if (part > 0) this.progress.value = part;
    else this.progress.removeAttribute("value");
  }

  // ---- results

  async showEntry(entry, keep = this.shownBefore === undefined) {
    this.shownResult = entry;
    this.shownBefore = undefined;
    const {command, made, report} = entry;
    const file = (pattern) => (made.items.find((item) => pattern.test(item.name) && !/\.html$/.test(item.name)) || {}).name;
    const tabs = [];
    if (report && report.pictures.length > 0) {
      tabs.push("space");
      this.view().name = entry.item.name;
      this.view().show(report.pictures[0], {keep});
    } else if (/^(polygonize|curvature|estimate-normals)$/.test(command)) {
      const look = await this.look(made.items[0].name);
      tabs.push("space");
      this.view().show(pictureOf({[look.kind]: look}), {keep});
    }
    if (command === "segment") {
      const look = await this.look(entry.item.name);
      const contour = entry.item.kind === "volume" ? await this.look(file(/-contour.*\.ply$/)) : null;
      tabs.unshift("slices");
      const drawn = file(/-contour.*\.svg$/);
      const lines = drawn ? svgLines(await (await this.engine.download(drawn)).text(), look) : null;
      await this.showLabels(entry.item.name, look, file(/-labels/), contour, lines);
      await this.slices().goToContour();
    } else if (command === "track") {
      tabs.unshift("slices");
      await this.showFrames(entry.item, await this.look(entry.item.name), labelFiles(made.items));
    } else if (command === "inpaint") {
      const name = made.items[0].name;
      const look = await this.look(name);
      tabs.unshift("slices");
      await this.slices().show(look, (axis, index) => this.engine.slice(name, axis, index), {keep: true, paintable: false, name});
    } else if (command === "render") {
      const name = made.items[0].name;
      const look = await this.look(name);
      tabs.unshift("slices");
      await this.slices().show(look, (axis, index) => this.engine.slice(name, axis, index), {paintable: false, name});
    } else if (command === "combine" && !tabs.includes("space")) {
      await this.showModel(this.find(made.items[0].name), {kind: "surface"});
      tabs.push("space");
    }
    if (report) {
      showReport(this.panes.report, report);
      tabs.push("report");
    }
    if (tabs.length > 0) this.offer(...tabs);
    this.showResult(entry);
    this.updateHistory();
  }

  showResult({made, report, command}) {
    const facts = report ? report.facts.slice(0, 4) : [];
    const list = element("dl", {className: "facts"}, ...facts.map(([value, what]) => element("div", {}, element("dd", {}, value), element("dt", {}, what))));
    const warnings = (report && report.warnings.length ? report.warnings : made.report.warnings || []).map((text) => element("li", {}, text));
    const each = made.items.filter(({name}) => name.includes("/") && !name.endsWith("/measures.csv"));
    const files = made.items.filter((item) => !each.includes(item)).map((item) => {
      const button = element("button", {type: "button", name: "download", dataset: {name: item.name}}, icon(ICONS.save), ` ${item.name} `, element("span", {className: "size"}, bytesText(item.bytes)));
      button.addEventListener("click", () => this.download(item.name));
      return button;
    });
    this.result.hidden = false;
    this.result.replaceChildren(element("h2", {}, "Result"), element("p", {className: "quiet"}, `${command} took ${readable(made.seconds, 2)} s`),
      facts.length ? list : element("pre", {className: "summary-lines"}, made.summary || ""),
      warnings.length ? element("ul", {className: "warning-list"}, ...warnings) : "", element("div", {className: "downloads"}, ...files, ...this.framesButton(each)));
  }

  // Labels of frames are saved together, one file each.
  framesButton(items) {
    const labels = labelFiles(items);
    if (labels.length === 0) return [];
    const button = element("button", {type: "button", name: "download-frames"}, icon(ICONS.save), ` ${counted(labels.length, "label image")}`);
    button.addEventListener("click", async () => {
      for (const name of labels) await this.download(name);
    });
    return [button];
  }

  // ---- history

  updateHistory() {
    this.undoButton.disabled = this.at < 0;
    this.redoButton.disabled = this.at >= this.history.length - 1;
    this.beforeButton.disabled = this.at < 0;
    this.beforeButton.setAttribute("aria-pressed", String(this.shownBefore !== undefined));
  }

  async go(place) {
    if (place < -1 || place >= this.history.length || this.running) return;
    this.at = place;
    const entry = this.history[Math.max(place, 0)];
    if (!entry) return;
    this.item = entry.item;
    this.task_ = entry.command;
    this.values[entry.command] = new Map(place < 0 ? FIRST[entry.command] : entry.values);
    this.roles = entry.roles && [...entry.roles];
    this.hasRun = null;
    try {
      const look = await this.look(entry.item.name);
      this.showTitle(entry.item.name, look);
      this.showTask();
      this.showFiles();
      if (place < 0) await this.showItem(entry.item, look);
      else await this.showEntry(entry, true);
    } catch (error) {
      this.complain(error);
    }
    this.updateHistory();
  }

  /** Shows what was there before the last command, with the same camera, and back. */
  async showBefore(on) {
    if (this.at < 0 || this.running) return;
    const entry = this.history[this.at], earlier = this.history[this.at - 1];
    if (!on) {
      this.shownBefore = undefined;
      await this.showEntry(entry, true);
    } else {
      this.shownBefore = this.at;
      if (earlier && earlier.item === entry.item && earlier.command === entry.command && earlier.report && earlier.report.pictures.length) {
        this.view().show(earlier.report.pictures[0], {keep: true});
      } else {
        const look = await this.look(entry.item.name);
        if (look.kind === "image" || look.kind === "volume") {
          this.showTab("slices");
          await this.slices().show(look, (axis, index) => this.engine.slice(entry.item.name, axis, index), {keep: true, paintable: entry.command === "segment"});
        } else if (look.kind === "points" || look.kind === "mesh") {
          this.showTab("space");
          this.view().show(pictureOf({[look.kind]: look}), {keep: true});
        } else if (look.kind === "table") this.showTable(look);
      }
    }
    this.updateHistory();
  }

  // ---- messages

  say(text, isError = false) {
    this.message.hidden = !text;
    this.message.textContent = text;
    this.message.classList.toggle("error", isError);
    clearTimeout(this.messageTimer);
    if (text && !isError) this.messageTimer = setTimeout(() => (this.message.hidden = true), 4000);
  }

  complain(error) {
    this.say(error.message, true);
  }
}

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

/** A function of two variables on a grid as a picture: heights are values. */
export function landscape({shape, values}, info) {
  const [rows, columns] = shape;
  const data = Float32Array.from(values, Number);
  let lo = Infinity, hi = -Infinity;
  for (const value of data) if (Number.isFinite(value)) [lo, hi] = [Math.min(lo, value), Math.max(hi, value)];
  const sides = [0, 1].map((a) => info.bounds.hi[a] - info.bounds.lo[a]);
  const longest = Math.max(...sides);
  // Axes of different units are drawn equally long; heights are scaled to be visible.
  const drawn = sides.map((side) => (longest / side > 3 ? 1 : side / longest));
  const height = 0.35;
  const half = [...drawn, height].map((side) => side / 2);
  const scale = 2 / Math.hypot(...half.map((side) => 2 * side));
  const positions = new Float32Array(3 * rows * columns);
  const triangles = [];
  for (let j = 0; j < rows; ++j)
    for (let i = 0; i < columns; ++i) {
      const k = j * columns + i;
      positions[3 * k] = scale * half[0] * ((2 * i) / (columns - 1) - 1);
      positions[3 * k + 1] = scale * half[1] * ((2 * j) / (rows - 1) - 1);
      positions[3 * k + 2] = scale * half[2] * (hi > lo ? (2 * (data[k] - lo)) / (hi - lo) - 1 : 0);
      if (i + 1 < columns && j + 1 < rows) triangles.push(k, k + 1, k + columns + 1, k, k + columns + 1, k + columns);
    }
  const name = (info.values || ["value"])[0];
  return {
    low: half.map((side) => -side),
    high: half,
    up: "z",
    unit: "",
    axes: [...(info.coordinates || ["x", "y"]), name],
    axisRanges: [...[0, 1].map((a) => [info.bounds.lo[a], info.bounds.hi[a]]), [lo, hi]],
    colors: null,
    shown: "0",
    mesh: {positions, normals: null, triangles: new Uint32Array(triangles), tint: null},
    points: null,
    scales: [{name, title: name, lo, hi, map: "sequential", values: data, pointValues: null}],
    inside: null,
  };
}

