import type {Csrbf, Model} from "./index.d.ts";

export type {Listener, Mesh, Model, Numbers, PolygonizeOptions, ReconstructOptions, ReconstructReport} from "./index.d.ts";

/** Surfaces alone, in half the bytes: models have neither `standardDeviation` nor `toBytes`. */
export type Surfaces = Pick<Csrbf, "version" | "reconstruct" | "polygonize">;

export function load(options?: {wasm?: string | URL | ArrayBuffer | Uint8Array | WebAssembly.Module}): Promise<Surfaces>;
