// Elements of the page. Each control has a label and can be used with the keyboard.

let controls = 0;

export function element(name, properties = {}, ...children) {
  const {dataset, style, ...rest} = properties;
  const result = Object.assign(document.createElement(name), rest);
  if (dataset) Object.assign(result.dataset, dataset);
  if (style) Object.assign(result.style, style);
  result.append(...children.filter((child) => child !== null && child !== undefined));
  return result;
}

/** An icon of 16 x 16 units, drawn in the colour of the text. */
export function icon(path) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  for (const [name, value] of Object.entries({viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true"}))
    svg.setAttribute(name, value);
  const line = document.createElementNS("http://www.w3.org/2000/svg", "path");
  line.setAttribute("d", path);
  svg.append(line);
  return svg;
}

export function labelled(text, control, className = "control") {
  control.id = control.id || `control-${++controls}`;
  return element("div", {className}, element("label", {htmlFor: control.id}, text), control);
}

/** A choice among [value, text] pairs. */
export function choice(text, name, options, chosen, changed) {
  const select = element("select", {name});
  const fill = (pairs) => select.replaceChildren(...pairs.map(([value, label]) => element("option", {value}, label)));
  fill(options);
  select.value = chosen;
  select.addEventListener("change", () => changed(select.value));
  const node = labelled(text, select);
  return {node, set: (value) => (select.value = value), fill: (pairs) => (fill(pairs), (node.hidden = pairs.length < 2))};
}

/** A slider from lo to hi. `shown` makes text of its value. */
export function slider(text, name, {lo = 0, hi = 100, step = 0.5, value = 50, shown = null}, changed) {
  const input = element("input", {type: "range", name, min: lo, max: hi, step, value});
  const output = shown ? element("output", {}, shown(value)) : null;
  input.addEventListener("input", () => {
    if (output) output.textContent = shown(Number(input.value));
    changed(Number(input.value));
  });
  const node = labelled(text, input);
  if (output) node.append(output);
  return {
    node,
    set: (now) => {
      input.value = now;
      if (output) output.textContent = shown(Number(now));
    },
  };
}

export function toggle(text, name, changed, on = false) {
  const input = element("input", {type: "checkbox", name, checked: on});
  input.addEventListener("change", () => changed(input.checked));
  const node = element("div", {className: "control"}, element("label", {}, input, " " + text));
  return {node, set: (now) => (input.checked = now)};
}

/** A button that calls pressed(event). */
export function plainButton(name, pressed, properties = {}, ...children) {
  const node = element("button", {type: "button", name, ...properties}, ...children);
  node.addEventListener("click", pressed);
  return node;
}

/** A button among controls. */
export function button(text, name, pressed, properties = {}) {
  const node = plainButton(name, pressed, properties, text);
  return {node: element("div", {className: "control"}, node), button: node};
}

/** A button that opens a small panel of controls; Escape and a click elsewhere close it. */
export function panel(text, name, ...children) {
  const body = element("div", {className: "popover"}, ...children);
  const details = element("details", {className: "menu", name}, element("summary", {}, text), body);
  details.dataset.name = name;
  document.addEventListener("pointerdown", (event) => {
    if (details.open && !details.contains(event.target)) details.open = false;
  });
  details.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !details.open) return;
    details.open = false;
    details.firstChild.focus();
    event.stopPropagation();
  });
  details.addEventListener("toggle", () => {
    body.classList.remove("leftwards");
    if (details.open && body.getBoundingClientRect().right > document.documentElement.clientWidth - 8)
      body.classList.add("leftwards");
  });
  return {node: details};
}

/** Saves a blob as a file of the user's. */
export function save(blob, name) {
  const address = URL.createObjectURL(blob);
  const link = element("a", {href: address, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** Copies text; says so on the button for a moment. */
export async function copy(text, from) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element("textarea", {value: text, style: {position: "fixed", opacity: 0}});
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  if (!from) return;
  const before = from.textContent;
  from.textContent = "Copied";
  setTimeout(() => (from.textContent = before), 1200);
}

/** Calls the function at most once per frame of the screen. */
export function oncePerFrame(action) {
  let waiting = false;
  return () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      action();
    });
  };
}
