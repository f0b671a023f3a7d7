from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, floats, queries


class Function:
    """A smooth function of d variables, with one value or k values at every point.

    Functions come from `fit`, `load` and `Segmentation.field`. Points may be given in an array of any shape
    (..., d); results have the same leading shape. Functions can be pickled.

    Attributes
    ----------
    report : dict
        What the fit did: the method and all options used, including those chosen automatically, the errors at the
        samples, the cross-validation error, times and warnings.

    Examples
    --------
    >>> x = np.random.default_rng(0).random((100, 2))
    >>> f = csrbf.fit(x, x[:, 0] * x[:, 1])
    >>> f
    <csrbf.Function of 2 variables, one value, method interpolate>
    >>> f([0.5, 0.5]).round(3)
    0.25
    """

    report: dict[str, Any]

    def __init__(self, function: _csrbf.Function, scalar: bool | None = None) -> None:
        self._function = function
        self._scalar = function.components == 1 if scalar is None else scalar
        self.report = function.report

    @property
    def dimension(self) -> int:
        """d, the number of variables.

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).dimension
        1
        """
        return self._function.dimension

    @property
    def bounds(self) -> Floats:
        """Lower and upper corner of the box of the samples, (2, d).

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).bounds
        array([[0.],
               [2.]])
        """
        return self._function.bounds

    def __call__(self, x: ArrayLike) -> Floats:
        """Values at points.

        Parameters
        ----------
        x : array_like (..., d)

        Returns
        -------
        ndarray (...) or (..., k)

        Raises
        ------
        ValueError
            When the last axis of `x` has another length.

        Examples
        --------
        >>> f = csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0])
        >>> f([[0.0], [2.0]]).round(6)
        array([0., 4.])
        """
        return self._evaluate(x, 0)

    def gradient(self, x: ArrayLike) -> Floats:
        """Gradients at points, exact derivatives of the function.

        Parameters
        ----------
        x : array_like (..., d)

        Returns
        -------
        ndarray (..., d) or (..., k, d)

        Examples
        --------
        >>> x = np.random.default_rng(0).random((100, 2))
        >>> f = csrbf.fit(x, x[:, 0] * x[:, 1])
        >>> f.gradient([0.3, 0.5]).round(3)
        array([0.5, 0.3])
        """
        return self._evaluate(x, 1)

    def hessian(self, x: ArrayLike) -> Floats:
        """Matrices of second derivatives at points.

        Parameters
        ----------
        x : array_like (..., d)

        Returns
        -------
        ndarray (..., d, d) or (..., k, d, d)

        Examples
        --------
        >>> x = np.random.default_rng(0).random((500, 2))
        >>> f = csrbf.fit(x, x[:, 0] * x[:, 1], kernel="quintic")
        >>> abs(f.hessian([0.3, 0.5]) - [[0, 1], [1, 0]]).max() < 0.01
        True
        """
        return self._evaluate(x, 2)

    def evaluate_grid(self, *axes: ArrayLike, dtype: DTypeLike = np.float64) -> NDArray[Any]:
        """Values at all nodes of a grid, several times faster than a call with the nodes.

        Parameters
        ----------
        *axes : d arrays (n1,), (n2,), ...
            Coordinates along the axes.
        dtype : numpy.float64 or numpy.float32
            Type of the values. Single precision, to which they are rounded, needs half the memory.

        Returns
        -------
        ndarray (n1, n2, ...) or (n1, n2, ..., k)
            The value at (axes[0][i], axes[1][j], ...) has index i, j, ..., as with numpy's
            ``meshgrid(..., indexing="ij")``.

        Examples
        --------
        >>> x = np.random.default_rng(0).random((100, 2))
        >>> f = csrbf.fit(x, x[:, 0] + 2 * x[:, 1])
        >>> f.evaluate_grid([0.2, 0.4], [0.1, 0.3, 0.5]).round(3)
        array([[0.4, 0.8, 1.2],
               [0.6, 1. , 1.4]])
        """
        if len(axes) != self.dimension:
            raise ValueError(f"evaluate_grid: {len(axes)} axes were given; the function has {self.dimension} variables")
        flat = [floats(np.ravel(axis), "axes") for axis in axes]
        values: NDArray[Any]
        if np.dtype(dtype) == np.float64:
            values = self._function.evaluate_grid(flat)
        elif np.dtype(dtype) == np.float32:
            values = self._function.evaluate_grid_float32(flat)
        else:
            raise ValueError(f"evaluate_grid: dtype = {np.dtype(dtype)}: must be float64 or float32")
        shape = tuple(len(axis) for axis in flat)
        values = values.reshape(shape[::-1] + values.shape[1:])  # the first axis is the fastest
        grid = np.transpose(values, tuple(range(len(shape)))[::-1] + (len(shape),))
        return grid[..., 0] if self._scalar else grid

    def standard_deviation(self, x: ArrayLike, of: str = "sample") -> Floats:
        """Standard deviations of the difference between a sample, or the function, and the value there.

        Those of a sample include the error of the function and the noise of the values. With the method "interpolate"
        they are 0 (or that of the noise) at the samples and grow with the distance to them; with "partition-of-unity"
        they are local cross-validation errors, and grow in gaps and outside the box of the samples.

        Parameters
        ----------
        x : array_like (..., d)
        of : "sample" or "function"
            With the noise of a sample, or without it.

        Returns
        -------
        ndarray (...) or (..., k)

        Raises
        ------
        ValueError
            For functions of other methods, and without the noise where it is unknown.

        Examples
        --------
        >>> f = csrbf.fit([[0.0], [1.0], [2.0], [4.0]], [0.0, 1.0, 4.0, 0.0], kernel="matern-c2", smoothing="none")
        >>> at_sample, between = f.standard_deviation([[1.0], [3.0]])
        >>> bool(at_sample < 0.01 * between)
        True
        """
        x, shape = queries(x, self.dimension)
        result = self._function.standard_deviation(x, of)
        result = result[:, 0] if self._scalar else result
        return result.reshape(shape + result.shape[1:])

    def save(self, path: Path) -> None:
        """Write a .csrbf file, which `load` and the program csrbf read.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        IoError
            When the file cannot be written; no partial file is left.

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).save("parabola.csrbf")
        """
        self._function.save(os.fspath(path))

    def _evaluate(self, x: ArrayLike, order: int) -> Floats:
        x, shape = queries(x, self.dimension)
        result = self._function.evaluate(x, order)[order]
        result = result[:, 0] if self._scalar else result
        return result.reshape(shape + result.shape[1:])

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self._function.to_bytes(), self._scalar)

    def __repr__(self) -> str:
        values = "one value" if self._scalar else f"{self._function.components} values"
        variables = "one variable" if self.dimension == 1 else f"{self.dimension} variables"
        return f"<csrbf.Function of {variables}, {values}, method {self.report['method']}>"


def _restore(content: bytes, scalar: bool) -> Function:
    return Function(_csrbf.Function.from_bytes(content), scalar)
