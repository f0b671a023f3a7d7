// The studio: files on the left, what is done with them below, the picture on the right, and the command that makes the
// same at the bottom. The parts know each other only through this.

import {element} from "../dom.js";
import {holesMask, holesOfMask, seedsOfTable, seedTable} from "../slices/seeds.js";
import {readable} from "../ticks.js";
import {PREVIEWED} from "./commands.js";
import {Files} from "./files.js";
import {History} from "./history.js";
import {Page} from "./page.js";
import {Previews} from "./preview.js";
import {parseReport} from "./report.js";
import {showResult} from "./result.js";
import {isSeries} from "./series.js";
import {describe, Stage} from "./stage.js";
import {Task} from "./task.js";

const shownName = () => new URLSearchParams(window.location.hash.slice(1)).get("show");

export class Studio {
  /** @param {HTMLElement} body @param {import("../engine/engine.js").Engine} engine */
  constructor(body, engine) {
    const failed = (error) => this.page.complain(error);
    this.engine = engine;
    this.page = new Page(body, {
      open: (files) => this.open(files),
      step: (by) => this.step(by),
      showBefore: (on) => this.showBefore(on),
    });
    this.files = new Files(this.page.files, engine, {selected: (name) => this.select(name), removed: (name) => this.removed(name), failed});
    this.stage = new Stage(this.page, this.files, {painted: () => this.seedsPainted(), drawing: (on) => this.work(on, "Drawing")});
    this.task = new Task(this.page, this.files, {
      run: () => this.run(),
      cancel: () => this.cancel(),
      changed: (moving) => this.changed(moving),
      chosen: (before) => this.chosen(before),
      rolesChanged: () => this.stage.showTable(this.task.look, this.task.roles),
      hasSeeds: () => this.seeds.size > 0,
      up: () => this.stage.up,
    });
    this.previews = new Previews(engine, {
      request: () => this.task.request(),
      show: (command, made, seconds) => this.showPreview(command, made, seconds),
      failed,
    });
    this.history = new History();
    this.item = null; // that is looked at
    this.running = null; // an AbortController
    this.showSteps();
  }

  async start() {
    const [commands, items] = await Promise.all([this.engine.commands(), this.engine.files()]);
    this.commands = new Map(commands.map((command) => [command.name, command]));
    this.task.start(this.commands);
    this.files.items = items;
    this.files.show();
    this.history.restore(this.files);
    const first = this.files.first(shownName());
    const {current} = this.history;
    if (first && current && current.item === first && shownName() === first.name) await this.go(this.history.at);
    else if (first) await this.select(first.name);
    else this.task.show();
    this.showSteps();
    window.addEventListener("focus", () => this.refresh().catch((error) => this.page.complain(error)));
  }

  // ---- files

  /** Shows what other tabs opened or made meanwhile, and a file as it is now where it changed. */
  async refresh() {
    if (this.running) return;
    const changed = await this.files.refresh();
    this.files.show(this.item);
    if (this.item && changed.includes(this.item.name)) {
      await this.select(this.item.name);
      this.page.say(`${this.item.name} has changed`);
    } else this.task.update();
  }

  async open(chosen) {
    const opened = [];
    let last = null;
    for (const file of chosen) {
      try {
        this.page.say(`Opening ${file.name} …`);
        last = await this.files.open(file, (part) => this.page.say(`Opening ${file.name}: ${Math.round(100 * part)} %`));
        opened.push(last);
        if (last.problem) throw new Error(last.problem);
        this.page.say("");
      } catch (error) {
        this.page.complain(error);
      }
    }
    this.files.show(this.item);
    if (!last || last.problem) return;
    if (isSeries(opened) && this.commands.has("track")) {
      this.task.choose(last.kind, "track");
      last = opened[0];
    }
    await this.select(last.name);
  }

