from __future__ import annotations

import os
from typing import Any, List

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path
from csrbf._function import Function
from csrbf._image import image_from_layout
from csrbf._mesh import Mesh, mesh_of


class Segmentation:
    """The regions of an image, with smooth boundaries, as found by `segment` and `track`.

    Attributes
    ----------
    labels : ndarray of uint8
        Like the image, 0 outside.
    field : Function
        The level set, a function of x, y (and z) in physical coordinates, positive inside; for more than two regions
        one value each, of which one is positive at every point.
    report : dict
        What was chosen and found: iterations, converged, energy, regions (label, voxels, volume, mean, sd),
        components, noise, speckle (the power of the amplitude that the image shows, None when it is not speckle),
        prices (of the energy "auto": energy, shading and nats, the length of the description of the image by each model
        over that by the one chosen), channels (the weights of the components, of whose sum the regions are), options,
        warnings.
    objects : ndarray of int32 or None
        With `objects=True` the number of the object that a voxel belongs to, from 1 on, 0 outside.
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
        objects: tuple[NDArray[np.int32], list[dict[str, Any]]] | None = None,
    ) -> None:
        self._segments = segments
        self.labels = segments.labels
        self.report = segments.report
        self.field = Function(segments.function())
        self.objects, self.table = objects or (None, None)

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
            Cells along the longest side of the image; chosen from the level set when not given.

        Returns
        -------
        Mesh or list of ndarray (n, 2)
            For a volume a mesh, for a 2D image the closed lines, with the inside on their left.

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> g = csrbf.segment(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0))
        >>> (line,) = g.contour()
        >>> bool(abs(np.hypot(*(line - [30, 20]).T) - 12).max() < 1)
        True
        """
        contour, _ = self._segments.contour(label, 0 if resolution is None else int(resolution))
        return contour if isinstance(contour, list) else mesh_of(contour)

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
            For a 2D image length and area, for a volume area and volume, with estimates of their errors: area_error and
            so on.

        Examples
        --------
        >>> y, x = np.mgrid[:48, :64]
        >>> g = csrbf.segment(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0))
        >>> bool(abs(g.measure()["area"] / (144 * np.pi) - 1) < 0.05)
        True
        """
        return self._segments.contour(label, 0 if resolution is None else int(resolution))[1]

    def save(self, path: Path) -> None:
        """Write the labels as an image, or the level set to a .csrbf file, by the extension of the name.

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
            image_from_layout(self.labels, self._segments.layout).save(path)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (
            self.field,
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
    labels: NDArray[np.uint8],
    layout: dict[str, Any],
    report: dict[str, Any],
    objects: NDArray[np.int32] | None = None,
    table: list[dict[str, Any]] | None = None,
) -> Segmentation:
    segmentation = Segmentation.__new__(Segmentation)
    segmentation._segments = _csrbf.Segments.restore(field._function, labels, layout)
    segmentation.labels, segmentation.report, segmentation.field = labels, report, field
    segmentation.objects, segmentation.table = objects, table
    return segmentation


class Tracking(List[Segmentation]):
    """The Segmentations of the frames of a sequence, in order.

    Attributes
    ----------
    measures : list of list of dict
        For each frame one dict per region except 0: label, voxels, volume (2D: area) and area (2D: length) of the level
        set, mean.
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

    def __reduce__(self) -> tuple[Any, ...]:
        return Tracking, (list(self), self.measures, self.warnings)
