#!/usr/bin/python3
"""Predicts samples left out of real data with csrbf and other programs, and writes a page of errors.

usage: real_samples.py [--sets NAME,...] [--folds N] [--json FILE] [--output FILE]

  --sets NAMES   default: all of the table below
  --folds N      random folds; default 5
  --json FILE    also writes all scores
  --output FILE  default: benchmarks/REAL_SAMPLES.md; -: prints it instead

The data are those of R and of its packages in Debian, which stay where they are. The peers are kriging (gstat, with
the best of nine variograms), thin plates with smoothing by likelihood (mgcv), a Gaussian process with one length per
axis (scikit-learn) and linear interpolation. All programs run without options, by the same folds and blocks.

Needs numpy, scipy, scikit-learn, csrbf, and the packages r-recommended, r-cran-gstat, r-cran-fields, r-cran-gss and
r-cran-spdata.
"""

import argparse
import datetime
import json
import os
import resource
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from pages import write_page

# The name of the data, their package, and R's expression for the coordinates and, last, the values.
SETS = {
    "trees": ("datasets", "trees"),
    "topo": ("MASS", "topo"),
    "ethanol": ("lattice", "ethanol[, c('C', 'E', 'NOx')]"),
    "mcycle": ("MASS", "mcycle"),
    "co2": ("datasets", "cbind(time(co2), co2)"),
    "LakeAcidity": ("gss", "LakeAcidity[, c('lon', 'lat', 'ph')]"),
    "ozone2": ("fields", "cbind(ozone2$lon.lat, ozone2$y[16, ])"),
    "coalash": ("gstat", "coalash"),
    "baltimore": ("spData", "baltimore[, c('X', 'Y', 'PRICE')]"),
    "COmonthlyMet": ("fields", "cbind(CO.loc, CO.elev, CO.tmax.MAM.climate)"),
    "Boston": ("MASS", "Boston[, c('lstat', 'rm', 'dis', 'nox', 'ptratio', 'tax', 'medv')]"),
    "quakes": ("datasets", "quakes[, c('long', 'lat', 'depth')]"),
    "volcano": ("datasets", "{set.seed(7); i <- sample(5307, 1000); cbind((i - 1) %% 87, (i - 1) %/% 87, volcano[i])}"),
    "rock": ("datasets", "rock[, c('area', 'peri', 'shape', 'perm')]"),
    "pressure": ("datasets", "cbind(pressure$temperature, log(pressure$pressure))"),
    "oxford": ("gstat", "oxford[, c('XCOORD', 'YCOORD', 'MG1')]"),
    "meuse.all": ("gstat", "meuse.all[, c('x', 'y', 'cadmium')]"),
    "sic2004": ("gstat", "as.data.frame(sic.val)[, c('x', 'y', 'dayx')]"),
    "pcb": ("gstat", "cbind(pcb$x, pcb$y, log(pcb$PCB138))"),
    "walker": ("gstat", "as.data.frame(walker)[, c('X', 'Y', 'U')]"),
    "jura": ("gstat", "rbind(jura.pred, jura.val)[, c('Xloc', 'Yloc', 'Cu')]"),
    "environmental": ("lattice", "environmental[, c('radiation', 'temperature', 'wind', 'ozone')]"),
    "cpus": ("MASS", "cbind(cpus[, 2:7], log(cpus$perf))"),
    "airpass": ("datasets", "cbind(time(AirPassengers), log(AirPassengers))"),
    "nottem": ("datasets", "cbind(time(nottem), nottem)"),
    "USprecip": ("spam", "{set.seed(1); USprecip[sample(nrow(USprecip), 800), c('lon', 'lat', 'anomaly')]}"),
    "NorthAmericanRainfall": ("fields", "{set.seed(1); with(NorthAmericanRainfall, cbind(longitude, latitude, elevation, "
                                        "precip))[sample(1720, 800), ]}"),
    "RMelevation": ("fields", "{set.seed(2); g <- with(RMelevation, cbind(expand.grid(x, y), c(z))); "
                              "g[sample(nrow(g), 800), ]}"),
}

