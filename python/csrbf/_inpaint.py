from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import numbers
from csrbf._fit import fit_options
from csrbf._image import as_image
from csrbf._masks import data_of
from csrbf._nibabel import is_nibabel
from csrbf._options import Extrapolation, FitMethod, Kernel, Smoothing
from csrbf._progress import Progress, listening

if TYPE_CHECKING:
    from csrbf._image import Image, ImageLike


def inpaint(
    image: ImageLike,
    mask: ImageLike | None = None,
    missing: float | None = None,
    *,
    voxel_size: ArrayLike | None = None,
    method: FitMethod = "auto",
    tolerance: float | None = None,
    centers: int | None = None,
    smoothing: Smoothing = "auto",
    kernel: Kernel = "auto",
    kernel_parameter: float | None = None,
    degree: int | None = None,
    extrapolation: Extrapolation = "constant",
    blocks: int | None = None,
    progress: Progress = None,
) -> Any:
    """Fill in the missing or unreliable values of an image.

    A smooth function is fitted to the known values, see `fit`, for every frame and component on its own, and refined by
    blocks that continue edges and textures. Known values do not change.

    Parameters
    ----------
    image : Image, array_like, DataArray, image of nibabel or file name
        [y, x] or [z, y, x]; other axes need an `Image`.
    mask : Image, array_like, image of nibabel or file name, optional
        Like the image or one frame of it; nonzero where values are to be replaced. The mask of a masked array
        (numpy.ma) counts as well.
    missing : float, optional
        Value that marks missing voxels. NaN and infinity are always missing.
    voxel_size : float or sequence of float, optional
        For an array: size of a voxel along x, y (and z), default 1.
    method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation, progress
        See `fit`.
    blocks : int, optional
        Width of the blocks, in voxels, 4 to 64; 0: no blocks, only the fitted function. By default what suits known
        voxels best, and 0 if options of the fit are given.

    Returns
    -------
    Image or DataArray
        Like `image` and, to numpy, an array of its type: whole numbers are rounded and clipped to the range of the
        type. Its `report` has the numbers of missing and known values and what the fit did. For a DataArray of xarray a
        DataArray with the same coordinates.

    Raises
    ------
    ValueError
        If no value is known, or the mask has another shape.

    Examples
    --------
    >>> y, x = np.mgrid[:32, :32]
    >>> image = np.where((x - 16) ** 2 + (y - 16) ** 2 < 9, np.nan, np.sin(0.2 * x) + 0.1 * y)
    >>> filled = csrbf.inpaint(image)
    >>> filled.report["missing"], bool(abs(filled[16, 16] - np.sin(3.2) - 1.6) < 0.01)
    (25, True)
    """
    image = as_image(image, voxel_size)
    values = data_of(image.values)
    floating = np.issubdtype(values.dtype, np.floating)
    if extrapolation == "nan" and not floating:
        raise ValueError('extrapolation: the image holds whole numbers, which cannot be NaN; use "constant"')
    options = fit_options(method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, extrapolation)
    holes = _holes(image, image._aligned(mask, "mask"), missing)
    with listening(progress) as listener:
        doubles = np.ascontiguousarray(values, dtype=np.float64).ravel()
        layout = dict(image._layout(), type="float64")
        filled, report = _csrbf.inpaint(doubles, layout, holes.ravel(), options, blocks, listener)
    if report["missing"] == 0:
        warnings.warn("inpaint: nothing is missing; give mask or missing", stacklevel=2)
    if not floating:
        filled = np.clip(np.rint(filled), *_range(values.dtype))
    return image._result(filled.reshape(values.shape).astype(values.dtype, copy=False), report)


def _range(dtype: np.dtype[Any]) -> tuple[float, float]:
    return (0, 1) if dtype == bool else (np.iinfo(dtype).min, np.iinfo(dtype).max)


def _holes(image: Image, mask: ImageLike | None, missing: float | None) -> NDArray[np.uint8]:
    """Missing voxels of every frame: those of the mask, and those whose components all have the value."""
    components = image.axes.endswith("c")
    shape = image.values.shape[:-1] if components else image.values.shape
    holes = np.zeros(shape, dtype=bool)
    if mask is not None:
        marked = numbers(as_image(mask) if isinstance(mask, (str, os.PathLike)) or is_nibabel(mask) else mask, "mask")
        if marked.shape not in (shape, shape[image.axes.startswith("t") :]):
            raise ValueError(f"mask: has shape {marked.shape}; the image has {shape}")
        holes |= marked != 0
    hidden = image._mask()
    if hidden is not None:
        holes |= hidden
    if missing is not None:
        values = data_of(image.values)
        same = values == np.asarray(missing).astype(values.dtype)
        holes |= same.all(axis=-1) if components else same
    return holes.astype(np.uint8)
