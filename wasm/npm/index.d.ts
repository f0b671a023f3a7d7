/** Numbers, flat (x0, y0, z0, x1, ...) or one array for each point. */
export type Numbers = ArrayLike<number> | ReadonlyArray<ArrayLike<number>>;

/** Told the stage and the part of it that is done, from 0 to 1; `false` ends the work, which then throws "Cancelled". */
export type Listener = (stage: string, part: number) => boolean | void;

/** Triangles over shared vertices, counter-clockwise seen from outside. */
export interface Mesh {
  /** x, y, z of each vertex. */
  positions: Float64Array;
  /** Three numbers of vertices for each triangle. */
  triangles: Uint32Array;
  /** Outward unit normals of the vertices. */
  normals: Float64Array;
}

export interface ReconstructReport {
  method: string;
  /** Where the normals come from: "file" (given), "estimated", "re-oriented" or "corrected". */
  normals: string;
  points: number;
  pointsUsed: number;
  centers: number;
  smoothing: number;
  /** Distances of the points used to the surface, as fractions of the diagonal of their box. */
  rmsDistance: number;
  p99Distance: number;
  maxDistance: number;
  patches?: number;
  levels?: number;
  crossValidationError?: number;
  prepareSeconds: number;
  fitSeconds: number;
  evaluateSeconds: number;
  warnings: string[];
}

/** The flags of `csrbf reconstruct`. */
export interface ReconstructOptions {
  /** Outward normals, one for each point; otherwise they are estimated. */
  normals?: Numbers;
  /** "auto", "composite", "medial-axis", ...; an unknown name lists them. */
  method?: string;
  /** Budget of centres; 0: the data decide. */
  centers?: number;
  /** Largest distance of a point to the surface, as a fraction of the diagonal; 0: no limit. */
  tolerance?: number;
  smoothing?: number | "auto" | "none";
  /** Cells along the longest side; 0: from the data. */
  resolution?: number;
  /** Whether the mesh keeps sharp edges. */
  sharp?: "auto" | "on" | "off";
  /** Opens the surface where it is farther than this from all points, in units of their spacing. */
  trim?: number | null;
  /** Whether the result has the surface itself as `model`. */
  model?: boolean;
  progress?: Listener;
}

export interface FitReport {
  method: string;
  kernel: string;
  samples: number;
  samplesFitted: number;
  mergedDuplicates: number;
  missing: number;
  grossErrors: number[];
  /** Of few samples those far from what those around them say, but kept. */
  suspects: number[];
  centers: number;
  levels: number;
  patches: number;
  degree: number;
  smoothing: number | null;
  rmse: number | null;
  maxError: number | null;
  crossValidationRmse: number | null;
  axisScales: number[];
  /** Unit vectors along which these are; empty: along the axes of the coordinates. */
  axes: number[][];
  drift: number[];
  driftDeviations: number[];
  noise: number[];
  chooseSeconds: number;
  fitSeconds: number;
  warnings: string[];
}

/** The flags of `csrbf fit`. */
export interface FitOptions {
  /** Coordinates of each point, from 1 to 3; needed where neither arrays of points nor the number of values tell. */
  dimension?: number;
  /** Values of each point; 1 by default. */
  components?: number;
  /** Inverse variances of the values, one for each point. */
  weights?: ArrayLike<number>;
  /** "auto", "interpolate", "partition-of-unity", ...; an unknown name lists them. */
  method?: string;
  /** "auto", "wendland-c2", "gaussian", ...; an unknown name lists them. */
  kernel?: string;
  kernelParameter?: number;
  centers?: number;
  tolerance?: number;
  smoothing?: number | "auto" | "none";
  degree?: number | "auto";
  loss?: "auto" | "squares" | "huber" | "student";
  transform?: "auto" | "none" | "sqrt" | "log";
  extrapolation?: "auto" | "constant" | "linear" | "trend" | "nan";
  /** Period of each coordinate, 0 for none. */
  periods?: number[];
  /** The axes of longitude and latitude, from 0. */
  sphere?: [number, number];
  /** Axes, from 0, that enter linearly. */
  drift?: number[];
  /** Samples with this value are left out. */
  missing?: number | null;
  scaleAxes?: boolean;
  /** Know standard deviations by every method: by a second fit, where the method has none. */
  standardDeviation?: boolean;
  progress?: Listener;
}

/** The flags of `csrbf polygonize`. */
export interface PolygonizeOptions {
  method?: "auto" | "marching-cubes" | "marching-tetrahedra" | "dual-contouring" | "adaptive";
  resolution?: number;
  level?: number;
  tolerance?: number;
  persistence?: number;
  refine?: boolean;
  /** The lowest x, y, z, then the highest: the solid is cut off there. */
  bounds?: ArrayLike<number>;
  trim?: number | null;
  progress?: Listener;
}

export interface SegmentReport {
  energy: string;
  shading: string;
  mode: string;
  method: string;
  regions: {label: number; voxels: number; volume: number; mean: number; sd: number}[];
  iterations: number;
  converged: boolean;
  components: number;
  noise: number;
  /** Energy after each step. */
  steps: number[];
  /** Nats of each model above the one chosen. */
  prices?: {energy: string; shading: string; nats: number}[];
  /** Deviation of the noise at bright over that at dark voxels, where it grows. */
  noise_growth?: number;
  /** Largest deviation of the noise over the least, where it varies over the place. */
  uneven_noise?: number;
  /** Voxels that one independent value of blurred noise covers. */
  grain?: number;
  /** Deviation of the Gaussian, in voxels, where more than two regions are classes of the blurred image. */
  blur?: number;
  /** Share of dead and hot voxels. */
  impulses?: number;
  /** Share of missing voxels. */
  missing?: number;
  speckle?: number;
  channels?: number[];
  warnings: string[];
}

