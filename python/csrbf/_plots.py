"""Plots by matplotlib, which is imported only when one is made."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from csrbf._arrays import Floats
from csrbf._masks import present

if TYPE_CHECKING:
    from csrbf._function import Function
    from csrbf._image import Image

_LINES = ("#d62728", "#ffbf00", "#1f77b4", "#2ca02c", "#e377c2", "#ffffff")  # contours on images
_MOST_WORK = 1e10  # operations for the deviations in a plot, some seconds


def axes_for(ax: Any) -> Any:
    """The axes given, or those of a new figure."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as pyplot
    except ImportError as error:
        raise ImportError(f"plot needs the package matplotlib, which cannot be imported: {error}") from error
    return pyplot.subplots(layout="constrained")[1]


def space_axes_for(ax: Any) -> Any:
    """The axes given, or those of a new figure in space."""
    if ax is not None:
        return ax
    axes_for_figure = axes_for(None).figure
    axes_for_figure.clear()
    return axes_for_figure.add_subplot(projection="3d")


def plot_picture(draw: Callable[[Any], Any], size: tuple[float, float] = (6.4, 4.2)) -> bytes | None:
    """The PNG file of what `draw` does with axes; None without matplotlib. Leaves the figures of users alone."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure(figsize=size, dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    draw(figure.add_subplot())
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return file.getvalue()


def plot_function(
    f: Function, ax: Any, variables: Sequence[int], at: Floats, component: int, deviation: bool, samples: bool, n: int
) -> Any:
    """A curve of one variable, or a map of two; the others are fixed at `at`."""
    from csrbf._function import Function

    assert isinstance(f, Function)
    names, low, high = f.coordinate_names, f.bounds[0], f.bounds[1]
    if deviation:  # one costs as much as the square of the number of samples, where these make one system
        n = int(np.clip((_MOST_WORK / max(f.report["samples_fitted"], 1) ** 2) ** (1 / len(variables)), 32, n))
    axes = [np.linspace(low[v], high[v], n) for v in variables]
    nodes = np.empty(tuple(len(a) for a in axes) + (f.dimension,))
    nodes[...] = at
    for position, (v, axis) in enumerate(zip(variables, axes)):
        nodes[..., v] = axis.reshape([-1 if p == position else 1 for p in range(len(axes))])
    values = _component(f(nodes), f, component)
    sd = _component(f.standard_deviation(nodes), f, component) if deviation else None
    title = f.value_names[component]
    ax.set_xlabel(names[variables[0]])
    dots = f.samples if samples and len(variables) == f.dimension else None
    if len(variables) == 1:
        if dots is not None:
            ax.plot(dots[0][:, 0], dots[1][:, component], ".", color="0.45", markersize=4, label="samples")
        (line,) = ax.plot(axes[0], values, label=title)
        if sd is not None:
            ax.fill_between(axes[0], values - 2 * sd, values + 2 * sd, color=line.get_color(), alpha=0.2, linewidth=0,
                            label="two standard deviations")
        ax.set_ylabel(title)
        ax.legend()
        return ax
    shown = values if sd is None else sd
    mesh = ax.pcolormesh(axes[0], axes[1], shown.T, shading="gouraud", cmap="viridis" if sd is None else "magma")
    ax.figure.colorbar(mesh, ax=ax, label=title if sd is None else f"standard deviation of {title}")
    if dots is not None:
        size = float(np.clip(4000 / len(dots[0]), 1, 16))
        ax.scatter(*dots[0].T, s=size, c="none" if len(dots[0]) < 400 else "k", edgecolors="k", linewidths=0.5,
                   alpha=0.6)
    ax.set_ylabel(names[variables[1]])
    extent = high - low
    if 0.2 < extent[variables[0]] / (extent[variables[1]] or np.inf) < 5:  # perhaps the same unit
        ax.set_aspect("equal")
    ax.set(xlim=(low[variables[0]], high[variables[0]]), ylim=(low[variables[1]], high[variables[1]]))
    return ax


def plot_image(image: Image, ax: Any, plane: NDArray[Any], axes: tuple[int, int], keywords: dict[str, Any]) -> Any:
    """A plane [row, column] of an image in its coordinates; `axes` are those of columns and rows (0 is x)."""
    origin, step = image.origin, image.spacing * np.diag(image.direction)
    if not np.allclose(np.abs(image.direction), np.eye(3)):  # turned: distances from the first voxel
        origin, step = np.zeros(3), image.spacing
    ends = []
    for axis, count in zip(axes, (plane.shape[1], plane.shape[0])):
        ends += [origin[axis] - 0.5 * step[axis], origin[axis] + (count - 0.5) * step[axis]]
    if plane.ndim == 2 and "vmin" not in keywords and "norm" not in keywords and plane.size > 0:
        finite = present(plane)
        if finite.size > 0:
            keywords = {"vmin": np.percentile(finite, 1), "vmax": np.percentile(finite, 99), **keywords}
    # Pictures have their first row on top; maps, whose y falls with the row, too.
    ax.imshow(plane, **{"cmap": "gray", "extent": (ends[0], ends[1], ends[3], ends[2]), "origin": "upper", **keywords})
    ax.set(xlabel="xyz"[axes[0]], ylabel="xyz"[axes[1]])
    return ax


def line_color(number: int) -> str:
    """Colour of the contour of a region."""
    return _LINES[number % len(_LINES)]


def _component(values: Any, f: Function, component: int) -> Floats:
    found: Floats = values if f._scalar else values[..., component]
    return found
