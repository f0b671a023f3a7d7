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


@dataclass
class Curvature:
    """How a surface is curved at points (m, 3); NaN where its gradient is zero."""

    k1: np.ndarray  # (m,), the larger principal curvature, positive where the inside is convex
    k2: np.ndarray  # (m,), the smaller one
    direction1: np.ndarray  # (m, 3), unit tangent along which the curvature is k1
    direction2: np.ndarray  # (m, 3), unit tangent along which it is k2

    @property
    def mean(self):
        """Mean curvature (k1 + k2) / 2."""
        return 0.5 * (self.k1 + self.k2)

    @property
    def gaussian(self):
        """Gaussian curvature k1 k2."""
        return self.k1 * self.k2


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

    def curvature(self, x):
        """Curvatures of the surfaces f = constant through points (m, 3): a Curvature."""
        x, shape = queries(x, 3)
        k1, k2, direction1, direction2 = self._surface.curvature(x)
        vector = shape + (3,)
        return Curvature(k1.reshape(shape), k2.reshape(shape), direction1.reshape(vector), direction2.reshape(vector))

    def contains(self, x):
        """Which of the points (m, 3) are inside: (m,) of bool."""
        return self(x) > 0

    def polygonize(self, resolution=None, *, level=0.0, method="marching-cubes", tolerance=None):
        """Triangle mesh of the surface f = level, watertight and manifold.

        resolution: cells along the longest side of the data; chosen from their sampling when not given.
        method: "marching-cubes", "marching-tetrahedra", "dual-contouring" (keeps the sharp edges of combined surfaces)
        or "adaptive" (the same with larger triangles where the surface is flat).
        tolerance: of "adaptive", about how far the mesh may be from the surface, as a fraction of the diagonal; a tenth
        of a cell when not given.
        """
        return Mesh(*self._surface.polygonize(0 if resolution is None else int(resolution), float(level), str(method),
                                              0.0 if tolerance is None else float(tolerance)))

    def raycast(self, origins, directions, *, resolution=None):
        """Where rays first meet the surface f = 0, from either side: distances (m,), inf for rays that meet nothing, and
        outward unit normals (m, 3), NaN for those.

        origins, directions: (m, 3); one origin (3,) may serve all rays. Directions may have any length but 0; distances
        are lengths. Points of the surface are origins + t directions / |directions|.
        resolution: cells of the search along the longest side of the data; parts thinner than one may be missed.
        """
        directions, shape = queries(directions, 3)
        origins = np.broadcast_to(floats(origins, "origins"), shape + (3,)).reshape(-1, 3)
        cells = 0 if resolution is None else int(resolution)
        t, normals = self._surface.raycast(np.ascontiguousarray(origins), directions, cells)
        return t.reshape(shape), normals.reshape(shape + (3,))

    def save(self, path):
        """Writes a .csrbf file for `load` and the program csrbf. The report and the points are not part of it."""
        self._surface.save(os.fspath(path))

    def __or__(self, other):
        """Union, with edges where the surfaces cross."""
        return combine("union", self, other) if isinstance(other, Surface) else NotImplemented

    def __and__(self, other):
        """Intersection."""
        return combine("intersection", self, other) if isinstance(other, Surface) else NotImplemented

    def __sub__(self, other):
        """What is inside this surface and outside the other one."""
        return combine("difference", self, other) if isinstance(other, Surface) else NotImplemented

    def __invert__(self):
        """The same surface with inside and outside exchanged."""
        return combine("complement", self)

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


def reconstruct_contours(contours, *, centers=2000, smoothing="auto"):
    """A smooth closed implicit surface through contours that were drawn on slices.

    contours: closed curves, each an array (n, 3) of its points in order, in a plane of its own or with others; at least
        two planes, which need not be parallel. Inside is where an odd number of curves of a plane is around a place.
    centers: largest number of basis functions, two for each point used.
    smoothing: "none" meets all contours; 1e-4 to 1e-2 smooth contours that do not fit together; "auto" smooths those in
        zigzag, as traced from pixels.
    """
    curves = [rows(curve, "contours") for curve in contours]
    sizes = [len(curve) for curve in curves]
    points = np.concatenate(curves) if curves else np.empty((0, 3))
    surface, report = _csrbf.reconstruct_contours(points, sizes, int(centers), smoothing_or_none(smoothing))
    return Surface(surface, report)


def combine(operation, *surfaces, radius=None, sharpness=None, blending=None):
    """Joins, intersects, cuts or blends surfaces.

    operation: "union", "intersection", "difference" (the first without the others), "complement" (of one surface) or
        "blend" (a union with rounded edges).
    radius: range of the blend, as a fraction of the diagonal of the box of all surfaces; surfaces further apart keep
        their shape. Default: 0.05 for "blend", else edges are sharp.
    sharpness: how closely the blend follows the edge, from 1 (a chamfer) on; default 3.
    blending: "sharp", "r-function" (the same edges, smooth elsewhere), "super-elliptic" (the default with a radius) or
        "log-sum-exp" (rounds edges, and swells a little everywhere).
    """
    rounded = operation == "blend" or radius is not None or sharpness is not None
    if blending is None:
        blending = "super-elliptic" if rounded else "sharp"
    if rounded and blending in ("sharp", "r-function"):
        raise ValueError(f'blending: "{blending}" has no radius or sharpness')
    if operation == "blend":
        operation = "union"
    for surface in surfaces:
        if not isinstance(surface, Surface):
            raise ValueError(f"surfaces: {surface!r} is not a csrbf.Surface")
    parts = [surface._surface for surface in surfaces]
    radius = 0.05 if radius is None else float(radius)
    sharpness = 3.0 if sharpness is None else float(sharpness)
    return Surface(_csrbf.combine(operation, parts, blending, radius, sharpness))


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
