"""Arrays with labels: masked arrays, tables of pandas, arrays of xarray.

Neither package is imported here: an object of theirs exists only where somebody has imported it.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from typing import Any, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf._arrays import Floats, floats
from csrbf._masks import data_of, mask_of, masked


class Frame(Protocol):
    """A DataFrame of pandas."""

    @property
    def columns(self) -> Any: ...
    @property
    def index(self) -> Any: ...


class Grid(Protocol):
    """A DataArray or Dataset of xarray."""

    @property
    def coords(self) -> Any: ...
    @property
    def dims(self) -> Any: ...


Labelled = Union[Frame, Grid]


def is_frame(x: Any) -> bool:
    """Is it a DataFrame?"""
    return is_instance(x, "pandas", "DataFrame")


def is_data_array(x: Any) -> bool:
    """Is it a DataArray?"""
    return is_instance(x, "xarray", "DataArray")


def is_dataset(x: Any) -> bool:
    """Is it a Dataset of xarray?"""
    return is_instance(x, "xarray", "Dataset")


def is_instance(x: Any, package: str, name: str) -> bool:
    """Is it of that class of a package, which may be missing?"""
    module = sys.modules.get(package)
    return module is not None and isinstance(x, getattr(module, name, ()))


def frame_columns(frame: Any, names: Sequence[str], argument: str) -> NDArray[Any]:
    """Columns of a DataFrame as an array (n, len(names)) of float64, missing entries as NaN."""
    _require(names, list(frame.columns), argument, "the table has the columns")
    return np.column_stack([_numbers_of(frame[name], name) for name in names])


def grid_columns(grid: Any, names: Sequence[str], argument: str) -> list[Any]:
    """Variables or coordinates of a DataArray or Dataset, broadcast against each other."""
    known = list(grid.coords) + (list(grid.data_vars) if is_dataset(grid) else [])
    _require(names, known, argument, "the array has the coordinates")
    xarray = sys.modules["xarray"]
    broadcast: list[Any] = list(xarray.broadcast(*(grid[name] for name in names)))
    dims = [dim for dim in grid.dims if dim in broadcast[0].dims]  # in the order of the grid
    return [part.transpose(*dims) for part in broadcast]


def numbers_of_grid(array: Any, name: str) -> Floats:
    """The entries of a DataArray in a row."""
    return floats(array.values, name).ravel()


def _numbers_of(column: Any, name: str) -> Floats:
    kind = getattr(column.dtype, "kind", "O")
    if kind in "biuf" and hasattr(column, "to_numpy"):
        return floats(column.to_numpy(dtype=float, na_value=np.nan), f'column "{name}"')
    return floats(column.to_numpy(), f'column "{name}"')


def _columns_of(result: NDArray[Any]) -> NDArray[Any]:
    """As a table with one row for each point, of which there may be none."""
    return result.reshape(len(result), math.prod(result.shape[1:]))


def _require(names: Sequence[str], known: Sequence[Any], argument: str, what: str) -> None:
    for name in names:
        if name not in known:
            raise ValueError(f'{argument}: there is no "{name}"; {what} {", ".join(map(str, known))}')


class Places:
    """The points of an argument x as rows, and the way back: results with the shape, mask or labels of x.

    `names` are those of the coordinates. Columns of a table are found by them; unless the names are `given`, a table of
    exactly as many columns may have others.
    """

    rows: Floats
    _template: Any

    def __init__(self, x: Any, names: Sequence[str], given: bool = False) -> None:
        self._x, self._template = x, None
        self._mask: NDArray[np.bool_] | None = None
        self._shape: tuple[int, ...] = ()
        if is_frame(x):
            columns = list(x.columns)
            unnamed = not given and len(columns) == len(names) and not all(name in columns for name in names)
            own = columns if unnamed else list(names)
            self.rows = frame_columns(x, own, "x")
        elif is_data_array(x) or is_dataset(x):
            self._template, *_ = parts = grid_columns(x, names, "x")
            self.rows = np.column_stack([numbers_of_grid(part, str(part.name)) for part in parts])
        else:
            self._take_array(x, len(names))

    def _take_array(self, x: ArrayLike, dimension: int) -> None:
        mask = mask_of(x)
        array = floats(data_of(x), "x")
        if dimension == 1 and array.shape[-1:] != (1,):  # one variable: every entry is a place
            array, mask = array[..., np.newaxis], None if mask is None else mask[..., np.newaxis]
        if array.ndim == 0 or array.shape[-1] != dimension:
            raise ValueError(f"x: has shape {array.shape}; its last axis must hold {dimension} coordinates of a point")
        self._shape = array.shape[:-1]
        self.rows = array.reshape(-1, dimension)
        if mask is not None:
            hidden: NDArray[np.bool_] = mask.any(axis=-1)
            self._mask, self.rows = hidden, np.ascontiguousarray(self.rows[~hidden.ravel()])

    @property
    def labelled(self) -> bool:
        """Do results have names?"""
        return self._template is not None or is_frame(self._x)

    def like_given(self, result: NDArray[Any], names: Sequence[str]) -> Any:
        """A result (m, ...), one row for each point, in the form of x; `names` are those of its columns."""
        if self._template is not None:
            return self._like_grid(_columns_of(result), names)
        if is_frame(self._x):
            pandas = sys.modules["pandas"]
            if result.ndim == 1:
                return pandas.Series(result, self._x.index, name=names[0])
            return pandas.DataFrame(_columns_of(result), self._x.index, list(names))
        shape = self._shape + result.shape[1:]
        if self._mask is None:
            return result.reshape(shape)
        whole = np.zeros(shape, result.dtype)
        whole[~self._mask] = result
        hidden = self._mask.reshape(self._mask.shape + (1,) * (len(shape) - self._mask.ndim))
        return masked(whole, np.broadcast_to(hidden, shape))

    def _like_grid(self, columns: NDArray[Any], names: Sequence[str]) -> Any:
        xarray, template = sys.modules["xarray"], self._template
        arrays = [
            xarray.DataArray(column.reshape(template.shape), template.coords, template.dims, name=name)
            for column, name in zip(columns.T, names)
        ]
        return arrays[0] if len(arrays) == 1 else xarray.Dataset({array.name: array for array in arrays})
