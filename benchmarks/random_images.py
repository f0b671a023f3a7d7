#!/usr/bin/python3
"""Segments random images, whose regions are known, with csrbf and thresholds, and writes a page of Dice coefficients.

usage: random_images.py [--seed N] [--cases N] [--only KEY=VALUE,...] [--csrbf PROGRAM] [--json FILE] [--keep DIR]
                        [--output FILE]

  --seed N         of the first case, the others count from it; default 7000
  --cases N        default 300
  --only CHOICES   of what is drawn, such as shape=dots,noise=grain: the other cases are left out
  --csrbf PROGRAM  default: build/release/bin/csrbf
  --json FILE      also writes all cases
  --keep DIR       keeps images and labels there, as SEED.npy, SEED_truth.npy and SEED_labels.npy
  --output FILE    default: benchmarks/RANDOM_IMAGES.md; -: prints instead

Every case draws two or three axes, a size, shapes, what tells the regions apart, the kind and the level of the noise,
blur, light, voxels that are not cubes, and a type of numbers. csrbf has no option but the number of regions. The peers
are Otsu's threshold (more regions: k-means) after a Gaussian whose width a rule picks from the noise, the same with the
width of 0, 1, 2 and 4 voxels that the truth picks, and the former on what differs from a local mean. Needs numpy, scipy.
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
from scipy import ndimage as ndi

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
CHOICES = {
    "size": ["small", "medium", "medium", "large"],
    "shape": ["disc", "flower", "discs", "ring", "half", "bars", "islands", "tree", "dots", "touching", "layers"],
    "contrast": ["means"] * 6 + ["deviations", "grain"],
    "noise": ["none", "gauss", "gauss", "photons", "speckle", "impulses", "heavy", "grain"],
    "level": [0.05, 0.2, 0.5, 1.0],
    "blur": [0, 0, 1, 2],
    "light": ["even"] * 4 + ["ramp", "added", "bump", "vignette"],
    "inverted": [False, True],
    "type": ["uint8", "uint16", "float32", "tiny", "offset"],
    "thick": [False, False, True],  # voxels of 1 x 1 x 4, in three axes
}
SIDES = {2: {"small": 40, "medium": 112, "large": 208}, 3: {"small": 18, "medium": 36, "large": 52}}
WIDTHS = [0, 1, 2, 4]  # of Gaussians
LOST = 0.01  # Dice
WRONG = 0.05

LEGEND = f"""\
Mean Dice coefficient of the regions, in the order of labels that suits best if they are two. **median**, **5 %**: of
csrbf, over the cases, and the fifth percentile; **Otsu**: median of the threshold with the rule; **lead**: mean of
csrbf's Dice minus that; **lost**: share of cases in which it is more than {LOST:g} below it; **best**: mean lead over the
best of all peers, chosen by the truth; **wrong**: share of cases more than {WRONG:g} below that one; **silent**: those of
them without a warning.
"""


def places(shape, spacing, margin, count, rng):
    return [rng.uniform(margin, 1 - margin, len(shape)) for _ in range(count)]


def ball(x, center, radius):
    return sum((a - c) ** 2 for a, c in zip(x, center)) < radius**2


def smooth_field(shape, width, rng):
    return ndi.gaussian_filter(rng.standard_normal(shape), np.array(width), mode="wrap")


def grow_tree(x, rng, width):
    """Branches of straight pieces, in units of the longest side."""
    mask = np.zeros(x[0].shape, bool)

    def grow(p, u, length, depth):
        steps = max(2, int(length / width * 2))
        for t in np.linspace(0, 1, steps):
            mask[ball(x, p + t * length * u, width / 2)] = True
        if depth < 3:
            for _ in range(2):
                v = u + 0.6 * rng.standard_normal(len(u))
                grow(p + length * u, v / np.linalg.norm(v), 0.8 * length, depth + 1)

    start = np.full(len(x), 0.5)
    start[0] = 0
    grow(start, np.eye(len(x))[0], 0.3, 0)
    return mask


def make_regions(case, x, voxel, spacing, rng):
    """Labels, at places of the unit cube."""
    shape, d = x[0].shape, len(x)
    name = case["shape"]
    center = rng.uniform(0.3, 0.7, d)
    if name == "disc":
        return ball(x, rng.uniform(0.1, 0.9, d), rng.uniform(0.1, 0.35))
    if name == "flower":
        angle = np.arctan2(x[-1] - center[-1], x[-2] - center[-2])
        return np.sqrt(sum((a - c) ** 2 for a, c in zip(x, center))) < 0.25 * (1 + 0.3 * np.cos(5 * angle))
    if name == "discs":
        return np.any([ball(x, p, rng.uniform(0.04, 0.12)) for p in places(shape, spacing, 0, 12, rng)], axis=0)
    if name == "touching":
        return np.any([ball(x, p, 0.1) for p in places(shape, spacing, 0.2, 25, rng)], axis=0)
    if name == "ring":
        r = np.sqrt(sum((a - c) ** 2 for a, c in zip(x, center)))
        return (r > 0.18) & (r < 0.3)
    if name == "half":
        u = rng.standard_normal(d)
        return sum(a * b for a, b in zip(x, u / np.linalg.norm(u))) > sum(center * u / np.linalg.norm(u))
    if name == "bars":
        return np.sin(2 * np.pi * x[-1] * rng.integers(3, 8)) > rng.uniform(-0.5, 0.7)
    if name == "islands":
        field = smooth_field(shape, 0.06 / np.array(voxel), rng)
        return field > np.quantile(field, rng.uniform(0.4, 0.85))
    if name == "tree":
        return grow_tree(x, rng, max(voxel) * rng.uniform(1.5, 4))
    if name == "dots":
        radius = max(voxel) * rng.uniform(1.2, 3)
        return np.any([ball(x, p, radius) for p in places(shape, spacing, 0.03, 30, rng)], axis=0)
    fields = [smooth_field(shape, 0.09 / np.array(voxel), rng) for _ in range(2)]  # layers: three regions
    inside = fields[0] > np.quantile(fields[0], 0.4)
    return inside.astype(int) + (inside & (fields[1] > np.quantile(fields[1], 0.6)))


def unit_noise(kind, shape, rng):
    if kind == "heavy":
        return np.clip(rng.standard_t(2.5, shape), -30, 30) / 2
    if kind == "grain":
        noise = ndi.gaussian_filter(rng.standard_normal(shape), 1.2, mode="wrap")
        return noise / noise.std()
    return rng.standard_normal(shape)


def light_of(kind, x, rng):
    center = rng.uniform(0.2, 0.8, len(x))
    if kind == "bump":
        return 0.4 + 1.2 * np.exp(-4 * sum((a - c) ** 2 for a, c in zip(x, center)))
    if kind == "vignette":
        return 1.2 - 1.4 * sum((a - 0.5) ** 2 for a in x)
    return 0.4 + 1.2 * x[int(rng.integers(len(x)))]


def make_image(case, labels, x, rng):
    """Values of the regions, blurred, lit, with noise, as numbers of the type."""
    d, regions = labels.ndim, int(labels.max()) + 1
    level, ratio = case["level"], rng.uniform(1.7, 3)
    if case["contrast"] == "deviations":
        image = np.where(labels > 0, ratio, 1) * unit_noise("gauss", labels.shape, rng) * 0.1 + 1
        return as_type(image, case["type"])
    if case["contrast"] == "grain":
        coarse = unit_noise("grain", labels.shape, rng)
        return as_type(1 + 0.1 * np.where(labels > 0, coarse, rng.standard_normal(labels.shape)), case["type"])
    image = labels / (regions - 1.0)
    image = 0.6 + (1 - image if case["inverted"] else image)
    if case["blur"]:
        image = ndi.gaussian_filter(image, [case["blur"] / (4 if a == 0 and case["thick"] and d == 3 else 1) for a in range(d)])
    if case["light"] == "added":
        image = image + 2 * x[int(rng.integers(d))]
    elif case["light"] != "even":
        image = image * light_of(case["light"], x, rng)
    step = level / (regions - 1)
    if case["noise"] == "photons":
        photons = 1 / step**2
        image = rng.poisson(np.maximum(image, 0) * photons) / photons
    elif case["noise"] == "speckle":
        image = image * np.sqrt(rng.gamma(1 / (0.3 * step) ** 2 / 4, 4 * (0.3 * step) ** 2, image.shape))
    elif case["noise"] == "impulses":
        hit = rng.random(image.shape) < 0.2 * level
        image = np.where(hit, rng.choice([image.min(), image.max()], image.shape), image)
    elif case["noise"] != "none":
        image = image + step * unit_noise(case["noise"], image.shape, rng)
    return as_type(image, case["type"])


def as_type(image, kind):
    if kind in ("uint8", "uint16"):
        lo, hi = np.percentile(image, [0.1, 99.9])
        most = 255 if kind == "uint8" else 4095
        return np.clip(np.rint((image - lo) / max(hi - lo, 1e-9) * 0.9 * most + 0.05 * most), 0, most).astype(kind)
    scale, offset = {"float32": (1, 0), "tiny": (1e-6, 0), "offset": (300, -1000)}[kind]
    return (scale * image + offset).astype(np.float32)


def draw(seed, wanted=None):
    """A case: what it is, its image and its labels; none that is not wanted or has a region of hardly any voxels."""
    rng = np.random.default_rng(seed)
    case = {"seed": seed, "axes": int(rng.choice([2, 2, 2, 3]))}
    for key, values in CHOICES.items():
        case[key] = values[int(rng.integers(len(values)))]
    if case["axes"] == 2:
        case["thick"] = False
    if case["contrast"] != "means":
        case.update(noise="none", light="even", blur=0)
        if case["shape"] in ("tree", "dots", "layers"):
            case["shape"] = "flower"
    if wanted and any(str(case[key]) not in values for key, values in wanted.items()):
        return None
    side = SIDES[case["axes"]][case["size"]]
    shape = [int(side * rng.uniform(0.7, 1)) for _ in range(case["axes"])]
    shape[-1] = side
    spacing = [1.0] * case["axes"]
    if case["thick"]:
        shape[0], spacing[0] = max(6, shape[0] // 4), 4.0
    voxel = [s / side for s in spacing]
    x = np.meshgrid(*[(np.arange(n) + 0.5) * v for n, v in zip(shape, voxel)], indexing="ij")
    labels = np.asarray(make_regions(case, x, voxel, spacing, rng)).astype(np.uint8)
    if np.bincount(labels.ravel(), minlength=2).min() < 12:
        return None
    return case, make_image(case, labels, x, rng), labels, spacing


def dice(found, truth):
    """Mean over the regions; of two in the better order."""
    regions = int(truth.max()) + 1

    def mean(labels):
        return float(np.mean([2 * ((labels == k) & (truth == k)).sum() / max(1, (labels == k).sum() + (truth == k).sum())
                              for k in range(regions)]))

    return max(mean(found), mean(1 - found.astype(int))) if regions == 2 else max(mean(found), mean(regions - 1 - found))


def class_limits(values, regions):
    """Thresholds of the classes of least variance: Otsu's for two, k-means otherwise."""
    counts, edges = np.histogram(values, 256)
    middles = 0.5 * (edges[1:] + edges[:-1])
    if regions == 2:
        weight, total = np.cumsum(counts), np.cumsum(counts * middles)
        with np.errstate(all="ignore"):
            between = (total[-1] * weight - total * weight[-1]) ** 2 / (weight * (weight[-1] - weight))
        return [edges[np.nanargmax(between[:-1]) + 1]]
    means = np.percentile(values, 100 * (np.arange(regions) + 0.5) / regions)
    for _ in range(100):
        nearest = abs(middles[:, None] - means).argmin(1)
        means = np.array([np.average(middles[nearest == k], weights=counts[nearest == k]) if counts[nearest == k].sum()
                          else means[k] for k in range(regions)])
    means.sort()
    return list(0.5 * (means[1:] + means[:-1]))


