"""Converts arguments to the arrays that the compiled module takes."""

from __future__ import annotations

import os
from typing import Any, Union

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]


def floats(array: ArrayLike, name: str) -> Floats:
    """A C-contiguous array of float64; `array` itself when it is one already."""
    if np.iscomplexobj(array):
        raise ValueError(f"{name}: must be real numbers")
    try:
        return np.ascontiguousarray(array, dtype=np.float64) if np.ndim(array) else np.asarray(array, dtype=np.float64)
    except TypeError as error:
        raise ValueError(f"{name}: must be numbers: {error}") from None


def rows(array: ArrayLike, name: str) -> Floats:
    """As floats(), with two dimensions."""
    array = floats(array, name)
    if array.ndim != 2:
        raise ValueError(f"{name}: has shape {array.shape}; give one point per row, in an array of shape (n, d)")
    return array


def queries(x: ArrayLike, dimension: int) -> tuple[Floats, tuple[int, ...]]:
    """Points of an array (..., d) as rows, and the leading shape."""
    x = floats(x, "x")
    if x.ndim == 0 or x.shape[-1] != dimension:
        raise ValueError(f"x: has shape {x.shape}; its last axis must hold the {dimension} coordinates of a point")
    return x.reshape(-1, dimension), x.shape[:-1]


def smoothing_or_none(smoothing: str | float | None) -> float | None:
    """None for "auto", which the library chooses, 0 for "none"."""
    if smoothing is None or (isinstance(smoothing, str) and smoothing == "auto"):
        return None
    if isinstance(smoothing, str):
        if smoothing == "none":
            return 0.0
        raise ValueError(f'smoothing: "{smoothing}" is neither "auto" nor "none" nor a number')
    return float(smoothing)


class ArrayBacked(NDArrayOperatorsMixin):
    """Base of classes that numpy and operators treat as arrays; results of both are plain arrays."""

    _array: NDArray[Any]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return self._array.shape

    @property
    def ndim(self) -> int:
        """Number of axes of the array."""
        return self._array.ndim

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the numbers."""
        return self._array.dtype

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, index: Any) -> Any:
        return self._array[index]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self._array, dtype=dtype) if copy else np.asarray(self._array, dtype=dtype)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        def plain(value: Any) -> Any:
            return value._array if isinstance(value, ArrayBacked) else value

        out = keywords.get("out")
        if out is not None:
            keywords["out"] = tuple(map(plain, out))
        result = getattr(ufunc, method)(*map(plain, inputs), **keywords)
        return result if out is None or len(out) != 1 else out[0]
