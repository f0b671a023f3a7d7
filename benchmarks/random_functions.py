#!/usr/bin/python3
"""Fits random functions from random samples with csrbf and SciPy, and writes a page of ratios of errors.

usage: random_functions.py [--seed N] [--cases N] [--sizes N,...] [--designs NAME,...] [--noises X,...] [--json FILE]
                           [--output FILE]

  --seed N        of the first case, the others count from it; default 5000
  --cases N       default 300
  --sizes NS      of samples; default 12,30,80,200,520
  --designs NAMES random, grid, tracks, clusters, dense_left; default: all
  --noises XS     standard deviations of the noise over that of the values; default 0,0,.02,.2
  --json FILE     also writes all cases
  --output FILE   default: benchmarks/RANDOM_FUNCTIONS.md; -: prints instead

Every case draws a dimension, a number of samples, a design, a function, its noise and the samples. Truths are known,
at points inside the hull of the samples. The peers are the nearest sample, linear interpolation and thin plates, of
which the one with the least error counts. Smoothing of the thin plates is the best of four, as seen by the truth.
Needs numpy, scipy and csrbf.
"""

import argparse
import datetime
import json
import os
import sys
import time
import warnings
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np
from scipy.interpolate import LinearNDInterpolator, RBFInterpolator
from scipy.spatial import Delaunay, QhullError, cKDTree

from pages import write_page

DIMENSIONS = [1, 2, 2, 2, 3, 3, 5]
SIZES = [12, 30, 80, 200, 520]
DESIGNS = ["random", "grid", "tracks", "clusters", "dense_left"]
NOISES = [0.0, 0.0, 0.02, 0.2]
FUNCTIONS = ["smooth", "wavy", "step", "kink", "bump", "exponential", "one_axis", "logarithm", "rough"]
QUERIES = 1500
SMOOTHINGS = [0.1, 1, 10]  # of thin plates, beside none
NEIGHBORS = 60
LEAST_ERROR = 1e-9  # of the deviation of the values: rounding

LEGEND = """\
Ratio of root mean square errors: csrbf's, without options, over that of the best of three peers, which is chosen by the
truth: the nearest sample, linear interpolation (up to three dimensions), and SciPy's thin plates with the best of four
smoothings. **ratio**: geometric mean; **thin plates**: over these alone; **lost**: share of cases above 1.1; **95 %**:
share of samples not seen, noise included, within 1.96 standard deviations, mean of all cases and fifth percentile.
"""


def mean_of_axes(x):
    return x.mean(axis=1)


def random_waves(dimension, rng):
    """Waves of 60 directions, lengths and phases; the longer, the larger."""
    directions = rng.standard_normal((60, dimension))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    frequencies = 2 * 25 ** rng.random(60)
    phases = 2 * np.pi * rng.random(60)
    return lambda x: (np.sin(x @ (directions * frequencies[:, None]).T + phases) / frequencies**0.75).sum(axis=1)


def make_function(name, dimension, rng):
    if name == "rough":
        return random_waves(dimension, rng)
    return {
        "smooth": lambda x: np.sin(3 * x[:, 0] + 1) * np.cos(2 * x[:, -1]) + mean_of_axes(x) ** 2,
        "wavy": lambda x: np.sin(14 * mean_of_axes(x)) + 0.4 * np.cos(9 * x[:, 0]),
        "step": lambda x: (mean_of_axes(x) > 0.5) + 0.2 * x[:, 0],
        "kink": lambda x: abs(x[:, 0] - 0.45) + abs(mean_of_axes(x) - 0.5),
        "bump": lambda x: np.exp(-60 * ((x - 0.5) ** 2).sum(axis=1) / dimension) + 0.1 * x[:, 0],
        "exponential": lambda x: np.exp(6 * mean_of_axes(x)),
        "one_axis": lambda x: np.tanh(12 * (x[:, 0] - 0.5)),
        "logarithm": lambda x: np.log(0.01 + x[:, 0]) + x[:, -1],
    }[name]


