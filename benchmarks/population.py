#!/usr/bin/python3
"""Reconstructs many shapes, each sampled in many ways, and writes a summary and the worst cases into a page of tables.

usage: population.py --tools DIR --meshes DIR [--csrbf PROGRAM] [--cases NAME,NAME,...] [--only NAME,NAME,...]
                     [--work DIR] [--output FILE]

  --tools DIR    holds population.py, which makes the clouds, and evaluate_mesh.py, which measures the errors
  --meshes DIR   holds the shapes: closed meshes, *.ply
  --csrbf PROGRAM  default: build/release/bin/csrbf
  --cases NAMES    ways of sampling, see population.py of --tools; default: all of them
  --only NAMES     shapes; default: all of them
  --work DIR       keeps clouds, meshes and errors: what is there is not made again; default: build/population
  --output FILE    default: benchmarks/SURFACES.md, of which only the section "Population" is replaced, after every shape

Where the points have normals, Open3D's Poisson reconstruction stands beside csrbf, the better of two depths by the true
surface. Without Open3D (Debian: python3-open3d) its rows are left out. Needs numpy and scipy.
"""

import argparse
import datetime
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

import surfaces

PROJECT = Path(__file__).resolve().parent.parent
HEADING = "## Population"
DEPTHS = {30_000: [7, 8], 10**9: [8, 9]}  # of the octree of Poisson reconstruction, up to numbers of points
WORST = 5
SAMPLES = 20_000  # of both surfaces, to compare them
COLUMNS = [("chamfer", "chamfer"), ("99 % Hausdorff", "haus99"), ("normals", "nrm_mean"), ("farthest", "farthest")]

LEGEND = """Errors as in the legend below, in 1e-4 of the diagonal. **right**: meshes that are watertight and have the true
number of components and the true Euler number. **normals**: mean angle in degrees between the normals of both surfaces.
**farthest**: largest distance of 20,000 points of the mesh from the true surface, in spacings of the samples
(the root of the area per sample)."""


def make_clouds(tools, mesh, work, cases, result):
    """Samples a mesh in every case; writes the files, and whether they have normals."""
    sys.path.insert(0, tools)
    import population
    import trimesh_io

    clouds = {}
    for case in cases.split(","):
        cloud = population.make(mesh, case, work)
        clouds[case] = [cloud, trimesh_io.read_points(cloud)[1] is not None]
    surfaces.write_json(result, clouds)


def evaluate(tools, truth, result, *pairs):
    """Measures meshes, each followed by the number of samples it was made from, against a mesh."""
    sys.path.insert(0, tools)
    import evaluate_mesh
    import numpy
    import population

    reference = evaluate_mesh.load_gt(truth)
    components, euler = population.topology(reference.V, reference.F)
    area = evaluate_mesh.face_normals(reference.V, reference.F)[1].sum()
    numbers = {}
    for mesh, samples in zip(pairs[::2], pairs[1::2]):
        found = evaluate_mesh.evaluate(mesh, reference, SAMPLES)
        spacing = 1e4 * numpy.sqrt(area / int(samples)) / reference.diag
        right = found["watertight"] and found["comps"] == components and found["euler"] == euler
        numbers[mesh] = {name: float(found[name]) for name in ("chamfer", "haus99", "nrm_mean")}
        numbers[mesh].update(farthest=float(found["acc_max"] / spacing), right=bool(right))
    surfaces.write_json(result, numbers)


SUBCOMMANDS = {"_clouds": make_clouds, "_evaluate": evaluate}


def run_self(log, name, *arguments):
    cost = surfaces.run([sys.executable, __file__, name, *arguments], log)
    if cost is None:
        sys.exit(f"population.py: {name} failed, see {log}")


def samples_of(cloud):
    """Number of points of a PLY file."""
    with open(cloud, "rb") as file:
        for line in file:
            if line.startswith(b"element vertex"):
                return int(line.split()[2])
    sys.exit(f"{cloud}: no element vertex")


def run_mesh(mesh, options, with_open3d):
    """Rows of one shape: case, tool, numbers; numbers is None where the tool failed."""
    work, stem = options.work, options.work / mesh.stem
    clouds_file = Path(f"{stem}_clouds.json")
    run_self(f"{stem}_clouds.log", "_clouds", options.tools, mesh, work, ",".join(options.cases), clouds_file)
    rows, measured = [], []
    for case, (cloud, has_normals) in json.loads(clouds_file.read_text()).items():
        made = {"csrbf": surfaces.run_csrbf(options.csrbf, cloud, f"{stem}_{case}")}
        if with_open3d and has_normals:
            for depth in next(depths for most, depths in DEPTHS.items() if samples_of(cloud) <= most):
                made[f"Poisson {depth}"] = surfaces.run_poisson(cloud, f"{stem}_{case}", depth)
        for tool, (reconstruction, cost) in made.items():
            rows.append([case, tool, str(reconstruction), cost])
            if cost is not None:
                measured += [reconstruction, samples_of(cloud)]
    result = Path(f"{stem}_errors.json")
    run_self(f"{stem}_errors.log", "_evaluate", options.tools, mesh, result, *measured)
    errors = json.loads(result.read_text())
    return [(case, tool, None if cost is None else {**cost, **errors[name]}) for case, tool, name, cost in rows]


