from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike

from csrbf import _csrbf
from csrbf._arrays import rows
from csrbf._image import Image, as_image
from csrbf._mesh import Mesh, read_mesh
from csrbf._points import PointCloud
from csrbf._progress import Progress, listening
from csrbf._segmentation import Segmentation

if TYPE_CHECKING:
    from csrbf._image import ImageLike

    Comparable = Union[Mesh, PointCloud, Segmentation, ImageLike]


def compare(
    a: Comparable,
    b: Comparable,
    *,
    voxel_size: ArrayLike | None = None,
    samples: int = 200000,
    seed: int = 7,
    progress: Progress = None,
) -> dict[str, Any]:
    """Differences between a mesh and another mesh or points, or between two label images.

    Parameters
    ----------
    a : Mesh, label image, Segmentation or file name
    b : Mesh, points, label image, Segmentation or file name
        The reference. Points may be an array (n, 3), a PointCloud or a file.
    voxel_size : float or sequence of float, optional
        Of label arrays: size of a voxel along x, y (and z); 1 when not given.
    samples, seed : int
        Points sampled on each mesh, and the random seed.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    dict
        For meshes: chamfer_mean and hausdorff99 (99th percentile of the distances), as fractions of the diagonal of the
        reference, normal_error_deg, the distances each way (accuracy, completeness; for points: distance), and the
        `Mesh.topology` of the first. For labels: dice, jaccard, hausdorff95 in units of the voxel size, and the same
        for each label in `labels`. Images with a single label each, of different values, are compared as one region.

    Raises
    ------
    ValueError
        For meshes without triangles, images of different size or position and labels that are not whole numbers.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(2000, 3))
    >>> x /= np.linalg.norm(x, axis=1, keepdims=True)
    >>> mesh = csrbf.reconstruct(x).polygonize(resolution=40)
    >>> result = csrbf.compare(mesh, x)
    >>> result["watertight"], result["chamfer_mean"] < 0.001
    (True, True)
    >>> csrbf.compare(np.array([[0, 1], [1, 1]]), np.array([[0, 0], [1, 1]]))["dice"]
    0.8
    """
    a, b = _opened(a, b), _opened(b, a)
    if isinstance(b, Mesh) and (not isinstance(a, Mesh) or len(a.faces) == 0):
        a, b = b, a
    with listening(progress) as listener:
        if not isinstance(a, Mesh):
            return _compare_labels(_labels(a, voxel_size), _labels(b, voxel_size), listener)
        if isinstance(b, Mesh) and len(b.faces) > 0:
            return _csrbf.compare_meshes(a._arrays(), b._arrays(), int(samples), int(seed), listener)
        return _csrbf.compare_points(a._arrays(), _point_arrays(b), listener)


def _opened(one: Any, other: Any) -> Any:
    """The image or mesh of a file name; .npy is an image next to an image, and points next to a mesh."""
    if not isinstance(one, (str, os.PathLike)):
        return one
    path = os.fspath(one)
    beside_mesh = isinstance(other, Mesh) or (
        isinstance(other, (str, os.PathLike)) and not _csrbf.is_image_file(os.fspath(other))
    )
    return read_mesh(path) if beside_mesh or not _csrbf.is_image_file(path) else as_image(path)


def _point_arrays(points: Any) -> _csrbf.CloudArrays:
    none = np.empty((0, 3))
    if isinstance(points, Mesh):
        return points.vertices, none if points.normals is None else points.normals, {}
    if isinstance(points, PointCloud):
        return points.points, none if points.normals is None else points.normals, {}
    return rows(points, "points"), none, {}


def _labels(labels: Any, voxel_size: ArrayLike | None) -> Image:
    if isinstance(labels, Segmentation):
        return labels._label_image()
    if isinstance(labels, Image):
        return labels
    return as_image(labels, voxel_size)


def _compare_labels(a: Image, b: Image, listener: Any) -> dict[str, Any]:
    marks = [np.setdiff1d(np.unique(image.values), [0]) for image in (a, b)]
    alike = len(marks[0]) == len(marks[1]) == 1 and marks[0][0] != marks[1][0]
    # An image without a position is given that of the other one.
    places = [b if _has_no_place(a) else a, a if _has_no_place(b) else b]
    layouts = [_placed(image, place) for image, place in zip((a, b), places)]
    numbers = [np.ascontiguousarray(image._filled(), dtype=np.float32).ravel() for image in (a, b)]
    return _csrbf.compare_labels(numbers[0], layouts[0], numbers[1], layouts[1], bool(alike), listener)


def _placed(image: Image, place: Image) -> dict[str, Any]:
    """The layout of an image, at the position of another one of the same size."""
    layout, other = dict(image._layout(), type="float32"), place._layout()
    if layout["size"] == other["size"]:
        layout.update((key, other[key]) for key in ("spacing", "origin", "direction", "space"))
    return layout


def _has_no_place(image: Image) -> bool:
    return (
        image.space == "unknown"
        and bool((image.spacing == 1).all())
        and not image.origin.any()
        and bool((image.direction == np.eye(3)).all())
    )
