#!/usr/bin/python3
"""Compares `csrbf reconstruct` with Open3D's screened Poisson reconstruction and writes a page of tables.

usage: surfaces.py --tools DIR --data DIR [--csrbf PROGRAM] [--cases NAME,NAME,...] [--work DIR] [--output FILE]

  --tools DIR    holds sample_mesh.py and evaluate_mesh.py, which make the clouds and measure the errors
  --data DIR     holds armadillo.ply and the scans bunny_scans_362k.ply and dragon_stand_scans.ply
  --csrbf PROGRAM  default: build/release/bin/csrbf
  --cases NAMES    default: all of them
  --work DIR       keeps clouds, which are made once, and meshes; default: build/surfaces
  --output FILE    default: benchmarks/SURFACES.md, rewritten after every case

Needs numpy and scipy. Without Open3D (Debian: python3-open3d) its rows are left out.

All work is done in child processes, and this one stays small: the peak memory the system reports for a child includes
that of its parent when the child was started.
"""

import argparse
import datetime
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
CLOUDS = ["n1m", "n100k", "noise25", "noise50", "nonuni", "holes"]
SCANS = ["bunny_scans_362k", "dragon_stand_scans"]
CASES = [f"{shape}_{cloud}" for shape in ("armadillo", "torus") for cloud in CLOUDS] + SCANS
DEPTHS = [8, 9, 10]  # of the octree of Poisson reconstruction
HELD_OUT = 0.1  # share of the points of a scan
SEED = 1

TRUTH_COLUMNS = [("chamfer", "chamfer"), ("99 % Hausdorff", "haus99")]
ANALYTIC_COLUMNS = TRUTH_COLUMNS + [("vertex rms", "vtx_rms")]
SCAN_COLUMNS = [("mean", "in_mean"), ("median", "in_p50"), ("99 %", "in_p99")]
COMMON_COLUMNS = [("triangles", "tris"), ("components", "comps"), ("Euler number", "euler"),
                  ("watertight", "watertight"), ("CPU s", "cpu"), ("wall s", "wall"), ("peak MB", "peak")]

LEGEND = """## Legend

Lengths are in 1e-4 of the bounding-box diagonal of the true surface, or of all points of a scan. Distances from points
to triangles are exact.

* **chamfer**: mean distance from 200,000 points of the mesh to the true surface and from as many points of the true
  surface to the mesh, averaged.
* **99 % Hausdorff**: 99th percentile of these distances, the larger of the two directions.
* **vertex rms**: root mean square distance from the vertices of the mesh to the true surface, which separates the error
  of the function from that of flat triangles.
* **mean, median, 99 %** (scans): distance to the mesh of a tenth of the points, chosen at random and withheld from the
  program. They include scanner noise and stray points.
* **triangles, components, Euler number** (vertices - edges + triangles): of the mesh. **watertight**: every edge has
  exactly two triangles.
* **CPU s**: user and system time of all threads. **wall s**: elapsed time. For csrbf both are those of the whole
  process, including reading and writing files; for Open3D only of the Poisson call, measured inside the process:
  start-up, the import of Open3D, reading the cloud with its normals and writing the mesh are left out.
* **peak MB**: peak resident memory of the process (1 MB = 1e6 bytes). For Open3D it includes the interpreter and the
  loaded modules, as stated above.

One run each, with the default number of threads.
"""


# Hidden sub-commands, each run in a process of its own.


def poisson(cloud, mesh, depth, result):
    """Reconstructs `cloud` by Open3D and writes the mesh, and the cost of the call alone."""
    import resource

    import open3d

    points = open3d.io.read_point_cloud(cloud)
    if not points.has_normals():
        sys.exit(f"{cloud}: has no normals")
    before, start = resource.getrusage(resource.RUSAGE_SELF), time.monotonic()
    surface, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(points, depth=int(depth))
    wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_SELF)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if not open3d.io.write_triangle_mesh(mesh, surface):
        sys.exit(f"{mesh}: cannot be written")
    write_json(result, {"cpu": cpu, "wall": wall})


