#!/usr/bin/python3
"""Segments pictures and volumes with `csrbf` and its peers, from seeds too, and writes a page of tables.

usage: segmentation.py --tools DIR [--data DIR] [--csrbf PROGRAM] [--cases NAME,...] [--peers] [--seeds N]
                       [--work DIR] [--output FILE]

  --tools DIR      holds make_images.py, which makes images with exact masks
  --data DIR       holds mr_ch2_slice.npz, microct100.npz, brain1_*.nrrd, example_*.nii.gz; without it their rows are
                   left out
  --csrbf PROGRAM  default: build/release/bin/csrbf; itk_threshold_level_set is run if it is beside it
  --cases NAMES    default: all of them, and those from seeds
  --peers          run scikit-image, too (Debian: python3-skimage)
  --seeds N        images with other noise of the pictures shape311_30dB, _20dB, _10dB and of speckle; default: 5
  --work DIR       keeps the images, which are made once; default: build/segmentation
  --output FILE    default: benchmarks/SEGMENTATION.md; -: prints it instead

Needs numpy and scipy.
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
from scipy import ndimage as ndi

import seeded_segmentation
from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
HEADER = ["case", "tool", "Dice", "min Dice", "evolve ms", "CPU s", "peak MB", "components", "what it chose"]
# name, flags of `csrbf segment`; a name with * stands for the seeds
CASES = [
    ("shape311_clean", []),
    ("shape311_30dB_*", []),
    ("shape311_20dB_*", []),
    ("shape311_10dB_*", []),
    ("shape311_islands_30dB", []),
    ("shape311_islands_30dB", ["--init", "sphere:155,155,40"]),
    ("shape311_islands_30dB", ["--init", "sphere:160,110,3"]),
    ("shape311_islands_30dB", ["--init", "sphere:280,30,10"]),
    ("shape311_islands_30dB", ["--init", "mask:{work}/checkerboard.npy"]),
    ("star446_clean", []),
    ("star446_clean", ["--center-spacing", "2.97"]),
    ("star446_clean", ["--center-spacing", "11.15"]),
    ("gyroid100_20dB", ["--center-spacing", "2"]),
    ("gyroid256_20dB", []),
    ("usim249", []),
    ("usim249", ["--energy", "generalized-gaussian"]),
    ("speckle_*", []),
    ("speckle_*", ["--energy", "generalized-gaussian"]),
    ("equal_means", []),
    ("equal_means", ["--energy", "generalized-gaussian"]),
    ("nested_rings", []),
    ("nested_rings", ["--shading", "none"]),
    ("mr_ch2_slice", []),
    ("mr_ch2_slice", ["--mode", "local", "--init", "sphere:108,90,20"]),
    ("microct100", ["--smoothness", "0"]),
]

LEGEND = """\
**Dice**: of the labels and the exact mask, averaged over the seeds if there are several; **min Dice**: the smallest of
them. **evolve**: the stage of the report, mean. **CPU s**, **peak MB**: of the whole command, including reading and
writing. scikit-image and the threshold run in Python: their CPU time is of the function alone, and for scikit-image the
better of the two sides counts. One run each.

