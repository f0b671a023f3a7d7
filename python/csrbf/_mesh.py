from __future__ import annotations

import dataclasses
import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, indices, rows
from csrbf._coarse import coarse, with_normals
from csrbf._options import UpAxis
from csrbf._picture import Color, picture_options, reference_mesh, write_picture
from csrbf._progress import Progress, listening
from csrbf._show import Page, Panel, Shown
from csrbf._viewer import MOST_VERTICES, Scale, View, colors_of

if TYPE_CHECKING:
    from csrbf._csrbf import MeshArrays


_VERTICES_IN_NOTEBOOK = 20000  # half a megabyte; notebooks hold many pictures
_POINTS_SHOWN = 10000  # more hide the surface
_RAYS = 2  # of shadows per pixel: the picture is only seen where the page cannot be turned
PLAIN: Color = (0.80, 0.76, 0.71)
WHITE: Color = (1.0, 1.0, 1.0)


class Mesh(Shown):
    """A mesh of triangles over shared vertices, counter-clockwise as seen from outside.

    Attributes
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (t, 3) of int32
        Indices of vertices.
    normals : ndarray (v, 3) or None
        Outward unit normals at the vertices.
    properties : dict of arrays (v,)
        Further values at the vertices, by name; colours are "red", "green" and "blue" of type uint8.
    space : str
        Space of the coordinates, as `Image.space`: "RAS", "LPS" or "unknown". From the image that the mesh is a contour
        of, or from the file; `save` writes it for 3D Slicer.

    Examples
    --------
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> corner = csrbf.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> corner.topology["watertight"], round(corner.volume, 3)
    (True, 0.167)
    """

    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats | None
    properties: dict[str, NDArray[Any]]

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        normals: ArrayLike | None = None,
        properties: dict[str, NDArray[Any]] | None = None,
    ) -> None:
        self.vertices = rows(vertices, "vertices")
        self.faces = _triangles(faces, len(self.vertices))
        self.normals = None if normals is None else rows(normals, "normals")
        self.properties = properties or {}
        self.space = "unknown"

    @property
    def topology(self) -> dict[str, Any]:
        """Topology of the mesh: components, watertight, manifold, euler, boundary_edges and so on.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).topology["boundary_edges"]
        3
        """
        return _csrbf.topology(self._arrays())

    @property
    def area(self) -> float:
        """Total area of the triangles.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).area
        0.5
        """
        a, b, c = (self.vertices[self.faces[:, i]] for i in range(3))
        return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    @property
    def volume(self) -> float:
        """Enclosed volume; meaningless for meshes that are not watertight.

        Examples
        --------
        >>> corners = [[0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1]]
        >>> csrbf.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).volume
        1.0
        """
        near_zero = self.vertices - self.vertices.mean(axis=0)
        a, b, c = (near_zero[self.faces[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    def save(self, path: Path) -> None:
        """Write a .ply, .obj, .off, .stl, .vtp, .glb or .3mf file, by the extension of the name.

        .ply stores coordinates as float32, or as float64 if float32 would move one by more than a millionth of the
        diagonal of the bounding box. .stl stores float32 only and warns of such a loss.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        ValueError
            If the arrays are inconsistent.
        IoError
            If the file cannot be written.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).save("triangle.ply")
        """
        for warning in _csrbf.write_mesh(os.fspath(path), self._arrays(), self.space):
            warnings.warn(warning, stacklevel=2)

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
        """A ray-traced picture of the mesh; `Surface.render` describes the arguments.

        The colours "mean-curvature" and "gaussian-curvature" need the properties mean_curvature and gaussian_curvature;
        "plain" shows the properties red, green and blue, if there are any.

        Returns
        -------
        ndarray (height, width, 3) of uint8

        Examples
        --------
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> corner = csrbf.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> corner.render("corner.png", size=(80, 60)).shape
        (60, 80, 3)
        """
        options, color_reference = picture_options(
            size, view, up, color, color_limit, field_of_view, material, background, ground
        )
        to = reference_mesh(reference if color_reference is None else color_reference)
        with listening(progress) as listener:
            picture = _csrbf.render_mesh(self._arrays(), options, to, listener)
        return write_picture(path, picture)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the mesh with matplotlib: ray-traced, or on 3D axes by `plot_trisurf`.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on; new ones by default.
        **options
            Options of `render`; on 3D axes those of ``plot_trisurf``.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> corner = csrbf.Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        >>> corner.plot(size=(160, 120))  # doctest: +SKIP
        <Axes: >
        """
        from csrbf._plots import axes_for

        ax = axes_for(ax)
        if hasattr(ax, "plot_trisurf"):
            ax.plot_trisurf(*self.vertices.T, triangles=self.faces, **options)
            ax.set_aspect("equal")
        else:
            chosen: dict[str, Any] = {"size": (640, 480), "ground": False, **options}
            ax.imshow(self.render(**chosen))
            ax.set_axis_off()
        return ax

    def _page(self, large: bool) -> Page:
        facts = {"vertices": f"{len(self.vertices):,}", "triangles": f"{len(self.faces):,}"}
        if len(self.faces) == 0:
            return Page("Mesh", facts, notes=["The mesh has no triangles."])
        facts |= _facts_of(self.topology)
        scales = [
            Scale(name.replace("_", " "), name.replace("_", " "), self.properties[name].astype(float), diverging=True)
            for name in ("mean_curvature", "gaussian_curvature")
            if name in self.properties
        ]
        panel = mesh_panel(self, large, scales)
        if panel.view is not None and panel.view.scales:
            panel.view.shown = "0"
        return Page("Mesh", facts, [panel])

    def to_trimesh(self) -> Any:
        """The same mesh as a ``trimesh.Trimesh``.

        Returns
        -------
        trimesh.Trimesh

        Raises
        ------
        ImportError
            If trimesh is not installed.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).to_trimesh().area  # doctest: +SKIP
        0.5
        """
        trimesh = _imported("trimesh", "to_trimesh")
        return trimesh.Trimesh(self.vertices, self.faces, vertex_normals=self.normals, process=False)

    def to_pyvista(self) -> Any:
        """The same mesh as a ``pyvista.PolyData``, with normals and properties as point data.

        Returns
        -------
        pyvista.PolyData

        Raises
        ------
        ImportError
            If pyvista is not installed.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).to_pyvista().n_points  # doctest: +SKIP
        3
        """
        pyvista = _imported("pyvista", "to_pyvista")
        sizes = np.full((len(self.faces), 1), 3, dtype=self.faces.dtype)
        mesh = pyvista.PolyData(self.vertices, np.hstack([sizes, self.faces]).ravel())
        if self.normals is not None:
            mesh.point_data["Normals"] = self.normals
        for name, values in self.properties.items():
            mesh.point_data[name] = values
        return mesh

    def to_open3d(self) -> Any:
        """The same mesh as an ``open3d.geometry.TriangleMesh``, with normals and colours.

        Returns
        -------
        open3d.geometry.TriangleMesh

        Raises
        ------
        ImportError
            If open3d is not installed.

        Examples
        --------
        >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).to_open3d()  # doctest: +SKIP
        TriangleMesh with 3 points and 1 triangles.
        """
        open3d = _imported("open3d", "to_open3d")
        vector = open3d.utility.Vector3dVector
        mesh = open3d.geometry.TriangleMesh(vector(self.vertices), open3d.utility.Vector3iVector(self.faces))
        if self.normals is not None:
            mesh.vertex_normals = vector(self.normals)
        if all(name in self.properties for name in ("red", "green", "blue")):
            colors = [self.properties[name] / 255 for name in ("red", "green", "blue")]
            mesh.vertex_colors = vector(np.column_stack(colors))
        return mesh

    def _arrays(self) -> MeshArrays:
        normals = np.empty((0, 3)) if self.normals is None else self.normals
        return rows(self.vertices, "vertices"), indices(self.faces, "faces"), rows(normals, "normals"), self.properties

    def __repr__(self) -> str:
        return f"<csrbf.Mesh of {len(self.vertices)} vertices, {len(self.faces)} triangles>"


def _triangles(faces: ArrayLike, vertices: int) -> NDArray[np.int32]:
    """Rows of three indices of vertices."""
    found = indices(faces, "faces")
    if found.ndim != 2 or found.shape[1] != 3:
        raise ValueError(f"faces: has shape {found.shape}; give one triangle per row, in an array of shape (t, 3)")
    if found.size > 0 and not 0 <= found.min() <= found.max() < vertices:
        wrong = found.min() if found.min() < 0 else found.max()
        raise ValueError(f"faces: {wrong} is no index of a vertex; they are from 0 to {vertices - 1}")
    return found


def mesh_of(arrays: MeshArrays, space: str = "unknown") -> Mesh:
    """The mesh that the compiled module returned."""
    vertices, faces, normals, properties = arrays
    mesh = Mesh(vertices, faces, normals if len(normals) else None, properties)
    mesh.space = space
    return mesh


def read_mesh(path: Path) -> Mesh:
    """Read a mesh from a .ply, .obj, .off, .stl or .vtp file.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    Mesh
        Polygons become fans of triangles. A file with only points gives a mesh without faces.

    Raises
    ------
    IoError
        For data that cannot be read, with the file and the position in it.

    Examples
    --------
    >>> csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).save("triangle.ply")
    >>> csrbf.read_mesh("triangle.ply")
    <csrbf.Mesh of 3 vertices, 1 triangles>
    """
    return mesh_of(*_csrbf.read_mesh(os.fspath(path)))


def mesh_panel(
    mesh: Mesh, large: bool, scales: Sequence[Scale] = (), points: Floats | None = None, caption: str = ""
) -> Panel:
    """A mesh to turn, with fewer triangles where it has too many; scales are those of its own vertices."""
    shown = with_normals(coarse(mesh, MOST_VERTICES if large else _VERTICES_IN_NOTEBOOK))
    if shown is not mesh and len(shown.vertices) < len(mesh.vertices):
        caption += f" Shown with {len(shown.faces):,} of its {len(mesh.faces):,} triangles."
        scales = [
            dataclasses.replace(scale, values=shown.properties[scale.name.replace(" ", "_")])
            for scale in scales
            if scale.name.replace(" ", "_") in shown.properties
        ]
    size = (900, 560) if large else (480, 300)
    options, _ = picture_options(size, (-65, 15), "z", "plain", 0.0, 20.0, PLAIN, WHITE, False)
    picture = _csrbf.render_mesh(shown._arrays(), options | {"occlusion_rays": _RAYS}, None, None)
    view = View(shown, scales=list(scales), shown="own" if colors_of(shown.properties) is not None else "plain")
    if points is not None:
        view.points = points[:: max(1, len(points) // _POINTS_SHOWN + 1)]
    return Panel(picture, caption.strip(), view)


def _facts_of(topology: dict[str, Any]) -> dict[str, str]:
    return {
        "components": f"{topology['components']:,}",
        "watertight": "yes" if topology["watertight"] else "no",
        "manifold": "yes" if topology["manifold"] else "no",
    }


def _imported(module: str, method: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"Mesh.{method} needs the package {module}, which cannot be imported: {error}") from error
