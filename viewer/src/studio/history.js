// What was run, to go back to and forward again.

export class History {
  /** Runs in their order: {command, item, values, roles, line, request, made, report}. */
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

  has(place) {
    return place >= -1 && place < this.entries.length && this.entries.length > 0;
  }

  /** @param {import("./page.js").Page} page whose buttons are for this */
  show({undo, redo, before}) {
    undo.disabled = before.disabled = this.at < 0;
    redo.disabled = this.at >= this.entries.length - 1;
    before.setAttribute("aria-pressed", String(this.showsBefore));
  }
}
