#!/usr/bin/python3
"""Measures csrbf-mpi on 1, 2 and 4 ranks, counts what more ranks would exchange, and writes a page of tables.

usage: scaling.py [--csrbf-mpi PROGRAM] [--size N] [--work DIR] [--output FILE]

  --csrbf-mpi PROGRAM  default: build/distributed/bin/csrbf-mpi
  --size N             points of the strong runs; the weak ones have N / 2 per rank (default: 200000)
  --work DIR           keeps clouds, samples and reports; default: build/scaling
  --output FILE        default: benchmarks/SCALING.md

Needs numpy.
"""

import argparse
import datetime
import json
import os
import subprocess
import time
from pathlib import Path

import numpy as np

PROJECT = Path(__file__).resolve().parent.parent
RANKS = [1, 2, 4]
NODES = 64
GOAL = 10**9
BANDWIDTH = 1e9  # bytes per second and node of the extrapolation: a network of 10 Gbit/s
NODE_MEMORY = 256e9


def torus(n):
    source = np.random.default_rng(1)
    u, v = source.uniform(0, 2 * np.pi, (2, n))
    normals = np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])
    ring = np.column_stack([np.cos(u), np.sin(u), np.zeros(n)])
    return np.column_stack([ring + (0.4 + source.normal(0, 0.002, n))[:, None] * normals, normals])


def waves(n):
    source = np.random.default_rng(2)
    x = source.uniform(0, 1, (n, 2))
    return np.column_stack([x, np.sin(9 * x[:, 0]) * np.cos(7 * x[:, 1])])


JOBS = {"reconstruct": (torus, ["-o", "mesh.ply"]),
        "fit": (waves, ["--method", "partition-of-unity", "-o", "model.csrbf"])}


class Runner:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        folder.mkdir(parents=True, exist_ok=True)

    def run(self, job, n, ranks, pretend=False):
        make, flags = JOBS[job]
        data = self.folder / f"{job}_{n}.npy"
        if not data.exists():
            np.save(data, make(n))
        command = [str(self.program), "--pretend-ranks", str(ranks)] if pretend else [
            "mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none",
            *(["--allow-run-as-root"] if os.geteuid() == 0 else []), str(self.program)]
        report = self.folder / "report.json"
        start = time.time()
        subprocess.run([*command, job, str(data), *flags, "--threads", "1", "--report", str(report), "--quiet"],
                       cwd=self.folder, check=True, env=dict(os.environ, OMP_NUM_THREADS="1"))
        result = json.loads(report.read_text())
        result["wall"] = time.time() - start
        return result


def total(shared, key):
    return sum(traffic[key] for traffic in shared.values())


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---:|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def measured_row(n, ranks, report, before):
    shared = report.get("shared_work") or {}
    busy = report["busy_seconds"]
    return [f"{n:,}", ranks, f"{busy:.1f}", f"{before / busy:.2f}" if before else "1", f"{total(shared, 'seconds'):.1f}",
            f"{report['wall']:.1f}", f"{report['peak_memory_mb']:.0f}", f"{total(shared, 'sent_bytes') / 1e6:.1f}",
            f"{total(shared, 'received_bytes') / 1e6:.1f}", total(shared, "rounds")]


HEAD = ["points", "ranks", "busy s", "gain", "shared s", "wall s", "peak MB", "sent MB", "received MB", "rounds"]


