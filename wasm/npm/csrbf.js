// The functions of the package, on a module of WebAssembly that node.js or browser.js has found. Arguments are copied into
// its memory, results out of it.

const RESULT_TYPES = {f8: Float64Array, i4: Int32Array, u4: Uint32Array, u1: Uint8Array};

/** Numbers as one flat array, and how many there are of each point: undefined for a flat array. */
function flat(numbers, name) {
  if (ArrayBuffer.isView(numbers) && !(numbers instanceof DataView)) return {array: numbers};
  if (!Array.isArray(numbers)) throw new TypeError(`${name}: must be an array of numbers, or of points`);
  if (!Array.isArray(numbers[0]) && !ArrayBuffer.isView(numbers[0])) return {array: numbers};
  const each = numbers[0].length;
  const array = new Float64Array(each * numbers.length);
  numbers.forEach((point, i) => {
    if (point.length !== each) throw new TypeError(`${name}: point ${i} has ${point.length} numbers, the first one ${each}`);
    array.set(point, each * i);
  });
  return {array, each};
}

/** How many points a flat array holds. */
function countOf({array, each}, dimension, name) {
  if (each !== undefined && each !== dimension) throw new TypeError(`${name}: each must have ${dimension} numbers, not ${each}`);
  if (array.length % dimension !== 0)
    throw new TypeError(`${name}: ${array.length} numbers are not a multiple of ${dimension}, the numbers of each point`);
  return array.length / dimension;
}

const listed = (key, value) => (ArrayBuffer.isView(value) ? Array.from(value) : value);

/** The memory that the arguments of one call take. */
class Arguments {
  #module;
  #addresses = [];

  constructor(module) {
    this.#module = module;
  }

