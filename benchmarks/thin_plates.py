#!/usr/bin/python3
"""Reconstructs walls thinner than the distance between points, beside Poisson reconstruction, and writes a table.

usage: thin_plates.py [--csrbf PROGRAM] [--seeds N] [--thickness T,T,...] [--noise S,S,...] [--output FILE]

  --csrbf PROGRAM  default: build/release/bin/csrbf
  --seeds N        random samplings of each wall; default: 3
  --thickness T    of the walls, in spacings (the root of the area per point); default: 0.3,0.5,0.7,1,1.5,2
  --noise S        standard deviation of the points, in spacings, for rows without normals; default: 0,0.1
  --output FILE    default: benchmarks/THIN_PLATES.md; -: prints it instead

Three walls, 10,000 random points each, turned at random: a bowl, a plate that is bent in both directions, and a tube. A
mesh is right if it has one component and the Euler number of the wall. Besides, as its worst part: the distance of its
farthest vertex from all points, and of the farthest point from all vertices, in spacings. Without Open3D (Debian:
python3-open3d) the columns of Poisson reconstruction are left out. Needs numpy and scipy.
"""

import argparse
import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from pages import write_page

PROJECT = Path(__file__).resolve().parent.parent
COUNT = 10_000
DEPTHS = [7, 8, 9]
EULER = {"bowl": 2, "plate": 2, "tube": 0}

LEGEND = """Walls of {count:,} random points, their thickness in spacings (the root of the area per point); {seeds} samplings
each of a bowl, a bent plate and a tube: {meshes} meshes a row. **right**: one component and the true Euler number.
**far**: the farthest vertex of a mesh from all points; **missed**: the farthest point from all vertices; medians and,
after the stroke, worst cases, in spacings. **wrong**: points whose estimated normal is on the wrong side, %.
**Poisson**: Open3D's, with exact normals, the best of depths {depths} in each mesh by the larger of far and missed.
Noise: its standard deviation in spacings. Made by `benchmarks/thin_plates.py`.
"""


def along_edge(random, wall, spacing, length):
    """Places on an edge `wall` wide: as dense as elsewhere, at least one."""
    n = max(1, round(wall * length / spacing**2))
    return random.random(n), wall * (random.random(n) - 0.5)


