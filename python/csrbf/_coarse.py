from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from csrbf._mesh import Mesh

_STEP = 0.9  # of the cells until few enough vertices are left; closer to 1: more of them, and more steps


def coarse(mesh: Mesh, most_vertices: int) -> Mesh:
    """A mesh of at most so many vertices, for a picture: `mesh` itself, or its vertices merged in cubic cells."""
    from csrbf._mesh import Mesh

    if len(mesh.vertices) <= most_vertices:
        return mesh
    low = mesh.vertices.min(axis=0)
    extent = float((mesh.vertices.max(axis=0) - low).max())
    cells = 2.0 * np.sqrt(most_vertices)  # a surface meets about as many cells as the square of their number
    while True:
        index = np.floor((mesh.vertices - low) * (cells / (extent or 1.0))).astype(np.int64)
        key = (index[:, 0] << 42) | (index[:, 1] << 21) | index[:, 2]
        _, merged, counts = np.unique(key, return_inverse=True, return_counts=True)
        if len(counts) <= most_vertices:
            break
        cells *= min(_STEP, float(np.sqrt(most_vertices / len(counts))))

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        columns = values.reshape(len(values), -1).T
        means = np.column_stack([np.bincount(merged, column, len(counts)) / counts for column in columns])
        return means.reshape((len(counts),) + values.shape[1:])

    faces = merged[mesh.faces]
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    normals = None
    if mesh.normals is not None:
        normals = mean(mesh.normals)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    properties = {
        name: mean(values.astype(float)).astype(values.dtype)
        for name, values in mesh.properties.items()
        if values.ndim == 1 and len(values) == len(merged)
    }
    return Mesh(mean(mesh.vertices), faces[kept], normals, properties)


def with_normals(mesh: Mesh) -> Mesh:
    """The mesh with normals at its vertices, the mean of those of the triangles around when it has none."""
    from csrbf._mesh import Mesh

    if mesh.normals is not None or len(mesh.faces) == 0:
        return mesh
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    areas = np.cross(b - a, c - a)
    normals = np.zeros_like(mesh.vertices)
    for axis in range(3):
        for corner in range(3):
            normals[:, axis] += np.bincount(mesh.faces[:, corner], areas[:, axis], len(normals))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    return Mesh(mesh.vertices, mesh.faces, normals, mesh.properties)
