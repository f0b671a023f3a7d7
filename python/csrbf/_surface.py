from __future__ import annotations

import os
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, floats, whole
from csrbf._curvature import Curvature
from csrbf._labels import Labelled, Places
from csrbf._mesh import Mesh, mesh_of, mesh_panel
from csrbf._options import MeshMethod, Operation, UpAxis
from csrbf._picture import Color, picture_options, reference_mesh, write_picture
from csrbf._polylines import Polylines
from csrbf._progress import Progress, listening
from csrbf._show import Page, Shown
from csrbf._viewer import Scale


class Surface(Shown):
    """A closed surface as the zero set of a function f: f > 0 inside, f < 0 outside, close to the signed distance near
    the data.

    Surfaces come from `reconstruct`, `reconstruct_contours`, `combine` and `load`. Points may be given in an array of
    any shape (..., 3); results have the same leading shape. ``a | b``, ``a & b``, ``a - b`` and ``~a`` are union,
    intersection, difference and complement. Surfaces can be pickled.

    Attributes
    ----------
    report : dict
        What `reconstruct` found, chose and measured; empty for other surfaces.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(2000, 3))
    >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
    >>> ball([0, 0, 0.9]).round(1), ball.contains([[0, 0, 0], [2, 0, 0]])
    (0.1, array([ True, False]))
    """

    report: dict[str, Any]

    def __init__(self, surface: _csrbf.Surface, report: dict[str, Any] | None = None) -> None:
        self._surface = surface
        self.report = report or {}
        self._shown: dict[int, Mesh] = {}

    @property
    def bounds(self) -> Floats:
        """Lower and upper corner of the box of the data, (2, 3).

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball.bounds.round(1)
        array([[-1., -1., -1.],
               [ 1.,  1.,  1.]])
        """
        return self._surface.bounds

    @overload
    def __call__(self, x: Labelled) -> Any: ...
    @overload
    def __call__(self, x: ArrayLike) -> Floats: ...
    def __call__(self, x: Any) -> Any:
        """Values of f at points, positive inside.

        Parameters
        ----------
        x : array_like (..., 3), DataFrame or DataArray
            Of a table the columns x, y and z.

        Returns
        -------
        ndarray (...), or of the kind of `x`

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball([[0, 0, 0.9], [0, 0, 1.1]]).round(1)
        array([ 0.1, -0.1])
        """
        places = Places(x, "xyz")
        return places.like_given(self._surface.evaluate(places.rows, False)[0], ["value"])

    @overload
    def gradient(self, x: Labelled) -> Any: ...
    @overload
    def gradient(self, x: ArrayLike) -> Floats: ...
    def gradient(self, x: Any) -> Any:
        """Gradients of f at points. They point inwards.

        Parameters
        ----------
        x : array_like (..., 3), DataFrame or DataArray

        Returns
        -------
        ndarray (..., 3), or of the kind of `x`
            With the columns value_x, value_y and value_z.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> bool(ball.gradient([0, 0, 1])[2] < -0.9)
        True
        """
        places = Places(x, "xyz")
        return places.like_given(self._surface.evaluate(places.rows, True)[1], ["value_x", "value_y", "value_z"])

    def normal(self, x: ArrayLike) -> Floats:
        """Outward unit normals -grad f / \\|grad f\\| at points; NaN where the gradient is zero.

        Parameters
        ----------
        x : array_like (..., 3)

        Returns
        -------
        ndarray (..., 3)

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> np.allclose(ball.normal([0, 0, 1]), [0, 0, 1], atol=0.02)
        True
        """
        gradient = self.gradient(floats(x, "x"))
        # Scaled first: squares of the gradient may overflow or underflow.
        largest = np.abs(gradient).max(axis=-1, keepdims=True, initial=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            gradient = gradient / largest
        length: Floats = np.linalg.norm(gradient, axis=-1, keepdims=True)
        return -gradient / length

    def curvature(self, x: ArrayLike) -> Curvature:
        """Curvatures of the surfaces f = constant through points.

        Parameters
        ----------
        x : array_like (..., 3)

        Returns
        -------
        Curvature

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(2 * x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> bool(abs(np.median(ball.curvature(ball.points).mean) - 0.5) < 0.01)
        True
        """
        x = floats(x, "x")
        if x.ndim == 0 or x.shape[-1] != 3:
            raise ValueError(f"x: has shape {x.shape}; its last axis must hold the 3 coordinates of a point")
        k1, k2, direction1, direction2 = self._surface.curvature(x.reshape(-1, 3))
        shape = x.shape[:-1]
        return Curvature(
            k1.reshape(shape), k2.reshape(shape), direction1.reshape(x.shape), direction2.reshape(x.shape)
        )

    @property
    def points(self) -> Floats:
        """The points used to make the surface; none for surfaces not made from points.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True)).points.shape
        (2000, 3)
        """
        return self._surface.points

    def contains(self, x: ArrayLike) -> NDArray[np.bool_]:
        """Which of the points are inside.

        Parameters
        ----------
        x : array_like (..., 3)

        Returns
        -------
        ndarray (...) of bool

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball.contains([[0, 0, 0], [2, 0, 0]])
        array([ True, False])
        """
        inside: NDArray[np.bool_] = self(x) > 0
        return inside

    def polygonize(
        self,
        resolution: int | None = None,
        *,
        level: float = 0.0,
        method: MeshMethod = "auto",
        tolerance: float | None = None,
        persistence: float | None = None,
        refine: bool = True,
        trim: float | None = None,
        progress: Progress = None,
    ) -> Mesh:
        """Triangle mesh of the surface f = level, watertight and manifold, with normals.

        Parameters
        ----------
        resolution : int, optional
            Cells along the longest side of the data; chosen from their sampling when not given.
        level : float
            Value of f on the surface; larger values are inside.
        method : str
            "marching-cubes", "marching-tetrahedra", "dual-contouring" (preserves sharp edges) or "adaptive" (the same
            with larger triangles where the surface is flat). "auto": dual contouring for surfaces from points without
            noise by the method composite, else marching cubes.
        tolerance : float, optional
            For "adaptive", approximate largest distance of the mesh from the surface, as a fraction of the diagonal; a
            tenth of a cell when not given.
        persistence : float, optional
            Bridges are cut and holes filled that are gone once the level moves by less than this value of f; 0 leaves
            all. When not given, a fifth of the smallest details, three tenths where the points are noisy; 0 for
            surfaces of other methods than composite.
        refine : bool
            Whether vertices are moved onto the surface.
        trim : float, optional
            Drop what is further than this many local point spacings from the data; the mesh is then open.
        progress : bool or callable, optional
            See `fit`.

        Returns
        -------
        Mesh

        Raises
        ------
        SolverFailure
            When there is no such surface.

        Warns
        -----
        UserWarning
            When many components have few points and lie beside others, as where a surface is torn.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> mesh = ball.polygonize(resolution=40)
        >>> mesh.topology["watertight"], round(mesh.volume, 1)
        (True, 4.2)
        """
        cells = 0 if resolution is None else whole(resolution, "resolution")
        bound = 0.0 if tolerance is None else float(tolerance)
        with listening(progress) as listener:
            return mesh_of(
                self._surface.polygonize(
                    cells, float(level), str(method), bound, persistence, bool(refine), trim, listener
                )
            )

    def raycast(
        self, origins: ArrayLike, directions: ArrayLike, *, resolution: int | None = None
    ) -> tuple[Floats, Floats]:
        """First intersections of rays with the surface f = 0, from either side.

        Parameters
        ----------
        origins : array_like (..., 3)
        directions : array_like (..., 3)
            Of any nonzero length. A single origin or direction (3,) is used for all rays.
        resolution : int, optional
            Cells of the search along the longest side of the data; parts thinner than one may be missed.

        Returns
        -------
        distances : ndarray (...)
            Lengths, inf for rays that miss. The points are origins + distances directions / \\|directions\\|.
        normals : ndarray (..., 3)
            Outward unit normals there, NaN for rays that miss.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> distances, normals = ball.raycast([0, 0, 5], [[0, 0, -1], [1, 0, 0]])
        >>> distances.round(2)
        array([ 4., inf])
        """
        given = {"origins": floats(origins, "origins"), "directions": floats(directions, "directions")}
        for name, array in given.items():
            if array.ndim == 0 or array.shape[-1] != 3:
                raise ValueError(f"{name}: has shape {array.shape}; its last axis must hold 3 coordinates")
        try:
            starts, ways = np.broadcast_arrays(*given.values())
        except ValueError:
            shapes = " and ".join(str(array.shape) for array in given.values())
            raise ValueError(f"origins and directions: have shapes {shapes}; give one of each, or as many") from None
        shape = starts.shape[:-1]
        cells = 0 if resolution is None else whole(resolution, "resolution")
        starts, ways = (np.ascontiguousarray(rays).reshape(-1, 3) for rays in (starts, ways))
        t, normals = self._surface.raycast(starts, ways, cells)
        return t.reshape(shape), normals.reshape(shape + (3,))

    def ridges(
        self, mesh: Mesh | None = None, *, level: float = 0.0, least_turning: float = 2.0, progress: Progress = None
    ) -> Polylines:
        """Ridge and valley lines, along which the surface is curved most.

        Parameters
        ----------
        mesh : Mesh, optional
            Of the surface f = level, which the lines follow; made by `polygonize` when not given.
        level : float
            Value of f on the surface.
        least_turning : float
            Lines across which the normal turns by less than this angle in total are dropped; radians.
        progress : bool or callable, optional
            See `fit`.

        Returns
        -------
        Polylines
            With the properties kind, 1 on ridges and -1 on valleys, and curvature.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> x /= np.linalg.norm(x, axis=1, keepdims=True)
        >>> lens = csrbf.reconstruct(x * [1, 1, 0.3])
        >>> rim = lens.ridges(lens.polygonize(40))
        >>> bool(abs(np.linalg.norm(rim.vertices[rim.properties["kind"] == 1], axis=1) - 1).max() < 0.05)
        True
        """
        base = self.polygonize(level=level) if mesh is None else mesh
        with listening(progress) as listener:
            return Polylines(*self._surface.ridges(base._arrays(), float(level), float(least_turning), listener))

    def render(
        self,
        path: Path | None = None,
        *,
        size: tuple[int, int] = (800, 600),
        view: tuple[float, float] = (30.0, 20.0),
        up: UpAxis = "z",
        color: str = "plain",
        reference: Mesh | Path | None = None,
        color_limit: float = 0.0,
        field_of_view: float = 20.0,
        material: Color = (0.80, 0.76, 0.71),
        background: Color = (1.0, 1.0, 1.0),
        ground: bool = True,
        progress: Progress = None,
    ) -> NDArray[np.uint8]:
        """A ray-traced picture of the surface.

        Parameters
        ----------
        path : str or path-like, optional
            .png file to write.
        size : (int, int)
            Width and height in pixels.
        view : (float, float)
            Position of the camera, degrees: azimuth about the axis `up`, then elevation.
        up : "x", "y" or "z"
            The axis that points up.
        color : str
            "plain", "normal", "mean-curvature", "gaussian-curvature", or "error": distance to the mesh `reference`.
        reference : Mesh or file name, optional
            For the colour "error"; can also be given as "error:FILE".
        color_limit : float
            Value at the ends of the colour scale, in units of the diagonal of the surface; 0: from what is visible.
        field_of_view : float
            Degrees across the shorter side; 0: parallel rays.
        material, background : (float, float, float)
            Red, green and blue from 0 to 1.
        ground : bool
            Whether a shadow is drawn below.
        progress : bool or callable, optional
            See `fit`.

        Returns
        -------
        ndarray (height, width, 3) of uint8
            The picture.

        Raises
        ------
        ValueError
            For options out of range.
        IoError
            When the picture cannot be written.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball.render("ball.png", size=(80, 60)).shape
        (60, 80, 3)
        """
        options, color_reference = picture_options(
            size, view, up, color, color_limit, field_of_view, material, background, ground
        )
        to = reference_mesh(reference if color_reference is None else color_reference)
        with listening(progress) as listener:
            picture = self._surface.render(options, to, listener)
        return write_picture(path, picture)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw a mesh of the surface with matplotlib, ray-traced; `render` draws the surface itself.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Those of a new figure when not given.
        **options
            Of `Mesh.render`.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball.plot(size=(160, 120))  # doctest: +SKIP
        <Axes: >
        """
        return self._mesh_shown(120).plot(ax, **options)

    def _mesh_shown(self, resolution: int) -> Mesh:
        """A mesh for pictures, with its mean curvature."""
        if resolution not in self._shown:
            mesh = self.polygonize(resolution, method="marching-cubes")
            curvature = self.curvature(mesh.vertices).mean
            self._shown[resolution] = Mesh(mesh.vertices, mesh.faces, mesh.normals, {"mean_curvature": curvature})
        return self._shown[resolution]

    def _page(self, large: bool) -> Page:
        resolution = 120 if large else 64
        mesh = self._mesh_shown(resolution)
        scale = Scale("mean curvature", "mean curvature", mesh.properties["mean_curvature"], diverging=True)
        facts = {"sides of the box": " x ".join(f"{side:.3g}" for side in self.bounds[1] - self.bounds[0])}
        if "points" in self.report:
            facts["points"] = f"{self.report['points']:,}"
            facts["rms distance / diagonal"] = f"{self.report['rms_distance']:.2g}"
            facts["method"] = str(self.report["method"])
        caption = f"A mesh of {resolution} cells along the longest side; polygonize() chooses as many as the data need."
        panel = mesh_panel(mesh, large, [scale], self.points if len(self.points) > 0 else None, caption)
        return Page("Surface", facts, [panel], list(self.report.get("warnings", [])))

    def save(self, path: Path) -> None:
        """Write a .csrbf file, which `load` and the program csrbf read.

        It does not contain the report and the points.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        ValueError
            For surfaces of methods that cannot be saved.
        IoError
            When the file cannot be written.

        Examples
        --------
        >>> x = np.random.default_rng(0).normal(size=(2000, 3))
        >>> ball = csrbf.reconstruct(x / np.linalg.norm(x, axis=1, keepdims=True))
        >>> ball.save("ball.csrbf")
        """
        self._surface.save(os.fspath(path))

    def __or__(self, other: Surface) -> Surface:
        """Union, with edges where the surfaces cross."""
        return _combined("union", self, other)

    def __and__(self, other: Surface) -> Surface:
        """Intersection."""
        return _combined("intersection", self, other)

    def __sub__(self, other: Surface) -> Surface:
        """The part inside this surface and outside the other one."""
        return _combined("difference", self, other)

    def __invert__(self) -> Surface:
        """The same surface with inside and outside swapped."""
        from csrbf._combine import combine

        return combine("complement", self)

    def __reduce__(self) -> tuple[Any, ...]:
        surface = self._surface
        return _restore, (surface.to_bytes(), surface.points, surface.normals, self.report)

    def __repr__(self) -> str:
        lower, upper = (", ".join(f"{x:.6g}" for x in corner) for corner in self.bounds)
        return f"<csrbf.Surface in [{lower}] ... [{upper}]>"


def _combined(operation: Operation, first: Surface, second: Surface) -> Surface:
    from csrbf._combine import combine

    return combine(operation, first, second) if isinstance(second, Surface) else NotImplemented


def _restore(content: bytes, points: Floats, normals: Floats, report: dict[str, Any]) -> Surface:
    return Surface(_csrbf.Surface.from_bytes(content, points, normals), report)
