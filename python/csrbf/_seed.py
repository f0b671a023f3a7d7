"""Initial regions of segmentations."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import numbers
from csrbf._function import Function
from csrbf._image import Image, as_image
from csrbf._nibabel import is_nibabel
from csrbf._points import read_points
from csrbf._reconstruct import reconstruct
from csrbf._surface import Surface

_FORMS = (
    'expected "auto", "sphere:X,Y[,Z],R", "box:X,Y[,Z],X,Y[,Z]", "mask:FILE", "points:FILE", "MODEL.csrbf", an array '
    "like the image, a Function or a Surface"
)


def like(given: Any, image: Image, name: str) -> NDArray[Any]:
    """The values of an array, Image or file, one for each voxel of the image, in the same place."""
    other = as_image(given) if isinstance(given, (str, os.PathLike)) or is_nibabel(given) else given
    array = numbers(other, name)
    shape = tuple(image.values.shape[image.axes.index(axis)] for axis in image._plane())
    if array.shape != shape:
        raise ValueError(f"{name}: has shape {array.shape}; the image has {shape}")
    if isinstance(other, Image):
        apart = _csrbf.places_apart(*(dict(one._layout(), type="float32") for one in (other, image)))
        if apart:
            raise ValueError(f"{name}: its voxels are not where those of the image are: {apart}; resample it")
    return array


def marked(given: Any, image: Image, name: str) -> NDArray[np.uint8] | None:
    """The voxels that an array, Image or file like the image marks."""
    if given is None:
        return None
    inside: NDArray[np.bool_] = np.nan_to_num(like(given, image, name)) != 0
    return inside.astype(np.uint8)


def seed(init: Any, image: Image, volume: _csrbf.Volume) -> NDArray[np.uint8] | None:
    """The voxels that are inside initially, or None."""
    if isinstance(init, (Function, Surface)):
        return _inside(init, image)
    if not isinstance(init, (str, os.PathLike)):
        return marked(init, image, "init")
    init = os.fspath(init)
    form, _, rest = init.partition(":")
    if init == "auto":
        return None
    if init.endswith(".csrbf"):
        from csrbf._load import load

        return _inside(load(init), image)
    if form == "mask":
        return marked(rest, image, "init")
    if form == "points":
        return _around(rest, image, volume)
    if form in ("sphere", "box"):
        numbers = _numbers(rest)
        d = volume.dimension
        if form == "sphere" and len(numbers) == d + 1:
            return _covering(volume.seed_ball(numbers[:d], numbers[d]), init)
        if form == "box" and len(numbers) == 2 * d:
            return _covering(volume.seed_box(numbers[:d], numbers[d:]), init)
    raise ValueError(f'init: "{init}": {_FORMS}')


def _numbers(text: str) -> NDArray[np.float64]:
    try:
        return np.array([float(word) for word in text.split(",")])
    except ValueError:
        return np.array([])


def _around(path: str, image: Image, volume: _csrbf.Volume) -> NDArray[np.uint8]:
    """The inside of points on the boundary: of a polygon in 2D, of a surface in 3D."""
    if volume.dimension == 3:
        return _inside(reconstruct(path), image)
    return _covering(volume.seed_polygon(np.ascontiguousarray(_csrbf.read_queries(path, ["x", "y"]))), path)


def _inside(f: Function | Surface, image: Image) -> NDArray[np.uint8]:
    # A volume of one slice is a 2D image.
    centers = image.centers()[..., : f.dimension] if isinstance(f, Function) else image.centers()
    return _covering((f(centers) > 0).astype(np.uint8), "the function")


def _covering(seed: NDArray[np.uint8], what: str) -> NDArray[np.uint8]:
    if not seed.any():
        raise ValueError(f"init: {what} covers no voxel of the image")
    return seed
