from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Union

import numpy as np
from numpy.typing import ArrayLike

from csrbf import _csrbf
from csrbf._arrays import Path, floats, rows, smoothing_or_none
from csrbf._points import PointCloud, read_points
from csrbf._progress import Progress, listening
from csrbf._surface import Surface

if TYPE_CHECKING:
    PointsLike = Union[PointCloud, ArrayLike, Path]


def reconstruct(
    points: PointsLike,
    normals: ArrayLike | None = None,
    method: str = "auto",
    centers: int | None = None,
    tolerance: float | None = None,
    smoothing: str | float = "auto",
    *,
    progress: Progress = None,
) -> Surface:
    """A closed implicit surface through, or under noise near, a cloud of points.

    Parameters
    ----------
    points : array_like (n, 3), PointCloud or file name
        Normals of a cloud or file are used as `normals` are.
    normals : array_like (n, 3), optional
        Outward; they are turned round where they contradict each other or point inward, and estimated when there
        are none.
    method : str
        "auto", "composite", "medial-axis", ...: a wrong name lists those there are.
    centers : int, optional
        Largest number of radial basis functions.
    tolerance : float, optional
        Largest distance from a point to the surface, outliers aside, as a fraction of the diagonal of the bounding box.
    smoothing : "auto", "none" or float
        "auto" chooses by cross-validation, "none" does not smooth, a number is taken as it is: larger is smoother.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        For fewer than four different points, points on a line and unknown options.
    SolverFailure
        When no surface comes out, or the tolerance cannot be reached.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(2000, 3))
    >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
    >>> ball.report["points"], ball.report["normals"], ball.report["rms_distance"] < 1e-3
    (2000, 'estimated', True)
    >>> ball.polygonize().save("ball.ply")
    """
    if isinstance(points, (str, os.PathLike)):
        points = read_points(points)
    if isinstance(points, PointCloud) and normals is None:
        normals = points.normals
    vectors = None if normals is None else floats(normals, "normals")
    smoothness = smoothing_or_none(smoothing)
    with listening(progress) as listener:
        surface, report = _csrbf.reconstruct(
            rows(points, "points"), vectors, method, int(centers or 0), float(tolerance or 0.0), smoothness, listener
        )
    return Surface(surface, report)


def reconstruct_contours(
    contours: Sequence[ArrayLike], *, centers: int = 2000, smoothing: str | float = "auto", progress: Progress = None
) -> Surface:
    """A smooth closed implicit surface through contours that were drawn on slices.

    Parameters
    ----------
    contours : sequence of array_like (n, 3)
        Closed curves by their points in order, each in a plane of its own or with others; at least two planes, which
        need not be parallel. Inside is where an odd number of curves of a plane is around a place.
    centers : int
        Largest number of basis functions, two for each point used.
    smoothing : "auto", "none" or float
        "none" meets all contours; 1e-4 to 1e-2 smooth contours that do not fit together; "auto" smooths those in
        zigzag, as traced from pixels.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        For curves that are not flat or enclose nothing, and fewer than two planes.

    Examples
    --------
    >>> t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    >>> rings = [np.column_stack([np.cos(t), np.sin(t), np.full(24, z)]) for z in (0.0, 0.5, 1.0)]
    >>> tube = csrbf.reconstruct_contours(rings)
    >>> tube.contains([[0, 0, 0.5], [1.2, 0, 0.5]])
    array([ True, False])
    """
    curves = [rows(curve, "contours") for curve in contours]
    sizes = [len(curve) for curve in curves]
    points = np.concatenate(curves) if curves else np.empty((0, 3))
    smoothness = smoothing_or_none(smoothing)
    with listening(progress) as listener:
        surface, report = _csrbf.reconstruct_contours(points, sizes, int(centers), smoothness, listener)
    return Surface(surface, report)
