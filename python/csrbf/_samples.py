"""Samples of a function, from arrays or tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from csrbf._arrays import Floats, floats, rows
from csrbf._labels import frame_columns, grid_columns, is_data_array, is_dataset, is_frame, numbers_of_grid
from csrbf._masks import as_nan, data_of, mask_of


class Samples(NamedTuple):
    """Points (n, d) with values (n, k) and weights (n,)."""

    points: Floats
    values: Floats
    weights: Floats | None
    scalar: bool  # one value without an axis for it
    kept: NDArray[np.bool_] | None  # which of the samples given; None for all
    coordinate_names: list[str]  # empty: the arrays have none
    value_names: list[str]

    @property
    def left_out(self) -> int:
        """How many samples were masked or had no value."""
        return 0 if self.kept is None else int((~self.kept).sum())


def samples_of(points: Any, values: Any, coordinates: Any, weights: Any) -> Samples:
    """The samples of arguments of `fit`; those that are masked, or NaN in a table, are left out."""
    if is_frame(points):
        return _of_frame(points, values, coordinates, weights)
    if is_data_array(points) or is_dataset(points):
        return _of_grid(points, values, coordinates, weights)
    if coordinates is not None:
        raise ValueError("coordinates: are columns of a table, and points is none; give a DataFrame or leave them out")
    if values is None:
        raise ValueError("values: are missing; give one for each of the points")
    return _of_arrays(points, values, weights)


def _of_arrays(points: Any, values: Any, weights: Any) -> Samples:
    indices = [given.index for given in (points, values) if hasattr(given, "to_frame")]  # of Series
    if len(indices) == 2 and not indices[0].equals(indices[1]):
        raise ValueError("values: have another index than points; in the same order, give values.to_numpy()")
    masks = [_mask(given) for given in (points, values, weights)]
    points, values = floats(data_of(points), "points"), floats(data_of(values), "values")
    points = rows(points[:, np.newaxis] if points.ndim == 1 and values.ndim > 0 else points, "points")
    if values.ndim not in (1, 2) or len(values) != len(points):
        raise ValueError(f"values: has shape {values.shape}; must be ({len(points)},) or ({len(points)}, k)")
    if weights is not None:
        weights = floats(data_of(weights), "weights")
    hidden = [mask for mask in masks if mask is not None and len(mask) == len(points)]
    missing: NDArray[np.bool_] = np.any(hidden, axis=0) if hidden else np.zeros(0, dtype=bool)
    return _present(points, values, weights, missing, [], [])


def _of_frame(frame: Any, values: Any, coordinates: Any, weights: Any) -> Samples:
    columns = ", ".join(map(str, frame.columns))
    if values is None:
        raise ValueError(f"values: name the column of the values, or several; the table has {columns}")
    scalar, are_names = _names_columns(values, frame)
    if coordinates is None and are_names:
        raise ValueError(f'coordinates: name the columns of the coordinates, as in ["x", "y"]; the table has {columns}')
    names = list(frame.columns) if coordinates is None else _names(coordinates)
    points = frame_columns(frame, names, "coordinates")
    if are_names:
        value_names = [values] if scalar else list(values)
        table = frame_columns(frame, value_names, "values")
    else:
        table, value_names = _values_beside(frame, values)
        scalar = table.ndim == 1
        table = table if table.ndim == 2 else table[:, np.newaxis]
    if isinstance(weights, str):
        weights = frame_columns(frame, [weights], "weights")[:, 0]
    elif weights is not None:
        weights = floats(weights, "weights")
    missing = np.isnan(points).any(axis=1) | np.isnan(table).any(axis=1)
    found = table[:, 0] if scalar else table
    return _present(points, found, weights, missing, [str(n) for n in names], [str(n) for n in value_names])


def _values_beside(frame: Any, values: Any) -> tuple[Floats, list[str]]:
    """Values of the rows of a table that are not in it: an array, or a Series or DataFrame with the same index."""
    is_series = hasattr(values, "to_frame")
    if is_series or is_frame(values):
        if not frame.index.equals(values.index):
            raise ValueError("values: have another index than the table; in the same order, give values.to_numpy()")
        columns = values.to_frame() if is_series else values
        table = frame_columns(columns, list(columns.columns), "values")
        if is_series:
            return table[:, 0], [] if values.name is None else [str(values.name)]
        return table, [str(name) for name in columns.columns]
    table = as_nan(values) if mask_of(values) is not None else floats(values, "values")
    if table.ndim not in (1, 2) or len(table) != len(frame):
        raise ValueError(f"values: has shape {table.shape}; must be ({len(frame)},) or ({len(frame)}, k)")
    return table, []


def _names_columns(values: Any, frame: Any) -> tuple[bool, bool]:
    """Is it the name of one column, and is it that or a list of names?"""
    if isinstance(values, str) or _is_label(values, frame):
        return True, True
    is_list = isinstance(values, (list, tuple)) and len(values) > 0
    return False, is_list and all(isinstance(name, str) or _is_label(name, frame) for name in values)


def _of_grid(grid: Any, values: Any, coordinates: Any, weights: Any) -> Samples:
    if weights is not None:
        raise ValueError("weights: cannot be given with an array of xarray; make a table of it with .to_dataframe()")
    # As in images, the last dimension is x.
    names = [str(d) for d in reversed(list(grid.dims))] if coordinates is None else _names(coordinates)
    scalar = values is None or isinstance(values, str)
    if is_data_array(grid):
        if values is not None:
            raise ValueError("values: are those of the DataArray; leave them out, or give a Dataset and their name")
        value_names = [str(grid.name or "value")]
        grid = grid.to_dataset(name=value_names[0])
    elif values is None:
        known = ", ".join(map(str, grid.data_vars))
        raise ValueError(f"values: name the variable, or several; the Dataset has {known}")
    else:
        value_names = [values] if isinstance(values, str) else [str(name) for name in values]
    parts = grid_columns(grid, [*names, *value_names], "coordinates")
    table = np.column_stack([numbers_of_grid(part, str(part.name)) for part in parts])
    points, found = np.ascontiguousarray(table[:, : len(names)]), table[:, len(names) :]
    missing = np.isnan(table).any(axis=1)
    return _present(points, found[:, 0] if scalar else found, None, missing, names, value_names)


def _present(
    points: Floats, values: Floats, weights: Any, missing: NDArray[np.bool_], coordinates: list[str], names: list[str]
) -> Samples:
    kept = None
    if missing.any():
        kept = ~missing
        if not kept.any():
            raise ValueError("values: all samples are masked or missing; there is none to fit")
        points, values = points[kept], values[kept]
        weights = weights[kept] if weights is not None and len(weights) == len(kept) else weights
    table = values if values.ndim == 2 else values.reshape(-1, 1)
    return Samples(points, np.ascontiguousarray(table), weights, values.ndim == 1, kept, coordinates, names)


def _mask(given: Any) -> NDArray[np.bool_] | None:
    """Samples of which anything is masked."""
    mask = mask_of(given)
    if mask is None or mask.ndim == 0:
        return None
    hidden: NDArray[np.bool_] = mask.reshape(len(mask), -1).any(axis=1)
    return hidden


def _names(coordinates: str | Sequence[str]) -> list[str]:
    return [coordinates] if isinstance(coordinates, str) else list(coordinates)


def _is_label(name: Any, frame: Any) -> bool:
    try:
        return name in frame.columns
    except TypeError:
        return False