def hold_out(tools, source, given, held):
    """Splits a cloud with normals at random into the points given to the programs and those held out."""
    sys.path.insert(0, tools)
    import numpy
    import trimesh_io

    points, normals = trimesh_io.read_points(source)
    if normals is None:
        sys.exit(f"{source}: has no normals")
    order = numpy.random.default_rng(SEED).permutation(len(points))
    count = round(HELD_OUT * len(points))
    for path, chosen in (held, order[:count]), (given, order[count:]):
        trimesh_io.write_ply_points(path + ".part", points[chosen], normals[chosen])
        os.replace(path + ".part", path)


def evaluate(tools, truth, source, held, result, *meshes):
    """Measures meshes against a shape or mesh `truth`, or, if that is "none", the points held out of `source`."""
    sys.path.insert(0, tools)
    import evaluate_mesh
    import trimesh_io

    inputs = trimesh_io.read_points(held)[0] if truth == "none" else None
    if truth == "none":
        reference = evaluate_mesh.NoTruth(trimesh_io.read_points(source)[0])
    else:
        reference = evaluate_mesh.load_gt(truth)
    numbers = {}
    for mesh in meshes:
        found = evaluate_mesh.evaluate(mesh, reference, inputs=inputs)
        numbers[mesh] = {name: value if isinstance(value, (bool, int)) else float(value)
                         for name, value in found.items()}
    write_json(result, numbers)


def versions(module, result):
    """Version of a Python module, and the memory of a process that has imported it."""
    import importlib
    import resource

    version = importlib.import_module(module).__version__
    write_json(result, {"version": version, "memory": megabytes(resource.getrusage(resource.RUSAGE_SELF))})


SUBCOMMANDS = {"_poisson": poisson, "_hold_out": hold_out, "_evaluate": evaluate, "_versions": versions}


# Running and measuring.


def write_json(path, content):
    Path(path).write_text(json.dumps(content))


def megabytes(usage):
    return usage.ru_maxrss * 1024 / 1e6