*speckle*: other shapes, contrasts, grains and displays than usim249, in turn a flower, a crescent brighter than its
surroundings, three cysts with a coarse grain, a faint blob, and an envelope instead of its logarithm; *equal means*:
Laplace inside, uniform outside, with the same mean and variance; *nested rings*: a gradient of half the contrast across
the background, and noise of a tenth of it; *microct100* without any smoothing: the minimum energy of two-means
classification is known, and the column "what it chose" says how far above it the result is.
"""


def run(command):
    """CPU seconds of a child process."""
    child = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}: failed")
    return usage.ru_utime + usage.ru_stime


def dice(a, b):
    return 2 * np.count_nonzero(a & b) / max(1, np.count_nonzero(a) + np.count_nonzero(b))


def save(work, name, image, mask):
    np.save(work / f"{name}.npy", image.astype(np.float32))
    np.save(work / f"{name}_mask.npy", mask.astype(np.uint8))


def speckle(seed, n=249):
    """Echoes of two mean powers through a Gaussian point spread, as amplitudes or their logarithms; and the mask."""
    y, x = np.mgrid[0:n, 0:n] - (n - 1) / 2
    r, angle = np.hypot(x, y), np.arctan2(y, x)
    mask, inside, outside, spread, logarithm = [
        (r < n * (0.28 + 0.06 * np.cos(5 * angle + seed)), 0.15, 1, (1, 1.5), True),
        ((r < 0.35 * n) & (np.hypot(x - 0.15 * n, y) > 0.25 * n), 1, 0.2, (1, 1.8), True),
        ((r < 0.17 * n) | (np.hypot(x + 0.3 * n, y + 0.25 * n) < 0.1 * n)
         | (np.hypot(x - 0.3 * n, y - 0.22 * n) < 0.13 * n), 0.1, 1, (1.5, 2.5), True),
        (r < n * (0.25 + 0.06 * np.cos(2 * angle) + 0.03 * np.sin(3 * angle + seed)), 0.3, 1, (1.2, 2), True),
        (r < n * (0.28 + 0.05 * np.cos(3 * angle + seed)), 0.2, 1, (1, 1.8), False),
    ][seed % 5]
    rng = np.random.default_rng([249, seed])
    amplitude = np.where(mask, inside, outside)
    real, imaginary = (ndi.gaussian_filter(amplitude * rng.normal(size=mask.shape), spread) for _ in range(2))
    envelope = np.hypot(real, imaginary) / np.hypot(real, imaginary).max()
    return 255 * (np.clip(1 + 20 * np.log10(envelope) / 50, 0, 1) if logarithm else envelope), mask


def make_images(work, tools, data, seeds):
    if not (work / "shape311_clean.npy").exists():
        subprocess.run([sys.executable, tools / "make_images.py", work], check=True, stdout=subprocess.DEVNULL)
    clean = np.load(work / "shape311_clean.npy").astype(float)
    mask = np.load(work / "shape311_clean_mask.npy")
    for level in (30, 20, 10):
        for seed in range(seeds):
            rng = np.random.default_rng([level, seed])
            noise = rng.normal(0, np.sqrt(clean.var() / 10 ** (level / 10)), clean.shape)
            save(work, f"shape311_{level}dB_{seed}", clean + noise, mask)
    for seed in range(seeds):
        save(work, f"speckle_{seed}", *speckle(seed))
    y, x = np.mgrid[0:311, 0:311]
    np.save(work / "checkerboard.npy", ((x // 20 + y // 20) % 2 == 0).astype(np.uint8))

    rng = np.random.default_rng(8)
    n = 256
    y, x = np.mgrid[0:n, 0:n] - 127.5
    inside = np.hypot(x, y) < 70 + 15 * np.cos(3 * np.arctan2(y, x))
    laplace, uniform = rng.laplace(0, np.sqrt(0.5), (n, n)), rng.uniform(-np.sqrt(3), np.sqrt(3), (n, n))
    save(work, "equal_means", 128 + 30 * np.where(inside, laplace, uniform), inside)
    r = np.hypot(x, y)
    rings = ((r > 85) & (r < 105)) | ((r > 45) & (r < 65)) | (r < 20)
    background = 0.5 * (x + 127.5) / 255
    image = ndi.gaussian_filter(np.where(rings, 1.0, background), 0.7) + rng.normal(0, 0.1, (n, n))
    save(work, "nested_rings", 100 * image, rings)
    for name in ("mr_ch2_slice", "microct100"):
        if data is not None and (data / f"{name}.npz").exists():
            arrays = np.load(data / f"{name}.npz")
            save(work, name, arrays["img"], arrays["gt"])


def two_means(image):
    """The least mean square about two means, each voxel in the nearer one."""
    values = image.astype(float).ravel()
    threshold = values.mean()
    for _ in range(100):
        high = values > threshold
        means = values[high].mean(), values[~high].mean()
        threshold = sum(means) / 2
    return np.where(high, (values - means[0]) ** 2, (values - means[1]) ** 2).mean()


def within(image, labels):
    return sum(image[labels == k].astype(float).var() * np.count_nonzero(labels == k) for k in (0, 1)) / labels.size


def csrbf_row(program, work, name, flags, names):
    out, report = work / "labels.npy", work / "report.json"
    scores, evolve, cpu, peak = [], [], [], 0
    for one in names:
        cpu.append(run([program, "segment", work / f"{one}.npy", "-o", out, "--report", report, *flags]))
        told = json.loads(report.read_text())
        labels = np.load(out)
        scores.append(dice(labels != 0, np.load(work / f"{one}_mask.npy") != 0))
        evolve.append(1e3 * told["time"]["evolve"])
        peak = max(peak, told["peak_memory_mb"])
    chosen = ", ".join(f"{key} {told['options'][key]}" for key in ("center_spacing", "shading")
                       if told["options"].get(key) not in (None, "none", "auto"))
    if name == "microct100":
        image = np.load(work / f"{name}.npy")
        chosen += f", energy {100 * (within(image, labels != 0) / two_means(image) - 1):.2f} % above the minimum"
    shown = " ".join(["csrbf", *(Path(f).name if "/" in f else f for f in flags)])
    return [name, shown, f"{np.mean(scores):.4f}", f"{min(scores):.4f}", f"{np.mean(evolve):.0f}",
            f"{np.mean(cpu):.2f}", f"{peak:.0f}", told["result"]["components"], chosen]


def threshold_row(work, name, names):
    scores, cpu = [], []
    for one in names:
        image = np.load(work / f"{one}.npy").astype(float)
        start = time.process_time()
        smooth = ndi.gaussian_filter(image, 1.5 if image.ndim == 2 else 1.0)
        threshold = smooth.mean()
        for _ in range(30):
            threshold = 0.5 * (smooth[smooth > threshold].mean() + smooth[smooth <= threshold].mean())
        labels = smooth > threshold
        cpu.append(time.process_time() - start)
        border = np.concatenate([np.take(labels, k, axis).ravel() for axis in range(image.ndim) for k in (0, -1)])
        if border.mean() > 0.5:
            labels = ~labels
        scores.append(dice(labels, np.load(work / f"{one}_mask.npy") != 0))
    return [name, "Gaussian and two means", f"{np.mean(scores):.4f}", f"{min(scores):.4f}", "", f"{np.mean(cpu):.2f}",
            "", "", ""]


def skimage_row(work, name, names):
    from skimage.segmentation import chan_vese

    scores, cpu = [], []
    for one in names:
        image = np.load(work / f"{one}.npy").astype(float)
        start = time.process_time()
        labels = chan_vese((image - image.min()) / np.ptp(image), mu=0.1)
        cpu.append(time.process_time() - start)
        mask = np.load(work / f"{one}_mask.npy") != 0
        scores.append(max(dice(labels, mask), dice(~labels, mask)))  # it does not say which side is inside
    return [name, "scikit-image chan_vese", f"{np.mean(scores):.4f}", f"{min(scores):.4f}", "", f"{np.mean(cpu):.2f}",
            "", "", ""]


def table(rows, header=HEADER):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tools", type=Path, required=True)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--cases")
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--work", type=Path, default=PROJECT / "build/segmentation")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/SEGMENTATION.md")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    make_images(arguments.work, arguments.tools, arguments.data, arguments.seeds)

    rows, seen = [], set()
    for name, flags in CASES:
        base = name.removesuffix("_*")
        if arguments.cases and base not in arguments.cases.split(","):
            continue
        names = [f"{base}_{seed}" for seed in range(arguments.seeds)] if name.endswith("_*") else [base]
        if not (arguments.work / f"{names[0]}.npy").exists():
            print(f"{base}: left out, its image is not there", file=sys.stderr)
            continue
        print(base, *flags, file=sys.stderr)
        flags = [flag.format(work=arguments.work) for flag in flags]
        rows.append(csrbf_row(arguments.csrbf, arguments.work, base, flags, names))
        if base in seen:
            continue
        seen.add(base)
        rows.append(threshold_row(arguments.work, base, names))
        if arguments.peers and np.load(arguments.work / f"{names[0]}.npy").ndim == 2:
            rows.append(skimage_row(arguments.work, base, names))
    sections = ""
    if not arguments.cases:
        seeded = seeded_segmentation
        found = list(seeded.seeded_rows(arguments.csrbf, arguments.work, arguments.data, arguments.peers))
        sections = f"\n## From seeds\n\n{seeded.LEGEND}\n{table(found, seeded.HEADER)}\n"
        tissues = list(seeded.tissue_rows(arguments.csrbf, arguments.work))
        if tissues:
            sections += f"\n## Tissues\n\n{seeded.TISSUES}\n{table(tissues, seeded.TISSUE_HEADER)}\n"
    version = subprocess.run([arguments.csrbf, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    page = (f"# Segmentation\n\n{version}, {os.cpu_count()} cores, {datetime.date.today()}; made by "
            f"`benchmarks/segmentation.py`.\n\n{LEGEND}\n{table(rows)}\n{sections}")
    write_page(page, arguments.output)
    print(page)


if __name__ == "__main__":
    main()
