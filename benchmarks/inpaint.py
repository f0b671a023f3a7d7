#!/usr/bin/python3
"""Fills missing pixels of photographs with `csrbf inpaint` and scikit-image's biharmonic, and writes a page of tables.

usage: inpaint.py [--csrbf PROGRAM] [--size N] [--images NAME,...] [--masks NAME,...] [--no-peer] [--output FILE]

  --csrbf PROGRAM  default: build/release/bin/csrbf
  --size N         of the square pictures, scaled from those of scikit-image; default: 192
  --no-peer        csrbf only
  --output FILE    default: benchmarks/INPAINT.md; -: prints it instead

Needs numpy, scikit-image (Debian: python3-skimage) and Pillow.
"""

import argparse
import datetime
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from skimage import data, transform
from skimage.restoration import inpaint_biharmonic

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
PHOTOS = ["camera", "coffee", "astronaut", "chelsea", "moon", "coins", "rocket", "brick", "grass", "page", "retina",
          "immunohistochemistry"]
LEGEND = """\
PSNR in dB over the missing pixels, of a range of 1; mean, and the smallest lead (largest lag, if negative) over the
biharmonic among the pictures. CPU seconds are means: of the whole command for csrbf, of the function alone for
scikit-image, which runs in Python. *text*: letters written over the picture; *50 %*, *90 %*: pixels missing at random;
*holes*: 14 discs of radius 6; *large holes*: three of radius 20.
"""


def photo(name, size):
    image = getattr(data, name)().astype(float) / 255
    if image.ndim == 3:
        image = image[..., :3] @ [0.299, 0.587, 0.114]
    side = min(image.shape)
    top, left = ((n - side) // 2 for n in image.shape)
    image = transform.resize(image[top:top + side, left:left + side], (size, size), anti_aliasing=True)
    return np.round(255 * image) / 255


def masks(size):
    random = np.random.default_rng(1)
    y, x = np.mgrid[:size, :size]
    page = Image.new("L", (size, size))
    draw = ImageDraw.Draw(page)
    for row, top in enumerate(range(2, size, 15)):
        draw.text((2, top), ("the quick brown fox jumps over the lazy dog " * 2)[row % 9:], fill=255)

    def discs(count, radius):
        mask = np.zeros((size, size), bool)
        for row, column in random.integers(2 * radius, size - 2 * radius, (count, 2)):
            mask |= np.hypot(y - row, x - column) < radius
        return mask

    return {"text": np.asarray(page) > 100, "50 %": random.random((size, size)) < 0.5,
            "90 %": random.random((size, size)) < 0.9, "holes": discs(14, 6), "large holes": discs(3, 20)}


def psnr(found, truth, mask):
    return -10 * np.log10(np.mean((found - truth)[mask] ** 2))


def cpu(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def fill(program, image, mask, folder, flags=()):
    np.save(folder / "image.npy", np.where(mask, np.nan, image).astype(np.float32))
    start = cpu(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "inpaint", folder / "image.npy", "-o", folder / "filled.npy", *flags], check=True,
                   stdout=subprocess.DEVNULL)
    return np.load(folder / "filled.npy"), cpu(resource.RUSAGE_CHILDREN) - start


def biharmonic(image, mask):
    start = time.process_time()
    return inpaint_biharmonic(np.where(mask, 0, image), mask), time.process_time() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csrbf", type=Path, default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--images")
    parser.add_argument("--masks")
    parser.add_argument("--no-peer", action="store_true")
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/INPAINT.md")
    parser.add_argument("flags", nargs="*")
    arguments = parser.parse_args()
    photos = {name: photo(name, arguments.size) for name in (arguments.images or ",".join(PHOTOS)).split(",")}
    lines = ["| missing | csrbf | biharmonic | smallest lead | csrbf CPU s | biharmonic CPU s |", "|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        for kind, mask in masks(arguments.size).items():
            if arguments.masks and kind not in arguments.masks.split(","):
                continue
            rows = []
            for name, image in photos.items():
                found, seconds = fill(arguments.csrbf, image, mask, Path(folder), arguments.flags)
                ours = psnr(found, image, mask)
                other, their_seconds = (np.nan, np.nan)
                if not arguments.no_peer:
                    filled, their_seconds = biharmonic(image, mask)
                    other = psnr(filled, image, mask)
                rows.append((ours, other, seconds, their_seconds))
                print(f"{kind} {name}: {ours:.2f} {other:.2f} dB, {seconds:.2f} {their_seconds:.2f} s", file=sys.stderr)
            rows = np.array(rows)
            lead = (rows[:, 0] - rows[:, 1]).min()
            ours, other, seconds, their_seconds = rows.mean(0)
            lines.append(f"| {kind} | {ours:.2f} | {other:.2f} | {lead:+.2f} | {seconds:.2f} | {their_seconds:.2f} |")
    version = subprocess.run([arguments.csrbf, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    page = (f"# Inpainting\n\n{version}, {os.cpu_count()} cores, {datetime.date.today()}; made by `benchmarks/inpaint.py`"
            f" from {len(photos)} pictures of scikit-image ({', '.join(photos)}), {arguments.size} x {arguments.size} "
            f"pixels each.\n\n{LEGEND}\n" + "\n".join(lines) + "\n")
    write_page(page, arguments.output)
    print(page)


if __name__ == "__main__":
    main()
