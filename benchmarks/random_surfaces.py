#!/usr/bin/python3
"""Reconstructs random solids from points taken in many ways, beside Poisson reconstruction, and writes a table.

usage: random_surfaces.py [--csrbf PROGRAM] [--solids N] [--seed N] [--ways NAME,...] [--points N] [--output FILE]

  --csrbf PROGRAM  default: build/release/bin/csrbf
  --solids N       for each way; default: 20
  --seed N         of the first one; default: 1
  --ways NAME,...  of taking points; default: all
  --points N       default: 10000
  --output FILE    default: benchmarks/RANDOM_SURFACES.md; - writes to the terminal

A solid is made of balls, rods, boxes and rings, joined smoothly or not, with holes bored through, turned at random.

  even      random points, everywhere as dense
  normals   the same with their exact normals
  noise     moved by 0.4 spacings in the mean of each axis
  heavy     a tenth moved by 2 spacings, the others by 0.1
  fading    the density falls by a hundred along the longest axis
  dense     spots are up to fifty times denser than the rest
  rows      on planes in one direction, four spacings apart
  lines     on scan lines in three directions, six spacings apart
  misfit    a third more points, of one half, moved by 1.3 spacings, as a second scan that does not fit
  gaps      three round gaps, a fifteenth of the diagonal wide, without points
  outliers  a fifth more points anywhere in the box

Positions only, but for normals. Poisson is Open3D's (Debian: python3-open3d; left out without it), the better of depths
7 and 8 in each mesh by the true surface, with normals of 16 neighbours oriented by a spanning tree. Needs numpy, scipy
and scikit-image.
"""

import argparse
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skimage.measure import marching_cubes

from pages import write_page

try:
    import open3d
except ImportError:
    open3d = None

PROJECT = Path(__file__).resolve().parent.parent
WAYS = ["even", "normals", "noise", "heavy", "fading", "dense", "rows", "lines", "misfit", "gaps", "outliers"]
CELLS = 120  # of the grid on which solids are made, along their longest side
DEPTHS = [7, 8]
COMPARED = 10_000  # points of each surface
WORST = 5