def bowl(thickness, random):
    rim, area = 0.4, 2 * 2 * math.pi * 1.4
    spacing = math.sqrt(area / COUNT)
    wall = thickness * spacing
    points, normals = [], []
    for side in (1, -1):
        z, a = rim - (1 + rim) * random.random(COUNT // 2), 2 * math.pi * random.random(COUNT // 2)
        ray = np.c_[np.sqrt(1 - z * z) * np.cos(a), np.sqrt(1 - z * z) * np.sin(a), z]
        points.append((1 + side * wall / 2) * ray)
        normals.append(side * ray)
    r = math.sqrt(1 - rim * rim)
    a, across = along_edge(random, wall, spacing, 2 * math.pi * r)
    a = 2 * math.pi * a
    points.append((1 + across)[:, None] * np.c_[r * np.cos(a), r * np.sin(a), np.full(len(a), rim)])
    normals.append(np.c_[-rim * np.cos(a), -rim * np.sin(a), np.full(len(a), r)])
    return points, normals, spacing


def plate(thickness, random):
    spacing = math.sqrt(2 * 4 * 1.1 / COUNT)
    wall = thickness * spacing

    def middle(u):
        x, y = u.T
        normal = np.c_[-0.6 * np.cos(3 * x) * np.cos(2 * y), 0.4 * np.sin(3 * x) * np.sin(2 * y), np.ones(len(u))]
        return np.c_[u, 0.2 * np.sin(3 * x) * np.cos(2 * y)], normal / np.linalg.norm(normal, axis=1)[:, None]

    points, normals = [], []
    for side in (1, -1):
        p, n = middle(2 * random.random((COUNT // 2, 2)) - 1)
        points.append(p + side * wall / 2 * n)
        normals.append(side * n)
    for axis in (0, 1):
        for side in (1, -1):
            t, across = along_edge(random, wall, spacing, 2.1)
            u = np.empty((len(t), 2))
            u[:, axis], u[:, 1 - axis] = side, 2 * t - 1
            p, n = middle(u)
            points.append(p + across[:, None] * n)
            out = np.zeros((len(t), 3))
            out[:, axis] = side
            normals.append(out)
    return points, normals, spacing


def tube(thickness, random):
    spacing = math.sqrt(2 * 2 * math.pi * 0.5 * 2 / COUNT)
    wall = thickness * spacing
    points, normals = [], []
    for side in (1, -1):
        z, a = 2 * random.random(COUNT // 2) - 1, 2 * math.pi * random.random(COUNT // 2)
        ray = np.c_[np.cos(a), np.sin(a), 0 * a]
        points.append((0.5 + side * wall / 2) * ray + np.c_[0 * a, 0 * a, z])
        normals.append(side * ray)
    for end in (1, -1):
        a, across = along_edge(random, wall, spacing, math.pi)
        a, r = 2 * math.pi * a, 0.5 + across
        points.append(np.c_[r * np.cos(a), r * np.sin(a), np.full(len(a), end)])
        normals.append(np.tile([0, 0, end], (len(a), 1)))
    return points, normals, spacing


WALLS = {"bowl": bowl, "plate": plate, "tube": tube}


def sample(name, thickness, noise, seed):
    random = np.random.default_rng([seed, round(100 * thickness), list(WALLS).index(name)])
    points, normals, spacing = WALLS[name](thickness, random)
    turn = np.linalg.qr(random.standard_normal((3, 3)))[0]
    points, normals = np.concatenate(points) @ turn.T, np.concatenate(normals) @ turn.T
    return points + noise * spacing * random.standard_normal(points.shape), normals, spacing


def euler_and_components(vertices, triangles):
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1)
    edges = np.unique(edges, axis=0)
    used = np.unique(triangles)
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(len(vertices),) * 2)
    pieces = connected_components(graph, directed=False)[0] - (len(vertices) - len(used))
    return len(used) - len(edges) + len(triangles), pieces


class Tried:
    """What was measured on the meshes of a row."""

    def __init__(self):
        self.right, self.far, self.missed, self.wrong = 0, [], [], []

    def add(self, right, far, missed):
        self.right += right
        self.far.append(far)
        self.missed.append(missed)

    def cells(self):
        def both(values):
            return f"{np.median(values):.1f} / {max(values):.1f}"

        return [f"{self.right} of {len(self.far)}", both(self.far), both(self.missed)]


def distances(points, vertices, spacing):
    return cKDTree(points).query(vertices)[0].max() / spacing, cKDTree(vertices).query(points)[0].max() / spacing


def run_csrbf(program, columns, name, points, spacing, tried):
    with tempfile.TemporaryDirectory() as folder:
        cloud, mesh, report = (f"{folder}/{file}" for file in ("cloud.npy", "mesh.obj", "report.json"))
        np.save(cloud, columns)
        subprocess.run([program, "reconstruct", cloud, "-o", mesh, "--report", report], check=True, capture_output=True)
        result = json.loads(Path(report).read_text())["result"]
        vertices = np.array([line.split()[1:4] for line in open(mesh) if line.startswith("v ")], float)
    right = result["components"] == 1 and result["euler"] == EULER[name]
    tried.add(right, *distances(points, vertices, spacing))


def wrong_share(program, points, normals):
    with tempfile.TemporaryDirectory() as folder:
        np.save(f"{folder}/cloud.npy", points)
        command = [program, "estimate-normals", f"{folder}/cloud.npy", "-o", f"{folder}/out.npy"]
        subprocess.run(command, check=True, capture_output=True)
        found = np.load(f"{folder}/out.npy")
    return 100 * np.mean((found[:, 3:6] * normals).sum(1) < 0)


def run_poisson(open3d, name, points, normals, spacing, tried):
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    cloud.normals = open3d.utility.Vector3dVector(normals)
    best = None
    for depth in DEPTHS:
        mesh = open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth, n_threads=1)[0]
        vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
        far, missed = distances(points, vertices, spacing)
        if best is None or max(far, missed) < max(best[1:]):
            best = (euler_and_components(vertices, triangles) == (EULER[name], 1), far, missed)
    tried.add(*best)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---:|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def numbers(text):
    return [float(x) for x in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--csrbf", default=str(PROJECT / "build/release/bin/csrbf"))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--thickness", type=numbers, default=[0.3, 0.5, 0.7, 1, 1.5, 2])
    parser.add_argument("--noise", type=numbers, default=[0, 0.1])
    parser.add_argument("--output", type=Path, default=PROJECT / "benchmarks/THIN_PLATES.md")
    options = parser.parse_args()
    try:
        import open3d
    except ImportError:
        open3d = None

    given, bare = [], []
    for thickness in options.thickness:
        exact, poisson = Tried(), Tried()
        for name in WALLS:
            for seed in range(options.seeds):
                points, normals, spacing = sample(name, thickness, 0, seed)
                run_csrbf(options.csrbf, np.c_[points, normals], name, points, spacing, exact)
                if open3d:
                    run_poisson(open3d, name, points, normals, spacing, poisson)
        given.append([f"{thickness:g}"] + exact.cells() + (poisson.cells() if open3d else []))
        for noise in options.noise:
            tried = Tried()
            for name in WALLS:
                for seed in range(options.seeds):
                    points, normals, spacing = sample(name, thickness, noise, seed)
                    tried.wrong.append(wrong_share(options.csrbf, points, normals))
                    run_csrbf(options.csrbf, points, name, points, spacing, tried)
            wrong = f"{np.median(tried.wrong):.1f} / {max(tried.wrong):.1f}"
            bare.append([f"{thickness:g}", f"{noise:g}", wrong] + tried.cells())
        print(given[-1], bare[-len(options.noise) :], flush=True)

    meshes = len(WALLS) * options.seeds
    depths = ", ".join(map(str, DEPTHS))
    legend = LEGEND.format(count=COUNT, seeds=options.seeds, meshes=meshes, depths=depths)
    peer = ["Poisson right", "far", "missed"] if open3d else []
    write_page(
        "# Walls thinner than the distance between points\n\n" + legend + "\n## With exact normals\n\n"
        + table(["thickness", "csrbf right", "far", "missed"] + peer, given) + "\n## Positions only\n\n"
        + table(["thickness", "noise", "wrong", "right", "far", "missed"], bare),
        options.output,
    )


if __name__ == "__main__":
    main()
