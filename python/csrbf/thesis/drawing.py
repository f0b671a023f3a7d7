"""Common parts of the drawings of the gallery: colours, lines, pictures of numbers."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullLocator  # noqa: E402

# Okabe and Ito: distinct for all common kinds of colour vision; markers and dashes differ as well.
COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DASHES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (7, 2))]
REFERENCE = "#9aa3ad"  # the target
QUIET = "#5b6675"  # bounds, remarks

# Pixels per inch: drawings are shown at 96, so they stay sharp on high-resolution screens.
RESOLUTION = 150

STYLE = {
    "figure.dpi": RESOLUTION,
    "font.size": 10.5,
    "axes.grid": True,
    "grid.color": "#e3e6ea",
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10.5,
    "legend.frameon": False,
    "legend.fontsize": 9.5,
    "savefig.bbox": "tight",
    "figure.constrained_layout.use": True,
}


def subplots(*shape, size, **options):
    """Figure and axes in inches."""
    return plt.subplots(*shape, figsize=size, **options)


def lines(axis, x, curves, markers=True):
    """One line for each (label, y); no legend for a label of None."""
    for i, (label, y) in enumerate(curves):
        axis.plot(x, y, ls=DASHES[i], marker=MARKERS[i] if markers else None, color=COLORS[i], ms=4.5, label=label)
    if any(label for label, _ in curves):
        axis.legend()


def style(axis, x_label, y_label, title="", x_log=False, y_log=False):
    axis.set_xlabel(x_label)
    axis.set_ylabel(y_label)
    axis.set_title(title)
    if x_log:
        axis.set_xscale("log")
    if y_log:
        axis.set_yscale("log")


def plain_ticks(axis, values):
    """Ticks at these values of a logarithmic axis, as plain numbers."""
    axis.set_xticks(values, [f"{value:,.0f}" for value in values])
    axis.minorticks_off()


def decimal_ticks(axis):
    """Ticks at 1, 2 and 5 of every decade of a short logarithmic y axis, as plain numbers."""
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axis.yaxis.set_minor_locator(NullLocator())


def whole_ticks(axis):
    axis.xaxis.get_major_locator().set_params(integer=True)


def bound(axis, at, text, x):
    """A dotted horizontal line with a label."""
    axis.axhline(at, color=QUIET, lw=1, ls=":")
    axis.text(x, at, text, va="bottom", color=QUIET, fontsize=9)


def bare(axis):
    """An axis for a 2D drawing: equal scales, no ticks."""
    axis.set_aspect("equal")
    axis.set_xticks([])
    axis.set_yticks([])
    axis.grid(False)
    for spine in axis.spines.values():
        spine.set_visible(False)


def show(axis, values, title, **options):
    shown = axis.imshow(values, interpolation="nearest", **options)
    axis.set_title(title)
    axis.axis("off")
    return shown


def pairs(pictures, cmap, limits=None, signed=False, **options):
    """Pictures above their errors ("error ... NAME"): one scale for the pictures, one for the errors."""
    names = [name for name in pictures if not name.startswith("error")]
    errors = {name: next((e for e in pictures if e.startswith("error") and e.endswith(name)), None) for name in names}
    low, high = limits or (pictures[names[0]].min(), pictures[names[0]].max())
    shown_errors = np.abs(np.concatenate([pictures[e].ravel() for e in errors.values() if e]))
    # Keeps a few pixels from turning all others black.
    largest = np.percentile(shown_errors, 99.5)
    height, width = pictures[names[0]].shape
    drawing, axes = subplots(2, len(names), size=(2.2 * len(names) + 0.9, 4.4 * height / width + 0.7))
    for column, name in enumerate(names):
        top = show(axes[0, column], pictures[name], name, cmap=cmap, vmin=low, vmax=high, **options)
        axes[1, column].axis("off")
        if errors[name]:
            scale = {"cmap": "RdBu_r", "vmin": -largest} if signed else {"cmap": "magma", "vmin": 0}
            title = "error" if signed else "|error|"
            bottom = show(axes[1, column], pictures[errors[name]], title, vmax=largest, **scale, **options)
    drawing.colorbar(top, ax=axes[0, :], shrink=0.85)
    drawing.colorbar(bottom, ax=axes[1, :], shrink=0.85, extend="both" if signed else "max")
    return drawing


def powers(text):
    """"d^2" with the exponent raised."""
    for exponent, raised in zip("234567", "²³⁴⁵⁶⁷"):
        text = text.replace("^" + exponent, raised)
    return text


def order(x, y):
    """The slope of log y against log x."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def bounded_cells(points, low, high):
    """The Voronoi cells of points (n, 2) in the box from low to high: a list of polygons (k, 2)."""
    box = np.array([low, (high[0], low[1]), high, (low[0], high[1])], dtype=float)
    cells = []
    for i, p in enumerate(points):
        cell = box
        for q in np.delete(points, i, axis=0):
            cell = below(cell, q - p, 0.5 * (q @ q - p @ p))
        cells.append(cell)
    return cells


def below(polygon, normal, offset):
    """The part of a convex polygon (k, 2) with normal . x <= offset."""
    if len(polygon) == 0:
        return polygon
    height = polygon @ normal - offset
    kept = []
    for a, b, ha, hb in zip(polygon, np.roll(polygon, -1, axis=0), height, np.roll(height, -1)):
        if ha <= 0:
            kept.append(a)
        if ha * hb < 0:
            kept.append(a + ha / (ha - hb) * (b - a))
    return np.array(kept).reshape(-1, 2)
