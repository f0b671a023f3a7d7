// Fingers, or the mouse, that are down on an element: where they are, in pixels of the page.

export class Pointers {
  #places = new Map();

  get count() {
    return this.#places.size;
  }

  has({pointerId}) {
    return this.#places.has(pointerId);
  }

  set({pointerId, clientX, clientY}) {
    this.#places.set(pointerId, [clientX, clientY]);
  }

  delete({pointerId}) {
    this.#places.delete(pointerId);
  }

  /** Their middle. */
  middle() {
    const all = [...this.#places.values()];
    return [0, 1].map((a) => all.reduce((sum, p) => sum + p[a], 0) / all.length);
  }

  /** The distance of two; 0 where there are not two. */
  spread() {
    const [a, b] = [...this.#places.values()];
    return this.count === 2 ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }

  /** Moves one of them: how far the middle went, and by which factor the distance grew. */
  move(event) {
    const [before, spread] = [this.middle(), this.spread()];
    this.set(event);
    const after = this.middle();
    return {way: [after[0] - before[0], after[1] - before[1]], factor: spread > 0 && this.spread() > 0 ? this.spread() / spread : 1};
  }
}
