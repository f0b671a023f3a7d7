from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from csrbf._arrays import Floats
from csrbf._coarse import with_normals
from csrbf._mesh import Mesh, mesh_panel
from csrbf._show import Panel
from csrbf._viewer import Scale

if TYPE_CHECKING:
    from csrbf._function import Function

_NODES = 120  # along each side
_HEIGHT = 0.35  # of the landscape, relative to its longer side
_FLATTEST = 4.0  # ratio of its sides; variables of different units may differ by more


def landscape_panel(f: Function) -> Panel:
    """A function of two variables as a landscape to turn, coloured by its value, with the samples."""
    low, high = f.bounds
    sides = high - low
    sides = np.where(sides > 0, sides, 1)
    shown = np.maximum(sides / sides.max(), 1 / _FLATTEST)
    axes = [np.linspace(low[a], high[a], _NODES) for a in range(2)]
    heights = f.evaluate_grid(*axes).reshape(_NODES, _NODES, -1)[..., 0]
    known = heights[np.isfinite(heights)]
    bottom, top = (float(known.min()), float(known.max())) if known.size > 0 else (0.0, 1.0)

    def placed(x: Floats, values: Floats) -> Floats:
        z = _HEIGHT * (values - bottom) / (top - bottom or 1)
        place: Floats = np.column_stack([(x - low) / sides * shown, z])
        return place

    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = heights.ravel()
    mesh = with_normals(Mesh(placed(nodes.reshape(-1, 2), np.nan_to_num(values, nan=bottom)), _triangles(values)))
    scale = Scale(f.value_names[0], f.value_names[0], values, limits=(bottom, top))
    points = None
    if f.samples is not None:
        points = placed(f.samples[0], np.clip(f.samples[1][:, 0], bottom - (top - bottom), top + (top - bottom)))
    panel = mesh_panel(mesh, True, [scale], points, "The function as a landscape; its height is not to scale.")
    if panel.view is not None:
        panel.view.shown = "0"
    return panel


def _triangles(values: Floats) -> NDArray[np.int64]:
    """Two for each cell of the grid whose corners have values."""
    corner = np.arange(_NODES * _NODES).reshape(_NODES, _NODES)[:-1, :-1].ravel()
    first = np.column_stack([corner, corner + _NODES, corner + _NODES + 1])
    second = np.column_stack([corner, corner + _NODES + 1, corner + 1])
    triangles = np.concatenate([first, second])
    finite: NDArray[np.int64] = triangles[np.isfinite(values)[triangles].all(axis=1)]
    return finite
