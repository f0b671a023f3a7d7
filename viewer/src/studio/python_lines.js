// Lines in Python that write the same files as a command.

import {HIDDEN, imageExtension} from "./commands.js";

const python = (text) => JSON.stringify(text);
const LISTS = new Set(["--periods", "--channels"]);

// A flag as keyword of the function of that name.
function keyword([flag, value]) {
  const name = flag.replace(/^--/, "").replace(/-/g, "_");
  if (value === true) return `${name}=True`;
  if (LISTS.has(flag)) return `${name}=[${value}]`;
  if (value !== "" && Number.isFinite(Number(value))) return `${name}=${value}`;
  return `${name}=${python(value)}`;
}

/** "2GB" or "2GiB" as a number of bytes, as the program reads sizes. */
function bytes(text) {
  const [, number, unit, binary] = /^([0-9.]+)([MGT])(i?)B$/.exec(text) || [];
  return Number(number) * (binary ? 1024 : 1000) ** (2 + "MGT".indexOf(unit));
}

/**
 * The same in Python.
 * @param {{command: string, inputs: string[], flags: [string, string|true][], outputs: [string, string][],
 *   columns?: {coordinates: number[], values: number[], weights: number[], names: string[], named: boolean,
 *   separator: string, firstLine: number, namesInComment: boolean}}} run columns: of a table; firstLine: that of the first row
 */
