from __future__ import annotations

import os
from typing import Any, List

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, whole
from csrbf._function import Function
from csrbf._image import Image, as_image, image_from_layout
from csrbf._mesh import Mesh, mesh_of, mesh_panel
from csrbf._show import Page, Panel, Shown, side_by_side


_MOST_KEPT = 1 << 26  # bytes of an image, or of a sequence, kept for pictures
_FRAMES = 4  # of a sequence in its picture


class Segmentation(Shown):
    """The regions of an image, with smooth boundaries, as found by `segment` and `track`.

    Attributes
    ----------
    labels : ndarray of uint8
        Like the image, 0 outside; a DataArray if the image is one.
    field : Function
        The level set, a function of x, y (and z) in physical coordinates, positive inside. For more than two regions it
        has one value per region, of which one is positive at every point.
    report : dict
        What was chosen and found: iterations, converged, energy, regions (label, voxels, volume, mean, sd), components,
        noise, options, warnings. None if they do not apply: noise_growth (standard deviation of the noise where the
        image is bright over that where it is dark), uneven_noise (largest standard deviation of the noise over the
        image, relative to the smallest), grain (voxels that one independent value of the noise covers), blur (standard
        deviation of the Gaussian, in voxels, if the regions are classes of the blurred image), impulses (share of dead
        and hot voxels), missing (share of missing voxels), textures (share of the variance that neighbours predict, for
        both regions), speckle (power of the amplitude that the image shows). Perhaps empty: prices (for the energy
        "auto": energy, shading and nats, by how much the description by each model is longer than that by the one
        chosen), channels (weights of the components in the sum that was segmented).
    objects : ndarray of int32 or None
        With `objects=True`, the number of the object of each voxel, from 1; 0 outside.
    table : list of dict or None
        For each object: label, voxels, volume and area (2D: area and length), centroid, axes of the ellipsoid with the
        same second moments, mean intensity, sphericity.

    Examples
    --------
    >>> y, x = np.mgrid[:48, :64]
    >>> g = csrbf.segment(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0))
    >>> g
    <csrbf.Segmentation of 48 x 64 voxels, 2 regions>
    >>> g.labels[20, 30], bool(g.field([30, 20]) > 0)
    (1, True)
    >>> two = np.minimum(np.hypot(x - 20, y - 24), np.hypot(x - 40, y - 24)) < 11
    >>> g = csrbf.segment(two, objects=True)
    >>> g.objects[24, 20], g.objects[24, 40], [row["voxels"] > 350 for row in g.table]
    (1, 2, [True, True])
    """

    labels: NDArray[np.uint8]
    field: Function
    report: dict[str, Any]
    objects: NDArray[np.int32] | None
    table: list[dict[str, Any]] | None

    def __init__(
        self,
        segments: _csrbf.Segments,
        objects: tuple[NDArray[np.int32], list[dict[str, Any]], int] | None = None,
        image: Image | None = None,
    ) -> None:
        self._segments = segments
        self.labels = segments.labels
        self.report = segments.report
        self.field = Function(segments.function())
        self.objects, self.table = objects[:2] if objects else (None, None)
        if objects:
            self.report["objects_left_out"] = objects[2]
        self._image = image if image is not None and image.values.nbytes <= _MOST_KEPT else None
        if image is not None:
            self.labels = image._labels_like(self.labels, "labels")
            self.objects = None if self.objects is None else image._labels_like(self.objects, "objects")

    @property
    def energy(self) -> list[float]:
        """Energy per voxel after each step.

        Examples
        --------
        >>> g = csrbf.segment(np.eye(12) + np.eye(12, k=1) > 0)
        >>> g.energy == sorted(g.energy, reverse=True)
        True
        """
        energy: list[float] = self.report["energy"]
        return energy

    def contour(self, label: int = 1, *, resolution: int | None = None) -> Mesh | list[Floats]:
        """The contour of a region, clipped at the border of the image, in physical coordinates.

        Parameters
        ----------
        label : int
        resolution : int, optional
            Cells along the longest side of the image; chosen from the level set by default.

        Returns
        -------
        Mesh or list of ndarray (n, 2)
            For a volume a mesh; for a 2D image its closed lines, with the inside on the left.

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> g = csrbf.segment(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0))
        >>> (line,) = g.contour()
        >>> bool(abs(np.hypot(*(line - [30, 20]).T) - 12).max() < 1)
        True
        """
        contour, _ = self._segments.contour(label, 0 if resolution is None else whole(resolution, "resolution"))
        return contour if isinstance(contour, list) else mesh_of(contour, self._segments.layout["space"])

    def measure(self, label: int = 1, *, resolution: int | None = None) -> dict[str, float]:
        """Measures of the contour of a region.

        Parameters
        ----------
        label : int
        resolution : int, optional
            As for `contour`.

        Returns
        -------
        dict
            Length and area for a 2D image, area and volume for a 3D one, with estimates of their errors: area_error and
            so on.

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> g = csrbf.segment(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0))
        >>> bool(abs(g.measure()["area"] / (144 * np.pi) - 1) < 0.05)
        True
        """
        return self._segments.contour(label, 0 if resolution is None else whole(resolution, "resolution"))[1]

    def plot(
        self, ax: Any = None, *, image: Any = None, axis: str = "z", slice: int | None = None, **options: Any
    ) -> Any:
        """Draw the contours over the image, or over a slice of a volume, with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on; new ones by default.
        image : Image, array_like or file name, optional
            The image that was segmented. Needed only after loading from a pickle and for images above 64 MB, which are
            not kept; without it the labels are drawn.
        axis : "x", "y" or "z"
            The axis across the slice.
        slice : int, optional
            Number of the slice along this axis; by default the one with most of the inside.
        **options
            Options of matplotlib's ``contour``, such as linewidths.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> csrbf.segment(np.eye(12) + np.eye(12, k=1) > 0).plot()  # doctest: +SKIP
        <Axes: xlabel='x', ylabel='y'>
        """
        from csrbf._plots import axes_for, line_color, plot_image

        labels = self._label_image()
        shown = self._image if image is None else as_image(image)
        back = labels if shown is None else shown
        if slice is None and labels.ndim == 3 and axis in labels.axes:
            across = labels.axes.index(axis)
            inside = np.moveaxis(np.asarray(labels), across, 0).reshape(labels.shape[across], -1) > 0
            slice = int(inside.sum(axis=1).argmax())
        plane, axes = back._slice(axis, slice)
        ax = plot_image(back, axes_for(ax), plane, axes, {})
        places = labels.centers()
        if labels.ndim == 3:
            places = np.take(places, slice or 0, axis=labels.axes.index(axis))
        values = self.field(places).reshape(places.shape[:2] + (-1,))
        left, right, bottom, top = ax.images[0].get_extent()
        rows, columns = values.shape[:2]
        x = left + (right - left) * (np.arange(columns) + 0.5) / columns
        y = top + (bottom - top) * (np.arange(rows) + 0.5) / rows
        for number, value in enumerate(np.moveaxis(values, 2, 0)[1 if values.shape[2] > 1 else 0 :]):
            if value.min() < 0 < value.max():
                ax.contour(x, y, value, **{"levels": [0.0], "colors": [line_color(number)], **options})
        return ax

    def _page(self, large: bool) -> Page:
        regions = self.report["regions"]
        facts = {"voxels": " x ".join(map(str, self._segments.labels.shape)), "regions": str(len(regions))}
        facts["components"] = f"{self.report['components']:,}"
        if self.table is not None:
            facts["objects"] = f"{len(self.table):,}"
            if self.report["objects_left_out"] > 0:
                facts["smaller ones left out"] = f"{self.report['objects_left_out']:,}"
        facts |= {f"mean of {region['label']}": f"{region['mean']:.4g}" for region in regions[:4]}
        panels = [] if self._image is None else [Panel(self._preview(large))]
        if self._segments.labels.ndim == 3:
            panels += self._surfaces(large)
        elif not panels:
            panels.append(Panel(label_picture(self._segments.labels)))
        return Page("Segmentation", facts, panels, list(self.report["warnings"]))

    def _preview(self, large: bool) -> NDArray[np.uint8]:
        """The image with the contours: three slices of a volume."""
        from csrbf._segment import volume_of

        assert self._image is not None
        volume = volume_of(self._image)
        pixels = 720 if large else 360
        if self._segments.labels.ndim == 2:
            return self._segments.preview(volume, 2, pixels)
        return side_by_side([self._segments.preview(volume, axis, pixels // 2) for axis in (2, 1, 0)])

    def _surfaces(self, large: bool) -> list[Panel]:
        """The contours of all regions but the outside, as one mesh; none where they are empty."""
        parts = []
        for region in self.report["regions"][1:]:
            try:
                parts.append(self.contour(region["label"], resolution=120 if large else 64))
            except (_csrbf.SolverFailure, ValueError):
                continue
        meshes = [part for part in parts if isinstance(part, Mesh) and len(part.faces) > 0]
        if not meshes:
            return []
        shifts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
        faces = np.concatenate([mesh.faces + shift for mesh, shift in zip(meshes, shifts)])
        colors = np.repeat(_TINTS[: len(meshes)], [len(mesh.vertices) for mesh in meshes[: len(_TINTS)]], axis=0)
        whole = Mesh(np.concatenate([mesh.vertices for mesh in meshes]), faces)
        if 1 < len(meshes) <= len(_TINTS):
            whole.properties = dict(zip(("red", "green", "blue"), colors.T))
        return [mesh_panel(whole, large, caption="The contour.")]

    def save(self, path: Path) -> None:
        """Write the level set to a .csrbf file, or the labels to an image file, by the extension.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        IoError
            When the file cannot be written.

        Examples
        --------
        >>> g = csrbf.segment(np.eye(12) + np.eye(12, k=1) > 0)
        >>> g.save("labels.png")
        >>> g.save("contour.csrbf")
        """
        if os.fspath(path).endswith(".csrbf"):
            self.field.save(path)
        else:
            self._label_image().save(path)

    def _label_image(self) -> Image:
        """The labels where the image is."""
        labels = self.labels if isinstance(self.labels, np.ndarray) else self._segments.labels
        return image_from_layout(labels, self._segments.layout)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (
            self.field,
            self._segments.labels,
            self.labels,
            self._segments.layout,
            self.report,
            self.objects,
            self.table,
        )

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.labels.shape))
        return f"<csrbf.Segmentation of {shape} voxels, {len(self.report['regions'])} regions>"


def _restore(
    field: Function,
    stored: NDArray[np.uint8],
    labels: NDArray[np.uint8],
    layout: dict[str, Any],
    report: dict[str, Any],
    objects: NDArray[np.int32] | None = None,
    table: list[dict[str, Any]] | None = None,
) -> Segmentation:
    segmentation = Segmentation.__new__(Segmentation)
    segmentation._segments = _csrbf.Segments.restore(field._function, stored, layout)
    segmentation.labels, segmentation.report, segmentation.field = labels, report, field
    segmentation.objects, segmentation.table, segmentation._image = objects, table, None
    return segmentation


_TINTS = np.array([[214, 96, 77], [244, 190, 70], [67, 147, 195], [90, 174, 97], [197, 120, 190]], dtype=np.uint8)


def label_picture(labels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Labels in colours, white outside."""
    colors = np.vstack([np.full((1, 3), 255, np.uint8), np.tile(_TINTS, (51, 1))])
    repeats = max(1, 360 // max(labels.shape))
    return np.kron(colors[labels], np.ones((repeats, repeats, 1), dtype=np.uint8))


class Tracking(List[Segmentation], Shown):
    """The Segmentations of the frames of a sequence, in order.

    Attributes
    ----------
    measures : list of list of dict
        For each frame, a dict per region except 0: label, voxels, mean intensity, and of the level set volume (2D:
        area) and area (2D: length).
    warnings : list of str

    Examples
    --------
    >>> y, x = np.mgrid[:48, :64]
    >>> discs = [np.where((x - 30) ** 2 + (y - 20) ** 2 < r**2, 10.0, 1.0) for r in (9, 10, 11)]
    >>> t = csrbf.track(discs)
    >>> len(t), t[1].labels.shape
    (3, (48, 64))
    """

    measures: list[list[dict[str, Any]]]
    warnings: list[str]

    def __init__(
        self, frames: list[Segmentation], measures: list[list[dict[str, Any]]], warnings: list[str]
    ) -> None:
        super().__init__(frames)
        if sum(frame._image.values.nbytes for frame in frames if frame._image is not None) > _MOST_KEPT:
            for frame in frames:
                frame._image = None
        self.measures = measures
        self.warnings = warnings

    def volumes(self, label: int = 1) -> Floats:
        """The volume (2D: area) of a region in each frame.

        Parameters
        ----------
        label : int

        Returns
        -------
        ndarray (frames,)

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> discs = [np.where((x - 30) ** 2 + (y - 20) ** 2 < r**2, 10.0, 1.0) for r in (9, 10, 11)]
        >>> volumes = csrbf.track(discs).volumes()
        >>> np.allclose(volumes, np.pi * np.array([9, 10, 11]) ** 2, rtol=0.05)
        True
        """
        return np.array([next(r["volume"] for r in regions if r["label"] == label) for regions in self.measures])

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the volumes (2D: areas) of the regions over the frames with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on; new ones by default.
        **options
            Options of matplotlib's ``plot``.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> csrbf.track([np.hypot(x - 30, y - 20) < r for r in (9, 10, 11)]).plot()  # doctest: +SKIP
        <Axes: xlabel='frame', ylabel='area'>
        """
        from csrbf._plots import axes_for

        ax = axes_for(ax)
        for label in [region["label"] for region in self.measures[0]] if self.measures else []:
            ax.plot(self.volumes(label), **{"marker": ".", "label": f"region {label}", **options})
        plane = len(self) > 0 and self[0]._segments.labels.ndim == 2
        ax.set(xlabel="frame", ylabel="area" if plane else "volume")
        ax.legend()
        return ax

    def _page(self, large: bool) -> Page:
        from csrbf._plots import plot_picture

        facts = {"frames": str(len(self))}
        if not self:
            return Page("Tracking", facts)
        facts["voxels"] = " x ".join(map(str, self[0]._segments.labels.shape))
        chosen = [frame for frame in self[:: max(1, -(-len(self) // _FRAMES))] if frame._image is not None]
        panels = [Panel(side_by_side([frame._preview(False) for frame in chosen]))] if chosen else []
        picture = plot_picture(self.plot, (6.4, 2.6))
        panels += [] if picture is None else [Panel(picture)]
        return Page("Tracking", facts, panels, self.warnings[:5])

    def __repr__(self) -> str:
        what = f" of {' x '.join(map(str, self[0]._segments.labels.shape))} voxels" if self else ""
        return f"<csrbf.Tracking of {len(self)} frames{what}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Tracking, (list(self), self.measures, self.warnings)