def run(command, log):
    """Runs a command and returns what it cost; None, after telling why, when it failed."""
    start = time.monotonic()
    with open(log, "wb") as output:
        child = subprocess.Popen([str(word) for word in command], stdout=output, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(child.pid, 0)
    wall = time.monotonic() - start
    child.returncode = os.waitstatus_to_exitcode(status)  # tells Popen that the child has been waited for
    if child.returncode != 0:
        last = Path(log).read_text(errors="replace").strip().splitlines()[-1:] or ["no message"]
        print(f"  {Path(str(command[0])).name} failed ({child.returncode}): {last[0]}", flush=True)
        return None
    return {"cpu": usage.ru_utime + usage.ru_stime, "wall": wall, "peak": megabytes(usage)}


def run_self(log, name, *arguments):
    return run([sys.executable, __file__, name, *arguments], log)


def module_version(work, module):
    result = work / f"{module}.json"
    if run_self(work / f"{module}.log", "_versions", module, result) is None:
        return None
    return json.loads(result.read_text())


def run_csrbf(program, cloud, stem):
    mesh = Path(f"{stem}_csrbf.ply")
    mesh.unlink(missing_ok=True)
    command = [program, "reconstruct", cloud, "-o", mesh, "--report", f"{stem}_csrbf.json"]
    return mesh, run(command, f"{stem}_csrbf.log")


def run_poisson(cloud, stem, depth):
    base = f"{stem}_poisson{depth}"
    mesh = Path(f"{base}.ply")
    mesh.unlink(missing_ok=True)
    cost = run_self(f"{base}.log", "_poisson", cloud, mesh, depth, f"{base}.json")
    if cost is not None:
        cost.update(json.loads(Path(f"{base}.json").read_text()))
    return mesh, cost


# Cases.


def is_scan(case):
    return case in SCANS


def split(case):
    """Shape and kind of cloud of a sampled case."""
    return case.rsplit("_", 1)


def source_file(case, options):
    """The file of --data that a case is made from; None for analytic shapes."""
    name = case if is_scan(case) else split(case)[0]
    return None if name == "torus" else options.data / f"{name}.ply"


def make_cloud(case, options):
    """The cloud given to the programs, made unless it is there already."""
    log = options.work / f"{case}_cloud.log"
    if is_scan(case):
        cloud, held = options.work / f"{case}_given.ply", options.work / f"{case}_held.ply"
        if not (cloud.exists() and held.exists()):
            run_self(log, "_hold_out", options.tools, source_file(case, options), cloud, held)
    else:
        cloud = options.work / f"{case}.ply"
        if not cloud.exists():
            shape, kind = split(case)
            unfinished = options.work / "unfinished"
            sampler = [sys.executable, "-B", options.tools / "sample_mesh.py"]
            if run([*sampler, source_file(case, options) or shape, kind, unfinished], log) is not None:
                os.replace(unfinished / cloud.name, cloud)
    if not cloud.exists():
        sys.exit(f"surfaces.py: the cloud of {case} could not be made, see {log}")
    return cloud


def measure(case, options, meshes):
    """Errors and topology of every mesh, by file name."""
    result = options.work / f"{case}_errors.json"
    source, held = source_file(case, options), options.work / f"{case}_held.ply"
    truth = "none" if is_scan(case) else source or split(case)[0]
    arguments = [options.tools, truth, source, held, result, *meshes]
    cost = run_self(options.work / f"{case}_errors.log", "_evaluate", *arguments)
    if cost is None:
        sys.exit(f"surfaces.py: the meshes of {case} could not be measured")
    return json.loads(result.read_text())


def run_case(case, options, with_open3d):
    """Rows of the table: the name of the tool and its numbers; none when it failed."""
    cloud = make_cloud(case, options)
    stem = options.work / case
    runs = {"csrbf": run_csrbf(options.csrbf, cloud, stem)}
    if with_open3d:
        runs.update({f"Poisson, depth {depth}": run_poisson(cloud, stem, depth) for depth in DEPTHS})
    errors = measure(case, options, [mesh for mesh, cost in runs.values() if cost is not None])
    return {tool: {**cost, **errors[str(mesh)]} if cost is not None else None for tool, (mesh, cost) in runs.items()}


# The page.


def columns(case):
    first = SCAN_COLUMNS if is_scan(case) else TRUTH_COLUMNS if source_is_mesh(case) else ANALYTIC_COLUMNS
    return first + COMMON_COLUMNS


def source_is_mesh(case):
    return split(case)[0] != "torus"


def cell(name, value):
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return str(value) if name == "euler" else f"{value:,}"
    return f"{value:.0f}" if name == "peak" else f"{value:.2f}" if name in ("cpu", "wall") else f"{value:.3g}"


def table(case, rows):
    shown = columns(case)
    lines = ["| tool | " + " | ".join(title for title, _ in shown) + " |", "|---|" + "---:|" * len(shown)]
    for tool, numbers in rows.items():
        if numbers is None:
            lines.append(f"| {tool} | failed |" + " |" * (len(shown) - 1))
        else:
            lines.append(f"| {tool} | " + " | ".join(cell(name, numbers.get(name)) for _, name in shown) + " |")
    return "\n".join([f"## {case}", "", *lines, ""])


def cpu():
    """Model, cores and threads of this machine."""
    entries = [line.split(":", 1) for line in Path("/proc/cpuinfo").read_text().splitlines() if ":" in line]
    pairs = [(name.strip(), value.strip()) for name, value in entries]
    model = next((value for name, value in pairs if name == "model name"), "unknown processor")
    sockets = [value for name, value in pairs if name == "physical id"]
    cores = [value for name, value in pairs if name == "core id"]
    count = len(set(zip(sockets, cores))) or os.cpu_count()
    return f"{model}, {count} cores, {os.cpu_count()} threads"


def memory():
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemTotal:"):
            return f"{int(line.split()[1]) * 1024 / 1e9:.1f} GB of memory"
    return "unknown memory"


def environment():
    """Variables that change how the threads of Open3D work."""
    found = [f"`{name}={value}`" for name, value in sorted(os.environ.items()) if name.startswith(("OMP_", "GOMP_"))]
    return [f"* Environment: {', '.join(found)}"] if found else []


def describe_open3d(open3d):
    if open3d is None:
        return "* Open3D: not installed, its rows are left out"
    return f"* Open3D {open3d['version']}; interpreter and modules take {open3d['memory']:.0f} MB of its peak memory"


def preamble(options, open3d):
    csrbf = subprocess.run([options.csrbf, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    tools = ", ".join(f"{name} {module_version(options.work, name)['version']}" for name in ("numpy", "scipy"))
    command = ["benchmarks/surfaces.py", "--tools", "TOOLS", "--data", "DATA", "--cases", ",".join(options.cases)]
    return "\n".join([
        "# csrbf compared with screened Poisson reconstruction", "",
        f"* {datetime.date.today().isoformat()}; {cpu()}, {memory()}, load {os.getloadavg()[0]:.1f} at the start",
        f"* {csrbf.splitlines()[0]}", describe_open3d(open3d), f"* Python {sys.version.split()[0]}, {tools}",
        *environment(), "",
        "```sh", shlex.join(command), "csrbf reconstruct FILE -o OUT.ply --report R.json", "```", "",
        "```python", "open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=8)  # 9, 10",
        "```", ""])


def population(output):
    """The section of the page that population.py writes."""
    page = output.read_text() if output.exists() else ""
    start = page.find("## Population\n")
    return [] if start < 0 else [page[start:page.find("\n## ", start)].rstrip() + "\n"]


# Command line.


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tools", type=Path)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--work", type=Path, default=PROJECT / "build/surfaces")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SURFACES.md")
    options = parser.parse_args(arguments)
    options.cases = options.cases.split(",")
    return options


def missing(options):
    """What keeps the comparison from starting, one sentence each."""
    found = [f"unknown case {case}; there are {', '.join(CASES)}" for case in options.cases if case not in CASES]
    for name, wanted in ("tools", ["sample_mesh.py", "evaluate_mesh.py"]), ("data", []):
        folder = getattr(options, name)
        if folder is None:
            found.append(f"--{name} DIR is missing" + (f": the folder with {' and '.join(wanted)}" if wanted else
                         ": the folder with the meshes and scans"))
        else:
            found += [f"--{name}: {folder / file} does not exist" for file in wanted if not (folder / file).is_file()]
    if options.data is not None and not found:
        files = sorted({source_file(case, options) for case in options.cases} - {None})
        found += [f"--data: {file} does not exist" for file in files if not file.is_file()]
    if not os.access(options.csrbf, os.X_OK) or options.csrbf.is_dir():
        found.append(f"--csrbf: {options.csrbf} is not a program; build it, or give another")
    return found


def main(arguments):
    if arguments and arguments[0] in SUBCOMMANDS:
        sys.dont_write_bytecode = True
        SUBCOMMANDS[arguments[0]](*arguments[1:])
        return
    options = parse(arguments)
    problems = missing(options)
    if problems:
        sys.exit("\n".join(f"surfaces.py: {problem}" for problem in problems))
    options.work.mkdir(parents=True, exist_ok=True)
    open3d = module_version(options.work, "open3d")
    if open3d is None:
        print("Open3D cannot be imported (Debian: apt install python3-open3d): its rows are left out", flush=True)
    parts, kept = [preamble(options, open3d)], population(options.output)
    for case in options.cases:
        print(case, flush=True)
        parts.append(table(case, run_case(case, options, open3d is not None)))
        options.output.write_text("\n".join([*parts, *kept, LEGEND]))
    print(f"written: {options.output}")


if __name__ == "__main__":
    main(sys.argv[1:])
