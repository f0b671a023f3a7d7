from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Floats, Path, rows


@dataclass(eq=False, repr=False)
class Polylines:
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
        arrays = (rows(self.vertices, "vertices"), np.asarray(self.edges), self.properties)
        _csrbf.write_polylines(os.fspath(path), arrays)

    def __repr__(self) -> str:
        return f"<csrbf.Polylines of {len(self.vertices)} vertices, {len(self.edges)} edges>"