export function pythonLines({command, inputs, flags, outputs, columns}) {
  const output = (flag) => (outputs.find(([name]) => name === flag) || [])[1];
  const options = flags.filter(([flag]) => !HIDDEN.has(flag));
  const of = (names) => options.filter(([flag]) => names.includes(flag)).map(keyword);
  const except = (names) => options.filter(([flag]) => !names.includes(flag)).map(keyword);
  const call = (name, args) => `csrbf.${name}(${args.filter(Boolean).join(", ")})`;
  const [input] = inputs;
  const saves = (variable) => (output("--model") ? [`${variable}.save(${python(output("--model"))})`] : []);
  const meshed = ["--resolution", "--sharp", "--trim"];
  const value = (flag) => (flags.find(([name]) => name === flag) || [])[1];
  const tuple = (text, separator) => `(${String(text).split(separator).join(", ")})`;
  switch (command) {
    case "reconstruct": {
      const methods = {on: "dual-contouring", off: "marching-cubes"};
      const sharp = methods[value("--sharp")] ? `method=${python(methods[value("--sharp")])}` : "";
      const trim = Number.isFinite(Number(value("--trim"))) ? of(["--trim"]) : [];
      return ["import csrbf", "", `cloud = csrbf.read_points(${python(input)})`,
        `surface = ${call("reconstruct", ["cloud", value("--normals") === "estimate" ? "" : "cloud.normals", ...except([...meshed, "--normals"])])}`,
        `surface.polygonize(${[...of(["--resolution"]), sharp, ...trim].filter(Boolean).join(", ")}).save(${python(output("-o"))})`, ...saves("surface")];
    }
    case "estimate-normals":
      return ["import csrbf", "", `cloud = csrbf.read_points(${python(input)})`,
        `normals = ${call("estimate_normals", ["cloud", ...except([])])}`,
        `csrbf.PointCloud(cloud.points, normals).save(${python(output("-o"))})`];
    case "polygonize":
      return ["import csrbf", "", `surface = csrbf.load(${python(input)})`,
        `surface.polygonize(${except([]).join(", ")}).save(${python(output("-o"))})`];
    case "combine":
      return ["import csrbf", "", `parts = [csrbf.load(name) for name in ${JSON.stringify(inputs.slice(1))}]`,
        `${call("combine", [python(inputs[0]), "*parts", ...except([])])}.save(${python(output("-o"))})`];
    case "fit": {
      // Of the points of a scanner the height is the value; .xyz is a table without names.
      if (!columns && !/\.xyz(\.gz)?$/i.test(input)) {
        const list = (flag, otherwise) => (value(flag) ? value(flag).split(",") : otherwise);
        const names = (columns) => (columns.length === 1 ? python(columns[0]) : `[${columns.map(python).join(", ")}]`);
        return ["import csrbf", "import pandas as pd", "", `cloud = csrbf.read_points(${python(input)})`,
          'table = pd.DataFrame(cloud.points, columns=["x", "y", "z"]).assign(**cloud.properties)',
          `f = ${call("fit", ["table", names(list("--values", ["z"])), `coordinates=[${list("--coordinates", ["x", "y"]).map(python).join(", ")}]`,
            value("--weights") ? `weights=${python(value("--weights"))}` : "", ...except(["--coordinates", "--values", "--weights"])])}`,
          `f.save(${python(output("-o"))})`];
      }
      columns = columns || {coordinates: [], values: [], weights: [], names: [], named: false, separator: " ", firstLine: 1};
      const {separator, firstLine} = columns;
      const apart = {",": "", " ": String.raw`r"\s+"`}[separator] ?? python(separator);
      // A table of pandas has the names of its columns, which the model keeps.
      if (columns.named && !/\.npy(\.gz)?$/i.test(input)) {
        const name = (column) => python(columns.names[column]);
        const list = (role) => `[${columns[role].map(name).join(", ")}]`;
        const values = columns.values.length === 1 ? name(columns.values[0]) : list("values");
        // Where comments come first, or hold the names.
        const head = firstLine === 2 && !columns.namesInComment ? "" : `skiprows=${firstLine - 1}, names=[${columns.names.map(python).join(", ")}]`;
        const reading = [python(input), apart && `sep=${apart}`, head, separator !== " " && "skipinitialspace=True", 'float_precision="round_trip"'].filter(Boolean);
        return ["import csrbf", "import pandas as pd", "", `table = pd.read_csv(${reading.join(", ")})`,
          `f = ${call("fit", ["table", values, `coordinates=${list("coordinates")}`,
            columns.weights.length ? `weights=${name(columns.weights[0])}` : "", ...except(["--coordinates", "--values", "--weights"])])}`,
          `f.save(${python(output("-o"))})`];
      }
      const delimiter = separator !== " " && `delimiter=${python(separator)}`;
      const reading = /\.npy$/i.test(input) ? `table = np.load(${python(input)})`
        : /\.npy\.gz$/i.test(input) ? `table = np.load(gzip.open(${python(input)}))`
        : `table = np.genfromtxt(${[python(input), delimiter, firstLine > 1 && `skip_header=${firstLine - 1}`].filter(Boolean).join(", ")})`;
      const pick = (list, otherwise) => (list.length ? `table[:, ${list.length === 1 && otherwise !== ":-1" ? list[0] : `[${list.join(", ")}]`}]` : `table[:, ${otherwise}]`);
      return ["import csrbf", "import numpy as np", ...(reading.includes("gzip.") ? ["import gzip"] : []), "", reading,
        `f = ${call("fit", [pick(columns.coordinates, ":-1"), pick(columns.values, "-1"),
          columns.weights.length ? `weights=table[:, ${columns.weights[0]}]` : "",
          ...except(["--coordinates", "--values", "--weights"])])}`, `f.save(${python(output("-o"))})`];
    }
    case "segment": {
      const seeds = flags.find(([flag]) => flag === "--seeds");
      const g = `g = ${call("segment", [python(input), ...(seeds ? [`seeds=${python(seeds[1])}`] : []), ...except([])])}`;
      const contour = output("--contour");
      const isSurface = /\.ply$/.test(contour || "") && !(Number(value("--regions")) > 2);
      const more = isSurface ? [`g.contour().save(${python(contour)})`] : [];
      if (!value("--objects")) return ["import csrbf", "", g, `g.save(${python(output("-o"))})`, ...more];
      return ["import csrbf", "import numpy as np", "", `image = csrbf.read_image(${python(input)})`, g,
        "objects = g.objects.astype(np.min_scalar_type(g.objects.max()))",
        `csrbf.Image(objects, image.spacing, image.origin, image.direction, space=image.space).save(${python(output("-o"))})`, ...more];
    }
    case "track": {
      const frames = inputs.length > 1 ? JSON.stringify(inputs) : python(input);
      const folder = output("-o");
      return ["import os", "", "import csrbf", "", `t = ${call("track", [frames, ...except([])])}`, `os.makedirs(${python(folder)}, exist_ok=True)`,
        "for i, frame in enumerate(t):", `    frame.save(f${python(`${folder}/labels_{i:04}${imageExtension(input)}`)})`,
        ...(value("--contour") === "ply" && !(Number(value("--regions")) > 2) ? [`    frame.contour().save(f${python(`${folder}/contours_{i:04}.ply`)})`] : [])];
    }
    case "inpaint":
      if (value("--memory"))
        return ["import csrbf", "",
          call("inpaint_slices", [python(input), python(output("-o")), `memory=${bytes(value("--memory"))}`, ...except(["--memory"])])];
      return ["import csrbf", "", `filled = ${call("inpaint", [python(input), ...except([])])}`, `filled.save(${python(output("-o"))})`];
    case "curvature":
      return ["import csrbf", "", `surface = csrbf.load(${python(input)})`, `mesh = surface.polygonize(${of(["--resolution"]).join(", ")})`,
        "c = surface.curvature(mesh.vertices)", 'values = {"k1": c.k1, "k2": c.k2}',
        "for i, direction in (1, c.direction1), (2, c.direction2):",
        '    values |= {f"d{i}{axis}": direction[:, k] for k, axis in enumerate("xyz")}',
        'values |= {"mean_curvature": c.mean, "gaussian_curvature": c.gaussian}',
        'values = {name: value.astype("float32") for name, value in values.items()}',
        `csrbf.Mesh(mesh.vertices, mesh.faces, surface.normal(mesh.vertices), values).save(${python(output("-o"))})`,
        ...(output("--ridges") ? [`surface.ridges(mesh).save(${python(output("--ridges"))})`] : [])];
    case "evaluate": {
      const grid = value("--grid") === undefined || value("--grid") === true ? "" : `grid=${/,/.test(value("--grid")) ? tuple(value("--grid"), ",") : value("--grid")}`;
      return ["import csrbf", "import numpy as np", "", `values = ${call("evaluate", [python(input), grid, ...except(["--grid"])])}`,
        `np.save(${python(output("-o"))}, values)`];
    }
    case "render": {
      const options = [value("--size") ? `size=${tuple(value("--size"), "x")}` : "", value("--view") ? `view=${tuple(value("--view"), ",")}` : "", ...except(["--size", "--view"])];
      return ["import csrbf", "", `surface = csrbf.${/\.csrbf$/.test(input) ? "load" : "read_mesh"}(${python(input)})`,
        call("render", [python(output("-o")), ...options]).replace("csrbf.", "surface.")];
    }
    case "compare":
      return ["import csrbf", "", `print(csrbf.compare(${inputs.map((name) => `csrbf.read_mesh(${python(name)})`).join(", ")}))`];
    default:
      return [];
  }
}
