from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import ArrayBacked, Floats, Path, numbers
from csrbf._labels import is_data_array
from csrbf._masks import as_nan, data_of, mask_of, masked, range_of
from csrbf._nibabel import is_nibabel, values_and_position
from csrbf._options import Space
from csrbf._show import Page, Panel, Shown, side_by_side

if TYPE_CHECKING:
    ImageLike = Union["Image", ArrayLike, Path]

_AXES = ("x", "yx", "zyx", "tzyx")  # default meaning of an array with that many axes


class Image(ArrayBacked, Shown):
    """An image or volume with its position in space. To numpy it is the array of its values.

    Parameters
    ----------
    values : array_like
        Indexed [y, x] or [z, y, x]; x is the fastest axis. Masked voxels (numpy.ma) have no value.
    spacing : float or sequence of float
        Distance between neighbouring voxels along x, y (and z), or one number for all axes.
    origin : sequence of float
        Coordinates of the centre of the first voxel.
    direction : array_like (3, 3), optional
        Its columns are the unit vectors of the axes x, y and z; by default those of space.
    axes : str, optional
        Meaning of the axes of the array: "yx" or "zyx", preceded by "t" for time and followed by "c" for components
        such as colours. By default "x", "yx", "zyx" or "tzyx", by the number of axes, and "yxc" if the last of three
        axes has the length 3 or 4.
    space : "unknown", "LPS" or "RAS"
        Orientation of the axes of space: for a patient, "LPS" (x points to the left, y to the back) or "RAS" (to the
        right, to the front); z points to the head.
    time_step : float
        Seconds between frames.

    Attributes
    ----------
    values : ndarray, or masked array if voxels are masked array where voxels are masked
    spacing, origin : ndarray (3,)
        For x, y and z, also for 2D images.
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
        space: Space = "unknown",
        time_step: float = 1.0,
    ) -> None:
        mask, plain = mask_of(values), numbers(data_of(values), "image")
        self.values = self._array = plain if mask is None else masked(plain, mask)
        self.axes = _checked_axes(axes, self.values.shape)
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
            x, y (and z), indexed as the image: (nz, ny, nx, 3) for [z, y, x].

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
        """Write an image file, by the extension of the name.

        Formats: .png, .pgm, .ppm, .jpg, .bmp, .tif, .nii, .nii.gz, .nrrd, .mha, .mhd, .npy, .vti and, if built with
        GDAL, .asc and .nc. Values keep their type if the format supports it. Pictures and .npy do not store the
        position in space.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        IoError
            If the file cannot be written, or its format cannot hold the image.

        Examples
        --------
        >>> csrbf.Image(np.zeros((4, 5, 6), np.uint8), spacing=(1, 1, 2)).save("volume.nrrd")
        >>> csrbf.read_image("volume.nrrd").spacing
        array([1., 1., 2.])
        """
        _csrbf.write_image(os.fspath(path), self._filled().ravel(), self._layout())

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        values = self._filled()
        return np.array(values, dtype=dtype) if copy else np.asarray(values, dtype=dtype)

    def _filled(self) -> NDArray[Any]:
        """The values, NaN where they are masked; refused where they cannot be."""
        if mask_of(self.values) is None:
            return self.values
        if self.values.dtype.kind != "f":
            raise ValueError(
                f"image: voxels are masked, and {self.values.dtype} has no number for them; use .values.filled()"
            )
        return as_nan(self.values).astype(self.values.dtype)

    def _mask(self) -> NDArray[np.bool_] | None:
        """Masked voxels, whatever component of theirs is masked; None without any."""
        mask = mask_of(self.values)
        if mask is None or not self.axes.endswith("c"):
            return mask
        hidden: NDArray[np.bool_] = mask.any(axis=-1)
        return hidden

    def plot(self, ax: Any = None, *, axis: str = "z", slice: int | None = None, frame: int = 0, **options: Any) -> Any:
        """Draw the image, or a slice of a volume, with matplotlib, in physical coordinates.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on; new ones by default.
        axis : "x", "y" or "z"
            The axis across the slice.
        slice : int, optional
            Number of the slice along this axis; by default the middle one.
        frame : int
            Number of the frame of a sequence.
        **options
            Options of matplotlib's ``imshow``.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> csrbf.Image(np.eye(8)).plot()  # doctest: +SKIP
        <Axes: xlabel='x', ylabel='y'>
        """
        from csrbf._plots import axes_for, plot_image

        plane, axes = self._slice(axis, slice, frame)
        return plot_image(self, axes_for(ax), plane, axes, options)

    def _slice(self, axis: str, number: int | None, frame: int = 0) -> tuple[NDArray[Any], tuple[int, int]]:
        """A plane [row, column] or [row, column, component] of the values, and the axes of its columns and rows."""
        values = self.values[frame] if self.axes.startswith("t") else self.values
        plane = self._plane()
        if len(plane) == 1:
            values, plane = values[None], "yx"
        if len(plane) == 3:
            if axis not in ("x", "y", "z"):
                raise ValueError(f'axis: "{axis}" must be "x", "y" or "z"')
            place = plane.index(axis)
            count = values.shape[place]
            number = count // 2 if number is None else number
            if not 0 <= number < count:
                raise ValueError(f"slice: {number} must be from 0 to {count - 1}")
            values, plane = np.take(values, number, axis=place), plane.replace(axis, "")
        if self.axes.endswith("c") and values.shape[-1] not in (3, 4):
            values = values[..., 0]
        rows, columns = ("xyz".index(name) for name in plane)
        return values, (columns, rows)

    def _page(self, large: bool) -> Page:
        facts = {f"size [{', '.join(self.axes)}]": " x ".join(map(str, self.shape)), "type": str(self.dtype)}
        facts["spacing"] = ", ".join(f"{step:.4g}" for step in self.spacing[: len(self._plane())])
        low, high = range_of(self.values)
        if not np.isfinite(high - low):
            return Page("Image", facts, notes=["No value is finite."])
        facts["values"] = f"{low:.4g} to {high:.4g}"
        pictures = []
        for axis in ("z", "y", "x") if len(self._plane()) == 3 else ("z",):
            plane, axes = self._slice(axis, None)
            pictures.append(_picture_of(plane, [self.spacing[a] for a in axes], large))
        caption = "The middle slices across z, y and x." if len(pictures) == 3 else ""
        return Page("Image", facts, [Panel(side_by_side(pictures), caption)])

    def _result(self, values: NDArray[Any], report: dict[str, Any]) -> Any:
        """An image of other values at the same place, of the kind that users gave this one in."""
        place = (self.spacing, self.origin, self.direction)
        image = Image(values, *place, axes=self.axes, space=self.space, time_step=self.time_step)
        image.report = report
        return image

    def _aligned(self, given: Any, name: str) -> Any:
        """Another array about the voxels, its axes in the order of those of this image."""
        return given

    def _frame(self, number: int) -> Image:
        """A frame of a sequence."""
        place = (self.spacing, self.origin, self.direction)
        return Image(self.values[number], *place, axes=self.axes[1:], space=self.space)

    def _labels_like(self, labels: NDArray[Any], name: str) -> Any:
        """An array with one number for each voxel, of the kind that users gave the image in."""
        return labels

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


_PIXELS = 360, 720  # along the longer side of a picture in a notebook and in a file


def _picture_of(plane: NDArray[Any], spacing: Sequence[float], large: bool) -> NDArray[np.uint8]:
    """A plane as a picture, its pixels repeated or left out; grey from the 1st to the 99th of 100 values."""
    colored = plane.ndim == 3
    values = as_nan(plane)
    if colored and plane.dtype == np.uint8:
        low, high = 0.0, 255.0
    elif colored and np.nanmin(values) >= 0 and np.nanmax(values) <= 1:
        low, high = 0.0, 1.0
    else:
        finite = values[np.isfinite(values)]
        low, high = np.percentile(finite, [1, 99]) if finite.size > 0 else (0.0, 1.0)
    grey = np.nan_to_num(255 * np.clip((values - low) / (high - low if high > low else 1), 0, 1)).astype(np.uint8)
    picture = grey[..., :3] if colored else np.repeat(grey[..., None], 3, axis=2)
    extent = np.array([plane.shape[0] * spacing[1], plane.shape[1] * spacing[0]])
    pixels = np.maximum(1, np.rint(_PIXELS[large] * extent / extent.max())).astype(int)
    row, column = (np.arange(pixels[a]) * plane.shape[a] // pixels[a] for a in range(2))
    shown: NDArray[np.uint8] = picture[row][:, column]
    return shown


def _checked_axes(axes: str | None, shape: tuple[int, ...]) -> str:
    ndim = len(shape)
    if axes is None:
        if not 1 <= ndim <= 4:
            raise ValueError(f"image: has {ndim} axes; must have 1 to 4, or give axes")
        return _axes_of_picture(shape) if ndim > 2 and shape[-1] in (3, 4) else _AXES[ndim - 1]
    if len(axes) != ndim or axes.removeprefix("t").removesuffix("c") not in _AXES[:3]:
        raise ValueError(f'axes: "{axes}" does not name {ndim} axes; give "yx" or "zyx", "t" before and "c" after it')
    return axes


def _axes_of_picture(shape: tuple[int, ...]) -> str:
    """Axes of an array whose last axis is as long as colours are: they are, unless the others are as short."""
    if len(shape) == 3 and min(shape[:2]) > 4:
        return "yxc"
    if max(shape) <= 4:
        return _AXES[len(shape) - 1]
    colours = {3: "yxc", 4: "tyxc"}[len(shape)]
    raise ValueError(
        f"image: has shape {shape}, whose last axis may be colours or x; give csrbf.Image(array, "
        f'axes="{colours}") or csrbf.Image(array, axes="{_AXES[len(shape) - 1]}")'
    )


def _three(given: ArrayLike, dimension: int, name: str, missing: float) -> Floats:
    """One number, or one per axis, as three for x, y and z."""
    numbers = np.atleast_1d(np.asarray(given, dtype=float)).ravel()
    if len(numbers) == 1:
        numbers = np.repeat(numbers, dimension)
    if name == "voxel_size" and not (np.isfinite(numbers) & (numbers > 0)).all():
        raise ValueError(f"{name}: {given!r} must be positive")
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
    """Read an image from a file.

    Parameters
    ----------
    path : str or path-like
        A .png, .pgm, .ppm, .jpg, .bmp, .tif, .nii, .nii.gz, .nrrd, .mha, .mhd, .npy or .vti file; if built with GDAL
        also .asc, .nc, .hgt and .grd; if built with GDCM also a DICOM file or the folder of its slices.

    Returns
    -------
    Image
        To numpy an array [y, x] or [z, y, x] of the type in the file, with spacing, origin and direction.

    Raises
    ------
    IoError
        For data that cannot be read, with the file and the position in it.

    Examples
    --------
    >>> csrbf.Image(np.eye(4, dtype=np.uint8)).save("diagonal.png")
    >>> image = csrbf.read_image("diagonal.png")
    >>> np.diagonal(image)
    array([1, 1, 1, 1], dtype=uint8)
    """
    return image_from_layout(*_csrbf.read_image(os.fspath(path)))


def as_image(image: ImageLike, voxel_size: ArrayLike | None = None) -> Image:
    """An argument `image`: an Image, an array, the name of a file, or an image of nibabel."""
    if isinstance(image, Image) or isinstance(image, (str, os.PathLike)):
        if voxel_size is not None:
            raise ValueError("voxel_size: the image has one; pass the array to use another one")
        return image if isinstance(image, Image) else read_image(image)
    if is_data_array(image):
        if voxel_size is not None:
            raise ValueError("voxel_size: follows from the coordinates of the DataArray; leave it out")
        from csrbf._grid_image import GridImage

        return GridImage(image)
    if is_nibabel(image):
        if voxel_size is not None:
            raise ValueError("voxel_size: the image has one; pass its array to use another one")
        values, position = values_and_position(image)
        return Image(values, **position)
    made = Image(image, 1.0 if voxel_size is None else voxel_size)
    axes = made._plane()
    if voxel_size is not None and np.size(voxel_size) not in (1, len(axes)):
        raise ValueError(
            f"voxel_size: {voxel_size!r} must be one number, or one for each of the {len(axes)} axes {', '.join(axes)}"
        )
    return made
