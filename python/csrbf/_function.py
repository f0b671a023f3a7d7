from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, floats, whole
from csrbf._labels import Labelled, Places
from csrbf._options import DeviationOf, Extrapolation
from csrbf._samples import Samples
from csrbf._show import Page, Panel, Shown

if TYPE_CHECKING:
    from csrbf._surface import Surface

_MOST_SAMPLES = 2000  # kept for pictures; more would hide what they lie on


class Function(Shown):
    """A smooth function of d variables, with one value or k values at every point.

    Functions come from `fit`, `load` and `Segmentation.field`. Points may be an array of any shape (..., d); results
    have the same leading shape. For one variable they may also be plain numbers, in an array of any shape whose last
    axis is not 1. A pandas DataFrame, whose columns have the names of the coordinates, gives a Series or DataFrame with
    the same index; the grid of an xarray DataArray gives a DataArray, or a Dataset for several columns. The result for
    a masked array of points is masked where these are. Functions can be pickled.

    Attributes
    ----------
    report : dict
        What the fit did: the method and all options used, given or chosen, errors at the samples, cross-validation
        error, times and warnings.
    samples : tuple of ndarray (m, d) and (m, k), or None
        Samples of the fit for pictures, at most 2000, evenly chosen; None for functions loaded from a file.

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
    samples: tuple[Floats, Floats] | None

    def __init__(self, function: _csrbf.Function, scalar: bool | None = None) -> None:
        self._function = function
        self._scalar = function.components == 1 if scalar is None else scalar
        self.report = function.report
        self.samples = None

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
        """Lower and upper corner of the bounding box of the samples, (2, d).

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).bounds
        array([[0.],
               [2.]])
        """
        return self._function.bounds

    @property
    def coordinate_names(self) -> list[str]:
        """Names of the variables: those of the table or file that was fitted, else x, y, z, or x1, x2, ...

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).coordinate_names
        ['x']
        """
        d = self.dimension
        return self._function.coordinate_names or (list("xyz"[:d]) if d <= 3 else [f"x{i + 1}" for i in range(d)])

    @property
    def value_names(self) -> list[str]:
        """Names of the values: those of the table or file that was fitted, else value, or value1, value2, ...

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).value_names
        ['value']
        """
        k = self._function.components
        return self._function.value_names or (["value"] if k == 1 else [f"value{i + 1}" for i in range(k)])

    @overload
    def __call__(self, x: Labelled) -> Any: ...
    @overload
    def __call__(self, x: ArrayLike) -> Floats: ...
    def __call__(self, x: Any) -> Any:
        """Values at points.

        Parameters
        ----------
        x : array_like (..., d), DataFrame or DataArray

        Returns
        -------
        ndarray (...) or (..., k), or the kind of `x`

        Raises
        ------
        ValueError
            If the last axis of `x` has another length than d.

        Examples
        --------
        >>> f = csrbf.fit([0.0, 1.0, 2.0], [0.0, 1.0, 4.0])
        >>> f([0.0, 2.0]).round(6)
        array([0., 4.])
        """
        return self._evaluate(x, 0)

    @overload
    def gradient(self, x: Labelled) -> Any: ...
    @overload
    def gradient(self, x: ArrayLike) -> Floats: ...
    def gradient(self, x: Any) -> Any:
        """Gradients at points, by exact differentiation.

        Parameters
        ----------
        x : array_like (..., d), DataFrame or DataArray

        Returns
        -------
        ndarray (..., d) or (..., k, d), or the kind of `x`
            For a table, the columns have names such as value_x and value_y.

        Examples
        --------
        >>> x = np.random.default_rng(0).random((100, 2))
        >>> f = csrbf.fit(x, x[:, 0] * x[:, 1])
        >>> f.gradient([0.3, 0.5]).round(3)
        array([0.5, 0.3])
        """
        return self._evaluate(x, 1)

    @overload
    def hessian(self, x: Labelled) -> Any: ...
    @overload
    def hessian(self, x: ArrayLike) -> Floats: ...
    def hessian(self, x: Any) -> Any:
        """Matrices of second derivatives at points.

        Parameters
        ----------
        x : array_like (..., d), DataFrame or DataArray

        Returns
        -------
        ndarray (..., d, d) or (..., k, d, d), or the kind of `x`
            For a table, the columns have names such as value_x_x, value_x_y and value_y_y.

        Examples
        --------
        >>> x = np.random.default_rng(0).random((500, 2))
        >>> f = csrbf.fit(x, x[:, 0] * x[:, 1], kernel="quintic")
        >>> abs(f.hessian([0.3, 0.5]) - [[0, 1], [1, 0]]).max() < 0.01
        True
        """
        return self._evaluate(x, 2)

    def evaluate_grid(self, *axes: ArrayLike, dtype: DTypeLike = np.float64) -> NDArray[Any]:
        """Values at all nodes of a rectilinear grid, several times faster than evaluating them as points.

        Parameters
        ----------
        *axes : d arrays (n1,), (n2,), ...
            Coordinates of the nodes along each axis.
        dtype : numpy.float64 or numpy.float32
            Type of the values. float32 values are rounded and need half the memory.

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

    @overload
    def standard_deviation(self, x: Labelled, of: DeviationOf = "sample") -> Any: ...
    @overload
    def standard_deviation(self, x: ArrayLike, of: DeviationOf = "sample") -> Floats: ...
    def standard_deviation(self, x: Any, of: DeviationOf = "sample") -> Any:
        """Standard deviations of the error of the function, with or without the noise of a sample.

        With the method "interpolate" they are 0, or that of the noise, at the samples and grow with the distance to
        them. With "partition-of-unity" they are local cross-validation errors, which grow in gaps and outside the box
        of the samples.

        Parameters
        ----------
        x : array_like (..., d), DataFrame or DataArray
        of : "sample" or "function"
            "sample": of the difference between a new sample and the function; "function": without the noise of the
            sample.

        Returns
        -------
        ndarray (...) or (..., k), or the kind of `x`
            For a table, the columns have names such as value_standard_deviation.

        Raises
        ------
        ValueError
            If the fit has no standard deviations, and for "function" if the noise is unknown.

        Examples
        --------
        >>> f = csrbf.fit([[0.0], [1.0], [2.0], [4.0]], [0.0, 1.0, 4.0, 0.0], kernel="matern-c2", smoothing="none")
        >>> at_sample, between = f.standard_deviation([[1.0], [3.0]])
        >>> bool(at_sample < 0.01 * between)
        True
        """
        places = self._places(x)
        result = self._function.standard_deviation(places.rows, of)
        names = [f"{value}_standard_deviation" for value in self.value_names]
        return places.like_given(result[:, 0] if self._scalar else result, names)

    def covered(self, x: Any, mask: str = "hull") -> Any:
        """Whether points are in the convex hull of the samples, or within a distance from one of them.

        Parameters
        ----------
        x : array_like (..., d)
        mask : "hull" or "distance:D"
            On a sphere D is in degrees and "hull" is not available.

        Returns
        -------
        ndarray of bool (...)

        Raises
        ------
        ValueError
            For the hull in more than three variables, functions with a drift, and old model files.

        Examples
        --------
        >>> f = csrbf.fit([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.3]], [0.0, 1.0, 4.0, 2.0])
        >>> f.covered([[0.2, 0.2], [0.9, 0.9]])
        array([ True, False])
        """
        places = self._places(x)
        return places.like_given(self._function.covered(places.rows, mask), ["covered"])

    def level_lines(
        self,
        levels: ArrayLike | None = None,
        *,
        step: float | None = None,
        resolution: int | None = None,
        mask: str | None = None,
    ) -> list[tuple[float, Floats]]:
        """The contour lines of a function of two variables, in the box of its samples.

        Parameters
        ----------
        levels : array_like, optional
            Values whose lines are wanted, in ascending order. By default multiples of `step`.
        step : float, optional
            By default 1, 2 or 5 times a power of ten, which makes 4 to 11 levels.
        resolution : int, optional
            Cells of the grid along the longest side of the box, on whose edges lines are found; 32 to 2048 by the
            smallest detail of the function when not given. Points are on the lines to about 1e-7 of a cell.
        mask : "hull" or "distance:D", optional
            Lines end where `covered` is False.

        Returns
        -------
        list of (level, ndarray (m, 2))
            Line after line, with higher values on its left. The last point of a closed line is its first.

        Raises
        ------
        ValueError
            For functions of other than two variables or of several values, and levels that are not ascending.

        Examples
        --------
        >>> x = np.random.default_rng(0).random((400, 2))
        >>> f = csrbf.fit(x, np.hypot(x[:, 0], x[:, 1]))
        >>> ((level, line),) = f.level_lines([0.5])
        >>> bool(np.abs(np.hypot(line[:, 0], line[:, 1]) - level).max() < 0.01)
        True
        """
        given = [] if levels is None else floats(np.ravel(np.asarray(levels, dtype=float)), "levels").tolist()
        cells = 0 if resolution is None else whole(resolution, "resolution")
        return self._function.level_lines(given, 0.0 if step is None else float(step), cells, mask or "")

    def extrapolated(self, extrapolation: Extrapolation) -> Function:
        """The same function with other values outside the box of the samples.

        Parameters
        ----------
        extrapolation : "constant", "linear", "trend" or "nan"
            See `fit`.

        Returns
        -------
        Function

        Examples
        --------
        >>> f = csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 2.0])
        >>> f.extrapolated("linear")([3.0]).round(1)
        3.0
        """
        function = Function(self._function.extrapolated(extrapolation), self._scalar)
        function.report, function.samples = self.report, self.samples
        return function

    def to_surface(self) -> Surface:
        """The surface f = 0 of a function of three variables with one value, as of a segmentation; f > 0 is inside.

        Returns
        -------
        Surface

        Raises
        ------
        ValueError
            For other numbers of variables or values.

        Examples
        --------
        >>> z, y, x = np.mgrid[:20, :20, :20]
        >>> ball = np.where((x - 10) ** 2 + (y - 9) ** 2 + (z - 9) ** 2 < 36, 10.0, 1.0)
        >>> csrbf.segment(ball).field.save("ball.csrbf")
        >>> csrbf.load("ball.csrbf").to_surface().polygonize().topology["watertight"]
        True
        """
        from csrbf._surface import Surface

        return Surface(_csrbf.surface_of(self._function))

    def save(self, path: Path) -> None:
        """Write a .csrbf file, which `load` and the csrbf program can read.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        IoError
            If the file cannot be written; no partial file remains.

        Examples
        --------
        >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).save("parabola.csrbf")
        """
        self._function.save(os.fspath(path))

    def plot(
        self,
        ax: Any = None,
        *,
        variables: Sequence[str | int] | None = None,
        at: ArrayLike | None = None,
        component: int = 0,
        deviation: bool = False,
        samples: bool = True,
        resolution: int = 200,
    ) -> Any:
        """Draw the function and its samples with matplotlib: a curve of one variable, or a map of two.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on; new ones by default.
        variables : one or two names or numbers, optional
            The variables to draw; by default the first two.
        at : array_like (d,), optional
            A point with the values of the other variables; by default the middle of the samples.
        component : int
            Which of several values to draw, from 0.
        deviation : bool
            Whether to draw a band of two standard deviations around a curve, or a map of the standard deviation.
        samples : bool
            Whether to draw the samples, if the function has no other variables than those drawn.
        resolution : int
            Number of nodes along each variable.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> x = np.random.default_rng(0).random((100, 2))
        >>> csrbf.fit(x, x[:, 0] * x[:, 1]).plot()  # doctest: +SKIP
        <Axes: xlabel='x', ylabel='y'>
        """
        from csrbf._plots import axes_for, plot_function

        names = self.coordinate_names
        given = names[:2] if variables is None else variables
        chosen = [names.index(v) if isinstance(v, str) and v in names else v for v in given]
        if len(chosen) not in (1, 2) or not all(isinstance(v, int) and 0 <= v < len(names) for v in chosen):
            raise ValueError(f"variables: {list(given)} must be one or two of {', '.join(names)}, or their numbers")
        if not 0 <= component < len(self.value_names):
            raise ValueError(f"component: {component} must be from 0 to {len(self.value_names) - 1}")
        place = self.bounds.mean(axis=0) if at is None else floats(at, "at")
        if place.shape != (self.dimension,):
            raise ValueError(f"at: has shape {place.shape}; must have one value for each variable, ({self.dimension},)")
        numbers = [int(v) for v in chosen]
        return plot_function(self, axes_for(ax), numbers, place, component, deviation, samples, whole(resolution, "resolution"))

    def _page(self, large: bool) -> Page:
        from csrbf._landscape import landscape_panel
        from csrbf._plots import plot_picture

        report = self.report
        facts = {"method": str(report["method"]), "samples": f"{report['samples']:,}"}
        for name, text in {"rmse": "rms error at samples", "cross_validation_rmse": "cross-validation error"}.items():
            if report.get(name) is not None and np.isfinite(report[name]):
                facts[text] = f"{report[name]:.3g}"
        low, high = self.bounds
        facts |= {name: f"{a:.3g} to {b:.3g}" for name, a, b in zip(self.coordinate_names, low, high)}
        picture = plot_picture(lambda ax: self.plot(ax, resolution=150))
        caption = "The first value." if len(self.value_names) > 1 else ""
        if self.dimension > 2:
            others = zip(self.coordinate_names[2:], self.bounds.mean(axis=0)[2:])
            caption = (caption + " At " + ", ".join(f"{name} = {value:.4g}" for name, value in others) + ".").strip()
        panels = [] if picture is None else [Panel(picture, caption)]
        if self.dimension == 2 and (large or picture is None):
            panels.append(landscape_panel(self))
        notes = [] if panels else ["Install matplotlib to see a plot here."]
        return Page(", ".join(self.value_names[:3]), facts, panels, list(report.get("warnings", [])) + notes)

    def _describe(self, samples: Samples) -> None:
        """Keeps what the compiled function does not know about its samples."""
        self._function.coordinate_names = samples.coordinate_names
        self._function.value_names = samples.value_names
        if samples.kept is not None:
            self.report = self._function.report_of_rows(np.flatnonzero(samples.kept).tolist())
            self.report["missing"] += samples.left_out
        shown = np.linspace(0, len(samples.points) - 1, min(len(samples.points), _MOST_SAMPLES)).astype(int)
        self.samples = samples.points[shown], samples.values[shown]

    def _places(self, x: Any) -> Places:
        places = Places(x, self.coordinate_names, given=bool(self._function.coordinate_names))
        if self._function.sphere:
            latitudes = places.rows[:, self._function.sphere[1]]
            beyond = latitudes[np.abs(latitudes) > 90]
            if len(beyond) > 0:
                order = ", ".join(self.coordinate_names)
                raise ValueError(f"x: the latitude {beyond[0]:g} is beyond 90 degrees; the coordinates are {order}")
        return places

    def _evaluate(self, x: Any, order: int) -> Any:
        places = self._places(x)
        values = self._function.evaluate(places.rows, order)[order]
        result = values[:, 0] if self._scalar else values
        if order == 2 and places.labelled:
            result = result[..., np.triu(np.ones((self.dimension, self.dimension), dtype=bool))]
        return places.like_given(result, self._columns(order))

    def _columns(self, order: int) -> list[str]:
        """Names of the values, or of their derivatives of first or second order."""
        axes = self.coordinate_names
        ends = [""] if order == 0 else [f"_{axis}" for axis in axes]
        if order == 2:
            ends = [f"_{first}_{second}" for a, first in enumerate(axes) for second in axes[a:]]
        return [value + end for value in self.value_names for end in ends]

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self._function.to_bytes(), self._scalar, self.report, self.samples)

    def __repr__(self) -> str:
        values = "one value" if self._scalar else f"{self._function.components} values"
        variables = "one variable" if self.dimension == 1 else f"{self.dimension} variables"
        return f"<csrbf.Function of {variables}, {values}, method {self.report['method']}>"


def _restore(
    content: bytes, scalar: bool, report: dict[str, Any], samples: tuple[Floats, Floats] | None
) -> Function:
    function = Function(_csrbf.Function.from_bytes(content), scalar)
    function.report, function.samples = report, samples
    return function
