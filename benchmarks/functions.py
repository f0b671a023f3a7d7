#!/usr/bin/python3
"""Predicts samples held back from real sets with csrbf and other programs, and writes a page of tables.

usage: functions.py --data DIR [--sets NAME,...] [--tools NAME,...] [--limit S] [--folds N] [--work DIR] [--output FILE]
                    [--picture FILE]

  --data DIR      holds NAME.npz: x (n, 2), v (n,), and for some sets their own test samples xt, vt
  --sets NAMES    default: all of them
  --tools NAMES   default: csrbf, gstat, mgcv, surface, greenspline, gp, scipy, linear; those that are missing are skipped
  --limit S       CPU seconds after which a program is stopped, for each fit; default 300
  --folds N       of ten, for sets without test samples: default 10 up to 3000 samples, 1 beyond
  --work DIR      default: build/functions; results are kept there, and only missing ones are made
  --output FILE   default: benchmarks/FUNCTIONS.md; -: prints it instead
  --picture FILE  also draws samples, prediction and deviation of the set heaton_satellite side by side

Sets with test samples predict these; of others a tenth is held back, ten times up to 3000 samples and once beyond. Needs
numpy, scipy and csrbf; for the others R with gstat and mgcv, GMT, scikit-learn.
"""

import argparse
import datetime
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent

# What each program is asked for: as its manual would have it, without options found by trying.
TOOLS = {
    "csrbf": "`csrbf.fit(x, v)`, no options",
    "gstat": "R package gstat: exponential, spherical or Matern variogram by `fit.variogram`, kriging from the nearest 50",
    "mgcv": "R package mgcv: `gam(v ~ s(x, y))`, REML, a basis of n / 2 up to 300",
    "surface": "GMT `surface -T0.25` on a grid of 500 nodes, read by `grdtrack`",
    "greenspline": "GMT `greenspline -St0.25` on a grid of 200 nodes, read by `grdtrack`, up to 2000 samples",
    "gp": "scikit-learn's GaussianProcessRegressor, Matern 3/2 and white noise, up to 1500 samples",
    "scipy": "`scipy.interpolate.RBFInterpolator`, thin plates, 50 neighbours",
    "linear": "`scipy.interpolate.LinearNDInterpolator`, the nearest sample outside the hull",
}
MOST_SAMPLES = {"greenspline": 2000, "gp": 1500}

GSTAT = """
suppressMessages({library(sp); library(gstat)})
d <- read.csv("samples.csv"); q <- read.csv("queries.csv")
d <- aggregate(v ~ x + y, d, mean)
coordinates(d) <- ~x+y; coordinates(q) <- ~x+y
some <- if (nrow(d) > 5000) d[round(seq(1, nrow(d), length.out = 5000)), ] else d
m <- fit.variogram(variogram(v ~ 1, some), vgm(c("Exp", "Sph", "Mat")))
k <- krige(v ~ 1, d, q, m, nmax = 50, debug.level = 0)
write.table(cbind(k$var1.pred, sqrt(k$var1.var)), "out.txt", row.names = FALSE, col.names = FALSE)
"""
MGCV = """
suppressMessages(library(mgcv))
d <- read.csv("samples.csv"); q <- read.csv("queries.csv")
k <- min(300, floor(nrow(unique(d[, c("x", "y")])) / 2))
m <- if (nrow(d) > 3000) bam(v ~ s(x, y, k = k), data = d, discrete = TRUE) else
  gam(v ~ s(x, y, k = k), data = d, method = "REML")
p <- predict(m, q, se.fit = TRUE)
write.table(cbind(p$fit, sqrt(p$se.fit^2 + m$sig2)), "out.txt", row.names = FALSE, col.names = FALSE)
"""


def available(tool):
    if tool in ("gstat", "mgcv"):
        return shutil.which("Rscript") is not None and subprocess.run(
            ["Rscript", "-e", f"library({tool})"], capture_output=True).returncode == 0
    if tool in ("surface", "greenspline"):
        return shutil.which("gmt") is not None
    module = {"gp": "sklearn", "csrbf": "csrbf"}.get(tool, "scipy")
    return subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


def by_python(tool, x, v, q):
    """Predictions, and deviations or None, in this process."""
    if tool == "csrbf":
        import csrbf

        f = csrbf.fit(x, v)
        return f(q), f.standard_deviation(q)
    from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator, RBFInterpolator

    unique, place = np.unique(x, axis=0, return_inverse=True)
    mean = np.bincount(place.ravel(), v) / np.bincount(place.ravel())
    if tool == "gp":
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

        low, extent = x.min(axis=0), np.ptp(x, axis=0).max()
        kernel = ConstantKernel() * Matern(0.2, nu=1.5) + WhiteKernel(0.1)
        model = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=1, random_state=0)
        return model.fit((x - low) / extent, v).predict((q - low) / extent, return_std=True)
    if tool == "scipy":
        return RBFInterpolator(unique, mean, neighbors=min(50, len(unique)))(q), None
    p = LinearNDInterpolator(unique, mean)(q)
    outside = ~np.isfinite(p)
    p[outside] = NearestNDInterpolator(unique, mean)(q[outside])
    return p, None


