#!/usr/bin/python3
"""Measures `csrbf reconstruct --tile-points` and `csrbf fit --tile-points`: CPU time and memory against all at once,
shared by processes, whether the meshes are the same and the functions as accurate. Writes a page.

usage: scaling.py [--program CSRBF] [--points N,...] [--tile-points N] [--processes P,...] [--weak N] [--samples N,...]
                [--folder DIR] [--page FILE]

Runs with one thread per process. Processes share the cores of this machine, so judge CPU seconds: those of the busiest
process stand for the time on as many cores as processes. Strong runs use the last number of --points, weak runs N points
for each process. Points are made by make_cloud.py, samples are of a smooth function in space.
"""

import argparse
import datetime
import filecmp
import json
import os
import subprocess
import sys
import time

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


class Run:
    """Some processes that do one command together."""

    def __init__(self, commands):
        begin = time.monotonic()
        processes = [subprocess.Popen(c, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) for c in commands]
        self.cpu, self.memory = [], []
        for process in processes:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode != 0:
                sys.exit(process.stderr.read().decode())
            self.cpu.append(usage.ru_utime + usage.ru_stime)
            self.memory.append(usage.ru_maxrss / 1024)
        self.wall = time.monotonic() - begin


class Bench:
    def __init__(self, arguments):
        self.program, self.folder = arguments.program, arguments.folder
        self.tile = arguments.tile_points
        os.makedirs(self.folder, exist_ok=True)

    def cloud(self, n):
        path = os.path.join(self.folder, f"cloud{n}.ply")
        if not os.path.exists(path):
            subprocess.run([sys.executable, os.path.join(HERE, "make_cloud.py"), str(n), path], check=True)
        return path

    def command(self, n, mesh, *flags):
        return [self.program, "reconstruct", self.cloud(n), "-o", mesh, "--threads", "1", *flags]

    def whole(self, n):
        mesh = os.path.join(self.folder, "whole.ply")
        return Run([self.command(n, mesh)])

    def tiled(self, n, processes, name):
        mesh = os.path.join(self.folder, name)
        flags = ["--tile-points", str(self.tile)]
        commands = [self.command(n, mesh, *flags, "--tile-share", f"{k}/{processes}") for k in range(1, processes + 1)]
        report = os.path.join(self.folder, "report.json")
        commands[0] += ["--report", report]
        run = Run(commands)
        with open(report) as file:
            run.result = json.load(file)["result"]
        run.mesh = mesh
        return run


class FunctionBench:
    """Fits of samples in space, and their errors at other places."""

    def __init__(self, arguments):
        self.program, self.folder, self.tile = arguments.program, arguments.folder, arguments.tile_points
        os.makedirs(self.folder, exist_ok=True)
        self.places = np.random.default_rng(7).random((200000, 3))
        np.save(os.path.join(self.folder, "places.npy"), self.places)

    @staticmethod
    def truth(x):
        return np.sin(5 * x[:, 0]) * np.cos(4 * x[:, 1]) + np.exp(-10 * ((x - 0.5) ** 2).sum(axis=1))

    def samples(self, n, noise):
        path = os.path.join(self.folder, f"samples{n}_{noise}.npy")
        if os.path.exists(path):
            return path
        random = np.random.default_rng(1)
        rows = np.lib.format.open_memmap(path, "w+", "f8", (n, 4))
        for begin in range(0, n, 1_000_000):
            x = random.random((min(1_000_000, n - begin), 3))
            rows[begin:begin + len(x)] = np.column_stack([x, self.truth(x) + noise * random.normal(size=len(x))])
        return path

    def fit(self, n, noise, *flags):
        model = os.path.join(self.folder, "model.csrbf")
        run = Run([[self.program, "fit", self.samples(n, noise), "-o", model, "--threads", "1", *flags]])
        values = os.path.join(self.folder, "values.npy")
        places = os.path.join(self.folder, "places.npy")
        run.evaluation = Run([[self.program, "evaluate", model, "--points", places, "-o", values, "--threads", "1"]])
        run.error = np.sqrt(np.mean((np.load(values).ravel() - self.truth(self.places)) ** 2))
        return run


