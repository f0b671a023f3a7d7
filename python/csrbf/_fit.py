from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from csrbf import _csrbf
from csrbf._arrays import Floats, floats, rows, smoothing_or_none
from csrbf._function import Function
from csrbf._labels import Labelled
from csrbf._options import Extrapolation, FitMethod, Kernel, Loss, Smoothing, Transform
from csrbf._progress import Progress, listening
from csrbf._samples import Samples, samples_of


def fit(
    points: ArrayLike | Labelled,
    values: ArrayLike | None = None,
    method: FitMethod = "auto",
    tolerance: float | None = None,
    centers: int | None = None,
    smoothing: Smoothing = "auto",
    *,
    coordinates: str | Sequence[str] | None = None,
    kernel: Kernel = "auto",
    kernel_parameter: float | None = None,
    degree: int | None = None,
    weights: ArrayLike | None = None,
    periods: Sequence[float | None] | float | None = None,
    sphere: bool | Sequence[int | str] = False,
    drift: Sequence[int | str] = (),
    derivatives: ArrayLike | None = None,
    faults: Sequence[ArrayLike] = (),
    extrapolation: Extrapolation = "auto",
    loss: Loss = "auto",
    transform: Transform = "auto",
    missing: float | None = None,
    scale_axes: bool = True,
    standard_deviation: bool = False,
    progress: Progress = None,
) -> Function:
    """A smooth function through, or with noise near, scattered samples.

    Parameters
    ----------
    points : array_like (n, d), or (n,) of one variable, DataFrame, DataArray or Dataset
        In any order, d from 1 to 20. Coincident points are merged. A table of pandas contains the values too, or is all
        coordinates; an array of xarray has values at the coordinates of its dimensions.
    values : array_like (n,) or (n, k), or names
        For a table or Dataset the name of a column or variable, or a list of names; none for a DataArray. For a table
        also an array, or a Series or DataFrame with the same index. Samples that are masked (numpy.ma), or NaN in a
        table, are left out; `report["missing"]` counts them.
    method : str
        "auto" chooses from the data; "interpolate", "least-squares", "partition-of-unity", "multilevel",
        "pca-multiresolution", "fixed-budget", "error-bounded", "moving-least-squares" or "along-tracks".
    tolerance : float, optional
        Largest error allowed at any sample, in the unit of the values.
    centers : int, optional
        Largest number of radial basis functions.
    smoothing : "auto", "none" or float
        "auto" chooses by cross-validation, "none" interpolates, a number is used as given: larger is smoother.
    coordinates : list of str, optional
        Names of the coordinate columns of a table, or of the coordinates of an array of xarray; by default those of its
        dimensions, x last.
    kernel : str
        "auto", "wendland-c2", "gaussian", "cubic", ...: an unknown name lists them all.
    kernel_parameter : float, optional
        Parameter of kernels that have one.
    degree : int, optional
        Degree of the polynomials; chosen automatically when not given.
    weights : array_like (n,) or name of a column, optional
        How much each sample counts: the inverse variance of its error, up to a factor.
    periods : sequence of float, optional
        Period of every axis, None or 0 for axes that are not periodic: ``[360, None]`` for longitude and latitude.
    sphere : bool or (int, int), or names
        Which coordinates are longitude and latitude in degrees (True: the first two). Distances are then measured on
        the sphere, and neither the poles nor the date line matter. Gradients are per degree of longitude and latitude;
        divide the first by the cosine of the latitude for degrees of arc.
    drift : sequence of int, or names, optional
        Coordinates that are covariates, such as elevation: they enter linearly (universal kriging). They remain
        variables of the function, so they are needed wherever it is evaluated. The report has the coefficients,
        `drift`, and their standard deviations, `drift_deviations`.
    derivatives : array_like (n, d) or (n, k, d), optional
        Gradients at the points, as data (Hermite); NaN where unknown.
    faults : sequence of array_like (m, 2), optional
        Polylines in the plane across which the function may jump, for two coordinates.
    extrapolation : "auto", "constant", "linear", "trend" or "nan"
        Outside the box of the samples: "constant" keeps the value at the nearest point of the box, "linear" continues
        with its slope, "trend" returns to the trend of the samples (method "interpolate"; others as "linear"), "nan"
        gives NaN. "auto" with few samples is "trend" or "constant", whichever predicts the outermost samples better;
        with many it is "linear" for the usual distance between samples, then "constant".
    loss : "auto", "squares", "huber" or "student"
        How samples far from their neighbours count: "auto" leaves gross errors out and reports them, "squares" keeps
        all, "huber" and "student" give them less weight.
    transform : "auto", "none", "sqrt" or "log"
        Fit the values, their square roots or their logarithms, and transform the result back to means. "auto" uses
        roots or logarithms for non-negative amounts that vary more where they are larger, such as concentrations or
        rain, if that is much likelier: with 30 to 20,000 unweighted samples of up to three coordinates, and no other
        choice made. `report["transforms"]` has the result.
    missing : float, optional
        Value, such as -9999, of samples that have none: they are left out.
    scale_axes : bool
        Whether axes of different units may be scaled; False where all coordinates are lengths of one unit.
    standard_deviation : bool
        Provide standard deviations with every method: for methods without any, from a second fit by "auto". "auto",
        "partition-of-unity", "along-tracks" and "interpolate" (unless of more than 4000 samples with a compact kernel)
        have them in any case.
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

    With a table of pandas:

    >>> soundings = pandas.DataFrame({"x": x[:, 0], "y": x[:, 1], "depth": depth})  # doctest: +SKIP
    >>> csrbf.fit(soundings, "depth", coordinates=["x", "y"])(soundings)  # a Series  # doctest: +SKIP
    """
    samples = samples_of(points, values, coordinates, weights)
    given = fit_options(method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation)
    given["scale_axes"] = bool(scale_axes)
    given["standard_deviation"] = bool(standard_deviation)
    given["loss"] = loss
    given["transform"] = transform
    if missing is not None:
        given["missing"] = missing
    if periods is not None:
        given["periods"] = [period or 0.0 for period in np.atleast_1d(np.asarray(periods, dtype=object)).tolist()]
    d, names = samples.points.shape[1], samples.coordinate_names
    given["sphere"] = [0, 1] if sphere is True else _axes(sphere or (), "sphere", d, names)
    given["drift"] = _axes(drift, "drift", d, names)
    if len(faults) > 0:
        given["faults"] = [_in_the_plane(line) for line in faults]
    slopes = None if derivatives is None else _slopes(derivatives, samples)
    with listening(progress) as listener:
        function = Function(
            _csrbf.fit(samples.points, samples.values, samples.weights, slopes, given, listener), scalar=samples.scalar
        )
    function._describe(samples)
    return function


