"""Makes the files that the blocks of code of the pages read: small, and always the same.

usage: fixtures.py FOLDER --program CSRBF
"""

import argparse
import gzip
import os
import pathlib
import shutil
import struct
import subprocess
import zlib

import numpy as np

GENERATOR = np.random.default_rng(1)
SPHERE_POINTS, SCAN_POINTS, SOUNDINGS = 400, 800, 400


def directions(n):
    """Unit vectors along a spiral, evenly spread."""
    z = 1 - (2 * np.arange(n) + 1) / n
    angle = np.pi * (3 - 5**0.5) * np.arange(n)
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def lumpy(n):
    """Points on a ball with bumps."""
    u = directions(n)
    radius = 1 + 0.15 * np.sin(3 * u[:, 0] + 1) * np.cos(4 * u[:, 1]) + 0.1 * u[:, 2] ** 3
    return u * radius[:, None]


def write_png(name, image):
    """A grey image of 8 bits."""
    image = np.clip(np.rint(image), 0, 255).astype(np.uint8)
    height, width = image.shape
    rows = b"".join(b"\0" + row.tobytes() for row in image)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    pathlib.Path(name).write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_nifti(name, array, spacing=(1, 1, 1), origin=(0, 0, 0)):
    """An array [z, y, x] or [t, z, y, x] of float32, as NIfTI 1; the origin is that of the physical coordinates."""
    array = np.asarray(array, dtype="<f4")
    sizes = list(array.shape[::-1])
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, len(sizes), *(sizes + [1] * (7 - len(sizes))))
    struct.pack_into("<hh", header, 70, 16, 32)
    struct.pack_into("<8f", header, 76, 1, *spacing, 1, 1, 1, 1)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<ff", header, 112, 1, 0)
    header[123] = 2  # mm
    struct.pack_into("<h", header, 254, 1)  # sform
    for axis in range(3):
        row = [0.0] * 4
        row[axis], row[3] = spacing[axis], origin[axis]
        struct.pack_into("<4f", header, 280 + 16 * axis, *row)
    header[344:348] = b"n+1\0"
    pathlib.Path(name).write_bytes(gzip.compress(bytes(header) + array.tobytes(), compresslevel=1, mtime=0))


