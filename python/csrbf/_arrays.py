"""Arguments as the arrays that the compiled module takes."""

import numpy as np


def floats(array, name):
    """A C-contiguous array of float64, which is `array` itself when it is one already."""
    if np.iscomplexobj(array):
        raise ValueError(f"{name}: must be real numbers")
    try:
        return np.ascontiguousarray(array, dtype=np.float64) if np.ndim(array) else np.asarray(array, dtype=np.float64)
    except TypeError as error:
        raise ValueError(f"{name}: must be numbers: {error}") from None


def rows(array, name):
    """As floats, and with two dimensions."""
    array = floats(array, name)
    if array.ndim != 2:
        raise ValueError(f"{name}: has shape {array.shape}; give one point a row, in an array of shape (n, d)")
    return array


def queries(x, dimension):
    """Points in an array (..., d), as rows, and the shape of what is in front."""
    x = floats(x, "x")
    if x.ndim == 0 or x.shape[-1] != dimension:
        raise ValueError(f"x: has shape {x.shape}; its last axis must hold the {dimension} coordinates of a point")
    return x.reshape(-1, dimension), x.shape[:-1]


def smoothing_or_none(smoothing):
    """None for "auto", which the library chooses, 0 for "none"."""
    if smoothing is None or (isinstance(smoothing, str) and smoothing == "auto"):
        return None
    if isinstance(smoothing, str):
        if smoothing == "none":
            return 0.0
        raise ValueError(f'smoothing: "{smoothing}" is neither "auto" nor "none" nor a number')
    return float(smoothing)
