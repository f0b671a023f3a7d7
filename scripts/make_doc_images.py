#!/usr/bin/env python3
"""Draws the pictures of the documentation: plots with matplotlib, surfaces with the program csrbf, all from synthetic
data and identical in every run.

usage: make_doc_images.py --program CSRBF [--out docs/images] [NAME ...]

PYTHONPATH must contain the module csrbf, such as build/release/python. NAMEs are those of pictures, without .png.
"""

import argparse
import os
import pathlib
import struct
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import csrbf

BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#8a8a8a"
DIVERGING, SEQUENTIAL = "RdBu_r", "viridis"
plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "figure.dpi": 110,
                     "axes.titlesize": 9, "legend.frameon": False, "legend.handlelength": 1.4, "savefig.facecolor": "white",
                     "figure.constrained_layout.h_pad": 0.08, "figure.constrained_layout.w_pad": 0.06})
PICTURES = {}
VIEW = (-55, 15)


def picture(draw):
    PICTURES[draw.__name__] = draw
    return draw


def generator(seed=0):
    return np.random.default_rng(seed)


# Surfaces.


def ellipsoid(center, radii, n=600):
    """An ellipsoid as a csrbf surface."""
    z = 1 - (2 * np.arange(n) + 1) / n
    angle = np.pi * (3 - 5**0.5) * np.arange(n)
    u = np.column_stack([np.sqrt(1 - z * z) * np.cos(angle), np.sqrt(1 - z * z) * np.sin(angle), z])
    normals = u / radii
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return csrbf.reconstruct(u * radii + center, normals)


def rabbit():
    """A toy of blended ellipsoids, from which points are scanned."""
    parts = [((0, 0, 0), (1, 0.75, 0.8)), ((0.95, 0, 0.75), (0.5, 0.42, 0.42)), ((0.75, 0.2, 1.4), (0.14, 0.1, 0.5)),
             ((0.75, -0.2, 1.4), (0.14, 0.1, 0.5)), ((-1, 0, 0.1), (0.25, 0.25, 0.25)),
             ((0.75, 0.4, -0.65), (0.4, 0.2, 0.2)), ((0.75, -0.4, -0.65), (0.4, 0.2, 0.2)),
             ((-0.45, 0.45, -0.6), (0.5, 0.28, 0.3)), ((-0.45, -0.45, -0.6), (0.5, 0.28, 0.3))]
    surfaces = [ellipsoid(np.array(center), np.array(radii)) for center, radii in parts]
    return csrbf.combine("blend", *surfaces, radius=0.04)