def ball_image(shape, spacing, origin, center, radius, noise=1.0):
    """[z, y, x]: 10 in a ball, 0 outside, with noise."""
    axes = [origin[a] + spacing[a] * np.arange(shape[2 - a]) for a in (2, 1, 0)]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    inside = (x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2 < radius**2
    return np.where(inside, 10.0, 0.0) + GENERATOR.normal(scale=noise, size=shape)


def write_points():
    np.savetxt("scan.xyz", lumpy(SCAN_POINTS), fmt="%.6f")
    np.savetxt("bunny.xyz", lumpy(SCAN_POINTS), fmt="%.6f")
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    rows = []
    for number, height in enumerate(np.linspace(0, 1, 5)):
        radius = 1 + 0.2 * np.sin(3 * height)
        rows += [(radius * np.cos(a), 0.8 * radius * np.sin(a), height, number) for a in angle]
    np.savetxt("contours.csv", rows, delimiter=",", header="x,y,z,contour", comments="", fmt=["%.6f"] * 3 + ["%d"])


def write_samples():
    xy = GENERATOR.uniform(size=(SOUNDINGS, 2))
    depth = 40 + 10 * np.sin(4 * xy[:, 0]) * np.cos(3 * xy[:, 1]) + GENERATOR.normal(scale=0.01, size=SOUNDINGS)
    np.savetxt("soundings.csv", np.column_stack([xy, depth]), delimiter=",", header="x,y,depth", comments="", fmt="%.5f")
    np.savetxt("places.csv", xy[:20], delimiter=",", header="x,y", comments="", fmt="%.5f")
    hour = np.sort(GENERATOR.uniform(0, 24, size=60))
    height = 2 * np.cos(2 * np.pi * hour / 12) + 0.3 * np.cos(2 * np.pi * hour / 24)
    np.savetxt("tides.csv", np.column_stack([hour, height]), delimiter=",", header="hour,height", comments="", fmt="%.4f")


def write_pictures():
    v, u = np.mgrid[:90, :120].astype(float)
    photo = 128 + 60 * np.sin(u / 15) * np.cos(v / 20)
    scratches = np.zeros(photo.shape)
    scratches[30:32, 34:46] = scratches[26:36, 40:42] = 255
    write_png("scratches.png", scratches)
    for name in ("photo.png", "scratched.png"):
        write_png(name, np.where(scratches > 0, 255, photo))
    np.save("depth.npy", np.where(scratches > 0, np.nan, photo))
    cells = np.zeros(photo.shape)
    for x, y, radius in ((30, 30, 14), (80, 25, 10), (70, 65, 18)):
        cells[(u - x) ** 2 + (v - y) ** 2 < radius**2] = 1
    write_png("drawn_by_hand.png", cells)
    write_png("labels.png", np.roll(cells, 1, axis=1))
    write_png("cells.png", 60 + 120 * cells + GENERATOR.normal(scale=8, size=cells.shape))


def write_volumes():
    head = ball_image((40, 44, 44), (3, 3, 3), (-60, -50, -40), (0, 10, 20), 42)
    write_nifti("head.nii.gz", head, (3, 3, 3), (-60, -50, -40))
    body = ball_image((30, 40, 40), (1, 1, 1.5), (0, 0, 0), (20, 20, 20), 12)
    for name in ("ct.nii.gz", "scan.nii.gz"):
        write_nifti(name, np.where(np.abs(body) < 0.05, 0, body), (1, 1, 1.5))
    for name in ("finer_image.nii.gz", "fine_image.nii.gz"):
        write_nifti(name, np.zeros((45, 60, 60)), (0.7, 0.7, 1))
    frames = [ball_image((1, 128, 128), (1, 1, 1), (0, 0, 0), (64, 64, 0), 30 - 2 * t) for t in range(5)]
    write_nifti("cine.nii.gz", frames)
    for t, frame in enumerate(frames):
        write_png(f"frame_{t}.png", 80 + 10 * frame[0])


def write_models(program):
    """Balls as surfaces, a scan, a function and a level set."""
    def run(*arguments):
        subprocess.run([program, *arguments, "--quiet"], check=True)

    for name, center, radius in (("body", (0, 0, 0), 1.0), ("handle", (1, 0, 0), 0.5), ("head", (0, 0, 1.2), 0.6),
                                 ("hole", (0, 0.8, 0), 0.5)):
        u = directions(SPHERE_POINTS)
        np.savetxt("ball.xyz", np.column_stack([radius * u + center, u]), fmt="%.6f")
        run("reconstruct", "ball.xyz", "-o", "ball.ply", "--model", f"{name}.csrbf", "--resolution", "16")
    run("combine", "difference", "body.csrbf", "hole.csrbf", "-o", "drilled.csrbf")
    run("reconstruct", "scan.xyz", "-o", "scan.ply", "--model", "scan.csrbf", "--resolution", "32")
    shutil.copy("scan.ply", "mesh.ply")
    run("polygonize", "scan.csrbf", "-o", "reference.ply", "--resolution", "40")
    run("fit", "soundings.csv", "-o", "depth.csrbf")
    run("segment", "ct.nii.gz", "-o", "unused.nii.gz", "--model", "brain.csrbf")
    for name in ("ball.xyz", "ball.ply", "unused.nii.gz"):
        os.remove(name)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    given = parser.parse_args()
    shutil.rmtree(given.folder, ignore_errors=True)
    given.folder.mkdir(parents=True)
    os.chdir(given.folder)
    write_points()
    write_samples()
    write_pictures()
    write_volumes()
    write_models(given.program)


if __name__ == "__main__":
    main()
