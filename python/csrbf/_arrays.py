"""Converts arguments to the arrays that the compiled module takes."""

from __future__ import annotations

import operator
import os
from typing import Any, Union

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, NDArray

from csrbf._masks import data_of, mask_of

Floats = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]


def numbers(array: ArrayLike, name: str, kinds: str = "biuf") -> NDArray[Any]:
    """An array of real numbers of any type (numpy's `kinds`); masked entries, which mostly have no meaning, are refused."""
    mask = mask_of(array)
    if mask is not None:
        entries = "entry is" if mask.sum() == 1 else "entries are"
        raise ValueError(f"{name}: {mask.sum()} {entries} masked; leave them out, or give them values with .filled()")
    try:
        found = np.asarray(data_of(array))
    except ValueError as error:
        raise ValueError(f"{name}: must be an array of numbers: {error}") from None
    if found.dtype.kind not in kinds:
        raise ValueError(f"{name}: must be real numbers{_what_else(found)}")
    return found


def _what_else(array: NDArray[Any]) -> str:
    """What an array holds instead of real numbers, as the end of a sentence."""
    if array.dtype.kind == "c":
        return ", not complex ones; give .real and .imag as two columns of values"
    if array.dtype.kind in "mM":
        return ", not dates or times; convert them, as in (times - times[0]) / numpy.timedelta64(1, 's')"
    if array.dtype.kind == "O":
        for index, entry in np.ndenumerate(array):
            if not isinstance(entry, (bool, int, float, np.number, np.bool_)):
                if not index:
                    return f", not {entry!r:.60}"
                place = ", ".join(map(str, index))
                return f"; entry [{place}] is {entry!r:.60}"
        return "; the array is of type object, convert it with .astype(float)"
    return f"; the array is of type {array.dtype}"


def floats(array: ArrayLike, name: str) -> Floats:
    """A C-contiguous array of float64; `array` itself when it is one already."""
    found = numbers(array, name)
    return np.ascontiguousarray(found, dtype=np.float64) if found.ndim else np.asarray(found, dtype=np.float64)


def indices(array: ArrayLike, name: str) -> NDArray[np.int32]:
    """A C-contiguous array of int32, of whole numbers that fit it."""
    found = numbers(array, name)
    limits = np.iinfo(np.int32)
    whole = found.dtype.kind in "iu" or found.size == 0 or bool((found == np.rint(found)).all())
    if found.size > 0 and not (whole and limits.min <= found.min() and found.max() <= limits.max):
        raise ValueError(f"{name}: must be whole numbers below 2^31, the indices of vertices")
    return np.ascontiguousarray(found, dtype=np.int32)


def rows(array: ArrayLike, name: str) -> Floats:
    """As floats(), with two dimensions."""
    array = floats(array, name)
    if array.ndim != 2:
        raise ValueError(f"{name}: has shape {array.shape}; give one point per row, in an array of shape (n, d)")
    return array


def whole(number: Any, name: str) -> int:
    """A whole number, of any type of numbers; int() would cut 0.5 down to 0, which often stands for a default."""
    try:
        return operator.index(number)
    except TypeError:
        if isinstance(number, (float, np.floating)) and float(number).is_integer():
            return int(number)
    raise ValueError(f"{name} = {number!r}: must be a whole number")


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
