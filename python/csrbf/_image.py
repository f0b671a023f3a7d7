from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import ArrayBacked, Floats, Path

if TYPE_CHECKING:
    ImageLike = Union["Image", ArrayLike, Path]

_AXES = ("x", "yx", "zyx", "tzyx")  # default meaning of an array with that many axes


class Image(ArrayBacked):
    """An image or volume with its position in space; to numpy, the array of its values.

    Parameters
    ----------
    values : array_like
        Indexed [y, x] or [z, y, x]: x is the fastest axis.
    spacing : float or sequence of float
        Distance of neighbouring voxels along x, y (and z), or one number for all.
    origin : sequence of float
        Coordinates of the centre of the first voxel.
    direction : array_like (3, 3), optional
        Columns: unit vectors of the axes x, y and z. Default: the axes of space.
    axes : str, optional
        Meaning of the axes of the array: "yx" or "zyx", preceded by "t" for time and followed by "c" for components,
        such as colours. Default: "x", "yx", "zyx" or "tzyx", by the number of axes.
    space : "unknown", "LPS" or "RAS"
        Orientation of the axes of space: those of a patient point to the left and the back, or to the right and the
        front.
    time_step : float
        Seconds between frames.

    Attributes
    ----------
    values : ndarray
    spacing, origin : ndarray (3,)
        Of x, y and z, also for 2D images.
    direction : ndarray (3, 3)
    axes, space, time_step
        As above.
    report : dict
        What `inpaint` did; empty for other images.

    Examples
    --------
    >>> image = csrbf.Image(np.arange(12.0).reshape(3, 4), spacing=0.5)
    >>> image.shape, image[2, 1], (image > 9).sum()
    ((3, 4), 9.0, 2)
    >>> image.centers()[2, 1]
    array([0.5, 1. ])
    """

    values: NDArray[Any]
    spacing: Floats
    origin: Floats
    direction: Floats

    def __init__(
        self,
        values: ArrayLike,
        spacing: ArrayLike = 1.0,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        direction: ArrayLike | None = None,
        *,
        axes: str | None = None,
        space: str = "unknown",
        time_step: float = 1.0,
    ) -> None:
        self.values = self._array = np.asarray(values)
        if np.iscomplexobj(self.values):
            raise ValueError("image: must be real numbers")
        self.axes = _checked_axes(axes, self.values.ndim)
        self.spacing = _three(spacing, len(self._plane()), "voxel_size", 1.0)
        self.origin = _three(origin, len(self._plane()), "origin", 0.0)
        self.direction = np.eye(3) if direction is None else np.array(direction, dtype=float).reshape(3, 3)
        if space not in ("unknown", "LPS", "RAS"):
            raise ValueError(f'space: "{space}" is neither "unknown" nor "LPS" nor "RAS"')
        self.space = space
        self.time_step = float(time_step)
        self.report: dict[str, Any] = {}

    def centers(self) -> Floats:
        """Physical coordinates of the centres of the voxels.

        Returns
        -------
        ndarray (..., d)
            x, y (and z), indexed as the image: for [z, y, x] an array (nz, ny, nx, 3).

        Examples
        --------
        >>> disc = csrbf.Image(np.zeros((3, 3))).centers() - 1
        >>> (np.hypot(disc[..., 0], disc[..., 1]) <= 1).astype(int)
        array([[0, 1, 0],
               [1, 1, 1],
               [0, 1, 0]])
        """
        plane = self._plane()
        shape = [self.values.shape[self.axes.index(axis)] for axis in plane]
        index = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij")[::-1], axis=-1)
        d = len(plane)
        places: Floats = (index * self.spacing[:d]) @ self.direction[:d, :d].T + self.origin[:d]
        return places

    def save(self, path: Path) -> None:
        """Write .png, .pgm, .ppm, .tif, .nii, .nii.gz, .nrrd, .mha, .mhd or .npy, by the extension of the name.

        The numbers keep their type where the format supports it. Pictures and .npy do not store the position in space.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        IoError
            When the file cannot be written, or its format cannot hold such an image.

        Examples
        --------
        >>> csrbf.Image(np.zeros((4, 5, 6), np.uint8), spacing=(1, 1, 2)).save("volume.nrrd")
        >>> csrbf.read_image("volume.nrrd").spacing
        array([1., 1., 2.])
        """
        _csrbf.write_image(os.fspath(path), self.values.ravel(), self._layout())

    def _plane(self) -> str:
        """The axes in space, slowest first."""
        return self.axes.strip("tc")

    def _layout(self) -> dict[str, Any]:
        size = dict(zip(self.axes, self.values.shape))
        dtype = np.dtype(np.uint8) if self.values.dtype == bool else self.values.dtype
        return {
            "axes": len(self._plane()),
            "size": [size.get(axis, 1) for axis in "xyz"],
            "spacing": self.spacing,
            "origin": self.origin,
            "direction": self.direction,
            "space": self.space,
            "frames": size.get("t", 1),
            "time_step": self.time_step,
            "components": size.get("c", 1),
            "type": dtype.name,
        }

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.shape))
        return f"<csrbf.Image of {shape} {self.dtype} [{', '.join(self.axes)}], spacing {self.spacing.tolist()}>"


