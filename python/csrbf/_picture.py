"""Arguments of pictures."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Tuple

import numpy as np
from numpy.typing import NDArray

from csrbf import _csrbf
from csrbf._arrays import Path

if TYPE_CHECKING:
    from csrbf._mesh import Mesh

Color = Tuple[float, float, float]


def picture_options(
    size: tuple[int, int],
    view: tuple[float, float],
    up: str,
    color: str,
    color_limit: float,
    field_of_view: float,
    material: Color,
    background: Color,
    ground: bool,
) -> tuple[dict[str, Any], str | None]:
    """Options for the compiled module, and the file of "error:FILE"."""
    if np.shape(size) != (2,) or np.shape(view) != (2,):
        raise ValueError(f"render: size {size} must be (width, height) and view {view} (azimuth, elevation)")
    name, _, file = str(color).partition(":")
    options = {
        "width": int(size[0]),
        "height": int(size[1]),
        "view": [float(angle) for angle in view],
        "up": up,
        "color": name,
        "color_limit": float(color_limit),
        "field_of_view": float(field_of_view),
        "material": [float(part) for part in material],
        "background": [float(part) for part in background],
        "ground": bool(ground),
    }
    return options, file or None


def reference_mesh(reference: Mesh | Path | None) -> Any:
    """Arrays of the mesh that errors are measured to, if any."""
    from csrbf._mesh import Mesh

    if reference is None:
        return None
    if isinstance(reference, Mesh):
        return reference._arrays()
    return _csrbf.read_mesh(os.fspath(reference))[0]


def write_picture(path: Path | None, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture, written to a file when a path is given."""
    if path is not None:
        _csrbf.write_picture(os.fspath(path), picture)
    return picture
