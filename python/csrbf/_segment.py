from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import whole
from csrbf._function import Function
from csrbf._image import Image, as_image
from csrbf._labels import is_data_array
from csrbf._masks import data_of, mask_of, present
from csrbf._nibabel import is_nibabel
from csrbf._options import CompactKernel, Energy, Mode, SegmentMethod, Shading, Smoothness
from csrbf._progress import Progress, listening
from csrbf._seed import like, marked, seed
from csrbf._segmentation import Segmentation, Tracking
from csrbf._surface import Surface

if TYPE_CHECKING:
    from csrbf._image import ImageLike

    Start = Union[ImageLike, Function, Surface]
    Force = Callable[[NDArray[np.uint8]], ArrayLike]


def segment(
    image: ImageLike,
    voxel_size: ArrayLike | None = None,
    init: Start = "auto",
    energy: Energy = "auto",
    regions: int = 2,
    *,
    mode: Mode = "global",
    method: SegmentMethod = "variational",
    mask: ImageLike | None = None,
    center_spacing: float | None = None,
    support: float | None = None,
    kernel: CompactKernel = "wendland-c2",
    smoothness: Smoothness = "auto",
    window: int | None = None,
    shading: Shading = "auto",
    balloon: float = 0.0,
    fill_holes: bool | None = None,
    force: Force | None = None,
    seeds: ImageLike | None = None,
    seed_confidence: float | ImageLike = 1.0,
    channels: Sequence[int] | None = None,
    missing: str | float = "auto",
    objects: bool = False,
    min_size: int | None = None,
    iterations: int = 100,
    progress: Progress = None,
) -> Segmentation:
    """Segment an image by level sets.

    Parameters
    ----------
    image : Image, array_like, DataArray, image of nibabel or file name
        [y, x] or [z, y, x]. Voxels that are masked (numpy.ma), or NaN in a DataArray of xarray, are ignored as by
        `mask`. The labels of a DataArray are a DataArray with the same coordinates.
    voxel_size : float or sequence of float, optional
        For an array: size of a voxel along x, y (and z), default 1. The first voxel is centred at 0.
    init : str, Image, array_like, image of nibabel, Function or Surface
        Where to start: "auto", "sphere:X,Y[,Z],R" or "box:X,Y[,Z],X,Y[,Z]" in physical units, "mask:FILE",
        "points:FILE" (points on the boundary), "MODEL.csrbf", an array like the image (nonzero inside), a Function or a
        Surface (positive inside). In global mode it only decides which of two regions gets label 1.
    energy : str
        How regions differ. "auto": the model that describes the image shortest; with a window or a smoothness
        "chan-vese". "chan-vese": in mean; "gaussian": in mean and standard deviation; "generalized-gaussian": also in
        the shape of the histogram; "rayleigh", "gamma": speckle; "edge": a short contour along edges, which needs
        `init`.
    regions : int
        Number of regions, 2 to 16; labels count from 0.
    mode : "global" or "local"
        "global": regions appear wherever they fit; "local": the contour moves from its start.
    method : str
        "variational", or one of the baselines "collocation" and "finite-difference".
    mask : Image, array_like, image of nibabel or file name, optional
        Like the image; 0 in voxels to ignore, which get label 0.
    center_spacing : float, optional
        Spacing of the RBF centres, in voxels of the shortest edge; large is smooth. Chosen when not given.
    support : float, optional
        Support radius of the RBFs, in centre spacings; 2.5 when not given, 4 for "collocation".
    kernel : str
        A compactly supported radial basis function; "wendland-c4" for curvatures.
    smoothness : "auto" or float
        Weight of the contour length, in voxels: details with a smaller radius vanish. "auto": 0, for the energy "edge"
        1.
    window : int, optional
        Half width of the boxes of 2 window + 1 voxels over which energies are averaged: separates textures, loses
        detail.
    shading : "auto", "none", "linear", "quadratic", "smooth", "objects" or "background"
        How the mean of a region varies over the image. "smooth", "objects" (a mean for each component of a region) and
        "background" (a smooth function added to both regions) need the energy "auto".
    balloon : float
        Pressure of the energy "edge", from -1 (shrink) to 1 (grow).
    fill_holes : bool, optional
        Whether holes that the contour encloses become inside; by default in local mode only.
    force : callable, optional
        Replaces the energy: a function that gets the labels (an array like the image, 1 inside) and returns an array of
        the same shape, the cost of each voxel inside minus that outside: negative where it should be inside.
    seeds : Image, array_like, image of nibabel or file name, optional
        Like the image: 1 + the label of voxels whose region is known, 0 elsewhere; at least one voxel of every region.
        In local mode the background may be left out, and the contour starts at the seeds inside unless `init` is given.
    seed_confidence : float, Image, array_like or file name
        Probability that a seed is right, one for all or one per voxel. Below 1, clear intensities overrule the seed.
    channels : sequence of int, optional
        For an image with components, such as colours: which ones to use, counted from 1; all except transparency when
        not given. An `Image` with the axes "yxc" or "zyxc" has components, and so has an array whose last of three axes
        has the length 3 or 4.
    missing : "auto" or float
        Value of missing voxels, which are ignored and get label 0, as NaN always does. "auto": a block of one extreme
        value at the border, far from all others, a frame with straight or round edges, or a negative mark such as -9999
        anywhere. nan: only NaN.
    objects : bool
        Whether to find objects, splitting those that touch: `Segmentation.objects` and `Segmentation.table`.
    min_size : int, optional
        Objects with fewer voxels are left out, and smaller holes filled. When not given, objects smaller than a tenth
        of the median are left out; `report["objects_left_out"]` says how many.
    iterations : int
        Largest number of iterations.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Segmentation

    Raises
    ------
    ValueError
        For a constant image, infinite values, arrays of another shape, and options out of range.
    IoError
        For files that cannot be read.

    Examples
    --------
    >>> y, x = np.mgrid[:48, :64]
    >>> rng = np.random.default_rng(0)
    >>> image = np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0) + rng.normal(size=(48, 64))
    >>> g = csrbf.segment(image, init="sphere:30,20,5")
    >>> g.labels[20, 30], g.labels[0, 0], g.report["components"]
    (1, 0, 1)
    """
    if objects and regions > 2:
        raise ValueError("objects: needs two regions, of which label 1 has the objects")
    if min_size is not None and not objects:
        raise ValueError("min_size: is about objects: add objects=True")
    image = as_image(image, voxel_size)
    volume = volume_of(image, channels)
    if force is not None and not callable(force):
        raise ValueError("force: must be a function of the labels")
    options = _options(energy, regions, mode, method, center_spacing, support, kernel, smoothness, window, shading,
                       balloon, fill_holes, iterations)
    start = seed(image._aligned(init, "init"), image, volume)
    voxels = _unmasked(image, marked(image._aligned(mask, "mask"), image, "mask"))
    if not (isinstance(missing, str) and missing == "auto"):
        options["missing"] = float(missing)
    known = None
    if seeds is not None:
        known = np.ascontiguousarray(like(image._aligned(seeds, "seeds"), image, "seeds"))
        if known.size == 0 or known.min() < 0 or known.max() > 16 or (known != np.floor(known)).any():
            raise ValueError("seeds: must be whole numbers from 0 to 16")
        known = known.astype(np.uint8)
        options["regions"] = max(options["regions"], int(known.max())) if regions == 2 else options["regions"]
    confidences = None
    if isinstance(seed_confidence, (int, float, np.number)):
        options["seed_confidence"] = float(seed_confidence)
    else:
        given = like(image._aligned(seed_confidence, "seed_confidence"), image, "seed_confidence")
        confidences = np.ascontiguousarray(given, np.float32)
    with listening(progress) as listener:
        found = _csrbf.segment(volume, start, voxels, known, confidences, options, force, listener)
        parts = _csrbf.find_objects(volume, found, min_size, listener) if objects else None
    return Segmentation(found, parts, image)