def _axes(axes: Sequence[int | str], name: str, d: int, names: list[str]) -> list[int]:
    """Coordinates by number, negative ones from the end, or by name."""
    given: list[Any] = [axes] if isinstance(axes, (int, str)) else list(axes)
    found = [names.index(axis) if axis in names else axis for axis in given]
    if not all(isinstance(axis, (int, np.integer)) and -d <= axis < d for axis in found):
        known = f", or of {', '.join(names)}" if names else ""
        raise ValueError(f"{name}: {axes!r}: must be numbers of coordinates, from 0 to {d - 1}{known}")
    return [int(axis) % d for axis in found]


def _slopes(derivatives: ArrayLike, samples: Samples) -> Floats:
    """Derivatives in rows of k x d."""
    slopes = floats(derivatives, "derivatives")
    n, d = samples.points.shape
    total = n if samples.kept is None else len(samples.kept)
    shape = (total, d) if samples.scalar else (total, samples.values.shape[1], d)
    if slopes.shape != shape:
        raise ValueError(f"derivatives: has shape {slopes.shape}; must be {shape}")
    kept = slopes if samples.kept is None else slopes[samples.kept]
    return np.ascontiguousarray(kept.reshape(n, -1))


def _in_the_plane(line: ArrayLike) -> Floats:
    places = rows(line, "faults")
    if places.shape[1] != 2:
        raise ValueError(f"faults: a line has shape {places.shape}; must be (m, 2), with the coordinates of its places")
    return places


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
