// What is done with a file: the choice of a command, its options and further inputs, and how far it is.

import {element, plainButton} from "../dom.js";
import {counted} from "../ticks.js";
import {columnsChooser, guessedRoles, placesOf, roleFlags, rolesOfFlags} from "./columns.js";
import {commandLine, COMPANIONS, FIRST, OPERATIONS, outputsOf, COMMANDS, seedsFile, unused} from "./commands.js";
import {commandControls} from "./options.js";
import {pythonLines} from "./python_lines.js";
import {contourExtension, framesOf} from "./series.js";

const wordsOf = (pairs) => pairs.flatMap(([flag, value]) => (value === true ? [flag] : [flag, String(value)]));
const choiceOf = (name, values, chosen, changed) => {
  const select = element("select", {name}, ...values.map((value) => element("option", {value}, value)));
  select.value = chosen;
  select.addEventListener("change", () => changed(select.value));
  return select;
};
const row = (text, control) => element("div", {className: "flag"}, element("label", {}, text), element("div", {className: "value"}, control));

export class Task {
  /**
   * @param {import("./page.js").Page} page
   * @param {import("./files.js").Files} files
   * @param {{run: () => void, cancel: () => void, changed: (moving: boolean) => void, chosen: (before: string) => void,
   *   rolesChanged: () => void, hasSeeds: () => boolean, up: () => string}} on changed: an option, perhaps while a slider is
   *   held; chosen: another command; hasSeeds: whether some are painted for the command; up: the axis that points upwards in the picture
   */
  constructor(page, files, on) {
    Object.assign(this, {page, files, on});
    this.item = null;
    this.kind = "";
    this.command = "";
    this.values = {}; // of flags, by command
    this.roles = null; // of the columns of a table
    this.operation = "union"; // of combine
    this.other = ""; // the second input
    this.isBusy = false;
    this.warnings = 0; // of the result
    this.seesResult = false;
    this.uprightName = ""; // the item whose picture `render` has its axis from
    const watch = ([entry]) => {
      this.seesResult = entry.isIntersecting && (entry.intersectionRatio > 0.98 || entry.boundingClientRect.top < entry.rootBounds.top + 8);
      this.showToResult();
    };
    new IntersectionObserver(watch, {root: page.result.parentElement, threshold: [0, 0.25, 0.5, 0.75, 0.99]}).observe(page.result);
  }

  /** @param {Map<string, import("../engine/engine.js").Command>} commands */
  start(commands) {
    this.commands = commands;
  }

  /** Chooses the command for the next file, of this kind. */
  choose(kind, command) {
    Object.assign(this, {kind, command});
  }

  /** Takes a file up; the command stays if it is of the same kind as the last one. */
  take(item, look) {
    if (this.kind !== look.kind) this.command = COMMANDS[look.kind][0];
    this.item = item;
    this.kind = look.kind;
    this.look = look;
    this.roles = look.kind === "table" ? guessedRoles(look.columns) : null;
  }

  /** Takes up a run of the history, or what the command began with. */
  takeEntry({item, command, values, roles}, look) {
    Object.assign(this, {item, command, look, kind: look.kind, roles: roles && [...roles], uprightName: item.name});
    this.values[command] = new Map(values || FIRST[command]);
  }

  get hasColumns() {
    return Boolean(this.roles) && this.command === "fit";
  }

  show() {
    const {item} = this;
    this.page.task.hidden = !item;
    if (!item) return this.page.task.replaceChildren();
    const command = this.commands.get(this.command);
    const names = COMMANDS[item.kind].filter((name) => this.commands.has(name));
    const choice = choiceOf("command", names, this.command, (chosen) => {
      const before = this.command;
      this.command = chosen;
      this.show();
      this.on.chosen(before);
    });
    const values = (this.values[this.command] ??= new Map(FIRST[this.command]));
    if (this.command === "render") this.setUpright(values);
    const skip = new Set(this.hasColumns ? ["--coordinates", "--values", "--weights"] : []);
    const controls = commandControls(command, values, (moving) => {
      this.update();
      this.on.changed(moving);
    }, (kinds) => this.others(kinds), skip);
    const columns = this.hasColumns ? columnsChooser(this.look, this.roles, () => {
      this.on.rolesChanged();
      this.update();
    }) : "";
    const reset = plainButton("defaults", () => {
      this.values[this.command] = new Map(FIRST[this.command]);
      this.show();
    }, {}, "Defaults");
    this.runButton = plainButton("run", () => this.on.run(), {className: "primary"}, "Run");
    this.cancelButton = plainButton("cancel", () => this.on.cancel(), {hidden: true}, "Cancel");
    this.toResult = plainButton("to-result", () => this.page.result.scrollIntoView({block: "start"}), {hidden: true, className: "to-result"});
    this.progress = element("progress", {max: 1, value: 0});
    this.stageText = element("span", {className: "quiet"});
    this.progressRow = element("div", {className: "progress", hidden: true}, this.progress, this.stageText);
    this.progressRow.setAttribute("aria-live", "polite");
    this.showWork(this.isBusy);
    this.showToResult();
    this.page.task.replaceChildren(element("h2", {}, "Command"), element("div", {className: "flag"}, choice, element("p", {className: "quiet"}, `${command.what}.`)),
      ...this.furtherInputs(), columns, controls, element("div", {className: "run-row"}, this.runButton, this.cancelButton, reset, this.toResult), this.progressRow);
    return this.update();
  }

