from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import ArrayBacked, Floats, Path, floats, rows, whole
from csrbf._options import Orientation
from csrbf._progress import Progress, listening
from csrbf._show import Page, Panel, Shown
from csrbf._viewer import View, colors_of


_MOST_PLOTTED = 20000
_MOST_IN_NOTEBOOK, _MOST_IN_FILE = 20000, 200000


class PointCloud(ArrayBacked, Shown):
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

        Properties that the format has no place for are left out, with a UserWarning that names them: all but colours
        in .obj and .off, all in .xyz, .pts and .npy.

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
        for warning in _csrbf.write_points(os.fspath(path), arrays):
            warnings.warn(warning, stacklevel=2)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the points with matplotlib, at most 20,000 of them, in their colours when they have some.

        Parameters
        ----------
        ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
            Those of a new figure when not given.
        **options
            Of ``scatter``.

        Returns
        -------
        mpl_toolkits.mplot3d.axes3d.Axes3D

        Examples
        --------
        >>> csrbf.PointCloud([[0, 0, 0], [1, 2, 3]]).plot()  # doctest: +SKIP
        <Axes3D: xlabel='x', ylabel='y', zlabel='z'>
        """
        from csrbf._plots import space_axes_for

        ax = space_axes_for(ax)
        step = -(-len(self) // _MOST_PLOTTED) or 1
        colors = colors_of(self.properties)
        given: dict[str, Any] = {} if colors is None else {"c": colors[::step] / 255}
        ax.scatter(*self.points[::step].T, **{"s": 1, **given, **options})
        ax.set(xlabel="x", ylabel="y", zlabel="z")
        ax.set_aspect("equal")
        return ax

    def _page(self, large: bool) -> Page:
        facts = {"points": f"{len(self):,}", "normals": "yes" if self.normals is not None else "no"}
        if len(self) == 0:
            return Page("Points", facts)
        facts["sides of the box"] = " x ".join(f"{side:.3g}" for side in np.ptp(self.points, axis=0))
        most = _MOST_IN_FILE if large else _MOST_IN_NOTEBOOK
        step = -(-len(self) // most)
        caption = "" if step == 1 else f"Shown with {-(-len(self) // step):,} of the points."
        return Page("Points", facts, [self._panel(step, caption)])

    def _panel(self, step: int, caption: str) -> Panel:
        from csrbf._mesh import Mesh

        points, colors = self.points[::step], colors_of(self.properties)
        colors = None if colors is None else colors[::step]
        none = Mesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int32), np.empty((0, 3)))
        view = View(none, points, colors, shown="plain" if colors is None else "own")
        return Panel(_dots(points, colors), caption, view)

    def __repr__(self) -> str:
        normals = "without normals" if self.normals is None else "with normals"
        return f"<csrbf.PointCloud of {len(self)} points {normals}>"


def _dots(points: Floats, colors: NDArray[np.uint8] | None) -> NDArray[np.uint8]:
    """Points seen from above their front, near ones over far ones, in their colours or lighter where farther."""
    azimuth, elevation = np.radians(-65), np.radians(15)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    near = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)])
    x, y, depth = ((points - points.mean(axis=0)) @ np.column_stack([right, np.cross(near, right), near])).T
    height, width, margin = 400, 640, 20
    picture = np.full((height, width, 3), 255, dtype=np.uint8)
    scale = min((width - 2 * margin) / (np.ptp(x) or 1), (height - 2 * margin) / (np.ptp(y) or 1))
    column = np.rint(width / 2 + scale * (x - (x.max() + x.min()) / 2)).astype(int)
    row = np.rint(height / 2 - scale * (y - (y.max() + y.min()) / 2)).astype(int)
    if colors is None:
        fade = (depth.max() - depth) / (np.ptp(depth) or 1)
        colors = (np.array([25, 82, 153]) + fade[:, None] * np.array([165, 118, 67])).astype(np.uint8)
    order = np.argsort(depth)
    for down in (0, 1):
        for across in (0, 1):
            picture[row[order] + down, column[order] + across] = colors[order]
    return picture


def read_points(path: Path) -> PointCloud:
    """The points of a file: .ply .xyz .pts .txt .csv .obj .off .npy .vtp .stl .las .laz .e57 .pcd .ptx.

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
    orient: Orientation = "consistent",
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
        return _csrbf.estimate_normals(rows(points, "points"), whole(neighbors or 0, "neighbors"), orient, place, listener)


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
        return _csrbf.farthest_points(rows(points, "points"), whole(n, "n"), first, listener)
