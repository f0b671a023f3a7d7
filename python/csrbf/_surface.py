import os
import pathlib
import tempfile
from dataclasses import dataclass

import numpy as np

from csrbf import _csrbf
from csrbf._arrays import floats, queries, rows, smoothing_or_none


@dataclass
class Mesh:
    """Triangles over shared vertices, counter-clockwise seen from outside."""

    vertices: np.ndarray  # (v, 3)
    faces: np.ndarray  # (t, 3), numbers of vertices
    normals: np.ndarray  # (v, 3), unit, outward; or no row

    def save(self, path):
        """Writes .ply, .obj, .off or .stl, whichever the name ends with."""
        _csrbf.write_mesh(
            os.fspath(path), rows(self.vertices, "vertices"), np.asarray(self.faces), rows(self.normals, "normals")
        )


class Surface:
    """A closed surface as the zero set of a function f: f > 0 inside, f < 0 outside, close to the signed distance near
    the data.

    Points may come in an array of any shape (..., 3); the same leading shape comes back.

    report: dict with what `reconstruct` found, chose and measured; empty for surfaces read from files.
    """

    def __init__(self, surface, report=None):
        self._surface = surface
        self.report = report or {}

    @property
    def bounds(self):
        """Lower and upper corner of the box of the data, (2, 3)."""
        return self._surface.bounds

    def __call__(self, x):
        """f at points (m, 3): (m,), positive inside."""
        x, shape = queries(x, 3)
        return self._surface.evaluate(x, False)[0].reshape(shape)

    def gradient(self, x):
        """Gradient of f at points (m, 3): (m, 3). It points inwards."""
        x, shape = queries(x, 3)
        return self._surface.evaluate(x, True)[1].reshape(shape + (3,))

    def normal(self, x):
        """Outward unit normals -grad f / |grad f| at points (m, 3): (m, 3); NaN where the gradient is zero."""
        gradient = self.gradient(x)
        # Scaled first, for gradients whose squares are not in the range of numbers.
        largest = np.abs(gradient).max(axis=-1, keepdims=True, initial=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            gradient = gradient / largest
        return -gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)

    def contains(self, x):
        """Which of the points (m, 3) are inside: (m,) of bool."""
        return self(x) > 0

    def polygonize(self, resolution=None, *, level=0.0):
        """Triangle mesh of the surface f = level, watertight and manifold.

        resolution: cells along the longest side of the data; chosen from their sampling when not given.
        """
        return Mesh(*self._surface.polygonize(0 if resolution is None else int(resolution), float(level)))

    def save(self, path):
        """Writes a .csrbf file for `load` and the program csrbf. The report and the points are not part of it."""
        self._surface.save(os.fspath(path))

    def __reduce__(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "surface.csrbf")
            self.save(file)
            return _restore, (file.read_bytes(), self._surface.points, self.report)

    def __repr__(self):
        lower, upper = self.bounds
        return f"<csrbf.Surface in {lower.tolist()} ... {upper.tolist()}>"


def _restore(content, points, report):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "surface.csrbf")
        file.write_bytes(content)
        surface = _csrbf.read_surface(str(file))
    surface.points = points
    return Surface(surface, report)


def reconstruct(points, normals=None, method="auto", centers=None, tolerance=None, smoothing="auto"):
    """A closed implicit surface through, or under noise near, a cloud of points.

    points: (n, 3). normals: (n, 3), outward; they are turned round where they contradict each other, and estimated when
        not given.
    method: "auto", "composite", "medial-axis", ... (`csrbf reconstruct --help` lists them).
    centers: largest number of radial basis functions.
    tolerance: largest distance from a point to the surface, as a fraction of the diagonal of the bounding box.
    smoothing: "auto" chooses by cross-validation, "none" does not smooth, a number is taken as it is.
    """
    points = rows(points, "points")
    normals = None if normals is None else floats(normals, "normals")
    surface, report = _csrbf.reconstruct(
        points, normals, method, centers or 0, tolerance or 0.0, smoothing_or_none(smoothing)
    )
    return Surface(surface, report)
