#!/usr/bin/python3
"""Writes a large point cloud with normals, as binary PLY: a bumpy torus, sampled all over in no order.

usage: make_cloud.py N OUT.ply

Needs memory for one block of points only. The same N gives the same file.
"""

import sys

import numpy as np

BLOCK = 1 << 20
BUMP, AROUND, ALONG = 0.06, 6, 9  # height, and how many bumps there are around the tube and along it


def surface(u, v):
    """Points of the surface at angles u along the ring and v around the tube."""
    radius = 0.4 * (1 + BUMP / 0.4 * np.sin(ALONG * u) * np.sin(AROUND * v))
    ring = 1 + radius * np.cos(v)
    return np.stack([ring * np.cos(u), ring * np.sin(u), radius * np.sin(v)], axis=1)


def oriented_points(first, count):
    """Rows x y z nx ny nz of the points with these numbers; a Kronecker sequence spreads the angles evenly."""
    number = np.arange(first, first + count, dtype=np.float64)
    plastic = 1.32471795724474602596
    u, v = (2 * np.pi * ((number / plastic**power) % 1.0) for power in (1, 2))
    step = 1e-5
    along = surface(u + step, v) - surface(u - step, v)
    around = surface(u, v + step) - surface(u, v - step)
    normal = np.cross(along, around)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.hstack([surface(u, v), normal]).astype("<f4")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    n, path = int(sys.argv[1]), sys.argv[2]
    names = ("x", "y", "z", "nx", "ny", "nz")
    header = ["ply", "format binary_little_endian 1.0", "element vertex %d" % n]
    header += ["property float " + name for name in names] + ["end_header", ""]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode())
        for first in range(0, n, BLOCK):
            file.write(oriented_points(first, min(BLOCK, n - first)).tobytes())


if __name__ == "__main__":
    main()