def classes(values, regions):
    return np.searchsorted(class_limits(values, regions), values)


def ruled_width(image):
    steps = np.diff(image, axis=-1).ravel()
    noise = np.median(abs(steps)) / 0.954 / max(1e-30, np.ptp(np.percentile(image, [2, 98])))
    return 0 if noise < 0.05 else 1 if noise < 0.15 else 2 if noise < 0.5 else 4


def peers(image, truth, spacing):
    image, regions = image.astype(float), int(truth.max()) + 1
    image = (image - image.mean()) / (image.std() or 1)
    blurred = {w: ndi.gaussian_filter(image, [w / s for s in spacing]) for w in WIDTHS}
    found = {f"Gaussian {w}": dice(classes(blurred[w], regions), truth) for w in WIDTHS}
    width = ruled_width(image)
    around = ndi.gaussian_filter(image, [max(image.shape[-1] / 8, 2 * w) / s for w, s in zip([width] * image.ndim, spacing)])
    return {"Otsu": found[f"Gaussian {width}"], **found, "local": dice(classes(blurred[width] - around, regions), truth)}


def write_nrrd(path, image, spacing):
    kind = {"uint8": "uint8", "uint16": "uint16", "float32": "float"}[image.dtype.name]
    head = (f"NRRD0004\ntype: {kind}\ndimension: {image.ndim}\nsizes: {' '.join(str(n) for n in image.shape[::-1])}\n"
            f"spacings: {' '.join(str(s) for s in spacing[::-1])}\nencoding: raw\nendian: little\n\n")
    Path(path).write_bytes(head.encode() + image.tobytes())