def _checked_axes(axes: str | None, ndim: int) -> str:
    if axes is None:
        if not 1 <= ndim <= 4:
            raise ValueError(f"dimension of the image: {ndim}; must be 1 to 4, or give axes")
        return _AXES[ndim - 1]
    if len(axes) != ndim or axes.removeprefix("t").removesuffix("c") not in _AXES[:3]:
        raise ValueError(f'axes: "{axes}" does not name {ndim} axes; give "yx" or "zyx", "t" before and "c" after it')
    return axes


def _three(given: ArrayLike, dimension: int, name: str, missing: float) -> Floats:
    """One number, or one per axis, as three for x, y and z."""
    numbers = np.atleast_1d(np.asarray(given, dtype=float)).ravel()
    if len(numbers) == 1:
        numbers = np.repeat(numbers, dimension)
    if len(numbers) not in (dimension, 3):
        raise ValueError(f"{name}: has {len(numbers)} numbers; must be one, or one for each of the {dimension} axes")
    return np.concatenate([numbers, np.full(3 - len(numbers), missing)])


def image_from_layout(values: NDArray[Any], layout: dict[str, Any]) -> Image:
    """The image that the compiled module returned."""
    axes = "t" * (layout["frames"] > 1) + "zyx"[3 - layout["axes"] :] + "c" * (layout["components"] > 1)
    size = dict(zip("xyz", layout["size"]), t=layout["frames"], c=layout["components"])
    return Image(
        values.reshape([size[axis] for axis in axes]),
        layout["spacing"],
        layout["origin"],
        layout["direction"],
        axes=axes,
        space=layout["space"],
        time_step=layout["time_step"],
    )


def read_image(path: Path) -> Image:
    """The image of a file: .png, .pgm, .ppm, .tif, .nii, .nii.gz, .nrrd, .mha, .mhd, .npy or DICOM.

    Parameters
    ----------
    path : str or path-like
        For DICOM slices also their folder, when the library was built with GDCM.

    Returns
    -------
    Image
        An array [y, x] or [z, y, x] to numpy, in the type of the file, with spacing, origin and direction.

    Raises
    ------
    IoError
        With the file and the position in it, for unreadable data.

    Examples
    --------
    >>> csrbf.Image(np.eye(4, dtype=np.uint8)).save("diagonal.png")
    >>> image = csrbf.read_image("diagonal.png")
    >>> np.diagonal(image)
    array([1, 1, 1, 1], dtype=uint8)
    """
    return image_from_layout(*_csrbf.read_image(os.fspath(path)))


def as_image(image: ImageLike, voxel_size: ArrayLike | None = None) -> Image:
    """An argument `image`: an Image, an array or the name of a file."""
    if isinstance(image, Image) or isinstance(image, (str, os.PathLike)):
        if voxel_size is not None:
            raise ValueError("voxel_size: the image has one; pass the array to use another one")
        return image if isinstance(image, Image) else read_image(image)
    array = np.asarray(image)
    if voxel_size is not None and np.size(voxel_size) not in (1, array.ndim):
        raise ValueError(f"voxel_size: {voxel_size!r} must be one number, or one for each of the {array.ndim} axes")
    return Image(array, 1.0 if voxel_size is None else voxel_size)