  async select(name) {
    const before = this.item;
    const item = (this.item = this.files.find(name));
    this.files.show(item);
    let look = null;
    try {
      look = await this.files.look(name);
      if (this.item !== item) return; // another one was selected since
      item.kind = look.kind;
      this.task.take(item, look);
      await this.findSeeds();
      this.showTitle(name, look);
      await this.showItem(item, look);
    } catch (error) {
      if (!look && this.item === item) this.item = before; // which is still shown
      this.page.complain(error);
    }
    this.task.show();
    this.files.show(this.item);
    this.showSteps();
  }

  removed(name) {
    for (const painted of [this.stage.seeds, this.stage.holes]) painted.delete(name);
    if (this.item && this.item.name === name) {
      this.item = null;
      const next = this.files.first();
      if (next) return this.select(next.name);
      this.page.showWelcome();
      this.task.item = null;
      this.task.show();
    }
    return this.files.show(this.item);
  }

  showTitle(name, look) {
    this.page.title.textContent = `${name} · ${describe(look)}`;
    // A reload, and links to a view, show the same file.
    if (shownName() !== name) window.history.replaceState(null, "", `#${new URLSearchParams({show: name})}`);
  }

  showItem(item, look) {
    this.page.result.hidden = true;
    this.task.tellResult();
    return this.stage.showItem(item, look, this.task);
  }

  // ---- the command

  async chosen(before) {
    const {item, look, command} = this.task;
    // Frames of a series are shown as one; seeds and holes are painted on the image itself.
    const isOther = (one) => (before === one) !== (command === one);
    try {
      if (isOther("inpaint")) await this.findSeeds();
      if (isOther("track") || isOther("inpaint")) await this.showItem(item, look);
      this.task.update();
    } catch (error) {
      this.page.complain(error);
    }
  }

  changed(moving) {
    // A preview of inpaint takes the place of the image that holes are painted on.
    const isPainted = this.task.command === "inpaint" && this.seeds.size > 0;
    if (PREVIEWED.has(this.task.command) && !isPainted) this.previews.run();
    if (!moving && this.hasRun && this.hasRun === this.task.command) this.run();
  }

  /** What is painted for the command: seeds or holes. */
  get seeds() {
    return this.stage.seedsOf(this.task.item.name, this.task.command);
  }

  async seedsPainted() {
    this.task.update();
    this.showSteps();
    const {seeds, task: {seedsName, command}} = this;
    try {
      if (seeds.size > 0) await this.writeSeeds();
      else if (this.files.find(seedsName)) await this.files.remove(seedsName);
      this.files.show(this.item);
      if (new Set(seeds.values()).size > 1 && command === "segment") this.previews.run();
    } catch (error) {
      this.page.complain(error);
    }
  }

  async writeSeeds() {
    const {seeds, task: {seedsName, look}} = this;
    this.files.put([await this.engine.write(seedsName, seeds.areHoles ? holesMask(seeds, look) : seedTable(seeds, look))]);
  }

  /** Takes up what was painted on an image before the page was loaded again. */
  async findSeeds() {
    const {seeds, task: {look, seedsName}} = this;
    if ((look.kind !== "image" && look.kind !== "volume") || seeds.size > 0 || !this.files.find(seedsName)) return;
    const file = await this.engine.download(seedsName);
    const found = seeds.areHoles ? holesOfMask(new Uint8Array(await file.arrayBuffer()), look) : seedsOfTable(await file.text(), look);
    for (const [voxel, brush] of found) seeds.set(voxel, brush);
  }

  async showPreview(command, made, seconds) {
    if (this.running) return;
    await this.stage.showPreview(command, this.item, made);
    this.page.say(`Preview on fewer samples, ${readable(seconds, 2)} s`);
  }

  // ---- runs

