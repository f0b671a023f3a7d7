from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike

from csrbf import _csrbf
from csrbf._arrays import Path, floats, rows, smoothing_or_none, whole
from csrbf._labels import Labelled, frame_columns, is_frame
from csrbf._masks import data_of, mask_of
from csrbf._options import Smoothing, SurfaceMethod
from csrbf._points import PointCloud, read_points
from csrbf._progress import Progress, listening
from csrbf._surface import Surface

if TYPE_CHECKING:
    PointsLike = Union[PointCloud, ArrayLike, Labelled, Path]


def reconstruct(
    points: PointsLike,
    normals: ArrayLike | None = None,
    method: SurfaceMethod = "auto",
    centers: int | None = None,
    tolerance: float | None = None,
    smoothing: Smoothing = "auto",
    *,
    progress: Progress = None,
) -> Surface:
    """Make a closed implicit surface through a point cloud or, in noise, close to it.

    Parameters
    ----------
    points : array_like (n, 3), PointCloud, DataFrame or file name
        The normals of a cloud or file are used like `normals`. A table has the columns x, y, z and, optionally, nx, ny,
        nz. Masked points (numpy.ma) are left out.
    normals : array_like (n, 3), optional
        Outward normals. They are corrected where they have errors, flipped where they contradict each other or point
        inward, and estimated if there are none.
    method : str
        "auto", "composite", "medial-axis" and others; the error for an unknown name lists them all.
    centers : int, optional
        Largest number of radial basis functions; chosen from the data by default.
    tolerance : float, optional
        Largest distance from a point to the surface, except for outliers, as a fraction of the diagonal of the bounding
        box.
    smoothing : "auto", "none" or float
        "auto": chosen by cross-validation; "none": no smoothing; a number: larger is smoother.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        For fewer than four distinct points, points on a line, and unknown options.
    SolverFailure
        If no surface is found or the tolerance cannot be met.

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
    cloud: Any
    cloud, normals = _of_frame(points, normals) if is_frame(points) else _unmasked(points, normals)
    vectors = None if normals is None else floats(normals, "normals")
    smoothness = smoothing_or_none(smoothing)
    if tolerance is not None and not tolerance > 0:
        raise ValueError(f"tolerance: {tolerance} is not positive; leave it out to let the data decide")
    positions = rows(cloud, "points")
    if positions.shape[1] == 6:
        raise ValueError("points: must be an array of 3 columns, not 6; normals are given apart: points, normals")
    with listening(progress) as listener:
        surface, report = _csrbf.reconstruct(
            positions, vectors, method, whole(centers or 0, "centers"), float(tolerance or 0.0), smoothness, listener
        )
    return Surface(surface, report)


def _of_frame(frame: Any, normals: ArrayLike | None) -> tuple[ArrayLike, ArrayLike | None]:
    """Columns x, y and z of a table, and its normals nx, ny and nz."""
    has_normals = normals is None and all(name in frame.columns for name in ("nx", "ny", "nz"))
    own = frame_columns(frame, ["nx", "ny", "nz"], "normals") if has_normals else normals
    return frame_columns(frame, ["x", "y", "z"], "points"), own


def _unmasked(points: PointsLike, normals: ArrayLike | None) -> tuple[Any, Any]:
    """Points of a masked array that are not masked, with their normals."""
    mask = mask_of(points)
    if mask is None or mask.ndim != 2:
        return points, normals
    kept = ~mask.any(axis=1)
    if normals is not None:
        normals = np.asanyarray(normals)
        normals = normals[kept] if len(normals) == len(kept) else normals
    return data_of(points)[kept], normals


def reconstruct_contours(
    contours: Sequence[ArrayLike], *, centers: int = 2000, smoothing: Smoothing = "auto", progress: Progress = None
) -> Surface:
    """Make a smooth closed implicit surface through contours drawn on slices.

    Parameters
    ----------
    contours : sequence of array_like (n, 3)
        Closed curves, each a sequence of points in one plane. Several curves may lie in the same plane. There must be
        at least two planes, which need not be parallel. A point is inside if an odd number of curves in its plane
        enclose it.
    centers : int
        Largest number of basis functions, at least 16; a point of a contour needs two.
    smoothing : "auto", "none" or float
        "none": the surface interpolates all contours; 1e-4 to 1e-2: smooths misaligned contours; "auto": smooths jagged
        contours only, such as those traced from pixels.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        For curves that are not planar or enclose nothing, and fewer than two planes.

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
        surface, report = _csrbf.reconstruct_contours(points, sizes, whole(centers, "centers"), smoothness, listener)
    return Surface(surface, report)
