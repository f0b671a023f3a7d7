#!/usr/bin/python3
"""Measures csrbf-mpi on 1, 2 and 4 ranks, counts what more ranks would exchange, and writes a page of tables.

usage: scaling.py [--csrbf-mpi PROGRAM] [--size N] [--group DIR] [--work DIR] [--output FILE]

  --csrbf-mpi PROGRAM  default: build/distributed/bin/csrbf-mpi
  --size N             points of the strong runs; the weak ones have N / 2 per rank (default: 200000)
  --group DIR          a memory control group (version 1) whose limit may be set: measures what --memory pages when
                       the node is short of memory; default: not measured
  --work DIR           keeps clouds, samples and reports; default: build/scaling
  --output FILE        default: benchmarks/SCALING.md

Needs numpy.
"""

import argparse
import datetime
import json
import os
import resource
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
DISK = 1e9  # bytes per second that a node reads and writes
CAP_SHARE = 0.9  # of the memory of a node, for --memory


def torus(n):
    """With noise of a fifth of the spacing, so that the patches are alike for any number of points."""
    noise = 0.2 * 4 * np.pi * np.sqrt(0.1 / n)  # R = 1, r = 0.4
    source = np.random.default_rng(1)
    u, v = source.uniform(0, 2 * np.pi, (2, n))
    normals = np.column_stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)])
    ring = np.column_stack([np.cos(u), np.sin(u), np.zeros(n)])
    return np.column_stack([ring + (0.4 + source.normal(0, noise, n))[:, None] * normals, normals])


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

    def run(self, job, n, ranks, pretend=False, flags=(), group=None):
        make, job_flags = JOBS[job]
        data = self.folder / f"{job}_{n}.npy"
        if not data.exists():
            np.save(data, make(n))
        # Through mpirun also for one process: a child of this script would count the memory of its parent as its own.
        command = ["mpirun", "-n", "1" if pretend else str(ranks), "--oversubscribe", "--bind-to", "none",
                   *(["--allow-run-as-root"] if os.geteuid() == 0 else []), str(self.program),
                   *(["--pretend-ranks", str(ranks)] if pretend else [])]
        report = self.folder / "report.json"
        start, before = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*command, job, str(data), *job_flags, *flags, "--threads", "1", "--report", str(report),
                        "--quiet"], cwd=self.folder, check=True, env=dict(os.environ, OMP_NUM_THREADS="1"),
                       preexec_fn=group and group.enter)
        result, after = json.loads(report.read_text()), resource.getrusage(resource.RUSAGE_CHILDREN)
        result["wall"] = time.time() - start
        result["read"], result["written"] = (512 * (getattr(after, key) - getattr(before, key))
                                             for key in ("ru_inblock", "ru_oublock"))
        return result


class Group:
    """A memory control group: what its processes use and what the system keeps of their files is limited."""

    def __init__(self, folder):
        self.folder = folder

    def limit(self, size):
        (self.folder / "memory.limit_in_bytes").write_text(str(int(size)))

    def enter(self):
        (self.folder / "cgroup.procs").write_text(str(os.getpid()))


def total(shared, key):
    return sum(traffic[key] for traffic in shared.values())


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---:|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def measured_row(n, ranks, report, before):
    shared = report.get("shared_work") or {}
    busy = report["busy_seconds"]
    return [f"{n:,}", ranks, f"{busy:.1f}", f"{before / busy:.2f}" if before else "1",
            f"{total(shared, 'seconds'):.1f}", f"{report['wall']:.1f}", f"{report['peak_memory_mb']:.0f}",
            f"{total(shared, 'sent_bytes') / 1e6:.1f}",
            f"{total(shared, 'received_bytes') / 1e6:.1f}", total(shared, "rounds")]


HEAD = ["points", "ranks", "busy s", "gain", "shared s", "wall s", "peak MB", "sent MB", "received MB", "rounds"]


