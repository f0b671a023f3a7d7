// A worker that reconstructs what it is sent; the page ends it to cancel.

import {load} from "../browser.js";

const ready = load();

self.onmessage = async ({data: {points, options}}) => {
  try {
    const csrbf = await ready;
    const progress = (stage, part) => self.postMessage({stage, part});
    const mesh = csrbf.reconstruct(points, {...options, progress});
    self.postMessage({mesh}, [mesh.positions.buffer, mesh.triangles.buffer, mesh.normals.buffer]);
  } catch (error) {
    self.postMessage({error: error.message});
  }
};
