#!/usr/bin/python3
"""Runs the parts of `global_functions`, the surface methods with one system, and ALGLIB, and writes GLOBAL.md.

usage: global_functions.py --cloud CLOUD.ply --mesh MESH.ply [--build DIR] [--largest N] [--work DIR] [--output FILE]

  --cloud FILE   points with normals (100,000 of the armadillo in the page)
  --mesh FILE    the mesh that they were sampled from
  --build DIR    default: build/release, configured with -DCSRBF_BUILD_BENCHMARKS=ON; ALGLIB needs
                 -DCSRBF_BENCHMARK_PEERS=ON and is left out without it
  --largest N    of sums and systems; default 1000000
  --work DIR     default: build/global; results are kept there, and only missing ones are made
  --output FILE  default: benchmarks/GLOBAL.md; -: prints it instead

Takes about a quarter of an hour. Needs numpy.
"""

import argparse
import datetime
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
METHODS = (("turk-obrien", 10000), ("turk-obrien", 35000), ("savchenko", 10000), ("savchenko", 35000))
PEER_SIZES = (4000, 20000)
INTRODUCTION = """# Global radial functions

Written {date} by `global_functions.py`; CPU seconds of all threads. See
[one system for many samples](../docs/global.md).
"""


def run(command):
    """What a command printed, its CPU seconds and most megabytes."""
    program = ("import json, resource, subprocess, sys; done = subprocess.run(sys.argv[1:], stdout=sys.stderr); "
               "used = resource.getrusage(resource.RUSAGE_CHILDREN); print(json.dumps([done.returncode, "
               "used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]))")
    done = subprocess.run([sys.executable, "-c", program, *map(str, command)], capture_output=True, text=True)
    code, cpu, megabytes = json.loads(done.stdout)
    if code != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return done.stderr, cpu, megabytes


def methods(program, cloud, work):
    rows = ["Other methods, `csrbf reconstruct CLOUD --method NAME --centers N`; the distance of the points to the",
            "surface is in fractions of the diagonal, root mean square.", "",
            "| method | points | centres | seconds | MB | distance |", "|---|---|---|---|---|---|"]
    for name, count in METHODS:
        report = work / f"{name}-{count}.json"
        _, cpu, megabytes = run([program, "reconstruct", cloud, "-o", work / "mesh.ply", "--method", name, "--centers",
                                 count, "--report", report])
        found = json.loads(report.read_text())["result"]
        rows.append(f"| {name} | {count} | {found['centers']} | {cpu:.1f} | {megabytes:.0f} | "
                    f"{found['rms_distance']:.1e} |")
    return "\n".join(rows) + "\n"


def peer(program, work):
    """ALGLIB's thin plates for the samples of the first system."""
    rows = ["## A peer", "",
            "ALGLIB (GPL, in a program of its own, `peers/alglib_rbf`), thin plate in the plane, uniform samples.", "",
            "| samples | seconds | MB |", "|---|---|---|"]
    random = np.random.default_rng(3)
    for count in PEER_SIZES:
        x = random.uniform(-1, 1, (count, 2))
        np.save(work / "samples.npy", np.column_stack([x, np.sin(5 * x[:, 0]) * np.cos(4 * x[:, 1])]))
        np.save(work / "queries.npy", x[:10])
        _, cpu, megabytes = run([program, work / "samples.npy", work / "queries.npy", work / "out.npy",
                                 work / "cost.json", "spline", 0])
        rows.append(f"| {count} | {cpu:.2f} | {megabytes:.0f} |")
    return "\n".join(rows) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cloud", type=Path, required=True)
    parser.add_argument("--mesh", type=Path, required=True)
    parser.add_argument("--build", type=Path, default=PROJECT / "build" / "release")
    parser.add_argument("--largest", type=int, default=1000000)
    parser.add_argument("--work", type=Path, default=PROJECT / "build" / "global")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks" / "GLOBAL.md")
    options = parser.parse_args()
    program = options.build / "bin" / "global_functions"
    alglib = options.build / "bin" / "alglib_rbf"
    if not program.exists():
        sys.exit(f"{program}: not built; configure with -DCSRBF_BUILD_BENCHMARKS=ON")
    options.work.mkdir(parents=True, exist_ok=True)
    parts = [("sums", lambda: run([program, "sums", options.largest])[0])]
    parts.append(("systems", lambda: run([program, "systems", options.largest])[0]))
    parts.append(("dense", lambda: run([program, "dense", 4000])[0]))
    parts.append(("deviations", lambda: run([program, "deviations"])[0]))
    parts.append(("smoothing", lambda: run([program, "smoothing", 20000])[0]))
    parts.append(("surface", lambda: run([program, "surface", options.cloud, options.mesh])[0]))
    parts.append(("methods", lambda: methods(options.build / "bin" / "csrbf", options.cloud, options.work)))
    if alglib.exists():
        parts.append(("peer", lambda: peer(alglib, options.work)))
    sections = [INTRODUCTION.format(date=datetime.date.today())]
    for name, measure in parts:
        kept = options.work / f"{name}.md"
        if not kept.exists():
            print(name, flush=True)
            kept.write_text(measure())
        sections.append(kept.read_text())
    write_page("\n".join(sections), options.output)


if __name__ == "__main__":
    main()
