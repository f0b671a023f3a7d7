#!/usr/bin/python3
"""Runs csrbf and other libraries on the same tasks, several times, and writes one table.

usage: compare.py --tools DIR --data DIR [--csrbf PROGRAM] [--runs N] [--jobs NAME,...] [--work DIR] [--output FILE]

  --tools DIR      holds sample_mesh.py, evaluate_mesh.py, scattered_cases.py and make_images.py
  --data DIR       holds the mesh and the scans of surfaces.py; their jobs are left out without it
  --csrbf PROGRAM  default: build/release/bin/csrbf; alglib_rbf and itk_chan_vese are expected beside it
  --runs N         of each tool on each job; default: 5
  --jobs NAMES     default: all of them
  --work DIR       keeps clouds, samples, images and results; default: build/compare
  --output FILE    default: benchmarks/RESULTS.md, rewritten after every job

Needs numpy and scipy. Tools that are not installed are left out: Open3D (Debian: python3-open3d), scikit-image
(python3-skimage), and the two programs, built with -DCSRBF_BUILD_BENCHMARKS=ON -DCSRBF_BENCHMARK_PEERS=ON (Debian:
libalglib-dev, libinsighttoolkit5-dev). Keep the machine otherwise idle.
"""

import argparse
import datetime
import importlib.util
import json
import os
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import surfaces  # of this folder; imports nothing large

PROJECT = Path(__file__).resolve().parent.parent
SURFACES = ["armadillo_n1m", "armadillo_n100k", "armadillo_noise25", "armadillo_holes", "bunny_scans_362k"]
SCATTERED = ["franke_1e5", "tracks_1e5", "f6d_1e4", "peaks_1e4", "image30", "ship", "franke_noise"]
IMAGES = ["shape311_20dB", "star446_clean", "usim249", "nested_rings", "equal_means", "gyroid100_20dB"]
SMOOTHING = {"image30": [0, 1, 100], "franke_noise": [0, 1, 100]}  # noisy: what SciPy is tried with
PENALTY = {"image30": [1e-5], "franke_noise": [1e-5]}  # and ALGLIB
QUERIES = 20_000
LONG = 20  # seconds; what takes longer is run once
LIMIT = 40  # seconds after which a tool is stopped

LEGEND = """Every tool is given the same file and has to return the same kind of result.

* **error**: for surfaces the chamfer distance to the true surface, for scans the mean distance of held-out points, both
  in 1e-4 of the diagonal; for scattered samples the root mean square error at {queries:,} queries; for images 1 - Dice.
* **CPU s**: over all threads, the median of {runs} runs, and the range. For csrbf it is that of whole processes,
  start-up, reading and writing included; for the others that of the library call alone. What takes more than {long} s
  is run once, and stopped after {limit} s.
* **peak MB**: of the process, including interpreter and modules for SciPy, scikit-image and Open3D.
* **relative to csrbf**: error and CPU time divided by those of csrbf; in the rows of csrbf, who does better.

csrbf runs with default options. The others get the options their manuals recommend and, where that takes trial and
error, the best of several tries by the true error:

* Open3D: depths 8, 9 and 10 are all shown.
* SciPy: RBFInterpolator with the cubic kernel and 50 neighbours; for noisy samples (image30, franke_noise) the best
  smoothing of 0, 1 and 100.
* ALGLIB: hierarchical, with radii from a quarter of the box down to half the spacing, and thin plate splines by domain
  decomposition; for noisy samples a penalty of 1e-5.
* ITK: Chan-Vese on a dense level set, 200 iterations; for 2D images the best of two curvature weights and of a start
  from one ball or many.
* scikit-image: chan_vese with mu 0.1, morphological_chan_vese with 100 iterations, and Otsu's threshold after a
  Gaussian. They do not say which side is inside: the better one counts, as for ITK.

polatory is not in Debian, and therefore not included.
"""


# Hidden sub-commands, each run in a process of its own: what others do in Python, and the errors.


def timed(call, result):
    import resource

    before, start = resource.getrusage(resource.RUSAGE_SELF), time.monotonic()
    value = call()
    wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_SELF)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    surfaces.write_json(result, {"cpu": cpu, "wall": wall})
    return value


def scipy_interpolate(kind, smoothing, samples, queries, out, result):
    import numpy
    from scipy.interpolate import CloughTocher2DInterpolator, RBFInterpolator

    table, points = numpy.load(samples), numpy.load(queries)

    def call():
        if kind == "clough-tocher":
            return CloughTocher2DInterpolator(table[:, :-1], table[:, -1])(points)
        neighbors = min(50, len(table))
        return RBFInterpolator(table[:, :-1], table[:, -1], neighbors=neighbors, smoothing=float(smoothing),
                               kernel="cubic")(points)

    numpy.save(out, timed(call, result))


