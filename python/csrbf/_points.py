from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import ArrayBacked, Floats, Path, floats, rows
from csrbf._progress import Progress, listening


class PointCloud(ArrayBacked):
    """Points in space with their normals and properties; to numpy, the array of their coordinates.

    Parameters
    ----------
    points : array_like (n, 3)
    normals : array_like (n, 3), optional
        Outward unit normals.
    properties : dict of arrays (n,), optional
        Other values by name; colours are "red", "green" and "blue" of type uint8.

    Examples
    --------
    >>> cloud = csrbf.PointCloud([[0, 0, 0], [1, 2, 3]])
    >>> cloud.shape, cloud.normals is None
    ((2, 3), True)
    >>> np.mean(cloud, axis=0)
    array([0.5, 1. , 1.5])
    """

    points: Floats
    normals: Floats | None
    properties: dict[str, NDArray[Any]]

    def __init__(
        self, points: ArrayLike, normals: ArrayLike | None = None, properties: dict[str, NDArray[Any]] | None = None
    ) -> None:
        self.points = self._array = rows(points, "points")
        self.normals = None if normals is None else rows(normals, "normals")
        self.properties = properties or {}

    def save(self, path: Path) -> None:
        """Write .ply, .xyz, .pts, .txt, .csv, .obj, .off or .npy, by the extension of the name.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        ValueError
            When the arrays are inconsistent.
        IoError
            When the file cannot be written.

        Examples
        --------
        >>> csrbf.PointCloud([[0, 0, 0], [1, 2, 3]]).save("two.xyz")
        """
        none = np.empty((0, 3))
        arrays = (self.points, none if self.normals is None else self.normals, self.properties)
        _csrbf.write_points(os.fspath(path), arrays)

    def __repr__(self) -> str:
        normals = "without normals" if self.normals is None else "with normals"
        return f"<csrbf.PointCloud of {len(self)} points {normals}>"


def read_points(path: Path) -> PointCloud:
    """The points of a file: .ply, .xyz, .pts, .txt, .csv, .obj, .off or .npy.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    PointCloud
        An array (n, 3) to numpy, with `normals` and `properties` when the file has them.

    Raises
    ------
    IoError
        With the file and the line, for unreadable data.

    Examples
    --------
    >>> csrbf.PointCloud([[0, 0, 0], [1, 2, 3]]).save("two.xyz")
    >>> cloud = csrbf.read_points("two.xyz")
    >>> cloud[1]
    array([1., 2., 3.])
    """
    points, normals, properties = _csrbf.read_points(os.fspath(path))
    return PointCloud(points, normals if len(normals) else None, properties)


def estimate_normals(
    points: ArrayLike,
    neighbors: int | None = None,
    orient: str = "consistent",
    *,
    viewpoint: ArrayLike | None = None,
    progress: Progress = None,
) -> Floats:
    """Unit normals of points on a surface.

    Parameters
    ----------
    points : array_like (n, 3)
    neighbors : int, optional
        Number of points that each normal is estimated from, at least 3; chosen from the noise when not given.
    orient : "consistent", "viewpoint" or "none"
        Outwards, in agreement with the neighbours; towards the scanner; either way.
    viewpoint : array_like (3,), optional
        Position of the scanner, for the orientation "viewpoint".
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    ndarray (n, 3)
        Zero where no normal is determined.

    Raises
    ------
    ValueError
        For non-finite coordinates, fewer than three distinct points and collinear points.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(2000, 3))
    >>> x /= np.linalg.norm(x, axis=1, keepdims=True)
    >>> n = csrbf.estimate_normals(x)
    >>> bool((n * x).sum(axis=1).min() > 0.99)
    True
    """
    if orient == "viewpoint" and viewpoint is None:
        raise ValueError('viewpoint: must be given for orient="viewpoint"')
    if orient != "viewpoint" and viewpoint is not None:
        raise ValueError(f'viewpoint: has no meaning for orient="{orient}"; give orient="viewpoint"')
    place = np.zeros(3) if viewpoint is None else floats(viewpoint, "viewpoint")
    with listening(progress) as listener:
        return _csrbf.estimate_normals(rows(points, "points"), int(neighbors or 0), orient, place, listener)


def farthest_points(
    points: ArrayLike, n: int, *, first: int | None = None, progress: Progress = None
) -> NDArray[np.int64]:
    """Well-spread points: each is the one farthest from all before it.

    Parameters
    ----------
    points : array_like (m, d)
        d from 1 to 6.
    n : int
        How many to pick; fewer when there are not as many distinct points.
    first : int, optional
        Index of the point to begin with; the one nearest to the lower corner of the box when not given.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    ndarray of int64
        Indices of the points in the order in which they were picked: the first k are well spread for every k.

    Raises
    ------
    ValueError
        For non-finite coordinates, a negative n and a `first` out of range.

    Examples
    --------
    >>> csrbf.farthest_points([[0.0], [1.0], [2.0], [10.0]], 3)
    array([0, 3, 2])
    """
    with listening(progress) as listener:
        return _csrbf.farthest_points(rows(points, "points"), int(n), first, listener)