LEGEND = """Random solids, {points:,} points each; {solids} solids a row, from seed {seed}. Distances of 10,000 points of
each surface from 100,000 of the other one, in spacings (the root of the area per point; equal surfaces have means of
about 0.16): **mean** and **99 %**, medians and, after the stroke, the worst. **right**: meshes with the true number of
components and the true Euler number. **worst**: the five largest 99 % with the seeds of their solids. Made by
`benchmarks/random_surfaces.py`, whose help tells the ways.
"""


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def solid(rng):
    """Vertices and triangles of a random solid."""
    axis = np.linspace(-1.7, 1.7, CELLS)
    place = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
    value = np.full(place.shape[:3], 9.0)
    center = np.zeros(3)
    for _ in range(rng.integers(3, 7)):
        p = (place - center) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
        size = rng.uniform(0.15, 0.5)
        kind = rng.integers(4)
        if kind == 0:
            part = np.linalg.norm(p, axis=-1) - size
        elif kind == 1:  # a rod
            along = np.clip(p[..., 0], -0.8, 0.8)
            part = np.sqrt((p[..., 0] - along) ** 2 + p[..., 1] ** 2 + p[..., 2] ** 2) - 0.5 * size
        elif kind == 2:  # a box
            beyond = np.abs(p) - size * np.array([1, rng.uniform(0.3, 1.5), rng.uniform(0.3, 1.5)])
            part = np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(axis=-1), 0)
        else:  # a ring
            part = np.hypot(np.hypot(p[..., 0], p[..., 1]) - 0.6, p[..., 2]) - 0.4 * size
        blend = rng.choice([0.0, 0.15])
        mix = np.maximum(blend - np.abs(value - part), 0) / max(blend, 1e-9)
        value = np.minimum(value, part) - 0.25 * blend * mix**2
        center = rng.uniform(-0.6, 0.6, 3)
    for _ in range(rng.integers(0, 3)):  # holes
        p = (place - rng.uniform(-0.4, 0.4, 3)) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
        value = np.maximum(value, rng.uniform(0.08, 0.2) - np.hypot(p[..., 0], p[..., 1]))
    vertices, triangles, _, _ = marching_cubes(value, 0.0)
    corner = vertices[triangles]
    volume = np.einsum("ij,ij->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2]))
    return vertices / CELLS, triangles if volume > 0 else triangles[:, ::-1]


def sample(vertices, triangles, count, rng):
    """Random points of the surface, their normals, and its area."""
    corner = vertices[triangles]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = 0.5 * np.linalg.norm(cross, axis=1)
    chosen = rng.choice(len(area), count, p=area / area.sum())
    s, t = rng.random((2, count, 1))
    flip = s + t > 1
    s, t = np.where(flip, 1 - s, s), np.where(flip, 1 - t, t)
    a, b, c = np.moveaxis(corner[chosen], 1, 0)
    return a + s * (b - a) + t * (c - a), unit(cross)[chosen], area.sum()


def take_points(way, mesh, count, rng):
    """Points of the surface and, for the way normals, the normals."""
    points, normals, area = sample(*mesh, count, rng)
    spacing = math.sqrt(area / count)
    many = sample(*mesh, 40 * count, rng)[0] if way in ("fading", "dense", "rows", "lines") else points
    box = points.max(axis=0) - points.min(axis=0)
    diagonal = np.linalg.norm(box)
    if way == "normals":
        return points, normals
    if way == "noise":
        points = points + 0.4 * spacing * rng.standard_normal(points.shape)
    elif way == "heavy":
        size = np.where(rng.random(count) < 0.1, 2, 0.1) * spacing
        points = points + size[:, None] * rng.standard_normal(points.shape)
    elif way == "fading":
        along = many[:, box.argmax()]
        share = 100 ** -((along - along.min()) / box.max())
        points = many[rng.random(len(many)) < share][:count]
    elif way == "dense":
        spots = many[rng.choice(len(many), 12)]
        near = np.exp(-((cKDTree(spots).query(many)[0] / (0.05 * diagonal)) ** 2))
        points = many[rng.random(len(many)) < 0.02 + 0.98 * near][:count]
    elif way in ("rows", "lines"):
        step, taken = (4 if way == "rows" else 6) * spacing, []
        for axis in [2] if way == "rows" else [0, 1, 2]:
            part = many[np.abs(many[:, axis] / step - np.round(many[:, axis] / step)) < 0.025]
            taken.append(part)
        points = rng.permutation(np.vstack(taken))[:count]
    elif way == "misfit":
        again = sample(*mesh, 2 * count // 3, rng)[0]
        axis = rng.integers(3)
        again = again[again[:, axis] < np.median(again[:, axis])]
        points = np.vstack([points, again + 1.3 * spacing * unit(rng.standard_normal(3))])
    elif way == "gaps":
        middles = points[rng.choice(count, 3)]
        points = points[cKDTree(middles).query(points)[0] > diagonal / 30]
    elif way == "outliers":
        points = np.vstack([points, points.min(axis=0) + box * rng.random((count // 5, 3))])
    return points, None


def topology(vertices, triangles):
    """Number of components and Euler number."""
    edges = np.unique(np.sort(np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1), axis=0)
    links = coo_matrix((np.ones(len(edges)), edges.T), shape=(len(vertices),) * 2)
    used = len(np.unique(triangles))
    parts = connected_components(links, directed=False)[0] - (len(vertices) - used)
    return parts, used - len(edges) + len(triangles)


def compare(mesh, truth, spacing, rng):
    """Mean and 99 % of the distances between both surfaces, in spacings, and whether the topology is right."""
    if len(mesh[1]) == 0:
        return math.inf, math.inf, False
    ours, theirs = (sample(*each, COMPARED, rng)[0] for each in (mesh, truth))
    # To points of the other surface, of which a tenth as far apart: distances below a tenth of a spacing are not seen.
    dense = [sample(*each, 10 * COMPARED, rng)[0] for each in (truth, mesh)]
    there, back = (cKDTree(target).query(points)[0] / spacing for target, points in zip(dense, (ours, theirs)))
    far = max(np.quantile(there, 0.99), np.quantile(back, 0.99))
    return 0.5 * (there.mean() + back.mean()), far, topology(*mesh) == topology(*truth)


def read_mesh(file):
    mesh = open3d.io.read_triangle_mesh(str(file)) if open3d else None
    if mesh is not None:
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    lines = file.read_text().splitlines()
    vertices = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    triangles = [[word.split("/")[0] for word in line.split()[1:4]] for line in lines if line.startswith("f ")]
    return vertices, np.array(triangles, int).reshape(-1, 3) - 1


def by_csrbf(program, points, normals, folder):
    cloud, mesh = folder / "cloud.xyz", folder / "mesh.obj"
    np.savetxt(cloud, points if normals is None else np.hstack([points, normals]), fmt="%.9g")
    mesh.unlink(missing_ok=True)
    done = subprocess.run([program, "reconstruct", cloud, "-o", mesh, "--quiet"], capture_output=True, text=True)
    return read_mesh(mesh) if done.returncode == 0 else (np.zeros((0, 3)), np.zeros((0, 3), int))


def by_poisson(points, normals):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    if normals is not None:
        cloud.normals = open3d.utility.Vector3dVector(normals)
    else:
        cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(16))
        cloud.orient_normals_consistent_tangent_plane(16)
    for depth in DEPTHS:
        mesh, _ = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth)
        yield np.asarray(mesh.vertices), np.asarray(mesh.triangles)


def row(way, results):
    """A row of the table from (seed, mean, 99 %, right) of csrbf and of Poisson."""
    words = [way]
    for rows in results:
        if not rows:
            continue
        mean, far = (np.array([r[k] for r in rows]) for k in (1, 2))
        words.append(f"{sum(r[3] for r in rows)} of {len(rows)}")
        words += [f"{np.median(values):.2f} / {values.max():.2f}" for values in (mean, far)]
    worst = sorted(results[0], key=lambda r: -r[2])[:WORST]
    words.append(", ".join(f"{far:.1f} ({seed})" for seed, _, far, _ in worst))
    return "| " + " | ".join(words) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csrbf", default=PROJECT / "build/release/bin/csrbf")
    parser.add_argument("--solids", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ways", default=",".join(WAYS))
    parser.add_argument("--points", type=int, default=10_000)
    parser.add_argument("--output", default=PROJECT / "benchmarks/RANDOM_SURFACES.md")
    arguments = parser.parse_args()
    ways = arguments.ways.split(",")
    if unknown := [way for way in ways if way not in WAYS]:
        sys.exit(f"{parser.prog}: --ways: {unknown[0]} is not one of {', '.join(WAYS)}")

    found = {way: ([], []) for way in ways}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.seed, arguments.seed + arguments.solids):
            truth = solid(np.random.default_rng(seed))
            spacing = math.sqrt(sample(*truth, 1, np.random.default_rng(0))[2] / arguments.points)
            for way in ways:
                rng = np.random.default_rng([seed, WAYS.index(way)])
                points, normals = take_points(way, truth, arguments.points, rng)
                ours, peers = found[way]
                mesh = by_csrbf(arguments.csrbf, points, normals, Path(folder))
                ours.append((seed, *compare(mesh, truth, spacing, rng)))
                if open3d:
                    every = [compare(mesh, truth, spacing, rng) for mesh in by_poisson(points, normals)]
                    peers.append((seed, *min(every)))

    columns = ["way", "csrbf right", "mean", "99 %"]
    columns += (["Poisson right", "mean", "99 %"] if open3d else []) + ["worst"]
    page = ["# Random solids, points taken in many ways", "", LEGEND.format(**vars(arguments))]
    page += ["| " + " | ".join(columns) + " |", "|---|" + "---:|" * (len(columns) - 2) + "---|"]
    page += [row(way, found[way]) for way in ways]
    write_page("\n".join(page) + "\n", arguments.output)


if __name__ == "__main__":
    main()