  #take(bytes) {
    const address = this.#module._malloc(Math.max(1, bytes)) >>> 0;
    if (address === 0) throw new RangeError(`csrbf: no memory for ${bytes} bytes; a page has at most 4 GB`);
    this.#addresses.push(address);
    return address;
  }

  /** The address of a copy; 0 for none. */
  array(values, type) {
    if (values === undefined || values === null) return 0;
    const address = this.#take(values.length * type.BYTES_PER_ELEMENT);
    new type(this.#module.HEAPU8.buffer, address, values.length).set(values);
    return address;
  }

  text(text) {
    const bytes = this.#module.lengthBytesUTF8(text) + 1;
    const address = this.#take(bytes);
    this.#module.stringToUTF8(text, address, bytes);
    return address;
  }

  options(options) {
    return this.text(JSON.stringify(options, listed));
  }

  release() {
    for (const address of this.#addresses) this.#module._free(address);
  }
}

/** A fitted function, or a surface. It lives in the memory of the module until delete(). */
export class Model {
  #csrbf;
  #address;

  constructor(csrbf, {address, ...description}) {
    this.#csrbf = csrbf;
    this.#address = address;
    Object.assign(this, description);
  }

  #living() {
    if (this.#address === 0) throw new Error("csrbf: this model was deleted");
    return this.#address;
  }

  #at(points, call) {
    const places = flat(points, "points");
    const count = countOf(places, this.dimension, "points");
    return this.#csrbf.call((args) => call(this.#living(), args.array(places.array, Float64Array), count, args));
  }

  evaluate(points) {
    return this.#at(points, (model, x, n) => ["evaluate", model, x, this.dimension, n, 0]).value;
  }

  gradient(points) {
    return this.#at(points, (model, x, n) => ["evaluate", model, x, this.dimension, n, 1]).gradient;
  }

  standardDeviation(points, of = "sample") {
    return this.#at(points, (model, x, n, args) => ["deviation", model, x, this.dimension, n, args.text(of)]).value;
  }

  polygonize({progress, ...options} = {}) {
    return this.#csrbf.call((args) => ["polygonize", this.#living(), args.options(options)], progress);
  }

  toBytes() {
    return this.#csrbf.call(() => ["to_bytes", this.#living()]).bytes;
  }

  delete() {
    if (this.#address !== 0) this.#csrbf.module._csrbf_delete(this.#address);
    this.#address = 0;
  }
}
if (Symbol.dispose) Model.prototype[Symbol.dispose] = Model.prototype.delete;

/** The functions, on one module. */
export class Csrbf {
  constructor(module) {
    this.module = module;
    this.version = module.UTF8ToString(module._csrbf_version());
  }

  /** Calls the function that `prepare` names with its arguments; throws its error. */
  call(prepare, progress) {
    const {module} = this;
    const args = new Arguments(module);
    let thrown;
    // An exception must not pass through the module: it ends the work, and is thrown again afterwards.
    const listener = (stage, part) => {
      try {
        return progress(stage, part) === false ? 0 : 1;
      } catch (error) {
        thrown = {error};
        return 0;
      }
    };
    let answer = 0;
    try {
      const [name, ...given] = prepare(args);
      if (!module[`_csrbf_${name}`]) throw new Error(`csrbf: ${name} is not in "csrbf/surfaces"; import from "csrbf"`);
      if (progress) module.listener = listener;
      answer = module[`_csrbf_${name}`](...given) >>> 0;
      if (thrown) throw thrown.error;
      return this.#read(answer);
    } finally {
      module.listener = undefined;
      args.release();
      if (answer) module._csrbf_release(answer);
    }
  }

  #read(answer) {
    const {arrays = [], error, name, model, ...result} = JSON.parse(this.module.UTF8ToString(this.module._csrbf_text(answer)));
    if (error !== undefined) throw Object.assign(new Error(error), {name});
    for (const {name, type, address, count} of arrays) {
      const values = new RESULT_TYPES[type](count);
      if (count > 0) values.set(new RESULT_TYPES[type](this.module.HEAPU8.buffer, address, count));
      result[name] = values;
    }
    if (model) result.model = new Model(this, {...model, report: result.report});
    return result;
  }

  reconstruct(points, {normals, progress, ...options} = {}) {
    const places = flat(points, "points");
    const count = countOf(places, 3, "points");
    const directions = normals ? flat(normals, "normals") : {array: []};
    const normalCount = countOf(directions, 3, "normals");
    return this.call(
      (args) => [
        "reconstruct",
        args.array(places.array, Float64Array),
        count,
        args.array(directions.array, Float64Array),
        normalCount,
        args.options(options),
      ],
      progress,
    );
  }

  fit(points, values, {weights, dimension, components, progress, ...options} = {}) {
    const places = flat(points, "points");
    const data = flat(values, "values");
    const eachValue = components ?? data.each ?? 1;
    const count = countOf(data, eachValue, "values");
    const each = dimension ?? places.each ?? places.array.length / count;
    if (countOf(places, each, "points") !== count)
      throw new TypeError(`points: ${places.array.length} numbers do not fit ${count} values`);
    if (weights && weights.length !== count) throw new TypeError(`weights: ${weights.length} do not fit ${count} values`);
    return this.call(
      (args) => [
        "fit",
        args.array(places.array, Float64Array),
        each,
        count,
        args.array(data.array, Float64Array),
        eachValue,
        args.array(weights, Float64Array),
        args.options(options),
      ],
      progress,
    ).model;
  }

  polygonize(model, options) {
    return model.polygonize(options);
  }

  segment(image, shape, {components = 1, init, seeds, mask, progress, ...options} = {}) {
    if (shape.length !== 2 && shape.length !== 3) throw new TypeError("shape: must be [rows, columns] or [slices, rows, columns]");
    const [nz, ny, nx] = shape.length === 2 ? [1, ...shape] : shape;
    const voxels = nx * ny * nz;
    if (image.length !== voxels * components)
      throw new TypeError(`image: ${image.length} numbers do not fit the shape, ${[...shape, components].join(" x ")}`);
    for (const [name, array] of Object.entries({init, seeds, mask}))
      if (array && array.length !== voxels) throw new TypeError(`${name}: ${array.length} numbers, the image has ${voxels}`);
    return this.call(
      (args) => [
        "segment",
        args.array(image, Float32Array),
        nx,
        ny,
        nz,
        components,
        args.array(init, Uint8Array),
        args.array(seeds, Uint8Array),
        args.array(mask, Uint8Array),
        args.options(options),
      ],
      progress,
    );
  }

  readModel(bytes) {
    return this.call((args) => ["from_bytes", args.array(bytes, Uint8Array), bytes.length]).model;
  }
}

/** @param {WebAssembly.Module} compiled @param {(options: object) => Promise<object>} createModule */
export function start(compiled, createModule) {
  return new Promise((resolve, reject) => {
    const instantiateWasm = (imports, receive) => {
      WebAssembly.instantiate(compiled, imports).then(receive, reject);
      return {};
    };
    createModule({instantiateWasm}).then((module) => resolve(new Csrbf(module)), reject);
  });
}
