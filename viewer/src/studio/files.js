// The files of the engine, in a list, and what is known of them.

import {element, icon, plainButton, save} from "../dom.js";
import {bytesText} from "../ticks.js";
import {iconButton, ICONS, SHAPES} from "./icons.js";

const MOST_SHOWN = 400000; // points that are drawn
const ASKS = 4000; // milliseconds in which a second click removes a file

export class Files {
  /**
   * @param {HTMLElement} list
   * @param {import("../engine/engine.js").Engine} engine
   * @param {{selected: (name: string) => void, removed: (name: string) => void, failed: (error: Error) => void}} on
   */
  constructor(list, engine, on) {
    Object.assign(this, {list, engine, on});
    this.items = [];
    this.looks = new Map();
  }

  find(name) {
    return this.items.find((item) => item.name === name);
  }

  /** The first one that can be looked at, that of this name if there is one. */
  first(name) {
    const usable = this.items.filter(({kind}) => kind !== "other");
    return usable.find((item) => item.name === name) || usable[0];
  }

  /** What a file looks like; as it was found before. */
  async look(name) {
    if (!this.looks.has(name)) this.looks.set(name, await this.engine.look(name, MOST_SHOWN));
    return this.looks.get(name);
  }

  /** Takes up files that a command wrote, in place of older ones. */
  put(items) {
    for (const item of items) {
      const known = this.find(item.name);
      if (known) Object.assign(known, item);
      else this.items.push(item);
      this.looks.delete(item.name);
    }
  }

  /** Takes up what other tabs of the browser opened or made, and what changed on the disk: names of what did. */
  async refresh() {
    const changed = [];
    for (const item of await this.engine.files()) {
      const known = this.find(item.name);
      if (known && known.written === item.written && known.bytes === item.bytes) continue;
      if (known) changed.push(item.name);
      this.put([item]);
    }
    return changed;
  }

  async open(file, progress) {
    const item = await this.engine.open(file, file.name.replace(/^[.-]+/, "").replace(/[:\\/]/g, "_"), progress);
    this.items = [...this.items.filter(({name}) => name !== item.name), item];
    return item;
  }

  async download(name) {
    try {
      save(await this.engine.download(name), name.replace(/^preview:/, "").replace(/\//g, "-"));
    } catch (error) {
      this.on.failed(error);
    }
  }

  async remove(name) {
    try {
      await this.engine.remove(name);
    } catch (error) {
      this.on.failed(error);
    }
    this.items = this.items.filter((item) => item.name !== name);
    this.looks.delete(name);
    this.on.removed(name);
  }

  /** Shows the list, in which one is marked and can be seen. */
  show(current) {
    this.current = current;
    // What track writes for each frame is shown on the stage.
    this.list.replaceChildren(...this.items.filter(({name}) => !name.includes("/")).map((item) => this.row(item, item === current)));
    const marked = this.list.querySelector("[aria-current]");
    if (!marked) return;
    const [row, all] = [marked.getBoundingClientRect(), this.list.getBoundingClientRect()];
    this.list.scrollTop += Math.min(0, row.top - all.top) + Math.max(0, row.bottom - all.bottom);
  }

  row({name, kind, bytes, made}, isCurrent) {
    const open = plainButton("file", () => (kind === "other" ? this.download(name) : this.on.selected(name)),
      {className: "file", title: `${name}: ${kind}, ${bytesText(bytes)}`, dataset: {name}},
      icon(SHAPES[kind] || SHAPES.other), element("span", {className: "name"}, name), element("span", {className: "size"}, bytesText(bytes)));
    if (isCurrent) open.setAttribute("aria-current", "true");
    // Nothing brings a removed file back: a second click says that it is meant.
    const remove = iconButton("remove-file", `Remove ${name}`, ICONS.remove, () => {
      if (remove.classList.contains("asks")) return this.remove(name);
      remove.classList.add("asks");
      remove.replaceChildren("Remove?");
      return setTimeout(() => this.show(this.current), ASKS);
    });
    return element("li", {className: made ? "made" : ""}, open,
      iconButton("save-file", `Save ${name}`, ICONS.save, () => this.download(name)), remove);
  }
}