READ = """
arguments <- commandArgs(TRUE)
suppressMessages(library(arguments[1], character.only=TRUE))
suppressWarnings(try(data(list=arguments[2], package=arguments[1]), silent=TRUE))
d <- as.data.frame(eval(parse(text=arguments[3])))
write.table(format(d[complete.cases(d), ], digits=15), arguments[4], row.names=FALSE, col.names=FALSE, quote=FALSE)
"""

PREDICT = """
arguments <- commandArgs(TRUE)
samples <- read.table(arguments[2])
queries <- read.table(arguments[3])
d <- ncol(queries)
names(queries) <- paste0("x", 1:d)
names(samples) <- c(names(queries), "v")
axes <- paste(names(queries), collapse=" + ")
if (arguments[1] == "thin plates") {
  suppressMessages(library(mgcv))
  distinct <- nrow(unique(samples[1:d]))
  fit <- gam(as.formula(sprintf("v ~ s(%s, k=%d)", gsub(" [+] ", ", ", axes), min(150, as.integer(.7 * distinct)))),
             data=samples, method="REML")
  z <- predict(fit, queries, se.fit=TRUE)
  out <- cbind(z$fit, sqrt(z$se.fit^2 + fit$sig2))
} else {
  suppressMessages({library(gstat); library(sp)})
  data <- aggregate(samples["v"], samples[1:d], mean)
  sill <- var(data$v)
  places <- as.formula(paste("~", axes))
  coordinates(data) <- places
  coordinates(queries) <- places
  empirical <- variogram(v ~ 1, data)
  range <- max(empirical$dist) / 3
  best <- vgm(.7 * sill, "Exp", range, .3 * sill)
  error <- Inf
  for (model in c("Exp", "Sph", "Mat")) for (factor in c(1, .3, 3)) {
    start <- vgm(.7 * sill, model, factor * range, .3 * sill, kappa=1.5)
    fit <- suppressWarnings(try(fit.variogram(empirical, start), silent=TRUE))
    if (inherits(fit, "try-error") || any(fit$psill < 0) || any(fit$range < 0) || attr(fit, "SSErr") >= error) next
    best <- fit
    error <- attr(fit, "SSErr")
  }
  invisible(capture.output(z <- krige(v ~ 1, data, queries, best, nmax=100)))
  out <- cbind(z$var1.pred, sqrt(pmax(z$var1.var, 0)))
}
write.table(out, arguments[4], row.names=FALSE, col.names=FALSE)
"""

LEGEND = """\
**error**: root mean square error of the values left out; **95 %**: share of them within 1.96 standard deviations, noise
included; **density**: mean negative logarithm of the density of the values left out, smaller is better; **CPU s**: mean
of a fit and its predictions, for gstat and mgcv with R's start. Folds are random; blocks are squares of a twelfth of
the extent, of which a tenth is left out, three times. -: none, or it failed.
"""


def read(name, folder):
    package, expression = SETS[name]
    file = folder / "data"
    subprocess.run(["Rscript", "-e", READ, package, name, expression, file], check=True)
    table = np.loadtxt(file)
    return table[:, :-1], table[:, -1]


def by_csrbf(x, v, q, _):
    import csrbf

    model = csrbf.fit(x, v)
    return model(q), model.standard_deviation(q)


def by_linear(x, v, q, _):
    unknown = np.full(len(q), np.nan)
    points, places = np.unique(x, axis=0, return_inverse=True)
    places = places.ravel()
    values = np.bincount(places, v) / np.bincount(places)
    if x.shape[1] == 1:
        return np.interp(q[:, 0], points[:, 0], values), unknown
    if x.shape[1] > 3:
        raise ValueError("too many axes")
    predicted = LinearNDInterpolator(points, values, rescale=True)(q)
    outside = ~np.isfinite(predicted)
    predicted[outside] = NearestNDInterpolator(points, values, rescale=True)(q[outside])
    return predicted, unknown


def by_process(x, v, q, _):
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    middle, size = x.mean(axis=0), x.std(axis=0)
    kernel = ConstantKernel() * Matern(np.ones(x.shape[1]), (1e-2, 1e3), nu=1.5) + WhiteKernel(0.1, (1e-8, 10))
    process = GaussianProcessRegressor(kernel, normalize_y=True).fit((x - middle) / size, v)
    return process.predict((q - middle) / size, return_std=True)