def track(
    frames: ImageLike | Iterable[ImageLike],
    voxel_size: ArrayLike | None = None,
    init: Start = "auto",
    energy: Energy = "auto",
    regions: int = 2,
    *,
    mask: ImageLike | None = None,
    persistence: float = 1.0,
    motion: float | None = None,
    sweeps: int = 2,
    mode: Mode = "global",
    method: SegmentMethod = "variational",
    center_spacing: float | None = None,
    support: float | None = None,
    kernel: CompactKernel = "wendland-c2",
    smoothness: Smoothness = "auto",
    window: int | None = None,
    shading: Shading = "auto",
    balloon: float = 0.0,
    fill_holes: bool | None = None,
    iterations: int = 100,
    progress: Progress = None,
) -> Tracking:
    """Segment an image sequence, frame by frame.

    Parameters
    ----------
    frames : array_like, Image, DataArray, image of nibabel, file name or sequence of these
        An array [t, y, x] or [t, z, y, x], an image or file with a time axis, or one image per frame.
    voxel_size, energy, regions
        See `segment`.
    init : str, Image, array_like, image of nibabel, Function or Surface
        The start in the first frame; what is inside there stays inside.
    mask : Image, array_like, image of nibabel or file name, optional
        Like a frame; 0 in voxels to ignore.
    persistence : float
        How much noisy frames rely on their neighbours, 0 to 100; 0: not at all.
    motion : float, optional
        How far the contour may move between frames beyond what is expected, in voxels. Chosen from the first frame when
        not given.
    sweeps : int
        1: forwards only, for frames that arrive one by one; 2 or more: each frame uses both its neighbours.
    mode, method, center_spacing, support, kernel, smoothness, window, shading, balloon, fill_holes, iterations
        See `segment`.
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Tracking
        A list with one Segmentation per frame.

    Raises
    ------
    ValueError
        For frames of different size, and as for `segment`.

    Examples
    --------
    >>> y, x = np.mgrid[:48, :64]
    >>> frames = [np.where((x - 30) ** 2 + (y - 20) ** 2 < r**2, 10.0, 1.0) for r in (9, 10, 11)]
    >>> volumes = csrbf.track(frames, init="sphere:30,20,5").volumes()
    >>> np.allclose(volumes, np.pi * np.array([9, 10, 11]) ** 2, rtol=0.05)
    True
    """
    images = _frames(frames, voxel_size)
    if not images:
        raise ValueError("frames: there are none")
    volumes = [volume_of(image) for image in images]
    options = _options(energy, regions, mode, method, center_spacing, support, kernel, smoothness, window, shading,
                       balloon, fill_holes, iterations)
    start = seed(images[0]._aligned(init, "init"), images[0], volumes[0])
    voxels = marked(images[0]._aligned(mask, "mask"), images[0], "mask")
    for image in images:
        voxels = _unmasked(image, voxels)
    with listening(progress) as listener:
        found, warnings = _csrbf.track(
            volumes, start, voxels, options, float(persistence), motion, whole(sweeps, "sweeps"), listener
        )
    segmentations = [Segmentation(one, None, image) for (one, _), image in zip(found, images)]
    return Tracking(segmentations, [regions for _, regions in found], warnings)