def measure(runner, job, size):
    """Tables of the runs, and the CPU seconds of one rank by the number of points."""
    text, alone = [], {}
    for title, sizes in (("Strong", [size] * len(RANKS)), ("Weak", [size // 2 * ranks for ranks in RANKS])):
        rows, first = [], None
        for n, ranks in zip(sizes, RANKS):
            report = runner.run(job, n, ranks)
            rows.append(measured_row(n, ranks, report, first))
            first = first or report["busy_seconds"]
            if ranks == 1:
                alone[n] = report["busy_seconds"]
        text.append(f"{title}, `{job}`:\n\n" + table(HEAD, rows))
    return "\n".join(text), alone


class Line:
    """What grows linearly with the number of points, through two values."""

    def __init__(self, sizes, values):
        self.slope = max(0.0, (values[1] - values[0]) / (sizes[1] - sizes[0]))
        self.offset = max(0.0, values[1] - self.slope * sizes[1])

    def __call__(self, n):
        return self.offset + self.slope * n

    def text(self, scale, digits):
        """The constant, and what a million points add."""
        return f"{scale * self.offset:,.{digits}f} + {scale * self.slope * 1e6:,.{digits}f}"


class Model:
    """What one rank does: lines through two runs that pretended to be of many ranks, and two of one rank."""

    def __init__(self, runner, job, sizes, alone):
        self.job, self.sizes, self.paged = job, sizes, {}
        runs = [runner.run(job, n, NODES, pretend=True) for n in sizes]
        self.works = {}
        for name, first in runs[1]["shared_work"][0].items():
            all_ranks = [[rank[name] for rank in run["shared_work"]] for run in runs]

            def line(key):
                return Line(sizes, [sum(traffic[key] for traffic in ranks) for ranks in all_ranks])

            self.works[name] = {"items": Line(sizes, [ranks[0]["items"] for ranks in all_ranks]),
                                "bytes": line("sent_bytes"), "seconds": line("seconds"), "works": first["works"]}
        self.memory = Line(sizes, [1e6 * run["peak_memory_mb"] for run in runs])
        self.other = Line(sizes, [alone[n] - self.sum("seconds", n) for n in sizes])

    def sum(self, key, n):
        return sum(work[key](n) for work in self.works.values())

    def messages(self, n):
        """Collective calls: an agreement per work, and two per round of 64 MB for all ranks."""
        works = sum(work["works"] for work in self.works.values())
        return works + 2 * (works + self.sum("bytes", n) / 2**26)

    def check(self, runner, n):
        """Relative error of the model's bytes against a count for another number of points."""
        counted = runner.run(self.job, n, NODES, pretend=True)["shared_work"]
        return self.sum("bytes", n) / sum(total(rank, "sent_bytes") for rank in counted) - 1

    def page(self, runner, group):
        """Bytes read, written and kept on disk per point where memory is as short as at the goal, by points."""
        share = NODE_MEMORY / self.memory(GOAL)
        if group is None or share >= 1:
            return
        for n in (2 * self.sizes[1], 4 * self.sizes[1]):  # enough that a cap is above the least
            limit = share * self.memory(n)
            group.limit(limit)
            run = runner.run(self.job, n, 1, flags=["--memory", f"{CAP_SHARE * limit / 1e6:.0f}MB"], group=group)
            self.paged[n] = [run["read"] / n, run["written"] / n, run["memory"]["peak_scratch_mb"] * 2**20 / n]

    def rows(self):
        for name, work in self.works.items():
            yield [name, work["works"], work["items"].text(1, 0), work["bytes"].text(1e-6, 2),
                   work["seconds"].text(1, 2)]


def predict(model):
    rows = []
    for n in (10**7, 10**8, GOAL):
        for ranks in (1, 16, NODES):
            held, results = model.memory(n), model.sum("bytes", n)
            received = results * (ranks - 1) / ranks
            rows.append([f"{n:,}", ranks, f"{held / 1e9:.1f}" + (" (too much)" if held > NODE_MEMORY else ""),
                         f"{model.sum('seconds', n) / ranks:,.0f}", f"{model.other(n):,.0f}"]
                        + ([f"{results / ranks / 1e9:.2f}", f"{received / 1e9:.1f}", f"{received / BANDWIDTH:,.1f}",
                            f"{model.messages(n):,.0f}"] if ranks > 1 else ["0"] * 4))
    return table(["points", "ranks", "held GB", "shared s", "not shared s", "sent GB", "received GB", "transfer s",
                  "messages"], rows)


TEXT = """# Scaling of csrbf-mpi

* {date}; {machine}, load {load:.1f} at the start
* One thread per rank. 4 ranks share {cores} cores, so wall times mean little. **busy s** is the CPU time of the busiest
  rank, not counting time spent waiting for others, and stands for the time on as many cores as ranks; **gain** is the
  busy time of one rank divided by it. **shared s** is the part of it that the first rank spends on shared work.

```sh
benchmarks/scaling.py --size {size}{group}
```

## Measured

{measured}
A perfect gain would be the number of ranks in the strong runs, and 1 in the weak ones. The cloud has noise of a fifth
of its spacing, which makes the fits of patches slow. As these are shared, other clouds may gain less.

## Model

Per million input points, from two runs with {half:,} and {size:,} points that counted what each of {nodes} ranks would
exchange (`--pretend-ranks {nodes}`): items of shared work, megabytes of their results, and CPU seconds to compute them,
each as a constant plus a part proportional to the points. For {other:,} points the bytes of the model differ from those
counted by {errors}.

{models}
With b(n) bytes and t(n) seconds of shared work, u(n) seconds of other work and m(n) bytes of memory for n points, each
of P ranks

* holds m(n) bytes for any P: points, trees, patches and mesh are replicated, in memory or, with `--memory`, on disk;
* computes t(n) / P + u(n) seconds (Amdahl's law);
* sends b(n) / P bytes and receives b(n) (P - 1) / P of them;
* takes part in one agreement per work and in two collective calls per 64 MB of all results.

A patch of s samples and k unknowns takes about 4 s k^2 flops, most of the work of `fit` (s = 32, k = 26: 87,000). The
transfer runs at {bandwidth:.0f} GB/s per node and does not overlap with the work.

{predictions}
## What this means for {goal:,} points on {nodes} nodes

{verdict}
"""


def verdict(model):
    limit = (NODE_MEMORY - model.memory.offset) / model.memory.slope
    shared, other = model.sum("seconds", GOAL), model.other(GOAL)
    return (f"* `{model.job}`: every rank would hold {model.memory(GOAL) / 1e9:,.0f} GB. With "
            f"{NODE_MEMORY / 1e9:.0f} GB per node the replicated data limit it to {limit:.1e} points without "
            f"`--memory`, however many nodes there are.\n  "
            f"{100 * shared / (shared + other):.0f} % of the work is shared: the gain cannot exceed "
            f"{1 + shared / other:.1f} at one thread per rank.\n") + paging(model)


def paging(model):
    if not model.paged:
        return ""
    read, written, scratch = (GOAL * value for value in model.paged[max(model.paged)])
    measured = ", ".join(f"{read:.0f} and {written:.0f} bytes per point for {n:,} points"
                         for n, (read, written, _) in model.paged.items())
    return (f"  Under `--memory {CAP_SHARE * NODE_MEMORY / 1e9:.0f}GB` a node would read {read / 1e9:,.0f} GB and "
            f"write {written / 1e9:,.0f} GB, which take {(read + written) / DISK:,.0f} s at {DISK / 1e9:.0f} GB/s, and "
            f"need {scratch / 1e9:,.0f} GB of disk space. Measured with memory, file cache included, short in the "
            f"same proportion: {measured}.\n")


ADVICE = """
Up to that limit, ranks save time as long as the work that is not shared is the smaller part; give each rank all cores
of its node, since loops that are not shared use them too. Beyond it, give each rank a memory cap and a disk of its own
(`--memory SIZE --scratch DIR`), or split the data: tiles of the cloud with a margin of a few supports, one run each. To
go further in one run, patches and their points would have to live only on the ranks whose region they reach: the fits
need no more than that, but the orientation of normals and the winding number far from the points need all the data.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--csrbf-mpi", type=Path, default=PROJECT / "build/distributed/bin/csrbf-mpi")
    parser.add_argument("--size", type=int, default=200000)
    parser.add_argument("--group", type=Path)
    parser.add_argument("--work", type=Path, default=PROJECT / "build/scaling")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SCALING.md")
    options = parser.parse_args()
    runner, size = Runner(options.csrbf_mpi.resolve(), options.work.resolve()), options.size
    load = os.getloadavg()[0]
    measured = {job: measure(runner, job, size) for job in JOBS}
    models = [Model(runner, job, [size // 2, size], alone) for job, (_, alone) in measured.items()]
    for model in models:
        model.page(runner, options.group and Group(options.group.resolve()))
    other = size // 4 * 3
    errors = ", ".join(f"{100 * model.check(runner, other):+.1f} % (`{model.job}`)" for model in models)
    model_text = "\n".join(
        f"`{model.job}`; other work {model.other.text(1, 2)} s, memory {model.memory.text(1e-6, 0)} MB:\n\n"
        + table(["work", "works", "items", "MB", "seconds"], model.rows()) for model in models)
    with open("/proc/cpuinfo") as info:
        machine = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), "unknown")
    options.output.write_text(TEXT.format(
        date=datetime.date.today(), machine=machine, load=load, cores=os.cpu_count(), size=size, half=size // 2,
        group=" --group DIR" if options.group else "",
        other=other, nodes=NODES, goal=GOAL, errors=errors,
        measured="\n".join(text for text, _ in measured.values()), bandwidth=BANDWIDTH / 1e9, models=model_text,
        predictions="\n".join(f"`{model.job}`:\n\n" + predict(model) for model in models),
        verdict="".join(verdict(model) for model in models) + ADVICE).rstrip() + "\n")


if __name__ == "__main__":
    main()
