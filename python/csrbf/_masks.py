"""Masked arrays of numpy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_ma: Any = np.ma  # which has no types


def mask_of(array: Any) -> NDArray[np.bool_] | None:
    """Which entries are masked; None when none is."""
    if not isinstance(array, np.ma.MaskedArray) or not _ma.is_masked(array):
        return None
    mask: NDArray[np.bool_] = _ma.getmaskarray(array)
    return mask


def data_of(array: Any) -> Any:
    """The numbers, masked ones too."""
    return array.data if isinstance(array, np.ma.MaskedArray) else array


def masked(values: NDArray[Any], mask: NDArray[np.bool_]) -> NDArray[Any]:
    """The values with a mask."""
    array: NDArray[Any] = _ma.MaskedArray(values, mask)
    return array


def as_nan(array: NDArray[Any]) -> NDArray[np.float64]:
    """The values as float64, NaN where they are masked."""
    values: NDArray[np.float64] = _ma.filled(_ma.asarray(array).astype(np.float64), np.nan)
    return values


def present(array: NDArray[Any]) -> NDArray[Any]:
    """The finite values that are not masked, in a row."""
    values: NDArray[Any] = _ma.compressed(array)
    if values.dtype.kind == "f":
        values = values[np.isfinite(values)]
    return values


def range_of(array: NDArray[Any]) -> tuple[float, float]:
    """The least and the greatest value, without those that are masked or NaN; NaN when there is none."""
    mask = mask_of(array)
    values = data_of(array)
    if mask is not None:
        values = values[~mask]
    if values.size == 0:
        return np.nan, np.nan
    return float(np.fmin.reduce(values, axis=None)), float(np.fmax.reduce(values, axis=None))