  // A picture has the axis upwards that it has on the page.
  setUpright(values) {
    if (this.uprightName === this.item.name) return;
    this.uprightName = this.item.name;
    const up = this.on.up();
    if (up === "z") values.delete("--up");
    else values.set("--up", up);
  }

  /** What the result says, for the way to it where it is out of sight. */
  tellResult(warnings = 0) {
    this.warnings = warnings;
    this.showToResult();
  }

  showToResult() {
    if (!this.toResult) return;
    this.toResult.hidden = this.page.result.hidden || this.seesResult;
    this.toResult.textContent = `${this.warnings ? counted(this.warnings, "warning") : "Result"} ↓`;
    this.toResult.classList.toggle("warns", this.warnings > 0);
  }

  /** Names of the other files of these kinds. */
  others(kinds) {
    return this.files.items.filter(({kind, name}) => kinds.includes(kind) && name !== this.item.name).map(({name}) => name);
  }

  // The operation of combine, and the other file of a command with two.
  furtherInputs() {
    if (this.command !== "combine" && this.command !== "compare") return [];
    const set = (name) => (value) => {
      this[name] = value;
      this.update();
    };
    const names = this.others(COMPANIONS[this.item.kind]);
    if (!names.includes(this.other)) this.other = names.at(-1) || ""; // the newest
    return [
      ...(this.command === "combine" ? [row("Operation", choiceOf("operation", OPERATIONS, this.operation, set("operation")))] : []),
      row("With", names.length ? choiceOf("other", names, this.other, set("other")) : "open another file first"),
    ];
  }

  inputs() {
    const two = [this.item.name, ...(this.other ? [this.other] : [])];
    if (this.command === "combine") return [this.operation, ...(this.operation === "complement" ? [this.item.name] : two)];
    if (this.command === "compare") return two;
    return this.command === "track" ? this.frames().files : [this.item.name];
  }

  frames() {
    return framesOf(this.item, this.files.items, this.look);
  }

  /** The file that painted seeds or holes are written to. */
  get seedsName() {
    return seedsFile(this.item, this.files.items, this.command);
  }

  /** The command as it stands: its parts, and the words of the command line. */
  request() {
    const taken = new Set(this.files.items.map(({name}) => name.split("/")[0]));
    const outputs = outputsOf(this.command, this.item, (name) => {
      const free = unused(name, taken);
      taken.add(free);
      return free;
    });
    let flags = [...this.values[this.command]];
    if (this.hasColumns) flags.unshift(...roleFlags(this.look.columns, this.roles));
    if (this.command === "track") flags.unshift(...this.frames().flags, ["--contour", contourExtension(this.frames().look)]);
    const seedsFlag = {segment: "--seeds", inpaint: "--mask"}[this.command];
    if (seedsFlag && this.on.hasSeeds()) flags = [...flags.filter(([flag]) => flag !== seedsFlag), [seedsFlag, this.seedsName]];
    const inputs = this.inputs();
    return {command: this.command, inputs, flags, outputs, columns: this.columns(), args: [...inputs, ...wordsOf(outputs), ...wordsOf(flags)]};
  }

  // Which columns of a table are what, for the lines in Python. A table of points has no chooser, but flags.
  columns() {
    const table = this.hasColumns ? this.look : this.look && this.look.table;
    if (!table || this.command !== "fit") return undefined;
    const {names, separator, firstLine, namesInComment} = table;
    const named = names.some((name, i) => name !== String(i + 1)) && new Set(names).size === names.length;
    const places = (role) => placesOf(this.look.columns, this.roles, role);
    const roles = this.hasColumns ? {coordinates: places("coordinate"), values: places("value"), weights: places("weight")}
      : rolesOfFlags(names, this.values[this.command]);
    return {...roles, names, named, separator, firstLine, namesInComment};
  }

  /** Shows the command line, and the same in Python. */
  update() {
    if (!this.item || !this.command) return;
    const request = this.request();
    this.page.commandLine.textContent = commandLine(request.command, request.args);
    this.page.python.textContent = pythonLines(request).join("\n");
  }

  /** Whether a command runs, or what it does. */
  showWork(isBusy, stage = "") {
    this.isBusy = isBusy;
    document.body.classList.toggle("working", isBusy);
    if (!this.runButton) return;
    const hadFocus = [this.runButton, this.cancelButton].includes(document.activeElement);
    this.runButton.hidden = isBusy;
    this.cancelButton.hidden = this.progressRow.hidden = !isBusy;
    if (hadFocus) (isBusy ? this.cancelButton : this.runButton).focus();
    if (isBusy) this.showProgress(stage, 0);
  }

  showProgress(stage, part) {
    this.stageText.textContent = stage ? `${stage}${part > 0 ? ` ${Math.round(100 * part)} %` : " …"}` : "starting …";
    if (part > 0) this.progress.value = part;
    else this.progress.removeAttribute("value");
  }
}
