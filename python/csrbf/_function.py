import os

import numpy as np

from csrbf import _csrbf
from csrbf._arrays import floats, queries, rows, smoothing_or_none


class Function:
    """A smooth function of d variables with one value (`fit` to values (n,)) or k values (n, k).

    Points may come in an array of any shape (..., d); the same leading shape comes back.

    report: dict with what the fit did: the method and all options used, also those chosen automatically, the errors
    at the samples, the cross-validated error, times and warnings.
    """

    def __init__(self, function, scalar=None):
        self._function = function
        self._scalar = function.components == 1 if scalar is None else scalar
        self.report = function.report

    @property
    def dimension(self):
        """d, the number of variables."""
        return self._function.dimension

    @property
    def bounds(self):
        """Lower and upper corner of the box of the samples, (2, d)."""
        return self._function.bounds

    def __call__(self, x):
        """Values at points (m, d): (m,), or (m, k)."""
        return self._evaluate(x, 0)

    def gradient(self, x):
        """Gradients at points (m, d): (m, d), or (m, k, d)."""
        return self._evaluate(x, 1)

    def hessian(self, x):
        """Matrices of second derivatives at points (m, d): (m, d, d), or (m, k, d, d)."""
        return self._evaluate(x, 2)

    def evaluate_grid(self, *axes):
        """Values at all nodes of a grid, given the coordinates along its d axes.

        evaluate_grid(x, y)[i, j] is the value at (x[i], y[j]), as with numpy's meshgrid(x, y, indexing="ij"): shape
        (nx, ny), or (nx, ny, k). Several times faster than calling the function at the nodes.
        """
        if len(axes) != self.dimension:
            raise ValueError(f"evaluate_grid: {len(axes)} axes were given; the function has {self.dimension} variables")
        axes = [floats(np.ravel(axis), "axes") for axis in axes]
        shape = tuple(len(axis) for axis in axes)
        values = self._function.evaluate_grid(axes)  # (k, nodes), the first axis the fastest
        grid = np.moveaxis(values.reshape((-1,) + shape[::-1]), 0, -1)
        grid = np.transpose(grid, tuple(range(len(shape)))[::-1] + (len(shape),))
        return grid[..., 0] if self._scalar else grid

    def standard_deviation(self, x):
        """Standard deviations at points (m, d) of the difference between a sample there and the value: (m,), or (m, k).

        They hold the error of the function and the noise of the values. Of the method "interpolate" they are 0 (or that
        of the noise) at the samples and grow between them; of "partition-of-unity" they are local errors of
        cross-validation. NaN outside the box of the samples. ValueError for the other methods.
        """
        x, shape = queries(x, self.dimension)
        result = self._function.standard_deviation(x)
        result = result[:, 0] if self._scalar else result
        return result.reshape(shape + result.shape[1:])

    def save(self, path):
        """Writes a .csrbf file for `load` and the program csrbf."""
        self._function.save(os.fspath(path))

    def _evaluate(self, x, order):
        x, shape = queries(x, self.dimension)
        result = self._function.evaluate(x, order)[order]
        result = result[:, 0] if self._scalar else result
        return result.reshape(shape + result.shape[1:])

    def __reduce__(self):
        return _restore, (self._function.to_bytes(), self._scalar)

    def __repr__(self):
        values = "one value" if self._scalar else f"{self._function.components} values"
        return f"<csrbf.Function of {self.dimension} variables, {values}, method {self.report['method']}>"


def _restore(content, scalar):
    return Function(_csrbf.Function.from_bytes(content), scalar)


def fit(
    points,
    values,
    method="auto",
    tolerance=None,
    centers=None,
    smoothing="auto",
    *,
    kernel="auto",
    kernel_parameter=None,
    degree=None,
    weights=None,
    periods=None,
    extrapolation="constant",
    scale_axes=True,
    progress=None,
):
    """A smooth function through, or under noise near, scattered samples.

    points: (n, d), any order, d from 1 to 6. values: (n,) or (n, k).
    method: "auto", "interpolate", "least-squares", "partition-of-unity", "multilevel", "pca-multiresolution",
        "fixed-budget", "error-bounded" or "moving-least-squares".
    tolerance: largest error allowed at any sample, in the unit of the values.
    centers: largest number of radial basis functions.
    smoothing: "auto" chooses by cross-validation, "none" interpolates, a number is taken as it is.
    kernel, kernel_parameter, degree: of the radial basis functions and of the polynomials; chosen when not given.
    weights: (n,), how much each sample counts: the inverse variance of its error, up to a factor.
    periods: period of every axis, None or 0 for axes that are not periodic: [360, None] for longitude and latitude.
    extrapolation: outside the box of the samples "constant" gives the value at the nearest point of the box, "nan"
        gives NaN.
    scale_axes: whether axes of different units may be scaled; False where all coordinates are lengths of one unit.
    progress: called as progress(stage, fraction) from time to time; what it raises ends the fit.
    """
    points = rows(points, "points")
    values = floats(values, "values")
    if values.ndim not in (1, 2) or len(values) != len(points):
        raise ValueError(f"values: has shape {values.shape}; must be ({len(points)},) or ({len(points)}, k)")
    if extrapolation not in ("constant", "nan"):
        raise ValueError(f'extrapolation: "{extrapolation}" is neither "constant" nor "nan"')
    options = {
        "method": method,
        "kernel": kernel,
        "kernel_parameter": kernel_parameter,
        "centers": centers,
        "tolerance": tolerance,
        "smoothing": smoothing_or_none(smoothing),
        "degree": degree,
        "periods": None if periods is None else [period or 0.0 for period in np.atleast_1d(periods).tolist()],
        "nan_outside": extrapolation == "nan",
        "scale_axes": bool(scale_axes),
    }
    given = {name: value for name, value in options.items() if value is not None}
    if weights is not None:
        weights = floats(weights, "weights")
    table = values if values.ndim == 2 else values.reshape(-1, 1)
    if progress is not None and not callable(progress):
        raise ValueError("progress: must be a function of stage and fraction")
    return Function(_csrbf.fit(points, table, weights, given, progress), scalar=values.ndim == 1)