def measure(runner, job, size):
    text = []
    for title, sizes in (("Strong", [size] * len(RANKS)), ("Weak", [size // 2 * ranks for ranks in RANKS])):
        rows, first = [], None
        for n, ranks in zip(sizes, RANKS):
            report = runner.run(job, n, ranks)
            rows.append(measured_row(n, ranks, report, first))
            first = first or report["busy_seconds"]
        text.append(f"{title}, `{job}`:\n\n" + table(HEAD, rows))
    return "\n".join(text)


class Model:
    """What one rank does, linear in the number of points: fitted to two pretended runs."""

    def __init__(self, runner, job, size):
        self.job = job
        half, full = (runner.run(job, n, NODES, pretend=True) for n in (size // 2, size))
        self.names = {}
        step = size - size // 2
        for name in full["shared_work"][0]:
            traffic = [[rank[name] for rank in run["shared_work"]] for run in (half, full)]
            bytes_of = [sum(rank["sent_bytes"] for rank in run) for run in traffic]
            items = [run[0]["items"] for run in traffic]
            seconds = sum(rank["seconds"] for rank in traffic[1])
            self.names[name] = {"items": (items[1] - items[0]) / step, "bytes": (bytes_of[1] - bytes_of[0]) / step,
                                "seconds": seconds / size, "works": traffic[1][0]["works"],
                                "rounds": traffic[1][0]["rounds"]}
        self.memory = 1e6 * (full["peak_memory_mb"] - half["peak_memory_mb"]) / step
        self.seconds = (full["time"]["total"] - full["time"].get("write", 0)) / size
        self.shared_seconds = sum(name["seconds"] for name in self.names.values())

    def bytes(self, n):
        return n * sum(name["bytes"] for name in self.names.values())

    def messages(self, n, ranks):
        """Collective calls: an agreement per work, and two per round of 64 MB for all ranks."""
        works = sum(name["works"] for name in self.names.values())
        return works + 2 * (works + self.bytes(n) / 2**26)

    def check(self, runner, n):
        """Largest error of the model's bytes against a count for another number of points."""
        counted = runner.run(self.job, n, NODES, pretend=True)["shared_work"]
        sent = sum(total(rank, "sent_bytes") for rank in counted)
        return self.bytes(n) / sent - 1

    def rows(self):
        for name, w in self.names.items():
            yield [name, f"{w['items']:.3g}", f"{w['bytes']:.1f}", f"{1e6 * w['seconds']:.2f}", w["works"]]


def predict(model):
    rows = []
    for n in (10**7, 10**8, GOAL):
        for ranks in (1, 16, NODES):
            held = model.memory * n
            alone = (model.seconds - model.shared_seconds) * n
            shared = model.shared_seconds * n / ranks
            received = model.bytes(n) * (ranks - 1) / ranks
            rows.append([f"{n:,}", ranks, f"{held / 1e9:.1f}" + (" (too much)" if held > NODE_MEMORY else ""),
                         f"{shared:,.0f}", f"{alone:,.0f}", f"{model.bytes(n) / ranks / 1e9:.2f}",
                         f"{received / 1e9:.1f}", f"{received / BANDWIDTH:,.0f}" if ranks > 1 else "0",
                         f"{model.messages(n, ranks):,.0f}" if ranks > 1 else "0"])
    return table(["points", "ranks", "held GB", "shared s", "not shared s", "sent GB", "received GB", "transfer s",
                  "messages"], rows)


TEXT = """# Scaling of csrbf-mpi

* {date}; {machine}, load {load:.1f} at the start
* One thread per rank. There are {cores} cores: 4 ranks take turns on them, so that wall times say little. **busy s** is
  the CPU time of the busiest rank without its waiting for others, and stands for the time on as many cores; **gain** is
  that of one rank divided by it. **shared s** is the part of it that is shared work of the first rank.

```sh
benchmarks/scaling.py --size {size}
```

## Measured

{measured}
In the strong runs a perfect gain would be the number of ranks, in the weak ones 1.

## Model

Per point of the input, from the difference of two runs, {half:,} and {size:,} points, that counted what each of
{nodes} ranks would exchange (`--pretend-ranks {nodes}`): items of shared work, bytes of their results, and CPU
microseconds to compute them. The bytes for {other:,} points, counted, differ from the model's by {errors}.

{models}
With n points and P ranks, b bytes and t seconds of shared work per point, u seconds of other work and m bytes of memory,
a rank

* holds m n bytes, whatever P: points, trees, patches and mesh are replicated;
* computes t n / P + u n seconds (Amdahl's law);
* sends b n / P bytes and receives b n (P - 1) / P of them;
* takes part in an agreement per work and two collective calls per 64 MB of all results.

{predictions}
## What this means for {goal:,} points on {nodes} nodes

{verdict}
"""


def verdict(model):
    held = model.memory * GOAL / 1e9
    limit = NODE_MEMORY / model.memory
    share = model.shared_seconds / model.seconds
    return (f"* `{model.job}`: every rank would hold {held:,.0f} GB. With {NODE_MEMORY / 1e9:.0f} GB per node the "
            f"replicated data end it at {limit:.1e} points, however many nodes there are. {100 * share:.0f} % of the work is "
            f"shared: the gain cannot exceed {1 / (1 - share):.1f} at one thread per rank.\n")


ADVICE = """
Up to there, ranks save time as long as work that is not shared is the smaller part; give each rank all cores of its
node, since loops that are not shared work use them too. Beyond, cut the data: tiles of the cloud with a margin of a few
supports, one run each. To go further in one run, patches would have to live only on the ranks whose region they reach,
and points with them: the fits need no more than that, but the orientation of normals and the winding number far from
the points look at everything.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--csrbf-mpi", type=Path, default=PROJECT / "build/distributed/bin/csrbf-mpi")
    parser.add_argument("--size", type=int, default=200000)
    parser.add_argument("--work", type=Path, default=PROJECT / "build/scaling")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SCALING.md")
    options = parser.parse_args()
    runner, size = Runner(options.csrbf_mpi.resolve(), options.work.resolve()), options.size
    load = os.getloadavg()[0]
    measured = "\n".join(measure(runner, job, size) for job in JOBS)
    models = [Model(runner, job, size) for job in JOBS]
    other = size // 4 * 3
    errors = ", ".join(f"{100 * model.check(runner, other):+.1f} % (`{model.job}`)" for model in models)
    model_text = "\n".join(
        f"`{model.job}`: {1e6 * model.seconds:.1f} microseconds in all and {model.memory:,.0f} bytes held.\n\n"
        + table(["work", "items", "bytes", "microseconds", "works"], model.rows()) for model in models)
    with open("/proc/cpuinfo") as info:
        machine = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), "unknown")
    options.output.write_text(TEXT.format(
        date=datetime.date.today(), machine=machine, load=load, cores=os.cpu_count(), size=size, half=size // 2,
        other=other, nodes=NODES, goal=GOAL, errors=errors, measured=measured, models=model_text,
        predictions="\n".join(f"`{model.job}`:\n\n" + predict(model) for model in models),
        verdict="".join(verdict(model) for model in models) + ADVICE))


if __name__ == "__main__":
    main()