  async run() {
    if (this.running) {
      this.runAgain = true;
      this.cancel();
      return;
    }
    const request = this.task.request();
    const {command, item, roles, values} = this.task;
    // As it stands: files and options may be others when it ends.
    const entry = {command, item, values: new Map(values[command]), roles: roles && [...roles], line: this.page.commandLine.textContent};
    let done = false;
    this.running = new AbortController();
    this.hasRun = command;
    this.work(true);
    try {
      this.previews.cancel();
      if (request.args.includes(this.task.seedsName)) await this.writeSeeds();
      Object.assign(entry, await this.runEngine(request));
      this.history.add(entry);
      this.history.keep();
      this.stage.seedsOf(item.name, command).settle();
      this.page.say("");
      done = true;
      if (this.item === entry.item) await this.showEntry(entry, !this.history.showsBefore);
    } catch (error) {
      if (error.name === "AbortError") this.page.say("Cancelled. Nothing half-written is left.");
      else this.page.complain(error);
    } finally {
      this.running = null;
      this.work(false);
      this.files.show(this.item);
      this.showSteps();
      this.task.update();
      if (done && this.item !== entry.item) await this.go(this.history.at);
      else if (this.runAgain) this.run();
      this.runAgain = false;
    }
  }

  /** What a command made, and its report. */
  async runEngine({command, args}) {
    const start = performance.now();
    const made = await this.engine.run({command, args}, (stage, part) => this.task.showProgress(stage, part), this.running.signal);
    made.seconds = (performance.now() - start) / 1000;
    this.files.put(made.items);
    return {made, report: await this.readReport(made)};
  }

  async readReport({page}) {
    return page ? parseReport(await (await this.engine.download(page)).text()) : null;
  }

  cancel() {
    if (this.running) this.running.abort();
  }

  // A command runs on while other files are looked at.
  work(on, stage = "") {
    this.task.showWork(on || Boolean(this.running), stage);
  }

  async showEntry(entry, keep) {
    this.history.showsBefore = false;
    if (entry.report === undefined) entry.report = await this.readReport(entry.made);
    await this.stage.showEntry(entry, keep);
    this.task.tellResult(showResult(this.page.result, entry, this.files));
    this.showSteps();
  }

  // ---- history

  /** The seeds, where some were painted since the last run. */
  get paintedSeeds() {
    return this.item && this.stage.paints ? this.seeds : null;
  }

  /** One step back or forward: of what was painted, or of the runs. */
  step(by) {
    return this.paintedSeeds?.canStep(by) ? this.stage.slices.stepSeeds(by) : this.go(this.history.at + by);
  }

  showSteps() {
    this.history.show(this.page, (by) => Boolean(this.paintedSeeds?.canStep(by)));
  }

  async go(place) {
    if (!this.history.has(place) || this.running) return;
    this.history.at = place;
    this.history.keep();
    const entry = this.history.entries[Math.max(place, 0)];
    const {item} = entry;
    this.item = item;
    this.hasRun = null;
    try {
      const look = await this.files.look(item.name);
      this.task.takeEntry(place < 0 ? {...entry, values: null} : entry, look);
      await this.findSeeds();
      this.showTitle(item.name, look);
      this.task.show();
      this.files.show(item);
      if (place < 0) await this.showItem(item, look);
      else await this.showEntry(entry, true);
    } catch (error) {
      this.page.complain(error);
    }
    this.showSteps();
  }

  /** Shows what was there before the last command, with the same camera, and back. */
  async showBefore(on) {
    const entry = this.history.current;
    if (!entry || this.running) return;
    if (!on) return this.showEntry(entry, true);
    this.history.showsBefore = true;
    const earlier = this.history.entries[this.history.at - 1];
    const isSame = earlier && earlier.item === entry.item && earlier.command === entry.command;
    if (isSame && earlier.report === undefined) earlier.report = await this.readReport(earlier.made);
    if (isSame && earlier.report && earlier.report.pictures.length > 0) this.stage.view.show(earlier.report.pictures[0], {keep: true});
    else await this.stage.showBefore(entry.item, await this.files.look(entry.item.name), entry);
    return this.showSteps();
  }
}

/** Starts the studio in the page with an engine, or says why there is none. */
export async function startStudio(engine) {
  try {
    const studio = new Studio(document.body, await engine);
    window.studio = studio;
    await studio.start();
  } catch (error) {
    document.body.append(element("p", {className: "fatal"}, error.message));
    throw error;
  }
}
