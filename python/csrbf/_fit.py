from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from csrbf import _csrbf
from csrbf._arrays import floats, rows, smoothing_or_none
from csrbf._function import Function
from csrbf._progress import Progress, listening


def fit(
    points: ArrayLike,
    values: ArrayLike,
    method: str = "auto",
    tolerance: float | None = None,
    centers: int | None = None,
    smoothing: str | float = "auto",
    *,
    kernel: str = "auto",
    kernel_parameter: float | None = None,
    degree: int | None = None,
    weights: ArrayLike | None = None,
    periods: Sequence[float | None] | float | None = None,
    extrapolation: str = "constant",
    loss: str = "auto",
    missing: float | None = None,
    scale_axes: bool = True,
    progress: Progress = None,
) -> Function:
    """A smooth function through, or with noise near, scattered samples.

    Parameters
    ----------
    points : array_like (n, d)
        In any order, d from 1 to 6. Coincident points are merged.
    values : array_like (n,) or (n, k)
    method : str
        "auto" chooses from the data; "interpolate", "least-squares", "partition-of-unity", "multilevel",
        "pca-multiresolution", "fixed-budget", "error-bounded", "moving-least-squares" or "along-tracks".
    tolerance : float, optional
        Largest error allowed at any sample, in the unit of the values.
    centers : int, optional
        Largest number of radial basis functions.
    smoothing : "auto", "none" or float
        "auto" chooses by cross-validation, "none" interpolates, a number is used as given: larger is smoother.
    kernel : str
        "auto", "wendland-c2", "gaussian", "cubic", ...: an unknown name lists them all.
    kernel_parameter : float, optional
        Parameter of kernels that have one.
    degree : int, optional
        Degree of the polynomials; chosen automatically when not given.
    weights : array_like (n,), optional
        How much each sample counts: the inverse variance of its error, up to a factor.
    periods : sequence of float, optional
        Period of every axis, None or 0 for axes that are not periodic: ``[360, None]`` for longitude and latitude.
    extrapolation : "constant", "linear", "trend" or "nan"
        Outside the box of the samples: the value at the nearest point of the box; the same and its slope; the trend of
        the samples, as the method "interpolate" continues (others as "linear"); or NaN.
    loss : "auto", "squares", "huber" or "student"
        What samples far from those around them count for: "auto" leaves gross errors out and reports them, "squares"
        keeps all, "huber" and "student" give them less weight.
    missing : float, optional
        Value, such as -9999, of samples that have none: they are left out.
    scale_axes : bool
        Whether axes of different units may be scaled; False where all coordinates are lengths of one unit.
    progress : bool or callable, optional
        True shows a bar. A function is called as ``progress(stage, fraction)`` from time to time; an exception from it
        stops the fit.

    Returns
    -------
    Function

    Raises
    ------
    ValueError
        For arrays of wrong shapes, non-finite numbers and unknown options.
    SolverFailure
        When the tolerance cannot be met.

    Notes
    -----
    Time and memory are proportional to n, except for the method "interpolate". C-contiguous arrays of float64 are not
    copied.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.uniform(-1, 1, (2000, 2))
    >>> depth = np.cos(3 * x[:, 0]) * x[:, 1] + 0.05 * rng.normal(size=2000)
    >>> f = csrbf.fit(x, depth)
    >>> bool(abs(f([0.2, 0.5]) - np.cos(0.6) * 0.5) < 0.05)
    True
    >>> f.report["method"], round(f.report["cross_validation_rmse"], 2)
    ('interpolate', 0.05)
    """
    points = rows(points, "points")
    values = floats(values, "values")
    if values.ndim not in (1, 2) or len(values) != len(points):
        raise ValueError(f"values: has shape {values.shape}; must be ({len(points)},) or ({len(points)}, k)")
    given = fit_options(method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation)
    given["scale_axes"] = bool(scale_axes)
    given["loss"] = loss
    if missing is not None:
        given["missing"] = float(missing)
    if periods is not None:
        given["periods"] = [period or 0.0 for period in np.atleast_1d(np.asarray(periods, dtype=object)).tolist()]
    if weights is not None:
        weights = floats(weights, "weights")
    table = values if values.ndim == 2 else values.reshape(-1, 1)
    with listening(progress) as listener:
        return Function(_csrbf.fit(points, table, weights, given, listener), scalar=values.ndim == 1)


def fit_options(
    method: str,
    tolerance: float | None,
    centers: int | None,
    smoothing: str | float,
    kernel: str,
    kernel_parameter: float | None,
    degree: int | None,
    extrapolation: str,
) -> dict[str, Any]:
    """Options common to `fit` and `inpaint`, without those left to the library."""
    options = {
        "method": method,
        "kernel": kernel,
        "kernel_parameter": kernel_parameter,
        "centers": centers,
        "tolerance": tolerance,
        "smoothing": smoothing_or_none(smoothing),
        "degree": degree,
        "extrapolation": extrapolation,
    }
    return {name: value for name, value in options.items() if value is not None}
