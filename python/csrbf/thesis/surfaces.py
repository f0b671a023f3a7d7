"""Drawings of Part III."""

import numpy as np
from matplotlib.patches import Polygon
from matplotlib.tri import Triangulation

from csrbf.thesis.drawing import (
    COLORS,
    QUIET,
    REFERENCE,
    bare,
    bounded_cells,
    lines,
    plain_ticks,
    powers,
    style,
    subplots,
)


def figure_4_1(figure):
    drawing, axes = subplots(1, 2, size=(9, 4.2))
    extents = {"plane y = 0": ("z", (-48, 48, -75, 40)), "plane z = 0": ("y", (-48, 48, -48, 48))}
    for axis, (name, values) in zip(axes, figure.pictures.items()):
        up, extent = extents[name]
        largest = np.abs(values).max()
        shown = axis.imshow(values, cmap="RdBu_r", vmin=-largest, vmax=largest, origin="lower", extent=extent)
        axis.contour(values, levels=[0], colors="black", linewidths=1.5, extent=extent)
        drawing.colorbar(shown, ax=axis, shrink=0.85, label="f")
        style(axis, "x [mm]", f"{up} [mm]", f"f on the {name}; line: f = 0 (Fig. 4.1 a)")
        axis.grid(False)
    return [("", drawing)]


def chapter_5(figure):
    t = figure.tables["methods"]
    best_last = np.argsort(-t["rms Taubin"])
    drawing, axes = subplots(1, 3, size=(11, 5.6), sharey=True)
    places = np.arange(len(t.labels))
    own = np.array([label in ("composite", "medial-axis") for label in t.labels])[best_last]
    for axis, column, text in [
        (axes[0], "rms Taubin", "rms Taubin distance [diagonals]"),
        (axes[1], "pieces", "components of the surface (1 is correct)"),
        (axes[2], "seconds", "seconds"),
    ]:
        values = t[column][best_last]
        axis.hlines(places, np.min(values[values > 0]) / 2, values, color="#d5dae0", lw=1)
        for mine, color, marker, label in [(True, COLORS[1], "D", "of the thesis"), (False, COLORS[0], "o", "earlier")]:
            axis.plot(values[own == mine], places[own == mine], marker, color=color, ms=6, label=label)
        style(axis, text, "", x_log=True)
        axis.grid(axis="y", visible=False)
    plain_ticks(axes[1], [n for n in (1, 2, 5, 10, 20, 50, 100, 200) if n <= 1.5 * t["pieces"].max()])
    functions = [f"{label} ({count:,.0f})" for label, count in zip(t.labels, t["centers"])]
    axes[0].set_yticks(places, np.array(functions)[best_last])
    axes[0].set_title("method (number of functions)")
    axes[2].legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncol=2)
    return [("", drawing)]


def figure_6_1(figure):
    samples, t = figure.tables["samples"], figure.tables["curves"]
    drawing, axes = subplots(1, 3, size=(11, 3.4), sharey=True)
    for axis, name, title in zip(
        axes, [None, "interpolation", "regularised"], ["a: noisy data", "b: interpolation", "c: regularised"]
    ):
        axis.plot(t["x"], t["truth"], color=REFERENCE, lw=3, label="truth")
        if name:
            axis.plot(t["x"], t[name], color=COLORS[1], lw=1.3, label="approximation")
        axis.plot(samples["x"], samples["s"], ".", color="black", ms=4, label="samples")
        style(axis, "x", "f" if axis is axes[0] else "", title)
    low, high = samples["s"].min(), samples["s"].max()
    axes[0].set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))
    axes[1].legend(loc="lower left")
    return [("", drawing)]


def figure_6_3(figure):
    t = figure.tables["decay"]
    drawing, axis = subplots(size=(7, 4.2))
    lines(axis, t["d"], [(powers(name), t[name]) for name in t.columns[1:]], markers=False)
    style(axis, "distance d from the centre of the patch", r"$\psi(d)$")
    return [("", drawing)]


def figure_6_6(figure):
    drawing, axes = subplots(2, 3, size=(11, 6.6))
    axes[1, 2].axis("off")
    for axis, (name, t) in zip(axes.flat, figure.tables.items()):
        lines(axis, t["centers"], [(None, t[choice]) for choice in t.columns[1:]])
        style(axis, "centres", "diagonals", name, x_log=True, y_log=True)
        plain_ticks(axis, t["centers"])
        axis.tick_params(axis="x", labelsize=8.5)
    axes[1, 2].legend(axes[0, 0].get_lines(), t.columns[1:], loc="center", title="centres chosen by")
    return [("", drawing)]