def _unmasked(image: Image, voxels: NDArray[np.uint8] | None) -> NDArray[np.uint8] | None:
    """The voxels to look at, without those that a masked array masks."""
    hidden = image._mask()
    if hidden is None:
        return voxels
    shown = (~hidden).astype(np.uint8)
    return shown if voxels is None else shown * voxels


def _frames(frames: Any, voxel_size: ArrayLike | None) -> list[Image]:
    if isinstance(frames, (str, os.PathLike, Image)) or is_data_array(frames) or is_nibabel(frames):
        sequence = as_image(frames, voxel_size)
        if not sequence.axes.startswith("t"):
            return [sequence]
        return [sequence._frame(number) for number in range(len(sequence))]
    return [as_image(frame, voxel_size) for frame in frames]


def volume_of(image: Image, channels: Sequence[int] | None = None) -> _csrbf.Volume:
    if image.axes.removesuffix("c") not in ("yx", "zyx"):
        raise ValueError(
            f"image: its axes are [{', '.join(image.axes)}]; they must be [y, x] or [z, y, x], and c for components; take "
            "one frame of a sequence"
        )
    values, components = _visible(image), 1
    if image.axes.endswith("c"):
        n = values.shape[-1]
        suspect = n in (2, 4) and values.dtype.kind in "ui"
        transparent = suspect and image.axes == "yxc"
        if suspect and channels is None and values[..., -1].min() != values[..., -1].max():
            done = (
                f"taken for transparency and left out; with channels={list(range(1, n + 1))} it counts"
                if transparent
                else "used like the others; if it is transparency, leave it out by channels"
            )
            warnings.warn(f"segment: the last of {n} components is {done}", stacklevel=3)
        chosen = range(1, n + 1 - transparent) if channels is None else [int(c) for c in channels]
        if not len(chosen) or min(chosen) < 1 or max(chosen) > n:
            raise ValueError(f"channels: {list(chosen)} must be numbers from 1 to {n}, the components of the image")
        values, components = values[..., [c - 1 for c in chosen]], len(chosen)
    elif channels is not None and list(channels) != [1]:
        raise ValueError("channels: the image has one value per voxel")
    layout = dict(image._layout(), type="float32", components=components)
    return _csrbf.Volume(np.ascontiguousarray(values, dtype=np.float32).ravel(), layout)


def _visible(image: Image) -> NDArray[Any]:
    """The values, masked ones replaced by the mean of the others: they are not looked at."""
    mask = mask_of(image.values)
    if mask is None:
        return image.values
    known = present(image.values)
    if known.size == 0:
        raise ValueError("image: all voxels are masked")
    values: NDArray[Any] = np.where(mask, known.mean(), data_of(image.values))
    return values


def _options(
    energy: str,
    regions: int,
    mode: str,
    method: str,
    center_spacing: float | None,
    support: float | None,
    kernel: str,
    smoothness: str | float,
    window: int | None,
    shading: str,
    balloon: float,
    fill_holes: bool | None,
    iterations: int,
) -> dict[str, Any]:
    """The options that were given; the others are automatic."""
    options = {
        "energy": energy,
        "regions": whole(regions, "regions"),
        "mode": mode,
        "method": method,
        "center_spacing": center_spacing,
        "support": support,
        "kernel": kernel,
        "smoothness": None if isinstance(smoothness, str) and smoothness == "auto" else float(smoothness),
        "window": window,
        "shading": shading,
        "balloon": float(balloon),
        "fill_holes": fill_holes,
        "iterations": whole(iterations, "iterations"),
    }
    return {name: value for name, value in options.items() if value is not None}
