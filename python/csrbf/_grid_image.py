from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from csrbf._function import Function
from csrbf._image import Image
from csrbf._labels import is_data_array
from csrbf._masks import masked
from csrbf._surface import Surface

_TIMES = {"time", "t", "frame"}
_BANDS = {"band", "bands", "channel", "channels", "component", "rgb", "color", "colour", "c"}
_RANKS = (
    {"z", "depth", "level", "altitude", "slice", "plane"},
    {"y", "lat", "latitude", "northing", "row"},
    {"x", "lon", "longitude", "easting", "column", "col"},
)
_UNEVEN = 1e-3  # of a step by which coordinates may deviate from even ones: files store them rounded


class GridImage(Image):
    """The image of a DataArray: its place follows from the coordinates, and results have its labels.

    Dimensions named like time or bands are those; of the others the last is x, unless their names say more. NaN marks
    voxels without a value.
    """

    def __init__(self, array: Any) -> None:
        dims = [str(dim) for dim in array.dims]
        times = [dim for dim in dims if dim in _TIMES][:1]
        bands = [dim for dim in dims if dim in _BANDS][:1]
        space = _in_order([dim for dim in dims if dim not in times + bands])
        if not 1 <= len(space) <= 3:
            raise ValueError(f"image: the DataArray has the dimensions {', '.join(dims)}; must be y, x or z, y, x")
        self._given, self._space = array, space
        self._stored = array.transpose(*times, *space, *bands)
        values = self._stored.values
        if bands and values.shape[-1] == 1:
            values, bands = values[..., 0], []
        if values.dtype.kind == "f" and np.isnan(values).any():
            values = masked(values, np.isnan(values))
        spacing, origin, signs = np.ones(3), np.zeros(3), np.ones(3)
        for axis, dim in enumerate(reversed(space)):  # x first
            if dim in array.coords:
                origin[axis], step = _start_and_step(array.coords[dim].values, dim)
                spacing[axis], signs[axis] = abs(step), np.sign(step)
        axes = "t" * len(times) + "zyx"[3 - len(space) :] + "c" * len(bands)
        super().__init__(values, spacing, origin, np.diag(signs), axes=axes)

    def _aligned(self, given: Any, name: str) -> Any:
        if is_data_array(given):
            return self._aligned_grid(given, name)
        if isinstance(given, (str, os.PathLike, Image, Function, Surface)) or np.ndim(given) < len(self._space):
            return given
        # A plain array has the axes of the DataArray, without the bands.
        stored = [str(dim) for dim in self._stored.dims if dim not in _BANDS][-np.ndim(given) :]
        own = [str(dim) for dim in self._given.dims if dim in stored]
        return np.transpose(given, [own.index(dim) for dim in stored]) if len(own) == np.ndim(given) else given

    def _aligned_grid(self, given: Any, name: str) -> NDArray[Any]:
        dims = [dim for dim in self._stored.dims if dim in given.dims]
        if len(dims) != len(given.dims):
            known = ", ".join(map(str, self._stored.dims))
            raise ValueError(f"{name}: has the dimensions {', '.join(map(str, given.dims))}; the image has {known}")
        for dim in dims:
            if dim in given.coords and dim in self._stored.coords:
                ours, theirs = self._stored.coords[dim].values, given.coords[dim].values
                if not np.array_equal(ours, theirs):
                    raise ValueError(f'{name}: its coordinate "{dim}" is not that of the image; use .interp_like(image)')
        values: NDArray[Any] = given.transpose(*dims).values
        return values

    def _frame(self, number: int) -> Image:
        return GridImage(self._stored.isel({self._stored.dims[0]: number}))

    def _labels_like(self, labels: NDArray[Any], name: str) -> Any:
        given = self._given
        coords = {key: c for key, c in given.coords.items() if set(c.dims) <= set(self._space)}
        found = type(given)(labels, coords, self._space, name)
        return found.transpose(*(dim for dim in given.dims if dim in self._space))

    def _result(self, values: NDArray[Any], report: dict[str, Any]) -> Any:
        shaped = values.reshape(self._stored.shape)
        return self._stored.copy(data=shaped).transpose(*self._given.dims)


def _in_order(dims: list[str]) -> list[str]:
    """z, y, x when the names say which is which, else as they are."""
    ranks = [rank for dim in dims for rank, names in enumerate(_RANKS) if dim.lower() in names]
    return [dim for _, dim in sorted(zip(ranks, dims))] if len(set(ranks)) == len(dims) else dims


def _start_and_step(coordinate: NDArray[Any], dim: str) -> tuple[float, float]:
    if coordinate.dtype.kind not in "iuf" or coordinate.ndim != 1:
        raise ValueError(f'image: the coordinate "{dim}" must be numbers along one dimension; .drop_vars leaves it out')
    if len(coordinate) < 2:
        return float(coordinate[0]), 1.0
    step = float(coordinate[-1] - coordinate[0]) / (len(coordinate) - 1)
    steps = np.diff(coordinate.astype(float))
    if not (step != 0 and (np.abs(steps - step) <= _UNEVEN * abs(step)).all()):
        raise ValueError(
            f'image: the coordinate "{dim}" is not evenly spaced; use .interp to make it so, or fit the array instead'
        )
    return float(coordinate[0]), step