def commands(tool, folder, x, q):
    """Programs to run in the folder, which write out.txt."""
    if tool in ("gstat", "mgcv"):
        Path(folder, "run.R").write_text(GSTAT if tool == "gstat" else MGCV)
        return [["Rscript", "run.R"]]
    everything = np.vstack([x, q])
    low, high = everything.min(axis=0), everything.max(axis=0)
    step = (high - low).max() / 500
    coarse = 2.5 * step
    high = low + coarse * np.ceil((high - low) / coarse)
    region = "-R" + "/".join(repr(float(c)) for c in (low[0], high[0], low[1], high[1]))
    if tool == "greenspline":
        return [["gmt", "blockmean", "samples.txt", region, f"-I{step!r}", ">", "means.txt"],
                ["gmt", "greenspline", "means.txt", region, f"-I{coarse!r}", "-St0.25", "-Ggrid.nc", "-Z1"],
                ["gmt", "grdtrack", "queries.txt", "-Ggrid.nc", ">", "out.txt"]]
    return [["gmt", "blockmean", "samples.txt", region, f"-I{step!r}", ">", "means.txt"],
            ["gmt", "surface", "means.txt", region, f"-I{step!r}", "-T0.25", "-Ggrid.nc"],
            ["gmt", "grdtrack", "queries.txt", "-Ggrid.nc", ">", "out.txt"]]


def by_programs(tool, folder, x, v, q):
    table = {"delimiter": ",", "comments": ""}
    np.savetxt(Path(folder, "samples.csv"), np.column_stack([x, v]), header="x,y,v", **table)
    np.savetxt(Path(folder, "queries.csv"), q, header="x,y", **table)
    np.savetxt(Path(folder, "samples.txt"), np.column_stack([x, v]))
    np.savetxt(Path(folder, "queries.txt"), q)
    for command in commands(tool, folder, x, q):
        target = None
        if ">" in command:
            command, target = command[:-2], command[-1]
        with open(Path(folder, target or "log.txt"), "w") as out:
            subprocess.run(command, cwd=folder, check=True, stdout=out, stderr=subprocess.DEVNULL)
    found = np.loadtxt(Path(folder, "out.txt"), ndmin=2)
    if tool in ("gstat", "mgcv"):
        return found[:, 0], found[:, 1]
    return found[:, 2], None


def work(tool, given, result):
    """One fit and its predictions, in a process of its own."""
    data = np.load(given)
    with tempfile.TemporaryDirectory() as folder:
        if tool in ("csrbf", "gp", "scipy", "linear"):
            p, s = by_python(tool, data["x"], data["v"], data["q"])
        else:
            p, s = by_programs(tool, folder, data["x"], data["v"], data["q"])
    np.savez(result, p=p, s=np.full(len(p), np.nan) if s is None else s)


