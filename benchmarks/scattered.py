#!/usr/bin/python3
"""Fits and evaluates scattered samples with `csrbf` and SciPy, and writes a page of tables.

usage: scattered.py --tools DIR [--csrbf PROGRAM] [--cases NAME,...] [--peers] [--growth] [--work DIR] [--output FILE]

  --tools DIR      holds scattered_cases.py, which makes samples, queries and their true values
  --csrbf PROGRAM  default: build/release/bin/csrbf
  --cases NAMES    default: all of them
  --peers          run SciPy, too (Clough-Tocher and linear in 2D, and a cubic kernel with 50 neighbours)
  --growth         cost for 1e4 to 1e7 samples in 2D and 3D (needs 4 GB of memory)
  --work DIR       keeps the cases, which are made once, and models; default: build/scattered
  --output FILE    default: benchmarks/SCATTERED.md

Needs numpy, and scipy for its rows.
"""

import argparse
import datetime
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parent.parent
CASES = ["franke_1e6", "f3d_1e6", "franke_1e5", "tracks_1e5", "f4d_1e4", "f6d_1e4", "peaks_500", "peaks_1e4", "image30",
         "ship", "franke_noise"]
LOOSE = [("franke_1e6", "8e-7")]  # with a tolerance
HEADER = ["tool", "rmse", "median", "fit CPU s", "evaluation CPU s", "per 1e6", "peak MB", "what it chose"]

LEGEND = """\
**rmse**, **median**: of the errors at the queries. **fit**: `csrbf fit SAMPLES.npy -o MODEL`, including reading and
writing. **evaluation**: `csrbf evaluate MODEL --points QUERIES.npy -o OUT.npy`, likewise; **per 1e6**: the stage
`evaluate` of its report, seconds times threads for a million queries. **peak MB**: peak resident memory of the fit,
including the samples. One run each, all threads.
"""


def run(command):
    """CPU seconds of a child process."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}: failed")
    return usage.ru_utime + usage.ru_stime


def load(work, case):
    return [np.load(work / f"{case}.{part}.npy") for part in ("samples", "queries", "truth")]


def errors(values, truth):
    error = np.abs(values.ravel() - truth.ravel())
    error = error[np.isfinite(error)]
    return f"{np.sqrt((error**2).mean()):.3g}", f"{np.median(error):.3g}"


def csrbf_row(program, work, case, *flags):
    model, report, out = work / "model.csrbf", work / "report.json", work / "out.npy"
    fit = run([program, "fit", work / f"{case}.samples.npy", "-o", model, "--report", report, *flags])
    options = json.loads(report.read_text())
    told, peak = options["options"], options["peak_memory_mb"]
    queries = work / f"{case}.queries.npy"
    evaluation = run([program, "evaluate", model, "--points", queries, "-o", out, "--report", report])
    stage = json.loads(report.read_text())
    count = stage["result"]["points"]
    threads = stage["threads"]
    per_million = stage["time"]["evaluate"] * threads * 1e6 / count
    rmse, median = errors(np.load(out), np.load(work / f"{case}.truth.npy"))
    chosen = ", ".join(f"{name} {told[name]}" for name in ("method", "kernel", "degree", "samples_per_patch", "smoothing")
                       if told.get(name) not in (None, ""))
    name = " ".join(("csrbf", *flags))
    return [name, rmse, median, f"{fit:.2f}", f"{evaluation:.2f}", f"{per_million:.2f}", f"{peak:.0f}", chosen]


def scipy_rows(work, case):
    from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator, RBFInterpolator

    samples, queries, truth = load(work, case)
    points, values = samples[:, :-1], samples[:, -1]
    few = 2000  # queries of the slow one
    peers = [("SciPy RBFInterpolator, cubic, 50 neighbours", few,
              lambda: RBFInterpolator(points, values, neighbors=min(50, len(points)), kernel="cubic"))]
    if points.shape[1] == 2:
        peers.append(("SciPy Clough-Tocher", len(queries), lambda: CloughTocher2DInterpolator(points, values)))
        peers.append(("SciPy linear", len(queries), lambda: LinearNDInterpolator(points, values)))
    for name, count, make in peers:
        start = time.process_time()
        f = make()
        fitted = time.process_time()
        result = f(queries[:count])
        done = time.process_time()
        rmse, median = errors(result, truth[:count])
        yield [name, rmse, median, f"{fitted - start:.2f}", f"{done - fitted:.2f}",
               f"{(done - fitted) * 1e6 / count:.2f}", "-", "" if count == len(queries) else f"first {count} queries"]


def table(rows, header):
    lines = ["| " + " | ".join(header) + " |", "|" + "|".join("---" if i == 0 else "---:" for i in range(len(header))) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def growth(program, work, tools):
    sys.path.insert(0, str(tools))
    import scattered_cases

    rows = []
    for d, function in ((2, scattered_cases.franke), (3, scattered_cases.franke3)):
        for n in (10**4, 10**5, 10**6, 10**7):
            case = f"growth_{d}d_{n}"
            if not (work / f"{case}.truth.npy").exists():
                x, values, queries, truth = scattered_cases.uniform(function, n, d)
                np.save(work / f"{case}.samples.npy", np.column_stack([x, values]))
                np.save(work / f"{case}.queries.npy", queries)
                np.save(work / f"{case}.truth.npy", truth)
            row = csrbf_row(program, work, case)
            rows.append([f"{d}", f"{n:,}", *row[1:2], row[3], f"{float(row[3]) / n * 1e6:.2f}", *row[5:]])
            print(*rows[-1], flush=True)
    return "## Growth with the number of samples\n\n" + table(
        rows, ["d", "samples", "rmse", "fit CPU s", "per 1e6 samples", "evaluation per 1e6", "peak MB", "what it chose"])


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1][len("usage: "):])
    parser.add_argument("--tools", type=Path, required=True)
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--growth", action="store_true")
    parser.add_argument("--work", type=Path, default=PROJECT / "build/scattered")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SCATTERED.md")
    given = parser.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    sections = [f"# csrbf on scattered samples\n\n{datetime.date.today()}; {os.cpu_count()} cores, load "
                f"{os.getloadavg()[0]:.1f} at the start\n\n{LEGEND}"]
    for case in given.cases.split(","):
        if not (given.work / f"{case}.truth.npy").exists():
            subprocess.run([sys.executable, given.tools / "scattered_cases.py", case, given.work], check=True)
        rows = [csrbf_row(given.csrbf, given.work, case)]
        rows += [csrbf_row(given.csrbf, given.work, case, "--tolerance", t) for name, t in LOOSE if name == case]
        if given.peers:
            rows += scipy_rows(given.work, case)
        sections.append(f"## {case}\n\n" + table(rows, HEADER))
        print(case, *rows, sep="\n  ", flush=True)
        given.output.write_text("\n".join(sections))
    if given.growth:
        sections.append(growth(given.csrbf, given.work, given.tools))
        given.output.write_text("\n".join(sections))


if __name__ == "__main__":
    main()