def by_r(what):
    def predict(x, v, q, folder):
        if x.shape[1] > 3 or (what == "kriging" and x.shape[1] == 1):
            raise ValueError("too many axes, or too few")
        np.savetxt(folder / "samples", np.c_[x, v])
        np.savetxt(folder / "queries", q)
        arguments = [what, folder / "samples", folder / "queries", folder / "out"]
        subprocess.run(["Rscript", "-e", PREDICT, *arguments], check=True, stderr=subprocess.DEVNULL)
        out = np.genfromtxt(folder / "out").reshape(-1, 2)
        return out[:, 0], out[:, 1]

    return predict


PROGRAMS = {
    "csrbf": by_csrbf,
    "kriging": by_r("kriging"),
    "thin plates": by_r("thin plates"),
    "process": by_process,
    "linear": by_linear,
}


def parts_left_out(x, folds):
    fold = np.random.default_rng(0).permutation(np.arange(len(x)) % folds)
    parts = {"folds": [fold == k for k in range(folds)]}
    if x.shape[1] == 2 and len(x) >= 100:
        square = np.floor(12 * (x - x.min(axis=0)) / np.ptp(x, axis=0)).astype(int)
        group = np.random.default_rng(1).permutation(14 * 14)[14 * square[:, 0] + square[:, 1]] % 10
        parts["blocks"] = [group == k for k in range(3) if (group == k).any()]
    return parts


def cpu_seconds():
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def scores(predict, x, v, left_out, folder):
    errors, deviations = [], []
    start = cpu_seconds()
    for part in left_out:
        try:
            predicted, deviation = predict(x[~part], v[~part], x[part], folder)
        except (ValueError, subprocess.CalledProcessError):
            return None
        errors.append(v[part] - predicted)
        deviations.append(deviation)
    seconds = (cpu_seconds() - start) / len(left_out)
    error, deviation = np.concatenate(errors), np.concatenate(deviations)
    result = {"error": float(np.sqrt(np.mean(error**2))), "seconds": seconds}
    if not np.isfinite(result["error"]):
        return None
    if (deviation > 0).all():
        z = error / deviation
        result["within"] = float(np.mean(abs(z) < 1.96))
        result["density"] = float(np.mean(np.log(2 * np.pi * deviation**2) + z**2) / 2)
    return result


def page(rows, folds):
    lines = ["# Real samples from Debian's packages", ""]
    lines.append(f"Measured {datetime.date.today()} by `benchmarks/real_samples.py --folds {folds}`.")
    lines += ["", LEGEND]
    for key, title in [("error", "Error"), ("within", "95 %"), ("density", "Density"), ("seconds", "CPU s")]:
        lines += [f"## {title}", "", "| set | samples | axes | left out | " + " | ".join(PROGRAMS) + " |"]
        lines.append("| --- | --- | --- | --- |" + " --- |" * len(PROGRAMS))
        for row in rows:
            cells = []
            for program in PROGRAMS:
                value = (row["scores"][program] or {}).get(key)
                cells.append("-" if value is None else f"{value:.3g}" if abs(value) < 1e4 else "> 10000")
            case = [row["set"], str(row["samples"]), str(row["axes"]), row["part"]]
            lines.append("| " + " | ".join(case + cells) + " |")
        lines.append("")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", default=",".join(SETS))
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--json")
    parser.add_argument("--output", default=str(Path(__file__).parent / "REAL_SAMPLES.md"))
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for data in options.sets.split(","):
            x, v = read(data, folder)
            for part, left_out in parts_left_out(x, options.folds).items():
                found = {program: scores(f, x, v, left_out, folder) for program, f in PROGRAMS.items()}
                rows.append({"set": data, "samples": len(v), "axes": x.shape[1], "part": part, "scores": found})
                errors = {program: f and round(f["error"], 4) for program, f in found.items()}
                print(data, part, errors, file=sys.stderr, flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=1))
    write_page(page(rows, options.folds), options.output)


if __name__ == "__main__":
    main()