def make_samples(design, count, dimension, rng):
    """Points of the unit cube."""
    x = rng.random((count, dimension))
    if design == "grid":
        nodes = max(2, round(count ** (1 / dimension)))
        x = np.stack(np.meshgrid(*[np.linspace(0, 1, nodes)] * dimension), -1).reshape(-1, dimension)
    elif design == "tracks" and dimension > 1:
        tracks = max(3, int(count**0.4))
        x[:, 0] = (rng.integers(0, tracks, count) + 0.5) / tracks + 0.002 * rng.standard_normal(count)
    elif design == "clusters":
        centers = rng.random((max(3, count // 25), dimension))
        x = centers[rng.integers(0, len(centers), count)] + 0.06 * rng.standard_normal((count, dimension))
        x = np.clip(x, 0, 1)
    elif design == "dense_left":
        x[:, 0] **= 3
    return x


def inside(q, x):
    """Those of the points that lie in the hull of the samples, beyond three dimensions in their box."""
    if 1 < x.shape[1] < 4:
        try:
            return q[Delaunay(np.unique(x, axis=0)).find_simplex(q) >= 0]
        except QhullError:
            pass
    return q[((q >= x.min(axis=0)) & (q <= x.max(axis=0))).all(axis=1)]


def predictions_of_peers(x, v, q, noise):
    points, places = np.unique(x, axis=0, return_inverse=True)
    places = places.ravel()
    values = np.bincount(places, v) / np.bincount(places)
    result = {"nearest": values[cKDTree(points).query(q)[1]]}
    if points.shape[1] == 1:
        order = np.argsort(points[:, 0])
        result["linear"] = np.interp(q[:, 0], points[order, 0], values[order])
    elif points.shape[1] < 4:
        try:
            result["linear"] = LinearNDInterpolator(points, values)(q)
        except QhullError:
            pass
    for smoothing in [0] + (SMOOTHINGS if noise else []):
        try:
            result[f"thin plates {smoothing}"] = RBFInterpolator(points, values, smoothing=smoothing,
                                                                 neighbors=min(len(points), NEIGHBORS))(q)
        except np.linalg.LinAlgError:
            pass
    return result


def draw(seed, sizes=SIZES, designs=DESIGNS, noises=NOISES):
    """A case: what it is, its samples, and points with the truth there; none where too few points lie inside."""
    rng = np.random.default_rng(seed)
    case = {"seed": seed, "dimension": int(rng.choice(DIMENSIONS)), "size": int(rng.choice(sizes)),
            "function": str(rng.choice(FUNCTIONS)), "design": str(rng.choice(designs)), "noise": float(rng.choice(noises))}
    x = make_samples(case["design"], case["size"], case["dimension"], rng)
    case["size"] = len(x)
    function = make_function(case["function"], case["dimension"], rng)
    truth = function(x)
    case["deviation"] = float(truth.std()) or 1.0
    v = truth + case["noise"] * case["deviation"] * rng.standard_normal(len(x))
    q = inside(rng.random((QUERIES, case["dimension"])), x)
    noisy = case["noise"] * case["deviation"] * rng.standard_normal(len(q))
    return (case, x, v, q, function(q), noisy) if len(q) >= 50 else None


def run(drawn):
    """Adds to a case its errors, those of csrbf and of the peers, and how honest the deviations are."""
    import csrbf

    case, x, v, q, truth, noisy = drawn

    def error(p):
        return float(max(np.sqrt(np.nanmean((p - truth) ** 2)) / case["deviation"], LEAST_ERROR))

    start = time.process_time()
    model = csrbf.fit(x, v)
    p = model(q)
    case["seconds"] = time.process_time() - start
    case["error"] = error(p)
    deviations = np.asarray(model.standard_deviation(q))
    case["within"] = float(np.mean(abs(p - truth - noisy) <= 1.96 * deviations))
    case.update({name: model.report[name] for name in ("method", "kernel")})
    peers = {name: error(p) for name, p in predictions_of_peers(x, v, q, case["noise"]).items()}
    case["peer"] = min(peers, key=peers.get)
    case["ratio"] = case["error"] / peers[case["peer"]]
    case["thin_plates"] = case["error"] / min(e for name, e in peers.items() if name.startswith("thin"))
    return case


def run_all(seed, count, sizes, designs, noises, progress=None):
    cases = []
    for k in range(count):
        drawn = draw(seed + k, sizes, designs, noises)
        if drawn is not None:
            cases.append(run(drawn))
        if progress is not None and k % 50 == 49:
            print(f"{k + 1} of {count}", file=progress, flush=True)
    return cases


def geometric_mean(ratios):
    return float(np.exp(np.mean(np.log(ratios))))


def summary(cases):
    ratios = np.array([c["ratio"] for c in cases])
    within = np.array([c["within"] for c in cases])
    return [f"{len(cases)}", f"{geometric_mean(ratios):.2f}",
            f"{geometric_mean([c['thin_plates'] for c in cases]):.2f}", f"{np.mean(ratios > 1.1):.0%}",
            f"{within.mean():.3f}", f"{np.percentile(within, 5):.2f}"]


def table(rows, header):
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ["---"] * len(header), *rows]) + "\n"


def groups(cases, key):
    return sorted({c[key] for c in cases})


def page(cases, arguments):
    header = ["cases", "ratio", "thin plates", "lost", "95 %", "5th percentile"]
    sections = [table([[*summary(cases)]], header)]
    rows = [[design, f"{noise:g}", *summary(some)] for design in groups(cases, "design")
            for noise in groups(cases, "noise")
            if (some := [c for c in cases if c["design"] == design and c["noise"] == noise])]
    sections.append("## By design and noise\n\n" + table(rows, ["design", "noise", *header]))
    for key, title in (("dimension", "By dimension"), ("function", "By function")):
        rows = [[str(value), *summary([c for c in cases if c[key] == value])] for value in groups(cases, key)]
        sections.append(f"## {title}\n\n" + table(rows, [key, *header]))
    bounds = [0, 20, 50, 150, 400, 800, 2000, 10**9]
    rows = [[f"{low + 1} to {high}" if high < 10**9 else f"above {low}", *summary(some)]
            for low, high in zip(bounds, bounds[1:]) if (some := [c for c in cases if low < c["size"] <= high])]
    sections.append("## By number of samples\n\n" + table(rows, ["samples", *header]))
    for title, order in (("Worst ratios", lambda c: -c["ratio"]), ("Narrowest intervals", lambda c: c["within"])):
        rows = [[str(c["seed"]), str(c["dimension"]), str(c["size"]), c["design"], c["function"], f"{c['noise']:g}",
                 f"{c['error']:.3g}", f"{c['ratio']:.2f}", c["peer"], f"{c['method']}, {c['kernel']}",
                 f"{c['within']:.2f}"] for c in sorted(cases, key=order)[:5]]
        sections.append(f"## {title}\n\n" + table(rows, ["seed", "dimension", "samples", "design", "function", "noise",
                                                         "error", "ratio", "best peer", "chosen", "95 %"]))
    slowest = max(cases, key=lambda c: c["seconds"])
    sizes = ",".join(str(n) for n in arguments.sizes)
    intro = (f"# Random functions from random samples\n\nMeasured {datetime.date.today()} by "
             f"`benchmarks/random_functions.py --seed {arguments.seed} --cases {arguments.cases} --sizes {sizes}`.\n"
             f"The slowest case took {slowest['seconds']:.1f} CPU seconds ({slowest['size']} samples).\n\n" + LEGEND)
    return intro + "\n" + "\n".join(sections)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--seed", type=int, default=5000)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--sizes", type=lambda text: [int(n) for n in text.split(",")], default=SIZES)
    parser.add_argument("--designs", type=lambda text: text.split(","), default=DESIGNS)
    parser.add_argument("--noises", type=lambda text: [float(x) for x in text.split(",")], default=NOISES)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--output", default=Path(__file__).resolve().parent / "RANDOM_FUNCTIONS.md")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    cases = run_all(arguments.seed, arguments.cases, arguments.sizes, arguments.designs, arguments.noises, sys.stderr)
    if arguments.json:
        arguments.json.write_text(json.dumps(cases))
    write_page(page(cases, arguments), arguments.output)


if __name__ == "__main__":
    main()