def run(drawn, program, work, keep=None):
    """Adds to a case the Dice of csrbf and of the peers, what was chosen, and whether it warned."""
    case, image, truth, spacing = drawn
    write_nrrd(work / "image.nrrd", image, spacing)
    regions = int(truth.max()) + 1
    before = os.times()
    done = subprocess.run([program, "segment", work / "image.nrrd", "-o", work / "labels.npy", "--report",
                           work / "report.json", "--quiet", "--regions", str(regions)], capture_output=True, text=True)
    after = os.times()
    case["seconds"] = after.children_user + after.children_system - before.children_user - before.children_system
    case["warning"] = done.stderr.strip()
    labels = np.zeros_like(truth)
    if done.returncode == 0:
        labels = np.load(work / "labels.npy").reshape(truth.shape)
        report = json.loads((work / "report.json").read_text())
        case["warning"] += "; ".join(report.get("warnings", []))
        case["chosen"] = f"{report['options']['energy']}, {report['options']['shading']}"
    case["dice"] = dice(labels, truth) if done.returncode == 0 else 0.0
    case.update(regions=regions, peers=peers(image, truth, spacing))
    case["otsu"], case["best"] = case["peers"]["Otsu"], max(case["peers"].values())
    if keep:
        for name, array in (("", image), ("_truth", truth), ("_labels", labels)):
            np.save(Path(keep) / f"{case['seed']}{name}.npy", array)
    return case


