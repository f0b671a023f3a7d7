from __future__ import annotations

import os

from csrbf import _csrbf
from csrbf._arrays import Path
from csrbf._function import Function
from csrbf._surface import Surface


def load(path: Path) -> Function | Surface:
    """The content of a .csrbf file, written by `save` or by the program csrbf.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    Function or Surface

    Raises
    ------
    IoError
        For files that are missing, damaged or from a later version.

    Examples
    --------
    >>> csrbf.fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0]).save("parabola.csrbf")
    >>> f = csrbf.load("parabola.csrbf")
    >>> f([[2.0]]).round(6)
    array([4.])
    """
    path = os.fspath(path)
    if _csrbf.is_function_file(path):
        return Function(_csrbf.read_function(path))
    return Surface(_csrbf.read_surface(path))