def skimage_segment(kind, image, out, result):
    import numpy
    from skimage import filters, segmentation

    given = numpy.load(image).astype(float)

    def call():
        unit = (given - given.min()) / numpy.ptp(given)
        if kind == "chan-vese":
            return segmentation.chan_vese(unit, mu=0.1)
        if kind == "morphological":
            return segmentation.morphological_chan_vese(unit, 100, init_level_set="checkerboard", smoothing=2) != 0
        smooth = filters.gaussian(unit, 1.5 if unit.ndim == 2 else 1.0)
        return smooth > filters.threshold_otsu(smooth)

    numpy.save(out, timed(call, result).astype(numpy.uint8))


def make_samples(tools, case, work):
    subprocess.run([sys.executable, Path(tools) / "scattered_cases.py", case, work], check=True)
    import numpy

    for part in ("queries", "truth"):
        values = numpy.load(f"{work}/{case}.{part}.npy")
        step = max(1, len(values) // QUERIES)
        numpy.save(f"{work}/{case}.{part}_few.npy", values[::step][:QUERIES])


def make_images(tools, data, work):
    import segmentation

    segmentation.make_images(Path(work), Path(tools), Path(data), 0)


def sample_error(truth, result, *outs):
    import numpy

    expected, errors = numpy.load(truth).ravel(), {}
    for out in outs:
        difference = numpy.load(out).ravel() - expected
        difference = difference[numpy.isfinite(difference)]  # Clough-Tocher has no value outside the hull
        errors[out] = float(numpy.sqrt((difference**2).mean()))
    surfaces.write_json(result, errors)


def label_error(mask, result, *outs):
    import numpy
    import segmentation

    expected, errors = numpy.load(mask) != 0, {}
    for out in outs:
        labels = numpy.load(out) != 0
        sides = [labels] if out.endswith("_csrbf.npy") else [labels, ~labels]
        errors[out] = 1 - max(segmentation.dice(side, expected) for side in sides)
    surfaces.write_json(result, errors)


SUBCOMMANDS = {"_scipy": scipy_interpolate, "_skimage": skimage_segment, "_make_samples": make_samples,
               "_make_images": make_images, "_sample_error": sample_error, "_label_error": label_error}


# Running and measuring.


@dataclass
class Tool:
    name: str
    out: Path
    commands: list  # run one after the other
    own_cost: Path | None = None  # file in which the tool tells the cost of the call alone
    error: float | None = None
    runs: list = field(default_factory=list)  # cost of each; empty when it failed
    problem: str = ""

    def median(self, key):
        return statistics.median(run[key] for run in self.runs)


def run_once(tool, log):
    """Cost of the commands of a tool, or a word about why there is none."""
    total = {"cpu": 0.0, "wall": 0.0, "peak": 0.0}
    for command in tool.commands:
        start = time.monotonic()
        with open(log, "wb") as output:
            child = subprocess.Popen(["timeout", str(LIMIT), *map(str, command)], stdout=output,
                                     stderr=subprocess.STDOUT)
            _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            return f"more than {LIMIT} s" if child.returncode == 124 else "failed"
        total["cpu"] += usage.ru_utime + usage.ru_stime
        total["wall"] += time.monotonic() - start
        total["peak"] = max(total["peak"], surfaces.megabytes(usage))
    if tool.own_cost is not None:
        total.update(json.loads(tool.own_cost.read_text()))
    return total


def run_all(tools, log):
    for tool in tools:
        if tool.problem or (tool.runs and tool.runs[0]["wall"] > LONG):
            continue
        cost = run_once(tool, log)
        if isinstance(cost, str):
            tool.problem = cost
        else:
            tool.runs.append(cost)


def measured(kind, name, options, tools):
    """Errors of the results, by file."""
    outs = [str(tool.out) for tool in tools if not tool.problem]
    if kind == "surface":
        errors = surfaces.measure(name, options, outs)
        return {out: numbers["in_mean" if surfaces.is_scan(name) else "chamfer"] for out, numbers in errors.items()}
    result = options.work / "errors.json"
    truth, command = ((options.work / f"{name}.truth_few.npy", "_sample_error") if kind == "samples" else
                      (options.work / f"{name}_mask.npy", "_label_error"))
    subprocess.run([sys.executable, __file__, command, truth, result, *outs], check=True)
    return json.loads(result.read_text())


# Jobs: the tools that take part, with their files.


def surface_tools(name, options):
    cloud, stem = surfaces.make_cloud(name, options), options.work / name
    mesh = Path(f"{stem}_csrbf.ply")
    tools = [Tool("csrbf", mesh, [[options.csrbf, "reconstruct", cloud, "-o", mesh, "--quiet"]])]
    if options.has["open3d"]:
        for depth in surfaces.DEPTHS:
            out, cost = Path(f"{stem}_poisson{depth}.ply"), Path(f"{stem}_poisson{depth}.json")
            tools.append(Tool(f"Open3D, Poisson, depth {depth}", out, [[
                sys.executable, PROJECT / "benchmarks/surfaces.py", "_poisson", cloud, out, depth, cost]], cost))
    return tools


def sample_tools(name, options):
    stem = options.work / name
    samples, queries = f"{stem}.samples.npy", f"{stem}.queries_few.npy"
    if not Path(queries).exists():
        subprocess.run([sys.executable, __file__, "_make_samples", options.tools, name, options.work], check=True)
    model, out = f"{stem}_csrbf.csrbf", Path(f"{stem}_csrbf.npy")
    tools = [Tool("csrbf", out, [[options.csrbf, "fit", samples, "-o", model, "--quiet"],
                                 [options.csrbf, "evaluate", model, "--points", queries, "-o", out, "--quiet"]])]

    def add(title, label, command, suffix=""):
        out, cost = Path(f"{stem}_{label}.npy"), Path(f"{stem}_{label}.json")
        tools.append(Tool(title + suffix, out, [command(out, cost)], cost))

    for smoothing in SMOOTHING.get(name, [0]):
        add("SciPy RBFInterpolator", f"scipy_{smoothing}", lambda out, cost: [
            sys.executable, __file__, "_scipy", "rbf", smoothing, samples, queries, out, cost],
            f", tried with {smoothing}" if name in SMOOTHING else "")
    if columns(samples) == 3:
        add("SciPy Clough-Tocher", "clough", lambda out, cost: [
            sys.executable, __file__, "_scipy", "clough-tocher", 0, samples, queries, out, cost])
    if options.has["alglib_rbf"]:
        for kind in ("hierarchical", "spline"):
            for penalty in PENALTY.get(name, [0]):
                add(f"ALGLIB, {kind}", f"alglib_{kind}_{penalty}", lambda out, cost: [
                    options.csrbf.parent / "alglib_rbf", samples, queries, out, cost, kind, penalty],
                    f", tried with {penalty}" if name in PENALTY else "")
    return tools


def columns(path):
    """Of a .npy file, from its header."""
    return int(Path(path).read_bytes()[:128].decode("latin1").split("'shape': (")[1].split(")")[0].split(",")[1])


def image_tools(name, options):
    stem = options.work / name
    image = f"{stem}.npy"
    if not Path(image).exists():
        subprocess.run([sys.executable, __file__, "_make_images", options.tools, options.data, options.work],
                       check=True, stdout=subprocess.DEVNULL)
    out = Path(f"{stem}_csrbf.npy")
    tools = [Tool("csrbf", out, [[options.csrbf, "segment", image, "-o", out, "--quiet"]])]
    flat = not name.startswith("gyroid")
    titles = {"chan-vese": "scikit-image chan_vese", "morphological": "scikit-image morphological_chan_vese",
              "otsu": "scikit-image Gaussian, Otsu"}
    for kind in titles if options.has["skimage"] else []:
        if kind == "chan-vese" and not flat:
            continue
        out, cost = Path(f"{stem}_{kind}.npy"), Path(f"{stem}_{kind}.json")
        tools.append(Tool(titles[kind], out, [[sys.executable, __file__, "_skimage", kind, image, out, cost]], cost))
    for start in (("ball", "balls") if flat else ("balls",)) if options.has["itk_chan_vese"] else ():
        for curvature in (100, 1000) if flat else (100,):
            out, cost = (Path(f"{stem}_itk_{start}_{curvature}{suffix}") for suffix in (".npy", ".json"))
            tools.append(Tool(f"ITK Chan-Vese, tried with {start}, {curvature}", out, [[
                options.csrbf.parent / "itk_chan_vese", image, out, cost, start, curvature]], cost))
    return tools


KINDS = [("surface", SURFACES, surface_tools), ("samples", SCATTERED, sample_tools), ("image", IMAGES, image_tools)]


def best_of_tries(tools):
    """Of tools that differ in what they were "tried with" only, the most accurate."""
    kept = {}
    for tool in tools:
        base = tool.name.split(", tried with ")[0]
        if base not in kept or (tool.error is not None and (kept[base].error is None or tool.error < kept[base].error)):
            kept[base] = tool
    return list(kept.values())


def run_job(kind, name, make_tools, options):
    tools, log = make_tools(name, options), options.work / "log"
    run_all(tools, log)
    errors = measured(kind, name, options, tools)
    for tool in tools:
        tool.error = errors.get(str(tool.out))
    tools = best_of_tries(tools)
    for _ in range(1, options.runs):  # in turns, so that all tools see the same machine
        run_all(tools, log)
    return tools


# The page.


def verdict(csrbf, others):
    found = []
    if better := [tool for tool in others if tool.error < csrbf.error]:
        best = min(better, key=lambda tool: tool.error)
        found.append(f"{best.name} is more accurate")
    if faster := [tool for tool in others if tool.median("cpu") < csrbf.median("cpu")]:
        found.append("faster: " + ", ".join(tool.name for tool in faster))
    return "; ".join(found) if found else "leads"


def rows(name, tools):
    csrbf, others = tools[0], tools[1:]
    if csrbf.problem:
        sys.exit(f"compare.py: csrbf, {name}: {csrbf.problem}")
    for tool in tools:
        first = name if tool is csrbf else ""
        if tool.problem:
            yield f"| {first} | {tool.name} | | {tool.problem} | | | |"
            continue
        cpu = [run["cpu"] for run in tool.runs]
        spread = "one run" if len(cpu) == 1 else f"{min(cpu):.2f}-{max(cpu):.2f}"
        told = verdict(csrbf, [other for other in others if not other.problem]) if tool is csrbf else (
            f"error x {tool.error / csrbf.error:.3g}, time x {tool.median('cpu') / csrbf.median('cpu'):.3g}")
        yield (f"| {first} | {tool.name} | {tool.error:.3g} | {tool.median('cpu'):.2f} | {spread} | "
               f"{tool.median('peak'):.0f} | {told} |")


def page(options, lines, leads):
    version = subprocess.run([options.csrbf, "--version"], capture_output=True, text=True, check=True).stdout
    head = (f"# csrbf compared with other tools\n\n* {datetime.date.today().isoformat()}; {surfaces.cpu()}, "
            f"{surfaces.memory()}, load {options.load:.1f} at the start\n"
            f"* {version.splitlines()[0]}, compared with Debian's "
            f"{', '.join(name for name, there in options.packages.items() if there)}\n\n"
            "```sh\nbenchmarks/compare.py --tools TOOLS --data DATA\n```\n\n")
    legend = LEGEND.format(queries=QUERIES, runs=options.runs, long=LONG, limit=LIMIT)
    table = ("| job | tool | error | CPU s | spread | peak MB | relative to csrbf |\n"
             "|---|---|---:|---:|---|---:|---|\n")
    told = (f"csrbf is the most accurate in {leads['accurate']} of {leads['jobs']} jobs, and in {leads['leads']} of "
            "these no other tool is faster: there it leads.")
    return f"{head}{legend}\n{told}\n\n{table}" + "\n".join(lines) + "\n"


def debian_version(package):
    found = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", package], capture_output=True, text=True)
    return found.stdout.split("-")[0].split("+")[0]


def main(arguments):
    if arguments and arguments[0] in SUBCOMMANDS:
        sys.dont_write_bytecode = True
        SUBCOMMANDS[arguments[0]](*arguments[1:])
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tools", type=Path, required=True)
    parser.add_argument("--data", type=Path, default=Path("none"))
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--jobs")
    parser.add_argument("--work", type=Path, default=PROJECT / "build/compare")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/RESULTS.md")
    options = parser.parse_args(arguments)
    options.work.mkdir(parents=True, exist_ok=True)
    options.load = os.getloadavg()[0]
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # or threads of Open3D spend CPU time waiting for each other
    options.has = {module: importlib.util.find_spec(module) is not None for module in ("open3d", "skimage")}
    options.has |= {name: (options.csrbf.parent / name).exists() for name in ("alglib_rbf", "itk_chan_vese")}
    packages = {"open3d": ("Open3D", "python3-open3d"), "skimage": ("scikit-image", "python3-skimage"),
                "alglib_rbf": ("ALGLIB", "libalglib-dev"), "itk_chan_vese": ("ITK", "libinsighttoolkit5-dev")}
    options.packages = {f"{title} {debian_version(package)}": options.has[key]
                        for key, (title, package) in packages.items()}
    options.packages[f"SciPy {debian_version('python3-scipy')}"] = True

    known = [name for _, names, _ in KINDS for name in names]
    wanted = options.jobs.split(",") if options.jobs else known
    if unknown := set(wanted) - set(known):
        sys.exit(f"compare.py: unknown jobs {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    lines, leads = [], {"jobs": 0, "accurate": 0, "leads": 0}
    for kind, names, make_tools in KINDS:
        for name in names:
            if name not in wanted:
                continue
            source = surfaces.source_file(name, options) if kind == "surface" else None
            if source is not None and not source.exists():
                print(f"{name}: left out, {source} is not there", file=sys.stderr)
                continue
            tools = run_job(kind, name, make_tools, options)
            made = list(rows(name, tools))
            print(*made, sep="\n", flush=True)
            lines += made
            leads["jobs"] += 1
            leads["accurate"] += "more accurate" not in made[0]
            leads["leads"] += made[0].endswith("| leads |")
            options.output.write_text(page(options, lines, leads))


if __name__ == "__main__":
    main(sys.argv[1:])
