// Round numbers for axes, and numbers as text.

const MINUS = "−";
const RAISED = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};

/** 1, 2 or 5 times a power of ten, such that about `count` of them fill the range. */
export function roundStep(range, count) {
  const raw = range / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const mantissa = raw / power;
  return power * (mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10);
}

/** Round numbers from lo to hi, about `count`, with the text of each. */
export function ticks(lo, hi, count = 5) {
  if (!(hi > lo) || !Number.isFinite(hi - lo)) return [];
  const step = roundStep(hi - lo, count);
  const result = [];
  for (let i = Math.ceil(lo / step - 1e-9); i <= Math.floor(hi / step + 1e-9); ++i)
    result.push({value: i * step, text: tickText(i * step, step, Math.max(Math.abs(lo), Math.abs(hi)))});
  return result;
}

/** A tick with the digits that its step needs; powers of ten where labels would be long. */
export function tickText(value, step, largest) {
  if (Math.abs(value) < 1e-9 * step) return "0";
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (largest >= 1e9 || largest < 1e-3 || step >= 1e6) {
    const digits = Math.max(0, Math.floor(Math.log10(Math.abs(value)) + 1e-9) - Math.floor(Math.log10(step) + 1e-9));
    return pretty(value.toExponential(Math.min(digits, 20)));
  }
  return pretty(grouped(value.toFixed(Math.min(decimals, 20))));
}

// With thousands set apart in numbers of five digits or more.
function grouped(text) {
  const [whole, part] = text.split(".");
  const shown = /\d{5}/.test(whole) ? whole.replace(/\B(?=(\d{3})+$)/g, ",") : whole;
  return part ? `${shown}.${part}` : shown;
}

/** A number for people, with this many significant digits: 52,980, 0.0753, 3.2×10⁻⁶. */
export function readable(value, digits = 4) {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : String(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return pretty(value.toExponential(digits - 1).replace(/\.?0+e/, "e"));
  const rounded = Number(value.toPrecision(digits));
  return (value < 0 ? MINUS : "") + grouped(Math.abs(rounded).toString());
}

/** A typographic minus, and powers of ten as 3×10⁻⁵. */
export function pretty(text) {
  const [number, power] = text.replace("e+", "e").split("e");
  const shown = number.replace("-", MINUS);
  return power === undefined ? shown : `${shown}×10${[...power].map((c) => RAISED[c]).join("")}`;
}

/** 1.2 MB. */
export function bytesText(count) {
  const units = ["B", "kB", "MB", "GB"];
  let unit = 0;
  while (count >= 1000 && unit + 1 < units.length) {
    count /= 1000;
    ++unit;
  }
  return `${unit === 0 ? count : count.toPrecision(3)} ${units[unit]}`;
}

/** "1 point", "52,980 points". */
export function counted(count, noun, plural = noun + "s") {
  return `${count.toLocaleString("en")} ${count === 1 ? noun : plural}`;
}
