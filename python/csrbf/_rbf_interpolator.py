from __future__ import annotations

import warnings
from itertools import combinations_with_replacement
from math import comb
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, floats, numbers
from csrbf._options import InterpolatorKernel


class SingularSystem(_csrbf.SolverFailure, np.linalg.LinAlgError):
    """The system of an interpolant is singular."""


def _points(array: ArrayLike, name: str) -> Floats:
    """Points in rows, refused in the words of SciPy."""
    points = floats(array, name)
    if points.ndim != 2:
        raise ValueError(
            f"`{name}` must be a 2-dimensional array. It has shape {points.shape}: give one point per row, as (n, dim)"
        )
    return points


class RBFInterpolator:
    """Interpolation by a radial basis function at every data point and a polynomial, with the arguments, conventions
    and results of the SciPy class of this name.

    Prefer `fit` for large or noisy data: it is smooth everywhere, needs no parameters and costs O(n).

    Parameters
    ----------
    y : array_like (n, dim)
        Data points, of any dimension.
    d : array_like (n, ...)
        Values, real or complex.
    neighbors : int, optional
        Every evaluation uses only this many nearest data points; all when not given. Systems shared by several
        evaluation points are solved once.
    smoothing : float or array_like (n,)
        Added to the diagonal of the system. 0 interpolates.
    kernel : str
        "linear", "thin_plate_spline", "cubic", "quintic", "multiquadric", "inverse_multiquadric", "inverse_quadratic",
        "gaussian", or any other kernel of csrbf, such as "wendland-c2" or "matern-c4".
    epsilon : float, optional
        Kernels are functions of epsilon times distance; required unless scaling the distance makes no difference
        (linear, thin_plate_spline, cubic, quintic).
    degree : int, optional
        Degree of the polynomial, -1 for none. Default: the smallest with which the kernel is well-posed, at least 0.

    Attributes
    ----------
    y, d, d_shape, d_dtype, neighbors, smoothing, kernel, epsilon, powers
        As in SciPy: the arguments, with complex values as twice as many columns, and the exponents of the monomials.

    Raises
    ------
    ValueError
        For invalid arguments.
    SolverFailure
        When the system is singular; here it is a numpy.linalg.LinAlgError as well.

    Examples
    --------
    >>> y = np.random.default_rng(0).random((60, 2))
    >>> f = csrbf.RBFInterpolator(y, np.exp(-y.sum(axis=1)))
    >>> bool(abs(f([[0.5, 0.5]])[0] - np.exp(-1)) < 0.01)
    True
    """

    def __init__(
        self,
        y: ArrayLike,
        d: ArrayLike,
        neighbors: float | None = None,
        smoothing: ArrayLike = 0.0,
        kernel: InterpolatorKernel = "thin_plate_spline",
        epsilon: float | None = None,
        degree: int | None = None,
    ) -> None:
        self.y = _points(y, "y")
        n, dimension = self.y.shape
        self.d_dtype: type = complex if np.iscomplexobj(d) else float
        given = numbers(_converted(d), "d", kinds="biufc")
        values: NDArray[Any] = np.ascontiguousarray(given, dtype=self.d_dtype)
        if given.ndim == 0 or len(values) != n:
            raise ValueError(
                f"Expected the first axis of `d` to have length {n}, that of `y`: it has shape {np.shape(d)}"
            )
        self.d_shape = values.shape[1:]
        # The real and imaginary parts of complex values are separate components.
        self.d: Floats = values.reshape(n, -1).view(float)
        diagonal = floats(smoothing, "smoothing")
        if diagonal.shape not in ((), (n,)):
            raise ValueError(
                f"Expected `smoothing` to be a scalar or have shape ({n},), one for each point: it has {diagonal.shape}"
            )
        self.smoothing: Floats = np.ascontiguousarray(np.broadcast_to(diagonal, n))
        self.kernel: str = kernel.lower()
        self.neighbors = None if neighbors is None else int(min(neighbors, n))
        if self.neighbors is not None and self.neighbors < 1:
            raise ValueError(f"neighbors: {neighbors} must be at least 1, or None for all")
        smallest = self._smallest_degree(dimension)
        if degree is not None:
            degree = self._checked_degree(int(degree), smallest)
        self._check_count(max(smallest, 0) if degree is None else degree)
        self._solve(None if epsilon is None else float(epsilon), degree)

    def __call__(self, x: ArrayLike) -> NDArray[Any]:
        """Values at points.

        Parameters
        ----------
        x : array_like (m, dim)

        Returns
        -------
        ndarray (m, ...)

        Raises
        ------
        ValueError
            For arrays of another shape.

        Examples
        --------
        >>> f = csrbf.RBFInterpolator([[0.0], [1.0], [3.0]], [1.0, 2.0, 4.0])
        >>> f([[2.0], [5.0]]).round(6)
        array([3., 6.])
        """
        x = _points(x, "x")
        if x.shape[1] != self.y.shape[1]:
            raise ValueError(
                f"Expected the second axis of `x` to have length {self.y.shape[1]}, that of `y`: it has shape {x.shape}"
            )
        try:
            values: NDArray[Any] = self._interpolant.evaluate(x)
        except _csrbf.SolverFailure as error:
            raise self._singular(error) from None
        found: NDArray[Any] = values[:, : self.d.shape[1]].view(self.d_dtype)
        return found.reshape((len(x),) + self.d_shape)

    def _smallest_degree(self, dimension: int) -> int:
        try:
            return _csrbf.RbfInterpolator.smallest_degree(self.kernel, dimension)
        except ValueError as error:
            raise ValueError(f"`kernel` must be one of those that there are: {error}") from None

    def _checked_degree(self, degree: int, smallest: int) -> int:
        if -1 <= degree < smallest:
            warnings.warn(
                f"`degree` should not be below {smallest} when `kernel` is '{self.kernel}': with {degree} the system "
                "may be singular, and smoothing may not smooth",
                UserWarning,
                stacklevel=3,
            )
        return degree

    def _check_count(self, degree: int) -> None:
        """Are there as many points as the polynomial has coefficients?"""
        n, dimension = self.y.shape
        needed = comb(degree + dimension, dimension) if degree >= 0 else 0
        found = n if self.neighbors is None else self.neighbors
        if found < needed:
            raise ValueError(
                f"At least {needed} data points are required when `degree` is {degree} and the number of dimensions is "
                f"{dimension}; there are {found}"
            )

    def _singular(self, error: Exception) -> SingularSystem:
        """What is wrong with a system without solution."""
        centred = self.y - self.y.mean(axis=0)
        unit = np.abs(centred).max(initial=0.0) or 1.0
        monomials = np.prod((centred / unit)[:, None, :] ** self._powers(), axis=2)
        rank, count = int(np.linalg.matrix_rank(monomials)), monomials.shape[1]
        if rank == count:
            return SingularSystem(*error.args)
        return SingularSystem(
            f"The matrix of the monomials at the data points does not have full column rank ({rank}/{count}): the "
            "points are on a line, a plane or the like; choose a lower degree"
        )

    def _powers(self) -> NDArray[Any]:
        """Exponents of the monomials, also before the system is solved."""
        dimension = self.y.shape[1]
        degree = max(self._smallest_degree(dimension), 0) if self._degree is None else self._degree
        unit = np.eye(dimension, dtype=int)
        factors = [axes for total in range(degree + 1) for axes in combinations_with_replacement(range(dimension), total)]
        return np.array([unit[list(axes)].sum(axis=0) for axes in factors], dtype=int).reshape(-1, dimension)

    def _solve(self, epsilon: float | None, degree: int | None) -> None:
        self._degree = degree
        # The library needs a value, even when the shape of d has none.
        values = self.d if self.d.size > 0 else np.zeros((len(self.y), 1))
        try:
            self._interpolant = _csrbf.RbfInterpolator(
                self.y, values, self.neighbors or 0, self.smoothing, self.kernel, epsilon, degree
            )
        except _csrbf.SolverFailure as error:
            raise self._singular(error) from None
        except ValueError as error:
            if epsilon is None and "epsilon" in str(error):
                raise ValueError(f"`epsilon` must be specified if `kernel` is not scale invariant: {error}") from None
            raise
        self.epsilon = self._interpolant.epsilon
        self.powers = self._interpolant.powers

    def __getstate__(self) -> dict[str, Any]:
        state = self.__dict__.copy()
        interpolant = state.pop("_interpolant")
        state["degree"] = interpolant.degree
        state["coefficients"] = interpolant.coefficients if self.neighbors is None else None
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        degree = state.pop("degree")
        coefficients = state.pop("coefficients")
        self.__dict__.update(state)
        if coefficients is None:
            self._solve(self.epsilon, degree)
        else:
            self._interpolant = _csrbf.RbfInterpolator.restore(
                self.y, coefficients, self.smoothing, self.kernel, self.epsilon, degree
            )


def _converted(d: ArrayLike) -> ArrayLike:
    """Objects as floats, as in SciPy, when all are numbers."""
    if isinstance(d, np.ma.MaskedArray) or np.asarray(d).dtype != object:
        return d
    try:
        return np.asarray(d, dtype=float)
    except (TypeError, ValueError):
        return d