def better_poisson(rows):
    """The better of the depths for each shape."""
    best = {}
    for name, numbers in rows:
        if numbers is not None and (name not in best or numbers["chamfer"] < best[name]["chamfer"]):
            best[name] = numbers
    return list(best.items())


def summary(case, tool, rows, count):
    good = [numbers for _, numbers in rows if numbers is not None]
    if not good:
        return f"| {case} | {tool} | 0 of {count} |" + " failed |" * (len(COLUMNS) + 1)
    cells = []
    for _, key in COLUMNS:
        values = [numbers[key] for numbers in good]
        cells.append(f"{statistics.median(values):.3g} / {max(values):.3g}")
    right, cpu = sum(numbers["right"] for numbers in good), statistics.median(numbers["cpu"] for numbers in good)
    return f"| {case} | {tool} | {right} of {count} | " + " | ".join(cells) + f" | {cpu:.2f} |"


def worst(case, rows):
    good = [(name, numbers) for name, numbers in rows if numbers is not None]
    cells = []
    for _, key in COLUMNS:
        listed = sorted(good, key=lambda row: -row[1][key])[:WORST]
        cells.append(", ".join(f"{name} {numbers[key]:.3g}" for name, numbers in listed))
    return f"| {case} | " + " | ".join(cells) + " |"


def section(options, open3d, results, count):
    titles = " | ".join(title for title, _ in COLUMNS)
    lines = [HEADING, "", f"* {datetime.date.today().isoformat()}; {surfaces.cpu()}, load {os.getloadavg()[0]:.1f} at "
             f"the end; {subprocess.run([options.csrbf, '--version'], capture_output=True, text=True, check=True).stdout.splitlines()[0]}",
             surfaces.describe_open3d(open3d), "", "```sh",
             "benchmarks/population.py --tools TOOLS --meshes MESHES --cases " + ",".join(options.cases), "```", "",
             LEGEND, "", "Medians and worst cases:", "",
             f"| case | tool | right | {titles} | CPU s |", "|---|---|---:|" + "---:|" * (len(COLUMNS) + 1)]
    for case in options.cases:
        lines.append(summary(case, "csrbf", results[case]["csrbf"], count))
        if results[case]["Poisson"]:
            lines.append(summary(case, "Poisson", better_poisson(results[case]["Poisson"]), count))
    lines += ["", f"The worst {WORST} of csrbf in each column:", "", f"| case | {titles} |",
              "|---|" + "---|" * len(COLUMNS)]
    lines += [worst(case, results[case]["csrbf"]) for case in options.cases]
    return "\n".join([*lines, ""])


def replace_section(page, text):
    """The page with its section of that heading replaced, or added before the legend."""
    start = page.find(HEADING + "\n")
    if start < 0:
        start = end = page.find("## Legend") if "## Legend" in page else len(page)
    else:
        end = page.find("\n## ", start)
        end = len(page) if end < 0 else end + 1
    return page[:start] + text + "\n" + page[end:]


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tools", type=Path, required=True)
    parser.add_argument("--meshes", type=Path, required=True)
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--cases")
    parser.add_argument("--only")
    parser.add_argument("--work", type=Path, default=PROJECT / "build/population")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SURFACES.md")
    return parser.parse_args(arguments)


def main(arguments):
    sys.dont_write_bytecode = True
    if arguments and arguments[0] in SUBCOMMANDS:
        SUBCOMMANDS[arguments[0]](*arguments[1:])
        return
    options = parse(arguments)
    for needed in (options.tools / "population.py", options.tools / "evaluate_mesh.py", options.meshes, options.csrbf):
        if not needed.exists():
            sys.exit(f"population.py: {needed} does not exist")
    if options.cases is None:
        sys.path.insert(0, str(options.tools))
        import population
        options.cases = population.CASES
    else:
        options.cases = options.cases.split(",")
    only = options.only.split(",") if options.only else None
    meshes = [mesh for mesh in sorted(options.meshes.glob("*.ply")) if only is None or mesh.stem in only]
    options.work.mkdir(parents=True, exist_ok=True)
    open3d = surfaces.module_version(options.work, "open3d")
    results = {case: {"csrbf": [], "Poisson": []} for case in options.cases}
    for mesh in meshes:
        print(mesh.stem, flush=True)
        for case, tool, numbers in run_mesh(mesh, options, open3d is not None):
            results[case]["csrbf" if tool == "csrbf" else "Poisson"].append((mesh.stem, numbers))
        done = meshes.index(mesh) + 1
        page = options.output.read_text() if options.output.exists() else ""
        options.output.write_text(replace_section(page, section(options, open3d, results, done)))
    print(f"written: {options.output}")


if __name__ == "__main__":
    main(sys.argv[1:])
