// A view as words of an address, and back.

const rounded = (value) => Number(value.toPrecision(5));

/** An address that opens the page with this view. */
export function linkTo({state, orbit, cutNormal}) {
  const {color, points, cut, depth, edges, orthographic, opacity, exaggeration, isolines} = state;
  const words = new URLSearchParams(window.location.hash.slice(1));
  const put = (name, value, usual) => (value === usual ? words.delete(name) : words.set(name, String(value)));
  words.set("up", orbit.up);
  words.set("view", orbit.state.map(rounded).join(","));
  words.set("color", color);
  put("points", points, false);
  put("edges", edges, "none");
  put("ortho", orthographic, false);
  put("opacity", opacity, 1);
  put("heights", exaggeration, 1);
  put("isolines", isolines, 0);
  put("cut", cut === "none" ? "" : [...cutNormal.map(rounded), depth].join(","), "");
  return `${window.location.href.split("#")[0]}#${words}`;
}

/**
 * What the words of an address say: `orbit`, the state of the camera, `cutNormal` where there is a cut, and `change`, of
 * the view's state.
 * @param {URLSearchParams} words @param {string[]} colors that may be chosen, the usual one first
 */
export function readLink(words, colors) {
  const change = {
    color: colors.includes(words.get("color")) ? words.get("color") : colors[0],
    points: words.get("points") === "true",
    orthographic: words.get("ortho") === "true",
  };
  if (["creases", "all"].includes(words.get("edges"))) change.edges = words.get("edges");
  for (const [name, key, lo, hi] of [["opacity", "opacity", 0.05, 1], ["heights", "exaggeration", 0.2, 10], ["isolines", "isolines", 0, 40]]) {
    const value = Number(words.get(name));
    if (words.has(name) && value >= lo && value <= hi) change[key] = value;
  }
  const cut = (words.get("cut") || "").split(",").map(Number);
  const isCut = cut.length === 4 && cut.every(Number.isFinite);
  if (isCut) Object.assign(change, {cut: "view", depth: cut[3]});
  return {orbit: words.get("view").split(",").map(Number), cutNormal: isCut ? cut.slice(0, 3) : null, change};
}