def predict(tool, x, v, q, limit):
    """Predictions, deviations and CPU seconds of a process; None when it fails or takes too long."""
    with tempfile.TemporaryDirectory() as folder:
        given, result = Path(folder, "in.npz"), Path(folder, "out.npz")
        np.savez(given, x=x, v=v, q=q)

        def limited():
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([sys.executable, __file__, "--worker", tool, given, result], env=environment,
                              preexec_fn=limited, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0 or not result.exists():
            return None
        found = np.load(result)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return found["p"], found["s"], cpu


def scores(y, p, s):
    error = y - p
    result = {"rmse": float(np.sqrt(np.mean(error**2)))}
    known = np.isfinite(s) & (s > 0)
    if known.mean() > 0.5:
        z, t = error[known] / s[known], s[known]
        result["c95"] = float(np.mean(np.abs(z) < 1.96))
        result["nlpd"] = float(np.mean(0.5 * np.log(2 * np.pi * t**2) + z**2 / 2))
    return result


def run_set(tool, data, limit, folds):
    x, v = data["x"], data["v"]
    if tool in MOST_SAMPLES and len(x) > MOST_SAMPLES[tool]:
        return {"why": "too many samples"}
    splits = []
    if "xt" in data:
        splits.append((x, v, data["xt"], data["vt"]))
    else:
        fold = np.random.default_rng(0).permutation(np.arange(len(v)) % 10)
        for number in range(folds or (1 if len(v) > 3000 else 10)):
            out = fold == number
            splits.append((x[~out], v[~out], x[out], v[out]))
    parts, cpu = [], 0.0
    for xi, vi, xo, vo in splits:
        found = predict(tool, xi, vi, xo, limit)
        if found is None:
            return {"why": f"failed, or more than {limit} s"}
        parts.append((vo, found[0], found[1]))
        cpu += found[2]
    return {**scores(*(np.concatenate(part) for part in zip(*parts))), "cpu": cpu / len(splits)}


def page(results, tools, sets, folds):
    times = f"{folds} times" if folds else "ten times up to 3000 samples and once beyond"
    lines = ["# Functions from real samples", "",
             f"Measured {datetime.date.today()} by `benchmarks/functions.py`. Of every set a tenth is held back,",
             f"{times}; heaton_satellite has test samples of its own (land",
             "surface temperatures under clouds; Heaton et al. 2019). **RMSE** of the predictions, the share of values",
             "within 1.96 standard deviations (**95 %**), the mean negative log density (**NLPD**), and **CPU** seconds of",
             "one fit and its predictions, the start of the program included, on one thread. A dash: the program has no",
             "deviations, or cannot take the set.", ""]
    lines += [f"* {tool}: {TOOLS[tool]}" for tool in tools] + [""]
    for name in sets:
        lines += [f"## {name}", "", "| tool | RMSE | 95 % | NLPD | CPU s |", "|---|---|---|---|---|"]
        for tool in tools:
            found = results.get(f"{name}/{tool}", {})
            cells = [f"{found[key]:.{digits}g}" if key in found else "-" for key, digits in
                     (("rmse", 4), ("c95", 3), ("nlpd", 4), ("cpu", 2))]
            lines.append(f"| {tool} | " + " | ".join(cells[:-1] + [found.get("why", cells[-1])]) + " |")
        lines.append("")
    return "\n".join(lines)


def draw(data, path):
    """Samples with their gaps, the prediction and its deviation, side by side."""
    import csrbf
    from matplotlib import pyplot

    x, v = data["x"], data["v"]
    f = csrbf.fit(x, v)
    low, high = x.min(axis=0), x.max(axis=0)
    axes = [np.linspace(low[a], high[a], n) for a, n in ((0, 500), (1, 300))]
    nodes = np.stack(np.meshgrid(*axes), axis=-1)
    mean = f.evaluate_grid(*axes).T
    deviation = f.standard_deviation(nodes, of="sample")
    figure, panels = pyplot.subplots(1, 3, figsize=(15, 4), constrained_layout=True)
    extent = (low[0], high[0], low[1], high[1])
    shades = {"vmin": np.percentile(v, 1), "vmax": np.percentile(v, 99), "cmap": "turbo"}
    panels[0].scatter(*x.T, c=v, s=0.1, **shades)
    panels[0].set(title="samples", xlim=extent[:2], ylim=extent[2:])
    shown = panels[1].imshow(mean, origin="lower", extent=extent, aspect="auto", **shades)
    panels[1].set_title("mean")
    figure.colorbar(shown, ax=panels[:2])
    shown = panels[2].imshow(deviation, origin="lower", extent=extent, aspect="auto", cmap="magma",
                             vmax=np.nanpercentile(deviation, 99.5))
    panels[2].set_title("standard deviation of a sample")
    figure.colorbar(shown, ax=panels[2])
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--sets")
    parser.add_argument("--tools", default=",".join(TOOLS))
    parser.add_argument("--limit", type=int, default=300)
    parser.add_argument("--folds", type=int)
    parser.add_argument("--work", type=Path, default=PROJECT / "build" / "functions")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks" / "FUNCTIONS.md")
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    sets = options.sets.split(",") if options.sets else sorted(path.stem for path in options.data.glob("*.npz"))
    if not sets:
        sys.exit(f"{options.data}: has no NAME.npz")
    tools = [tool for tool in options.tools.split(",") if available(tool)]
    options.work.mkdir(parents=True, exist_ok=True)
    kept = options.work / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    for name in sets:
        data = dict(np.load(options.data / f"{name}.npz"))
        for tool in tools:
            if f"{name}/{tool}" in results:
                continue
            start = time.time()
            results[f"{name}/{tool}"] = run_set(tool, data, options.limit, options.folds)
            print(f"{name} {tool}: {results[f'{name}/{tool}']} ({time.time() - start:.0f} s)", flush=True)
            kept.write_text(json.dumps(results, indent=1))
    write_page(page(results, tools, sets, options.folds), options.output)
    if options.picture:
        draw(dict(np.load(options.data / "heaton_satellite.npz")), options.picture)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--worker"]:
        work(*sys.argv[2:])
    else:
        main()
