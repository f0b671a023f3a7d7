from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, indices, rows
from csrbf._show import Page, Shown
from csrbf._viewer import Scale

if TYPE_CHECKING:
    from csrbf._mesh import Mesh


_THICKNESS = 0.0025  # radius of a curve in pictures, relative to the diagonal


@dataclass(eq=False, repr=False)
class Polylines(Shown):
    """Polygonal curves over shared vertices.

    Attributes
    ----------
    vertices : ndarray (v, 3)
    edges : ndarray (e, 2) of int32
        Indices of vertices.
    properties : dict of arrays (v,)
        Other values at the vertices, by name.

    Examples
    --------
    >>> csrbf.Polylines(np.eye(3), np.array([[0, 1], [1, 2]]))
    <csrbf.Polylines of 3 vertices, 2 edges>
    """

    vertices: Floats
    edges: NDArray[np.int32]
    properties: dict[str, NDArray[Any]] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write a .ply file.

        Parameters
        ----------
        path : str or path-like

        Raises
        ------
        ValueError
            When the arrays are inconsistent.
        IoError
            When the file cannot be written.

        Examples
        --------
        >>> csrbf.Polylines(np.eye(3), np.array([[0, 1], [1, 2]])).save("lines.ply")
        """
        arrays = (rows(self.vertices, "vertices"), indices(self.edges, "edges"), self.properties)
        _csrbf.write_polylines(os.fspath(path), arrays)

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Draw the curves with matplotlib.

        Parameters
        ----------
        ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
            Those of a new figure when not given.
        **options
            Of ``Line3DCollection``.

        Returns
        -------
        mpl_toolkits.mplot3d.axes3d.Axes3D

        Examples
        --------
        >>> csrbf.Polylines(np.eye(3), np.array([[0, 1], [1, 2]])).plot()  # doctest: +SKIP
        <Axes3D: xlabel='x', ylabel='y', zlabel='z'>
        """
        from csrbf._plots import space_axes_for

        ax = space_axes_for(ax)
        from mpl_toolkits.mplot3d.art3d import Line3DCollection

        ax.add_collection3d(Line3DCollection(self.vertices[self.edges], **options))
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        ax.set(xlabel="x", ylabel="y", zlabel="z")
        ax.auto_scale_xyz(*np.column_stack([low, high]))
        ax.set_aspect("equal")
        return ax

    def _page(self, large: bool) -> Page:
        from csrbf._mesh import mesh_panel

        facts = {"vertices": f"{len(self.vertices):,}", "edges": f"{len(self.edges):,}"}
        if len(self.edges) == 0:
            return Page("Curves", facts, notes=["There are no curves."])
        ends = self.vertices[self.edges]
        facts["length"] = f"{np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum():.4g}"
        tubes = self._tubes()
        kinds = [tubes.properties["kind"]] if "kind" in tubes.properties else []
        scales = [Scale("kind", "kind: valleys and ridges", kind, diverging=True) for kind in kinds]
        panel = mesh_panel(tubes, large, scales)
        if panel.view is not None and scales:
            panel.view.shown = "0"
        return Page("Curves", facts, [panel])

    def _tubes(self) -> Mesh:
        """Thin prisms around the edges: views show surfaces."""
        from csrbf._mesh import Mesh

        start, end = self.vertices[self.edges[:, 0]], self.vertices[self.edges[:, 1]]
        along = end - start
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
        aside = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
        aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), np.finfo(float).tiny)
        third = np.cross(along, aside)
        radius = _THICKNESS * np.linalg.norm(np.ptp(self.vertices, axis=0))
        angles = 2 * np.pi * np.arange(3) / 3
        ring = np.cos(angles)[:, None, None] * aside + np.sin(angles)[:, None, None] * third  # 3, e, 3
        corners = np.stack([start + radius * ring, end + radius * ring])  # 2, 3, e, 3
        vertices = corners.transpose(2, 0, 1, 3).reshape(-1, 3)
        sides = [face for i in range(3) for face in ((i, (i + 1) % 3, 3 + i), ((i + 1) % 3, 3 + (i + 1) % 3, 3 + i))]
        faces = (6 * np.arange(len(self.edges)))[:, None, None] + np.array(sides)
        normals = np.stack([ring, ring]).transpose(2, 0, 1, 3).reshape(-1, 3)
        ends = self.edges.ravel()
        properties = {name: np.repeat(np.asarray(v, dtype=float)[ends], 3) for name, v in self.properties.items()}
        return Mesh(vertices, faces.reshape(-1, 3), normals, properties)

    def __repr__(self) -> str:
        return f"<csrbf.Polylines of {len(self.vertices)} vertices, {len(self.edges)} edges>"
