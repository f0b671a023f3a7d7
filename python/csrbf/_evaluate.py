from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf._arrays import Floats, Path, floats
from csrbf._function import Function
from csrbf._image import as_image
from csrbf._labels import Labelled, Places, is_data_array, is_dataset
from csrbf._load import load
from csrbf._options import DeviationOf, Extrapolation
from csrbf._surface import Surface

if TYPE_CHECKING:
    from csrbf._image import ImageLike


def evaluate(
    model: Function | Surface | Path,
    points: ArrayLike | Labelled | None = None,
    *,
    grid: int | Sequence[int] | None = None,
    bounds: ArrayLike | None = None,
    like: ImageLike | Labelled | None = None,
    gradient: bool = False,
    hessian: bool = False,
    standard_deviation: bool = False,
    deviation_of: DeviationOf = "sample",
    labels: bool = False,
    mask: str | None = None,
    extrapolation: Extrapolation | None = None,
) -> Any:
    """Evaluate a model, and its derivatives, at points, at the nodes of a grid or at the voxels of an image.

    Parameters
    ----------
    model : Function, Surface or file name
    points : array_like (..., d) or DataFrame, optional
        The columns of a table have the names of the coordinates of the model.
    grid : int or sequence of int, optional
        Instead of points: number of nodes along x, y (and z).
    bounds : array_like (d, 2), optional
        First and last node of the grid along each axis; by default the box of the samples.
    like : Image, array_like, DataArray or file name, optional
        Instead of points: the centres of the voxels of this image, or the coordinates of an xarray object, whose names
        are those of the coordinates of the model.
    gradient, hessian, standard_deviation : bool
        Whether to append the gradient, the upper triangle of the Hessian, and the standard deviation.
    deviation_of : "sample" or "function"
        "sample": the standard deviation includes the noise of a sample; "function": it does not.
    labels : bool
        Labels instead of values: 1 where a single component is positive; for several, the number of the largest, from
        0.
    mask : "hull" or "distance:D", optional
        Values are NaN outside the convex hull of the samples, or farther than D from all of them (on a sphere in
        degrees).
    extrapolation : "constant", "linear", "trend" or "nan", optional
        Values outside the box of the samples, instead of what `fit` was given.

    Returns
    -------
    ndarray (..., columns), or (...) for one column; DataFrame, Series, Dataset or DataArray
        For points (m, ...); for a grid or image [y, x] or [z, y, x], indexed as images are. The columns are the k
        values, then the derivatives value by value (k x d for the gradient), then the standard deviations.

    Raises
    ------
    ValueError
        Unless exactly one of `points`, `grid` and `like` is given; for a `grid` of a model with covariates.

    Examples
    --------
    >>> x = np.random.default_rng(0).random((100, 2))
    >>> f = csrbf.fit(x, x[:, 0] * x[:, 1])
    >>> csrbf.evaluate(f, [[0.5, 0.5], [0.2, 0.5]], gradient=True).round(2)
    array([[0.25, 0.5 , 0.5 ],
           [0.1 , 0.5 , 0.2 ]])
    >>> csrbf.evaluate(f, grid=(3, 2), bounds=[[0.2, 0.8], [0.4, 0.6]]).round(2)
    array([[0.08, 0.2 , 0.32],
           [0.12, 0.3 , 0.48]])
    """
    if (points is not None) + (grid is not None) + (like is not None) != 1:
        raise ValueError("evaluate: give one of points, grid and like: where to evaluate")
    if bounds is not None and grid is None:
        raise ValueError("bounds: needs grid")
    if labels and (gradient or hessian or standard_deviation):
        raise ValueError("labels: have no derivatives or deviations; leave those out")
    f = load(model) if isinstance(model, (str, os.PathLike)) else model
    if labels and mask is not None:
        raise ValueError("labels: have no number for none; leave mask out")
    if extrapolation is not None:
        f = _function(f, "extrapolation").extrapolated(extrapolation)
    d = f.dimension if isinstance(f, Function) else 3
    where: Any = points
    lines: list[Floats] = []
    if grid is not None:
        if isinstance(f, Function) and (drift := f.report["drift_axes"]):
            covariate = f.coordinate_names[drift[0]]
            raise ValueError(f"grid: does not tell the {covariate} of its nodes, a covariate of the model; give points")
        lines = _axes(f.bounds.T if bounds is None else floats(bounds, "bounds"), grid, d)
        where = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], axis=-1)
    elif like is not None:
        # A volume of one slice is a 2D image.
        given: Any = like
        where = given if is_data_array(given) or is_dataset(given) else as_image(given).centers()[..., :d]
    places = f._places(where) if isinstance(f, Function) else Places(where, "xyz")
    x = places.rows
    axes, values = (f.coordinate_names, f.value_names) if isinstance(f, Function) else (list("xyz"), ["value"])
    names = list(values)
    if lines and isinstance(f, Function) and not (gradient or hessian or standard_deviation):
        nodes = f.evaluate_grid(*lines).reshape(*map(len, lines), -1)
        columns = [nodes.transpose(*range(d)[::-1], d).reshape(len(x), -1)]
    else:
        columns = [f(x).reshape(len(x), -1)]
    if labels:
        found = columns[0]
        numbers: NDArray[Any] = found[:, 0] > 0 if found.shape[1] == 1 else found.argmax(axis=1)
        return places.like_given(np.asarray(numbers, dtype=np.uint8), ["label"])
    if gradient:
        columns.append(f.gradient(x).reshape(len(x), -1))
        names += [f"{value}_{axis}" for value in values for axis in axes]
    if hessian:
        upper = np.triu(np.ones((d, d), dtype=bool))
        columns.append(_function(f, "hessian").hessian(x)[..., upper].reshape(len(x), -1))
        names += [f"{value}_{axes[a]}_{axes[b]}" for value in values for a, b in np.argwhere(upper)]
    if standard_deviation:
        columns.append(_function(f, "standard_deviation").standard_deviation(x, deviation_of).reshape(len(x), -1))
        names += [f"{value}_standard_deviation" for value in values]
    table: NDArray[Any] = np.concatenate(columns, axis=1)
    if mask is not None:
        table[~_function(f, "mask").covered(x, mask)] = np.nan
    return places.like_given(table[:, 0] if table.shape[1] == 1 else table, names)


def _function(f: Function | Surface, option: str) -> Function:
    if not isinstance(f, Function):
        raise ValueError(f"{option}: surfaces have none; see Surface.curvature")
    return f


def _axes(bounds: Floats, grid: int | Sequence[int], d: int) -> list[Floats]:
    """Coordinates of the nodes of a grid along its axes."""
    sizes = np.atleast_1d(np.asarray(grid))
    if sizes.dtype.kind not in "iu" or sizes.shape not in ((1,), (d,)) or sizes.min() < 1:
        raise ValueError(f"grid: {grid} must be whole numbers, the nodes along each of the {d} axes, or one for all")
    if bounds.shape != (d, 2) or not (bounds[:, 0] <= bounds[:, 1]).all():
        raise ValueError(f"bounds: must be an array ({d}, 2) of the first and last node along each axis")
    return [
        low + (high - low) / (n - 1) * np.arange(n) if n > 1 else np.array([0.5 * (low + high)])  # as the program does
        for (low, high), n in zip(bounds, np.broadcast_to(sizes, d))
    ]