def scan(n, noise=0.0, seed=0):
    """Points on the rabbit, uniformly distributed over its surface."""
    mesh = rabbit().polygonize(120)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    random = generator(seed)
    t = random.choice(len(area), size=n, p=area / area.sum())
    u, v = random.uniform(size=(2, n, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[t] + u * (b - a)[t] + v * (c - a)[t] + random.normal(scale=noise or 1e-9, size=(n, 3))


def camera(view=VIEW):
    """Directions to the right, upwards and towards the camera."""
    azimuth, elevation = np.radians(view)
    to = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    return right, np.cross(to, right), to


def flat(points, view=VIEW):
    right, up, _ = camera(view)
    return np.column_stack([points @ right, points @ up])


def rendered(surface, view=VIEW, color="plain", size=(420, 420), extra=()):
    """A picture of a surface or a mesh, drawn by the program."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, "model." + ("csrbf" if isinstance(surface, csrbf.Surface) else "ply"))
        surface.save(name)
        for number, mesh in enumerate(extra):
            mesh.save(os.path.join(folder, f"extra{number}.ply"))
        command = [PROGRAM, "render", name, "-o", os.path.join(folder, "picture.png"), "--quiet", "--size",
                   f"{size[0]}x{size[1]}", "--view", f"{view[0]},{view[1]}", "--color", color.format(folder=folder)]
        subprocess.run(command, check=True)
        return plt.imread(os.path.join(folder, "picture.png"))


def show(ax, image, title=None):
    ax.imshow(image, interpolation="antialiased")
    ax.axis("off")
    if title:
        ax.set_title(title)


def draw_mesh(ax, mesh, view, title, color="#d9d2c5"):
    """Triangles with their edges, back to front."""
    right, up, to = camera(view)
    corners = mesh.vertices[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True) + 1e-300
    front = normal @ to > 0
    corners, light = corners[front], 0.55 + 0.45 * (normal[front] @ (0.8 * to + 0.6 * up)).clip(0, 1)
    order = np.argsort((corners @ to).mean(axis=1))
    shade = np.clip(np.outer(light[order], matplotlib.colors.to_rgb(color)), 0, 1)
    ax.add_collection(PolyCollection(np.stack([corners @ right, corners @ up], axis=-1)[order], facecolors=shade,
                                     edgecolors="#333333", linewidths=0.25))
    ax.autoscale_view()
    ax.set_aspect("equal")
    ax.axis("off")
    ax.set_title(title)


def panels(columns, height=2.6, width=7.4, rows=1):
    figure, axes = plt.subplots(rows, columns, figsize=(width, height * rows), layout="constrained")
    return figure, np.ravel(axes)


def draw_points(ax, points, title):
    _, _, to = camera()
    order = np.argsort(points @ to)
    x = flat(points[order])
    ax.scatter(*x.T, s=2.2, c=(points[order] @ to), cmap="Greys", vmin=-3, vmax=1.4, linewidths=0)
    ax.set_aspect("equal")
    ax.axis("off")
    ax.set_title(title)


@picture
def reconstruct():
    points = scan(20000, noise=0.008)
    surface = csrbf.reconstruct(points)
    small = csrbf.reconstruct(points, method="medial-axis", centers=300)
    figure, axes = panels(3)
    draw_points(axes[0], points, "20,000 points with noise, no normals")
    show(axes[1], rendered(surface.polygonize()), "reconstruct")
    show(axes[2], rendered(small.polygonize(160)), "--method medial-axis --centers 300")
    return figure


@picture
def estimate_normals():
    points = scan(6000)
    surface = csrbf.reconstruct(points)
    near = np.abs(points[:, 1]) < 0.05
    normals = surface.normal(points[near])
    figure, ax = plt.subplots(figsize=(5.2, 3.9), layout="constrained")
    ax.quiver(points[near, 0], points[near, 2], normals[:, 0], normals[:, 2], color=ORANGE, width=0.0025, scale=22)
    ax.plot(points[near, 0], points[near, 2], ".", color="black", markersize=3)
    ax.margins(0.09)
    ax.set_aspect("equal")
    ax.axis("off")
    return figure


def drilled():
    body = ellipsoid(np.zeros(3), np.array([1, 1, 0.7]))
    return body - ellipsoid(np.array([0, 0, 0.9]), np.array([0.6, 0.6, 0.7])) - ellipsoid(
        np.array([1, -0.4, 0]), np.array([0.5, 0.4, 0.35]))


@picture
def polygonize():
    solid = drilled()
    figure, axes = panels(3, height=2.2)
    for ax, method in zip(axes, ("marching-cubes", "dual-contouring", "adaptive")):
        mesh = solid.polygonize(26 if method != "adaptive" else 52, method=method,
                                **({"tolerance": 0.004} if method == "adaptive" else {}))
        draw_mesh(ax, mesh, (-35, 40), f"{method}\n{len(mesh.faces):,} triangles")
    return figure


@picture
def render():
    surface = rabbit()
    coarse, fine = surface.polygonize(28), surface.polygonize(120)
    figure, axes = panels(4, height=2.2)
    show(axes[0], rendered(surface), "plain")
    show(axes[1], rendered(surface, color="normal"), "normal")
    show(axes[2], rendered(surface, color="mean-curvature"), "mean-curvature")
    show(axes[3], rendered(coarse, color="error:{folder}/extra0.ply", extra=[fine]), "error:reference.ply")
    return figure


@picture
def curvature():
    surface = rabbit()
    figure, axes = panels(2, height=3.2, width=6.4)
    show(axes[0], rendered(surface, color="mean-curvature", size=(520, 520)), "mean curvature: blue concave, red convex")
    with tempfile.TemporaryDirectory() as folder:
        surface.save(f"{folder}/s.csrbf")
        subprocess.run([PROGRAM, "curvature", f"{folder}/s.csrbf", "-o", f"{folder}/c.ply", "--ridges",
                        f"{folder}/r.ply", "--resolution", "90", "--quiet"], check=True)
        vertices, edges, kind = read_lines(f"{folder}/r.ply")
    _, _, to = camera()
    normals = surface.normal(vertices)
    distance, _ = surface.raycast(vertices + 0.02 * normals, np.broadcast_to(to, vertices.shape))
    visible = np.isinf(distance) & (normals @ to > -0.05)
    x = flat(vertices)
    outline = flat(surface.polygonize(150).vertices)
    axes[1].plot(*outline.T, ",", color="#e6e1d8", zorder=0)
    for sign, color, name in ((1, ORANGE, "ridges"), (-1, BLUE, "valleys")):
        lines = [e for e in edges if visible[e].all() and kind[e[0]] == sign]
        for number, edge in enumerate(lines):
            axes[1].plot(*x[edge].T, color=color, linewidth=1.4, label=name if number == 0 else None)
    axes[1].set_aspect("equal")
    axes[1].axis("off")
    axes[1].set_title("ridge and valley lines")
    axes[1].legend(loc="upper left")
    return figure


def read_lines(path):
    """Vertices, edges and kinds of a binary .ply file of lines."""
    content = pathlib.Path(path).read_bytes()
    head, body = content.split(b"end_header\n", 1)
    types = {"float": "<f4", "char": "i1", "int": "<i4", "uint": "<u4"}
    layout, count, name = {}, {}, None
    for words in (line.split() for line in head.decode().splitlines()):
        if words[0] == "element":
            name, count[words[1]] = words[1], int(words[2])
            layout[name] = []
        elif words[0] == "property":
            layout[name].append((words[2], types[words[1]]))
    vertices = np.frombuffer(body, np.dtype(layout["vertex"]), count["vertex"])
    edges = np.frombuffer(body, np.dtype(layout["edge"]), count["edge"], vertices.nbytes)
    return (np.column_stack([vertices[a] for a in "xyz"]).astype(float),
            np.column_stack([edges["vertex1"], edges["vertex2"]]).astype(int), vertices["kind"])


@picture
def combine():
    a, b = ellipsoid(np.zeros(3), np.array([1, 0.8, 0.8])), ellipsoid(np.array([0.9, -0.3, 0.35]), np.full(3, 0.6))
    figure, axes = panels(4, height=2.1)
    solids = {"union": a | b, "intersection": a & b, "difference": a - b,
              "blend --radius 0.1": csrbf.combine("blend", a, b, radius=0.1)}
    for ax, (name, solid) in zip(axes, solids.items()):
        show(ax, rendered(solid.polygonize(140, method="dual-contouring"), view=(-70, 25)), name)
    return figure


@picture
def compare():
    surface = rabbit()
    reference = surface.polygonize(160)
    figure, axes = panels(3)
    show(axes[0], rendered(reference), "reference, resolution 160")
    for ax, resolution in zip(axes[1:], (32, 64)):
        mesh = surface.polygonize(resolution)
        show(ax, rendered(mesh, color="error:{folder}/extra0.ply", extra=[reference]),
             f"distance of resolution {resolution}")
    return figure


# Functions.


def terrain(x, y):
    return (np.exp(-8 * ((x - 0.3) ** 2 + (y - 0.6) ** 2)) - 0.6 * np.exp(-12 * ((x - 0.75) ** 2 + (y - 0.35) ** 2))
            + 0.3 * np.sin(4 * x) * np.cos(3 * y))


def noisy_line(n=45, noise=0.12, seed=3):
    random = generator(seed)
    x = np.sort(np.concatenate([random.uniform(0, 0.45, 2 * n // 3), random.uniform(0.65, 1, n - 2 * n // 3)]))
    return x, wave(x) + random.normal(scale=noise, size=len(x))


def wave(x):
    return np.sin(7 * x) + 0.5 * np.sin(15 * x + 1)


@picture
def fit():
    x, y = noisy_line()
    f = csrbf.fit(x[:, None], y, method="interpolate", smoothing="auto")
    at = np.linspace(x.min(), x.max(), 400)
    value, deviation = f(at[:, None]), f.standard_deviation(at[:, None])
    figure, ax = plt.subplots(figsize=(6.4, 2.6), layout="constrained")
    ax.fill_between(at, value - 2 * deviation, value + 2 * deviation, color=BLUE, alpha=0.15, linewidth=0,
                    label="± 2 standard deviations")
    ax.plot(at, wave(at), "--", color=GREY, label="truth")
    ax.plot(at, value, color=BLUE, label="function")
    ax.plot(x, y, ".", color="black", label="samples")
    ax.legend(ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1))
    return figure


@picture
def evaluate():
    random = generator(1)
    points = random.uniform(size=(400, 2))
    f = csrbf.fit(points, terrain(*points.T))
    x, y = np.linspace(0, 1, 200), np.linspace(0, 1, 150)
    figure, axes = panels(2, height=2.5, width=6.4)
    picture_of = axes[0].pcolormesh(x, y, f.evaluate_grid(x, y).T, cmap=SEQUENTIAL, rasterized=True)
    axes[0].plot(*points.T, ".", color="black", markersize=1.5)
    axes[0].set_title("values on a grid, and the samples")
    figure.colorbar(picture_of, ax=axes[0])
    gx, gy = np.meshgrid(np.linspace(0.04, 0.96, 16), np.linspace(0.05, 0.95, 12))
    slope = f.gradient(np.column_stack([gx.ravel(), gy.ravel()]))
    axes[1].contour(x, y, f.evaluate_grid(x, y).T, levels=12, cmap=SEQUENTIAL, linewidths=0.8)
    axes[1].quiver(gx.ravel(), gy.ravel(), *slope.T, color="black", width=0.003, scale=60)
    axes[1].set_title("gradients")
    return figure


def las_file(points, classes, corner):
    """Points in metres as LAS 1.2, format 0, in millimetres from a corner."""
    head = bytearray(227)
    head[:4], head[24:26] = b"LASF", bytes([1, 2])
    struct.pack_into("<HII", head, 94, 227, 227, 0)
    struct.pack_into("<BHI", head, 104, 0, 20, len(points))
    struct.pack_into("<6d", head, 131, *[0.001] * 3, *corner)
    records = np.zeros(len(points), dtype=[("place", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("kind", "u1"),
                                           ("angle", "i1"), ("user", "u1"), ("source", "<u2")])
    records["place"], records["returns"], records["kind"] = np.rint((points - corner) * 1000), 1 | 1 << 3, classes
    return bytes(head) + records.tobytes()


@picture
def las_tile():
    """A made tile of a scanner in the air, in UTM coordinates: ground, trees and a house."""
    random, corner = generator(6), np.array([500000.0, 4650000.0, 0.0])
    xy = random.uniform(0, 200, size=(60000, 2))

    def ground(x, y):
        return 100 + 12 * terrain(x / 200, y / 200) - 2.5 * np.exp(-(((y - 60 - 0.3 * x + 8 * np.sin(x / 25)) / 5) ** 2))

    z, kind = ground(*xy.T), np.full(len(xy), 2)
    for tree in random.uniform(10, 190, size=(70, 2)):
        near = np.hypot(*(xy - tree).T)
        hit = (near < 5) & (random.uniform(size=len(xy)) < 0.7)
        z[hit] = ground(*tree) + 9 - 0.2 * near[hit] ** 2 + random.normal(scale=0.5, size=hit.sum())
        kind[hit] = 5
    house = (abs(xy[:, 0] - 140) < 12) & (abs(xy[:, 1] - 140) < 8)
    z[house], kind[house] = ground(140, 140) + 8 - 0.4 * abs(xy[house, 1] - 140), 6
    z += random.normal(scale=0.03, size=len(z))
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "tile.las").write_bytes(las_file(np.column_stack([xy, z]) + corner, kind, corner))
        for command in ("fit tile.las -o ground.csrbf --class 2",
                        "evaluate ground.csrbf -o dem.tif --cell 0.5 --extent 500000,4650000,500200,4650200 --crs EPSG:32633"):
            subprocess.run([PROGRAM, *command.split(), "--quiet"], check=True, cwd=folder)
        dem = np.asarray(csrbf.read_image(path / "dem.tif"))
    figure, axes = panels(3, height=2.6)
    colors = np.array([GREY, GREEN, ORANGE])[np.searchsorted([2, 5, 6], kind)]
    strip = abs(xy[:, 1] - 140) < 6
    axes[0].scatter(*xy.T, s=0.15, c=colors, linewidths=0, rasterized=True)
    axes[0].set_title("tile.las: ground, trees, a house")
    axes[1].scatter(xy[strip, 0], z[strip], s=0.6, c=colors[strip], linewidths=0, rasterized=True)
    axes[1].plot(np.arange(0.25, 200, 0.5), dem[120], color="black", linewidth=1)
    axes[1].set_title("a strip, and the ground")
    light = matplotlib.colors.LightSource(azdeg=315, altdeg=40)
    axes[2].imshow(light.shade(dem, plt.get_cmap("gist_earth"), blend_mode="soft", vert_exag=2, dx=0.5, dy=0.5, vmin=80, vmax=115),
                   extent=(0, 200, 0, 200))
    axes[2].set_title("dem.tif")
    for ax in axes[[0, 2]]:
        ax.set_aspect("equal")
        ax.axis("off")
    return figure


@picture
def inpaint():
    random = generator(2)
    v, u = np.mgrid[:140, :180]
    truth = terrain(u / 180, v / 140)
    missing = random.uniform(size=truth.shape) < 0.5
    missing[60:85, 30:70] = missing[20:30, 90:160] = True
    with tempfile.TemporaryDirectory() as folder:
        np.save(f"{folder}/in.npy", np.where(missing, np.nan, truth))
        subprocess.run([PROGRAM, "inpaint", f"{folder}/in.npy", "-o", f"{folder}/out.npy", "--quiet"], check=True)
        filled = np.load(f"{folder}/out.npy")
    figure, axes = panels(3, height=2.1)
    for ax, image, title in zip(axes, (np.where(missing, np.nan, truth), filled, truth),
                                ("half of it missing, and two holes", "filled", "truth")):
        ax.imshow(image, cmap=SEQUENTIAL, vmin=truth.min(), vmax=truth.max(), interpolation="nearest")
        ax.axis("off")
        ax.set_title(title)
    return figure


# Images.


def cells_image(seed=0):
    random = generator(seed)
    v, u = np.mgrid[:180, :240].astype(float)
    inside = np.zeros(u.shape, bool)
    for x, y, a, b in ((50, 50, 26, 18), (120, 40, 16, 20), (190, 70, 28, 22), (80, 125, 30, 24), (165, 135, 20, 26),
                       (28, 145, 14, 14)):
        inside |= ((u - x) / a) ** 2 + ((v - y) / b) ** 2 + 0.15 * np.sin((u + 2 * v) / 9) < 1
    return np.where(inside, 1.0, 0.2) + 0.15 * u / 240 + random.normal(scale=0.08, size=u.shape)


def draw_contours(ax, image, lines, title, color=ORANGE):
    ax.imshow(image, cmap="gray", interpolation="nearest")
    for line in lines:
        closed = np.vstack([line, line[:1]]) if np.linalg.norm(line[0] - line[-1]) < 3 else line
        ax.plot(*closed.T, color=color, linewidth=1.3)
    ax.set_xlim(-0.5, image.shape[1] - 0.5)
    ax.set_ylim(image.shape[0] - 0.5, -0.5)
    ax.axis("off")
    ax.set_title(title)


@picture
def segment():
    image = cells_image()
    figure, axes = panels(2, height=2.6, width=6.6)
    draw_contours(axes[0], image, csrbf.segment(image).contour(), "no start: all that is bright")
    local = csrbf.segment(image, init="sphere:80,125,8", mode="local")
    draw_contours(axes[1], image, local.contour(), "--mode local --init sphere:80,125,8")
    turn = np.linspace(0, 2 * np.pi, 60)
    axes[1].plot(80 + 8 * np.cos(turn), 125 + 8 * np.sin(turn), ":", color="#56B4E9", linewidth=1.5)
    return figure


@picture
def info():
    figure, ax = plt.subplots(figsize=(5, 2.4), layout="constrained")
    columns, rows, spacing, origin = 7, 4, (1.5, 1.0), (4.0, 2.0)
    shade = generator().uniform(size=(rows, columns))
    ax.imshow(shade, cmap="gray", vmin=-3, vmax=1.3, origin="upper", aspect="equal",
              extent=(origin[0] - spacing[0] / 2, origin[0] + (columns - 0.5) * spacing[0],
                      origin[1] + (rows - 0.5) * spacing[1], origin[1] - spacing[1] / 2))
    ax.plot(*np.array([(origin[0] + i * spacing[0], origin[1] + j * spacing[1]) for i in range(columns)
                       for j in range(rows)]).T, ".", color="black", markersize=3)
    ax.plot(*origin, "o", color=ORANGE)
    ax.annotate("origin (4, 2)", origin, (0.7, 0.4), color=ORANGE, arrowprops={"arrowstyle": "->", "color": ORANGE})
    ax.annotate("", (origin[0] + 3 * spacing[0], origin[1]), (origin[0] + 2 * spacing[0], origin[1]),
                arrowprops={"arrowstyle": "<->", "color": BLUE})
    ax.text(origin[0] + 2.5 * spacing[0], origin[1] - 0.6, "spacing x 1.5", color=BLUE, ha="center", va="bottom")
    ax.annotate("", (origin[0] + 6 * spacing[0], origin[1] + 2), (origin[0] + 6 * spacing[0], origin[1] + 1),
                arrowprops={"arrowstyle": "<->", "color": BLUE})
    ax.text(origin[0] + 6.1 * spacing[0], origin[1] + 1.5, " spacing y 1", color=BLUE, va="center")
    ax.set_xlim(0, 17.5)
    ax.set_ylim(6.5, 0)
    ax.set_xlabel("x (mm), the fastest axis: size 7")
    ax.set_ylabel("y (mm): size 4")
    return figure


# Concepts.


def wendland(r):
    """Wendland's C2 function for three dimensions."""
    return np.clip(1 - r, 0, None) ** 4 * (4 * r + 1)


@picture
def concept_kernel():
    figure, axes = panels(2, height=2.4, width=7)
    r = np.linspace(-1.3, 1.3, 400)
    profiles = {"C0": lambda s: np.clip(1 - s, 0, None) ** 2, "C2": wendland,
                "C4": lambda s: np.clip(1 - s, 0, None) ** 6 * (35 * s**2 + 18 * s + 3) / 3}
    for (name, profile), color in zip(profiles.items(), (GREY, BLUE, ORANGE)):
        axes[0].plot(r, profile(np.abs(r)), color=color, label=name)
    axes[0].annotate("", (0, -0.06), (1, -0.06), arrowprops={"arrowstyle": "<->", "color": "black"})
    axes[0].text(0.5, -0.09, "support", ha="center", va="top")
    axes[0].plot(0, 0, "k^", markersize=5)
    axes[0].text(0, -0.09, "centre", ha="center", va="top")
    axes[0].set_ylim(-0.22, 1.05)
    axes[0].set_title("kernels")
    axes[0].legend()
    centers = np.linspace(0.05, 0.95, 7)
    heights = np.array([0.4, 0.9, 0.3, -0.5, 0.2, 0.8, 0.5])
    x = np.linspace(-0.2, 1.2, 500)
    bumps = heights[:, None] * wendland(np.abs(x - centers[:, None]) / 0.32)
    axes[1].plot(x, bumps.T, color=BLUE, linewidth=0.8, alpha=0.7)
    axes[1].plot(x, bumps.sum(axis=0), color=ORANGE, linewidth=2)
    axes[1].plot(centers, np.zeros(7), "k^", markersize=4)
    axes[1].set_title("seven bumps and their sum")
    return figure


def smoothed(x, y, smoothing, kernel="cubic"):
    return csrbf.fit(x[:, None], y, method="interpolate", kernel=kernel, smoothing=smoothing)


@picture
def concept_smoothing():
    x, y = noisy_line(60, 0.2, seed=5)
    at = np.linspace(x.min(), x.max(), 500)
    chosen = smoothed(x, y, "auto")
    amount = chosen.report["smoothing"]
    cases = (("none", smoothed(x, y, "none")), ("auto", chosen), ("ten thousand times as much",
             smoothed(x, y, 1e4 * amount)))
    figure, axes = panels(3, height=2.1)
    for ax, (name, f) in zip(axes, cases):
        ax.plot(at, wave(at), "--", color=GREY, label="truth")
        ax.plot(at, f(at[:, None]), color=BLUE, label="function")
        ax.plot(x, y, ".", color="black", markersize=3, label="samples")
        ax.set_ylim(-2.2, 2.2)
        ax.set_title(name)
    axes[1].legend(loc="lower left")
    return figure


@picture
def concept_cross_validation():
    x, y = noisy_line(60, 0.2, seed=5)
    figure, axes = panels(2, height=2.4, width=7)
    out = np.arange(len(x)) % 6 == 2
    f = smoothed(x[~out], y[~out], "auto")
    at = np.linspace(x.min(), x.max(), 400)
    axes[0].plot(at, f(at[:, None]), color=BLUE)
    axes[0].plot(x[~out], y[~out], ".", color="black", markersize=3, label="fitted")
    axes[0].plot(x[out], y[out], "o", color=ORANGE, markersize=4, label="left out")
    axes[0].vlines(x[out], y[out], f(x[out][:, None]), color=ORANGE, linewidth=1)
    axes[0].legend()
    axes[0].set_title("samples left out, and their predictions")
    amounts = np.geomspace(1e-8, 1e3, 34)
    left_out, fitted, true = [], [], []
    for amount in amounts:
        errors = []
        for part in range(6):
            some = np.arange(len(x)) % 6 == part
            errors.append((smoothed(x[~some], y[~some], amount)(x[some][:, None]) - y[some]) ** 2)
        f = smoothed(x, y, amount)
        left_out.append(np.sqrt(np.concatenate(errors).mean()))
        fitted.append(np.sqrt(((f(x[:, None]) - y) ** 2).mean()))
        true.append(np.sqrt(((f(x[:, None]) - wave(x)) ** 2).mean()))
    axes[1].loglog(amounts, left_out, color=ORANGE, label="left-out samples")
    axes[1].loglog(amounts, fitted, color="black", label="fitted samples")
    axes[1].loglog(amounts, true, "--", color=GREY, label="truth")
    axes[1].axvline(amounts[np.argmin(left_out)], color=ORANGE, linewidth=0.8, linestyle=":")
    axes[1].set_ylim(0.01, 3)
    axes[1].set_xlabel("smoothing")
    axes[1].set_title("error, root mean square")
    axes[1].legend()
    return figure


@picture
def concept_partition():
    x = np.linspace(0, 1, 600)
    middles, radius = np.array([0.1, 0.37, 0.63, 0.9]), 0.27
    samples = np.linspace(0.01, 0.99, 24)
    values = wave(samples)
    d = np.abs(x - middles[:, None]) / radius
    weights = np.clip(1 - d**2, 0, None) ** 4
    shares = weights / weights.sum(axis=0)
    figure, axes = panels(3, height=2.1)
    blend = np.zeros_like(x)
    for middle, share, color in zip(middles, shares, (BLUE, ORANGE, GREEN, "#CC79A7")):
        near = np.abs(samples - middle) < radius
        local = np.polynomial.Polynomial.fit(samples[near], values[near], 4)
        inside = np.abs(x - middle) < radius
        axes[0].plot(x[inside], local(x[inside]), color=color)
        axes[1].plot(x, np.where(inside, share, np.nan), color=color)
        blend += np.where(inside, share * local(x), 0)
    axes[2].plot(x, blend, color="black")
    for ax, title in zip(axes, ("local functions", "weights: together one", "the blend")):
        ax.set_title(title)
    for ax in (axes[0], axes[2]):
        ax.plot(samples, values, ".", color="black", markersize=3)
        ax.set_ylim(-1.9, 1.9)
    return figure


@picture
def concept_implicit():
    surface = csrbf.reconstruct(scan(20000))
    x, z = np.linspace(-1.6, 1.7, 260), np.linspace(-1.15, 2.15, 260)
    gx, gz = np.meshgrid(x, z)
    values = surface(np.stack([gx, np.full_like(gx, 0.0), gz], axis=-1))
    figure, axes = panels(2, height=2.8, width=6.6)
    limit = 0.8 * np.abs(values).max()  # colours where f follows the surface; farther away it is constant
    shown = axes[0].pcolormesh(x, z, values, cmap=DIVERGING, vmin=-limit, vmax=limit, rasterized=True)
    axes[0].contour(x, z, values, levels=[0], colors="black", linewidths=1.5)
    axes[0].text(-0.2, 0, "f > 0", ha="center", color="white")
    axes[0].text(-1.1, 1.6, "f < 0", ha="center", color="white")
    axes[0].annotate("f = 0", (-0.5, 0.7), (-1.0, 1.1), ha="center", color="white",
                     arrowprops={"arrowstyle": "->", "color": "white"})
    axes[0].set_aspect("equal")
    axes[0].axis("off")
    figure.colorbar(shown, ax=axes[0], shrink=0.8, extend="both")
    axes[0].set_title("f on a plane through the object")
    show(axes[1], rendered(surface.polygonize(90)), "the mesh of f = 0")
    return figure


@picture
def concept_level_set():
    x, y = np.meshgrid(np.linspace(0, 1.5, 240), np.linspace(0, 1, 160))
    bumps = sum(height * wendland(np.hypot(x - a, y - b) / 0.55)
                for a, b, height in ((0.4, 0.45, 1.1), (0.95, 0.55, 1.0), (0.7, 0.6, 0.25), (1.15, 0.4, 0.3)))
    figure, axes = panels(3, height=1.9)
    for ax, level, title in zip(axes, (0.25, 0.5, 0.72), ("f", "f sinks ...", "... and one part becomes two")):
        f = bumps - level
        ax.pcolormesh(x, y, f, cmap=DIVERGING, vmin=-0.9, vmax=0.9, rasterized=True)
        ax.contour(x, y, f, levels=[0], colors="black", linewidths=1.6)
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title(title)
    return figure


@picture
def overview():
    figure, axes = plt.subplots(2, 3, figsize=(7.4, 4.4), layout="constrained")
    points = scan(6000, noise=0.005)
    draw_points(axes[0, 0], points, "points ...")
    show(axes[1, 0], rendered(csrbf.reconstruct(points).polygonize()), "... a mesh")
    random = generator(4)
    places = random.uniform(size=(150, 2))
    values = terrain(*places.T)
    f = csrbf.fit(places, values)
    x = np.linspace(0, 1, 160)
    axes[0, 1].scatter(*places.T, c=values, s=9, cmap=SEQUENTIAL)
    axes[1, 1].pcolormesh(x, x, f.evaluate_grid(x, x).T, cmap=SEQUENTIAL, rasterized=True)
    for ax, title in zip(axes[:, 1], ("samples ...", "... a function")):
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title(title)
    image = cells_image()
    draw_contours(axes[0, 2], image, [], "an image ...")
    draw_contours(axes[1, 2], image, csrbf.segment(image).contour(), "... regions")
    for ax in axes.ravel():
        ax.set_anchor("N")  # titles in line
    return figure


def main():
    global PROGRAM
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="csrbf")
    parser.add_argument("--out", default="docs/images", type=pathlib.Path)
    parser.add_argument("names", nargs="*", metavar="NAME")
    given = parser.parse_args()
    PROGRAM = os.path.abspath(given.program)
    unknown = sorted(set(given.names) - set(PICTURES))
    if unknown:
        parser.error(f"unknown pictures: {', '.join(unknown)}; there are {', '.join(PICTURES)}")
    given.out.mkdir(parents=True, exist_ok=True)
    for name in given.names or PICTURES:
        figure = PICTURES[name]()
        figure.savefig(given.out / f"{name}.png", dpi=130, metadata={"Software": None})
        plt.close(figure)
        print(given.out / f"{name}.png")


if __name__ == "__main__":
    main()