def row(*cells):
    return "| " + " | ".join(str(c) for c in cells) + " |\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="csrbf")
    parser.add_argument("--points", default="1000000,4000000")
    parser.add_argument("--tile-points", type=int, default=250000)
    parser.add_argument("--processes", default="1,2,3,8")
    parser.add_argument("--weak", type=int, default=500000)
    parser.add_argument("--samples", default="1000000,4000000")
    parser.add_argument("--folder", default="tiles-benchmark")
    parser.add_argument("--page")
    arguments = parser.parse_args()
    bench = Bench(arguments)
    sizes = [int(n) for n in arguments.points.split(",")]
    counts = [int(p) for p in arguments.processes.split(",")]

    page = "# Surfaces and functions in tiles\n\n"
    page += f"* {datetime.date.today()}, load {os.getloadavg()[0]:.1f} at the start, one thread per process\n"
    page += f"* Tiles of up to {arguments.tile_points:,} points. **busiest s** is the CPU time of the busiest process.\n\n"
    page += "```sh\nbenchmarks/scaling.py --page benchmarks/SCALING.md\n```\n\n"
    page += "## All at once and in tiles\n\n"
    page += row("points", "CPU s at once", "in tiles", "ratio", "MB at once", "in tiles", "tiles", "watertight")
    page += row(*["---:"] * 8)
    for n in sizes:
        whole, tiled = bench.whole(n), bench.tiled(n, 1, "alone.ply")
        page += row(f"{n:,}", f"{whole.cpu[0]:.1f}", f"{tiled.cpu[0]:.1f}", f"{tiled.cpu[0] / whole.cpu[0]:.2f}",
                    f"{whole.memory[0]:.0f}", f"{tiled.memory[0]:.0f}", tiled.result["tiles"],
                    "yes" if tiled.result["watertight"] else "NO")
        print(page.splitlines()[-1], flush=True)

    page += f"\n## {sizes[-1]:,} points by several processes\n\n"
    page += row("processes", "busiest s", "sum s", "busiest / (alone / processes)", "peak MB", "same bytes")
    page += row(*["---:"] * 6)
    alone = None
    for count in counts:
        run = bench.tiled(sizes[-1], count, f"mesh{count}.ply")
        alone = alone or run
        same = filecmp.cmp(alone.mesh, run.mesh, shallow=False)
        page += row(count, f"{max(run.cpu):.1f}", f"{sum(run.cpu):.1f}",
                    f"{max(run.cpu) * count / sum(alone.cpu):.2f}", f"{max(run.memory):.0f}", "yes" if same else "NO")
        print(page.splitlines()[-1], flush=True)

    page += f"\n## {arguments.weak:,} points for each process\n\n"
    page += row("processes", "points", "busiest s", "against one", "peak MB")
    page += row(*["---:"] * 5)
    first = None
    for count in counts:
        run = bench.tiled(arguments.weak * count, count, "weak.ply")
        first = first or max(run.cpu)
        page += row(count, f"{arguments.weak * count:,}", f"{max(run.cpu):.1f}", f"{max(run.cpu) / first:.2f}",
                    f"{max(run.memory):.0f}")
        print(page.splitlines()[-1], flush=True)
    page += "\n## Functions, at once and in tiles\n\n"
    page += "Errors and times of evaluation are those at 200,000 other places in the cube of the samples.\n\n"
    page += row("samples", "noise", "CPU s at once", "in tiles", "ratio", "MB at once", "in tiles", "rms error at once",
                "in tiles", "evaluation s at once", "in tiles")
    page += row(*["---:"] * 11)
    functions = FunctionBench(arguments)
    for n in [int(n) for n in arguments.samples.split(",")]:
        for noise in (0, 0.01):
            whole = functions.fit(n, noise)
            tiled = functions.fit(n, noise, "--tile-points", str(arguments.tile_points))
            page += row(f"{n:,}", noise, f"{whole.cpu[0]:.1f}", f"{tiled.cpu[0]:.1f}",
                        f"{tiled.cpu[0] / whole.cpu[0]:.2f}", f"{whole.memory[0]:.0f}", f"{tiled.memory[0]:.0f}",
                        f"{whole.error:.2e}", f"{tiled.error:.2e}", f"{whole.evaluation.cpu[0]:.1f}",
                        f"{tiled.evaluation.cpu[0]:.1f}")
            print(page.splitlines()[-1], flush=True)
    if arguments.page:
        with open(arguments.page, "w") as file:
            file.write(page)
    else:
        print(page)


if __name__ == "__main__":
    main()
