/** Light and dark colours of the picture. */
export const THEMES = {
  light: {
    missing: [0.76, 0.77, 0.79], plain: [0.86, 0.82, 0.76], point: [0.1, 0.32, 0.6], inside: [0.42, 0.55, 0.66],
    line: [0.13, 0.16, 0.2], box: [0.55, 0.59, 0.65],
    palette: {dark: false, axis: "#8b95a3", text: "#4a5463", strong: "#1b2330", halo: "rgba(247,248,250,.85)", ground: "#ffffff", measure: "#b4420a"},
  },
  dark: {
    missing: [0.36, 0.38, 0.42], plain: [0.78, 0.74, 0.69], point: [0.45, 0.72, 0.95], inside: [0.3, 0.42, 0.52],
    line: [0.05, 0.06, 0.08], box: [0.42, 0.46, 0.52],
    palette: {dark: true, axis: "#667081", text: "#aab4c2", strong: "#e4e8ee", halo: "rgba(27,32,40,.85)", ground: "#14181e", measure: "#f0924c"},
  },
};
