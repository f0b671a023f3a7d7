#!/usr/bin/python3
"""The extra time and memory of fitting a million samples from Python instead of C++; writes a page with a table.

usage: python_overhead.py [--csrbf PROGRAM] [--module DIR] [--samples N] [--runs N] [--output FILE]

  --csrbf PROGRAM  default: build/release/bin/csrbf
  --module DIR     holds the package csrbf; default: build/release/python
  --samples N      default: 1000000
  --runs N         of each, alternating; the fastest counts; default: 7
  --output FILE    default: benchmarks/PYTHON.md; -: prints it instead

Needs numpy. Exit status 1 when Python takes more than 5 % longer, or holds a copy of the samples.
"""

import argparse
import datetime
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
MOST = 0.05
CASES = {"function of two variables": 2, "function of three variables": 3}

# Fits in a process of its own and prints seconds and by how many bytes the peak of its memory is above what it held
# before, the samples included.
SCRIPT = """
import json, sys, time
import numpy as np
import csrbf

def resident(field):
    with open("/proc/self/status") as status:
        return next(1024 * int(line.split()[1]) for line in status if line.startswith(field))

table = np.load(sys.argv[1])
points, values = np.array(table[:, :-1], order=sys.argv[2]), table[:, -1].copy()
del table
csrbf.fit(points[:1000], values[:1000])  # so that threads and libraries are there
before = resident("VmRSS")
open("/proc/self/clear_refs", "w").write("5")  # forgets the peak
begin = time.perf_counter()
f = csrbf.fit(points, values)
print(json.dumps({"seconds": time.perf_counter() - begin, "grown": resident("VmHWM") - before}))
"""

LEGEND = """\
`csrbf.fit(points, values)` of {samples:,} samples with default options, compared with `csrbf fit` of the same samples:
the fastest of {runs} alternating runs, on all threads. **C++**: the total time in the report of the program without its
stages read and write. **Python**: the whole call. **memory**: the peak of the process above what it held before the
call. **Fortran order**: how much more it is when the points have to be copied.
"""


def samples(dimension, n):
    x = np.random.default_rng(dimension).random((n, dimension))
    return np.column_stack([x, np.sin(5 * x[:, 0]) * np.cos(3 * x[:, 1]) + x.sum(axis=1) ** 2])


def from_program(program, path):
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "report.json")
        command = [program, "fit", path, "-o", Path(folder, "model.csrbf"), "--report", report, "--quiet"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        stages = json.loads(report.read_text())["time"]
        return stages["total"] - stages["read"] - stages["write"]


def from_python(module, path, order):
    environment = dict(os.environ, PYTHONPATH=str(module))
    command = [sys.executable, "-c", SCRIPT, str(path), order]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout)


def measure(given, dimension):
    """One row of the table, and whether it is what it should be."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "samples.npy")
        np.save(path, samples(dimension, given.samples))
        program, python, copied = [], [], []
        for _ in range(given.runs):
            program.append(from_program(given.csrbf, path))
            python.append(from_python(given.module, path, "C"))
            copied.append(from_python(given.module, path, "F"))
    seconds = min(run["seconds"] for run in python)
    overhead = seconds / min(program) - 1
    grown = min(run["grown"] for run in python)
    more = min(run["grown"] for run in copied) - grown
    points = 8 * dimension * given.samples
    row = [f"{min(program):.3f} s", f"{seconds:.3f} s", f"{100 * overhead:+.1f} %", f"{grown / 1e6:.0f} MB",
           f"{more / 1e6:+.0f} MB (points: {points / 1e6:.0f} MB)"]
    return row, overhead < MOST and more > 0.5 * points


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1][len("usage: "):])
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--module", type=Path, default=PROJECT / "build/release/python")
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/PYTHON.md")
    given = parser.parse_args()
    header = ["samples of a", "C++", "Python", "overhead", "memory", "Fortran order"]
    place = (f"{datetime.date.today()}; preset {given.module.resolve().parent.name}, {os.cpu_count()} cores, load "
             f"{os.getloadavg()[0]:.1f} at the start")
    lines = [f"# csrbf from Python\n\n{place}\n\n{LEGEND.format(samples=given.samples, runs=given.runs)}",
             f"| {' | '.join(header)} |", "|---" + "|---:" * (len(header) - 1) + "|"]
    fine = True
    for name, dimension in CASES.items():
        row, good = measure(given, dimension)
        fine = fine and good
        lines.append(f"| {' | '.join([name, *row])} |")
        print(*lines[-1:], flush=True)
    write_page("\n".join(lines) + "\n", given.output)
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
