// The picture in space where another script of the page, that of reports (main.js), has it.

export const View = globalThis.csrbfView;
