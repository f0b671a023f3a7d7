// What was run, to go back to and forward again, also after the page was loaded again.

const KEY = () => `csrbf studio ${window.location.pathname}`; // a path is one start of the program

export class History {
  /** Runs in their order: {command, item, values, roles, line, made, report}; no report: it was not read yet. */
  entries = [];
  /** The place of the one that is shown; -1: what was there before the first. */
  at = -1;
  /** Whether what was there before it is shown in its place. */
  showsBefore = false;

  get length() {
    return this.entries.length;
  }

  get current() {
    return this.entries[this.at];
  }

  /** Adds a run in place of those that were undone. */
  add(entry) {
    this.entries.splice(this.at + 1, Infinity, entry);
    this.at = this.entries.length - 1;
  }

  /** Keeps all but the reports for as long as the tab is open. */
  keep() {
    const entries = this.entries.map(({report: _, item, values, made, ...entry}) =>
      ({...entry, item: item.name, values: [...values], made: {...made, report: {warnings: made.report && made.report.warnings}}}));
    try {
      sessionStorage.setItem(KEY(), JSON.stringify({at: this.at, entries}));
    } catch {
      // no room, or not allowed: then there is no way back after a reload
    }
  }

  /** Takes up what was kept, as far as all its files are still there. @param {import("./files.js").Files} files */
  restore(files) {
    let kept = null;
    try {
      kept = JSON.parse(sessionStorage.getItem(KEY()));
    } catch {
      return;
    }
    if (!kept) return;
    const isThere = ({item, made}) => files.find(item) && made.items.every(({name}) => files.find(name));
    this.at = kept.entries.slice(0, kept.at + 1).filter(isThere).length - 1;
    this.entries = kept.entries.filter(isThere).map(({item, values, ...entry}) => ({...entry, item: files.find(item), values: new Map(values)}));
  }

  has(place) {
    return place >= -1 && place < this.entries.length && this.entries.length > 0;
  }

  /** @param {import("./page.js").Page} page whose buttons are for this @param {(by: number) => boolean} more other steps */
  show({undo, redo, before}, more) {
    before.disabled = this.at < 0;
    undo.disabled = this.at < 0 && !more(-1);
    redo.disabled = this.at >= this.entries.length - 1 && !more(1);
    before.setAttribute("aria-pressed", String(this.showsBefore));
  }
}