/** The flags of `csrbf segment`. */
export interface SegmentOptions {
  /** Values of each voxel, which follow each other in the image. */
  components?: number;
  /** Distance of the voxels along x, y (and z). */
  spacing?: ArrayLike<number>;
  /** Centre of the first voxel. */
  origin?: ArrayLike<number>;
  /** 1 where the inside starts, for each voxel. */
  init?: ArrayLike<number>;
  /** 1 + the label of voxels that are known, else 0. */
  seeds?: ArrayLike<number>;
  /** Probability that a seed is right; below 1, clear intensities overrule it. */
  seedConfidence?: number;
  /** Value of voxels that are missing, as NaN always are. When not given, a block or frame of one value is, too. */
  missing?: number;
  /** 0 in voxels to ignore. */
  mask?: ArrayLike<number>;
  energy?: "auto" | "chan-vese" | "gaussian" | "generalized-gaussian" | "rayleigh" | "gamma" | "edge";
  mode?: "global" | "local";
  method?: "variational" | "collocation" | "finite-difference";
  shading?: "auto" | "none" | "linear" | "quadratic" | "smooth" | "objects" | "background";
  regions?: number;
  centerSpacing?: number | "auto";
  support?: number | "auto";
  kernel?: string;
  smoothness?: number | "auto";
  window?: number | "auto";
  balloon?: number;
  fillHoles?: boolean | "auto";
  iterations?: number;
  /** Whether the result has the contour; true by default. */
  contour?: boolean;
  /** Whether the result has the level sets as `model`. */
  model?: boolean;
  /** Whether the result has the objects that label 1 consists of. */
  objects?: boolean;
  /** Smaller objects, in voxels, are left out; by default those below a tenth of the median of all. */
  minSize?: number;
  progress?: Listener;
}

export interface SegmentedObject {
  label: number;
  voxels: number;
  volume: number;
  area: number;
  centroid: number[];
  mean: number;
  sphericity: number;
}

/** Labels of an image, with the contour around each label but 0. */
export interface Segmentation {
  /** One for each voxel; 0 is outside. */
  labels: Uint8Array;
  report: SegmentReport;
  /** In the plane: x, y of the points of all lines. Absent without contour and in space. */
  contour?: Float64Array;
  /** In the plane: for each closed line its first point, the number of its points and its label. */
  lines?: Uint32Array;
  /** In space: the surfaces of all labels, and the label of each vertex. */
  positions?: Float64Array;
  triangles?: Uint32Array;
  normals?: Float64Array;
  regions?: Uint8Array;
  /** Length and area (in space: area and volume) of each label. */
  measures?: {label: number; length?: number; area: number; volume?: number}[];
  objects?: SegmentedObject[];
  /** How many were too small. */
  objectsLeftOut?: number;
  /** The number of its object for each voxel, or 0. */
  objectLabels?: Uint32Array;
  model?: Model;
}

/** A fitted function, or a surface: positive inside, zero on it. It takes memory until delete(). */
export interface Model {
  readonly dimension: number;
  readonly components: number;
  /** The box of the data: the lowest corner, then the highest. */
  readonly bounds: number[];
  readonly report?: FitReport | ReconstructReport;
  /** `components` values for each point. */
  evaluate(points: Numbers): Float64Array;
  /** For each point and component the derivatives along the axes. */
  gradient(points: Numbers): Float64Array;
  /** Of a sample there from the value, or of the function alone. */
  standardDeviation(points: Numbers, of?: "sample" | "function"): Float64Array;
  polygonize(options?: PolygonizeOptions): Mesh;
  /** The bytes of a .csrbf file, which the program and Python read too. */
  toBytes(): Uint8Array;
  delete(): void;
}

/** The functions. Errors of the library have the name InvalidInput, SolverFailure, IoError or Cancelled. */
export interface Csrbf {
  readonly version: string;
  /** The closed surface through, or under noise near, points in space. */
  reconstruct(points: Numbers, options?: ReconstructOptions): Mesh & {report: ReconstructReport; model?: Model};
  /** A smooth function of 1 to 3 variables from samples. */
  fit(points: Numbers, values: Numbers, options?: FitOptions): Model;
  /** The mesh of a surface, or of a function of three variables. */
  polygonize(model: Model, options?: PolygonizeOptions): Mesh;
  /** Regions of an image of `shape` [rows, columns] or [slices, rows, columns], the last one fastest. */
  segment(image: ArrayLike<number>, shape: ArrayLike<number>, options?: SegmentOptions): Segmentation;
  /** From the bytes of a .csrbf file. */
  readModel(bytes: Uint8Array): Model;
}

/**
 * Loads the module, which has memory of its own. `wasm`: its address, bytes or compiled form where it is not beside this
 * file.
 */
export function load(options?: {wasm?: string | URL | ArrayBuffer | Uint8Array | WebAssembly.Module}): Promise<Csrbf>;