def figure_6_8(figure):
    drawing, axis = subplots(size=(7, 3.8))
    t = figure.tables["errors"]
    lines(axis, t["weight"], [(None, t["rms Taubin"])])
    chosen = figure.tables["chosen"]["rms Taubin"][0]
    axis.axhline(chosen, color=QUIET, lw=1, ls=":", label="weight chosen by cross-validation")
    style(axis, "weight of the penalty", "rms Taubin distance [diagonals]", x_log=True)
    axis.set_ylim(0, 1.15 * max(t["rms Taubin"].max(), chosen))
    axis.legend(loc="lower right")
    return [("", drawing)]


def figure_6_9(figure):
    t = figure.tables["samples"]
    at, poles = t.rows[:, :2], t.rows[:, 2:]
    low, high = at.min(axis=0) - 0.5, at.max(axis=0) + 0.5
    drawing, axes = subplots(1, 2, size=(10.5, 4.2))
    for cell in bounded_cells(at, low, high):
        axes[0].add_patch(Polygon(cell, fill=False, ec="#aab3bd", lw=0.8))
    axes[0].plot(poles[:, 0], poles[:, 1], "D", color=COLORS[1], ms=3, label="poles inside")
    end = 1.5 - 0.8**2 / 1.5  # the medial axis of an ellipse with semi-axes 1.5 and 0.8 ends at centres of curvature
    axes[0].plot([-end, end], [0, 0], color=COLORS[2], lw=8, alpha=0.45, label="medial axis", zorder=0)
    axes[1].triplot(Triangulation(at[:, 0], at[:, 1]), color="#aab3bd", lw=0.8)
    for axis, title in zip(axes, ["a: Voronoi diagram", "b: Delaunay triangulation"]):
        axis.plot(at[:, 0], at[:, 1], "o", color=COLORS[0], ms=4, label="samples")
        axis.set_title(title)
        bare(axis)
        axis.set_xlim(low[0], high[0])
        axis.set_ylim(low[1], high[1])
    axes[0].legend(ncol=3, loc="upper center", bbox_to_anchor=(0.5, 0.02))
    places = drawing
    t = figure.tables["distance to the medial axis"]
    drawing, axis = subplots(size=(6, 3.4))
    lines(axis, t["samples"], [(None, t[1])])
    style(axis, "samples", "largest distance of a pole", x_log=True, y_log=True)
    plain_ticks(axis, t["samples"])
    return [("", places), ("-distances", drawing)]


def figure_6_10(figure):
    t = figure.tables["bunny"]
    drawing, axis = subplots(size=(7, 3.8))
    lines(axis, t["centers"], [(name, t[name]) for name in t.columns[1:]])
    style(axis, "centres", "support [diagonals]", "bunny", x_log=True, y_log=True)
    plain_ticks(axis, t["centers"])
    return [("", drawing)]


def figure_6_17(figure):
    t = figure.tables["rms Taubin"]
    drawing, axis = subplots(size=(7, 4))
    lines(axis, t["centers"], [(name, t[name]) for name in t.columns[1:]])
    style(axis, "centres", "rms Taubin distance [diagonals]", x_log=True, y_log=True)
    plain_ticks(axis, t["centers"])
    return [("", drawing)]


def figure_6_21(figure):
    t = figure.tables["condition"]
    drawing, axis = subplots(size=(7, 3.8))
    lines(axis, t["weight"], [(name, t[name]) for name in t.columns[1:]])
    style(axis, r"weight $(\epsilon / t)^2$", "condition number", "Fig. 6.23", x_log=True, y_log=True)
    return [("", drawing)]


DRAW = {
    "figure-4.1": figure_4_1,
    "chapter-5": chapter_5,
    "figure-6.1": figure_6_1,
    "figure-6.3": figure_6_3,
    "figure-6.6": figure_6_6,
    "figure-6.8": figure_6_8,
    "figure-6.9": figure_6_9,
    "figure-6.10": figure_6_10,
    "figure-6.17": figure_6_17,
    "figure-6.21": figure_6_21,
}
