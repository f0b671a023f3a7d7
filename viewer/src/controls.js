// The row of controls of a picture. Each has a label and can be used with the keyboard.

let controls = 0;

function element(name, properties = {}, ...children) {
  const result = Object.assign(document.createElement(name), properties);
  result.append(...children);
  return result;
}

function labelled(text, control) {
  control.id = `control-${++controls}`;
  return element("div", {className: "control"}, element("label", {htmlFor: control.id}, text), control);
}

/** A choice among [value, text] pairs; null when there is nothing to choose. */
export function choice(text, name, options, chosen, changed) {
  if (options.length < 2) return null;
  const select = element("select", {name}, ...options.map(([value, label]) => element("option", {value}, label)));
  select.value = chosen;
  select.addEventListener("change", () => changed(select.value));
  return {node: labelled(text, select), set: (value) => (select.value = value)};
}

export function slider(text, name, changed) {
  const input = element("input", {type: "range", name, min: 0, max: 100, step: 0.5, value: 50, disabled: true});
  input.addEventListener("input", () => changed(Number(input.value) / 100));
  return {
    node: labelled(text, input),
    set: (fraction, enabled) => {
      input.value = 100 * fraction;
      input.disabled = !enabled;
    },
  };
}

export function toggle(text, name, changed) {
  const input = element("input", {type: "checkbox", name});
  input.addEventListener("change", () => changed(input.checked));
  const node = element("div", {className: "control"}, element("label", {}, input, " " + text));
  return {node, set: (on) => (input.checked = on)};
}

export function button(text, name, pressed) {
  const node = element("button", {type: "button", name}, text);
  node.addEventListener("click", pressed);
  return {node: element("div", {className: "control"}, node)};
}

/** The colour bar with its ticks; hidden without a scale. */
export class Legend {
  constructor() {
    this.bar = element("div", {className: "legend-bar"});
    this.ticks = element("div", {className: "legend-ticks"});
    this.title = element("div", {className: "legend-title"});
    this.node = element("div", {className: "legend", hidden: true}, this.title, this.bar, this.ticks);
  }

  show(scale, stops) {
    this.node.hidden = !scale;
    if (!scale) return;
    this.title.textContent = scale.title;
    this.bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    this.ticks.replaceChildren(...scale.ticks.map((text) => element("span", {}, text)));
  }
}