def run_all(seed, count, program, wanted=None, keep=None, progress=None):
    cases = []
    with tempfile.TemporaryDirectory() as work:
        for k in range(count):
            drawn = draw(seed + k, wanted)
            if drawn is not None:
                cases.append(run(drawn, program, Path(work), keep))
            if progress is not None and k % 50 == 49:
                print(f"{k + 1} of {count}", file=progress, flush=True)
    return cases


def summary(cases):
    found, otsu, best = (np.array([c[key] for c in cases]) for key in ("dice", "otsu", "best"))
    wrong = found < best - WRONG
    silent = wrong & np.array([not c["warning"] for c in cases])
    return [f"{len(cases)}", f"{np.median(found):.4f}", f"{np.percentile(found, 5):.3f}", f"{np.median(otsu):.4f}",
            f"{np.mean(found - otsu):+.3f}", f"{np.mean(found < otsu - LOST):.0%}", f"{np.mean(found - best):+.3f}",
            f"{wrong.mean():.0%}", f"{silent.mean():.0%}"]


def table(rows, header):
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ["---"] * len(header), *rows]) + "\n"


def describe(case):
    words = [f"{case['axes']}D", case["size"], case["shape"]]
    if case["contrast"] != "means":
        words.append(f"differing in {case['contrast']}")
    else:
        words.append(f"{case['noise']} {case['level']:g}" if case["noise"] != "none" else "no noise")
        words += [f"blur {case['blur']}"] * (case["blur"] > 0) + [f"light {case['light']}"] * (case["light"] != "even")
        words += ["inverted"] * case["inverted"]
    return ", ".join(words + ["thick voxels"] * case["thick"] + [case["type"]])


def page(cases, arguments):
    header = ["cases", "median", "5 %", "Otsu", "lead", "lost", "best", "wrong", "silent"]
    sections = [table([summary(cases)], header)]
    for key in ("axes", "shape", "contrast", "noise", "level", "light", "blur", "size", "thick", "type"):
        rows = [[str(value), *summary([c for c in cases if c[key] == value])] for value in sorted({c[key] for c in cases})]
        sections.append(f"## By {key}\n\n" + table(rows, [key, *header]))
    for title, order in (("Farthest below the rule", lambda c: c["dice"] - c["otsu"]),
                         ("Farthest below the best peer", lambda c: c["dice"] - c["best"]),
                         ("Farthest above the best peer", lambda c: c["best"] - c["dice"])):
        rows = [[str(c["seed"]), describe(c), f"{c['dice']:.3f}", f"{c['otsu']:.3f}", f"{c['best']:.3f}",
                 max(c["peers"], key=c["peers"].get), c.get("chosen", "refused"), "yes" if c["warning"] else ""]
                for c in sorted(cases, key=order)[:5]]
        sections.append(f"## {title}\n\n" + table(rows, ["seed", "image", "Dice", "Otsu", "best peer", "which", "chosen",
                                                         "warned"]))
    intro = (f"# Random images\n\nMeasured {datetime.date.today()} by `benchmarks/random_images.py --seed {arguments.seed} "
             f"--cases {arguments.cases}`; {sum(c['seconds'] for c in cases) / len(cases):.2f} CPU seconds for each image.\n\n"
             + LEGEND)
    return intro + "\n" + "\n".join(sections)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=7000)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--only", default="")
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--output", default=PROJECT / "benchmarks/RANDOM_IMAGES.md")
    arguments = parser.parse_args()
    wanted = {}
    for choice in filter(None, arguments.only.split(",")):
        key, value = choice.split("=")
        wanted.setdefault(key, set()).add(value)
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
    cases = run_all(arguments.seed, arguments.cases, arguments.csrbf, wanted, arguments.keep, sys.stderr)
    if arguments.json:
        arguments.json.write_text(json.dumps(cases))
    write_page(page(cases, arguments), arguments.output)


if __name__ == "__main__":
    main()
