"""Surfaces, points and colours as the data of the interactive view (viewer/)."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats

if TYPE_CHECKING:
    from csrbf._mesh import Mesh

MOST_VERTICES = 65535  # 16-bit indices
_MARGIN = 0.02  # of the diagonal, around a surface; points further away are not shown
_STOPS = 9  # of a colour scale; more are not seen


@dataclass
class Scale:
    """A quantity that colours a surface and its points; NaN: no value there."""

    name: str
    title: str
    values: Floats
    point_values: Floats | None = None
    diverging: bool = False  # blue and red on the two sides of 0
    limits: tuple[float, float] | None = None  # chosen from the values when not given


@dataclass
class View:
    """What there is to see: a mesh, points on it or alone, and scales of colours."""

    mesh: Mesh
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))
    point_colors: NDArray[np.uint8] | None = None
    scales: list[Scale] = field(default_factory=list)
    shown: str = "plain"  # "own" for its own colours, or the number of a scale

    def data(self) -> dict[str, Any]:
        """The numbers of the script `surface-data`, as app/report/surface_view.cpp writes them too."""
        corners = self.mesh.vertices if len(self.mesh.vertices) > 0 else self.points
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = _MARGIN * np.linalg.norm(high - low) if len(self.points) > 0 else 0.0
        low, high = low - margin, high + margin
        near = ((self.points >= low) & (self.points <= high)).all(axis=1)
        normals = np.zeros_like(self.mesh.vertices) if self.mesh.normals is None else self.mesh.normals
        data = {
            "low": low.tolist(),
            "high": high.tolist(),
            "up": "z",
            "shown": self.shown,
            "positions": _fractions(self.mesh.vertices, low, high),
            "normals": _text(np.rint(127 * np.clip(np.nan_to_num(normals), -1, 1)).astype("i1")),
            "triangles": _text(self.mesh.faces.astype("<u2")),
            "scales": [_scale_data(scale, near) for scale in self.scales],
            "colors": {"sequential": _stops(False), "diverging": _stops(True)},
        }
        own = colors_of(self.mesh.properties)
        if own is not None:
            data["tints"] = _text(own)
        if near.any():
            data["points"] = {"positions": _fractions(self.points[near], low, high)}
            if self.point_colors is not None:
                data["points"]["tints"] = _text(self.point_colors[near])
        return data

    def script(self) -> str:
        """The data as JSON that cannot end the element it is in."""
        return json.dumps(self.data(), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def colors_of(properties: dict[str, NDArray[Any]]) -> NDArray[np.uint8] | None:
    """Red, green and blue (n, 3), where there are such properties."""
    if not all(name in properties for name in ("red", "green", "blue")):
        return None
    return np.column_stack([np.asarray(properties[name], dtype=np.uint8) for name in ("red", "green", "blue")])


def limits_of(values: Floats, diverging: bool) -> tuple[float, float]:
    """Ends of a scale: all but the outermost values, 0 in the middle of a diverging one."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return 0.0, 1.0
    low, high = (float(end) for end in np.percentile(finite, [1, 99] if diverging else [0, 100]))
    most = max(abs(low), abs(high))
    return (-most, most) if diverging else (low, high)


def places(values: Floats, low: float, high: float) -> Floats:
    """Where values are on the scale, from 0 to 1."""
    if not high > low:
        return np.where(np.isnan(values), np.nan, 0.5)
    parts: Floats = np.clip((values - low) / (high - low), 0, 1)
    return parts


def _scale_data(scale: Scale, near: NDArray[np.bool_]) -> dict[str, Any]:
    low, high = limits_of(scale.values, scale.diverging) if scale.limits is None else scale.limits
    data = {
        "name": scale.name,
        "title": scale.title,
        "map": "diverging" if scale.diverging else "sequential",
        "values": _bytes(scale.values, low, high),
        "lo": low,
        "hi": high,
    }
    if scale.point_values is not None:
        data["point_values"] = _bytes(scale.point_values[near], low, high)
    return data


def _bytes(values: Floats, low: float, high: float) -> str:
    """0 to 254 along the scale, 255 where there is no value."""
    parts = places(values, low, high)
    return _text(np.where(np.isfinite(parts), np.rint(254 * np.nan_to_num(parts)), 255).astype("u1"))


def _fractions(points: Floats, low: Floats, high: Floats) -> str:
    """Fractions of the box in 16 bits."""
    extent = high - low
    parts = np.where(extent > 0, (points - low) / np.where(extent > 0, extent, 1), 0.5)
    return _text(np.rint(65535 * parts).astype("<u2"))


def _stops(diverging: bool) -> list[str]:
    colors = _csrbf.color_map(np.linspace(0, 1, _STOPS), diverging)
    return ["#" + bytes(color).hex() for color in colors]


def _text(numbers: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(numbers).tobytes()).decode()
