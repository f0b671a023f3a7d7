// The page: what is where on it, files dropped on it, and messages. The parts fill their own places.

import {copy, element, icon, plainButton} from "../dom.js";
import {iconButton, ICONS} from "./icons.js";

const PANES = {space: "Space", slices: "Slices", report: "Report"};
const MESSAGE_TIME = 4000; // milliseconds for which a message stays that is no error

/** Whether all of the page is seen at once: where it is narrow it scrolls (studio.css). */
export const isWhole = () => !window.matchMedia("(max-width: 52rem)").matches;

export class Page {
  /**
   * @param {HTMLElement} body
   * @param {{open: (files: File[]) => void, step: (by: 1|-1) => void, showBefore: (on: boolean) => void}} on what the page
   *   is asked for; step: through the history
   */
  constructor(body, on) {
    this.files = element("ul", {className: "files"});
    this.task = element("section", {className: "task"});
    this.result = element("section", {className: "result", hidden: true});
    this.title = element("div", {className: "title"});
    body.append(this.header(on), this.side(on), this.main(), this.foot(), this.messages());
    listen(body, on);
  }

  header(on) {
    this.undo = iconButton("undo", "Undo (Ctrl Z)", ICONS.undo, () => on.step(-1));
    this.redo = iconButton("redo", "Redo (Ctrl Shift Z)", ICONS.redo, () => on.step(1));
    this.before = plainButton("before", () => on.showBefore(this.before.getAttribute("aria-pressed") !== "true"),
      {title: "Show what was there before"}, "Before");
    return element("header", {className: "bar"}, element("h1", {}, "csrbf ", element("span", {}, "studio")), this.title,
      element("div", {className: "bar-buttons"}, this.before, this.undo, this.redo));
  }

  side(on) {
    this.chooser = element("input", {type: "file", multiple: true, hidden: true, name: "files"});
    this.chooser.addEventListener("change", () => {
      on.open([...this.chooser.files]);
      this.chooser.value = "";
    });
    const open = plainButton("open", () => this.chooser.click(), {className: "drop"}, icon(ICONS.open), element("span", {}, "Open or drop files"));
    return element("aside", {}, element("section", {}, element("h2", {}, "Files"), open, this.chooser, this.files), this.task, this.result);
  }

  main() {
    this.tabs = element("div", {className: "tabs", hidden: true});
    this.tabs.setAttribute("role", "tablist");
    this.panes = {};
    for (const [name, text] of Object.entries(PANES)) {
      const tab = plainButton(`tab-${name}`, () => this.showTab(name), {hidden: true, dataset: {tab: name}}, text);
      tab.setAttribute("role", "tab");
      this.tabs.append(tab);
      this.panes[name] = element("div", {className: `pane ${name}`, hidden: true});
    }
    this.welcome = element("div", {className: "pane welcome"},
      element("h2", {}, "Drop a file, or click to open one"),
      element("p", {}, "A scan or point cloud becomes a closed surface, a table of samples a function, an image or volume is divided into regions or repaired."),
      element("p", {className: "quiet"}, "Points .ply .xyz .las .pcd · meshes .stl .obj .glb · tables .csv .npy · images .png .tif · volumes .nii.gz .nrrd .mha · models .csrbf. Nothing leaves this machine."));
    this.welcome.addEventListener("click", () => this.chooser.click());
    return element("main", {}, this.tabs, element("div", {className: "panes"}, this.welcome, ...Object.values(this.panes)));
  }

  foot() {
    this.commandLine = element("code", {className: "command-line"});
    this.python = element("pre", {className: "python", hidden: true});
    const showPython = plainButton("python", () => {
      this.python.hidden = !this.python.hidden;
      showPython.setAttribute("aria-expanded", String(!this.python.hidden));
    }, {}, "Python");
    showPython.setAttribute("aria-expanded", "false");
    const copies = (name, text, node) => plainButton(name, (event) => copy(node.textContent, event.currentTarget), {}, text);
    return element("footer", {}, element("div", {className: "line"}, this.commandLine, copies("copy-command", "Copy", this.commandLine),
      showPython, copies("copy-python", "Copy Python", this.python)), this.python);
  }

  messages() {
    this.message = element("div", {className: "message", hidden: true});
    this.message.setAttribute("role", "status");
    this.message.addEventListener("click", () => this.say(""));
    return this.message;
  }

  say(text, isError = false) {
    this.message.hidden = !text;
    this.message.textContent = text;
    this.message.classList.toggle("error", isError);
    clearTimeout(this.messageTimer);
    if (text && !isError) this.messageTimer = setTimeout(() => (this.message.hidden = true), MESSAGE_TIME);
  }

  complain(error) {
    this.say(error.message, true);
  }

  /** Shows these tabs; the first is opened where another one is open. */
  offer(...names) {
    this.welcome.hidden = true;
    for (const tab of this.tabs.children) tab.hidden = !names.includes(tab.dataset.tab);
    this.tabs.hidden = names.length < 2;
    if (!names.includes(this.tab)) this.showTab(names[0]);
  }

  /** Gives a tab another name. */
  nameTab(tab, text) {
    this.tabs.querySelector(`[data-tab=${tab}]`).textContent = text;
  }

  showTab(name) {
    this.tab = name;
    for (const [pane, node] of Object.entries(this.panes)) node.hidden = pane !== name;
    for (const tab of this.tabs.children) tab.setAttribute("aria-selected", String(tab.dataset.tab === name));
  }

  /** As it is without any file. */
  showWelcome() {
    this.title.textContent = this.commandLine.textContent = "";
    this.result.hidden = this.tabs.hidden = true;
    this.showTab(null);
    this.welcome.hidden = false;
  }
}

function listen(body, on) {
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
    on.open([...event.dataTransfer.files]);
  });
  window.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.matches("input[type=text], input[type=number]")) return;
    event.preventDefault();
    on.step(event.shiftKey ? 1 : -1);
  });
}
