"""Images of nibabel, which is not imported here: an object of its exists only where somebody has imported it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from csrbf._labels import is_instance

_SECONDS = {"msec": 1e-3, "usec": 1e-6}


def is_nibabel(image: Any) -> bool:
    """Is it an image of nibabel?"""
    return is_instance(image, "nibabel.spatialimages", "SpatialImage")


def values_and_position(image: Any) -> tuple[NDArray[Any], dict[str, Any]]:
    """The values of such an image, [z, y, x] or [t, z, y, x], and the other arguments of csrbf.Image."""
    values, axes = np.asanyarray(image.dataobj).T, "tzyx"
    if values.ndim == 5 and values.shape[1] == 1:  # components of one frame
        values, axes = np.moveaxis(values[:, 0], 0, -1), "zyxc"
    position: dict[str, Any] = {"axes": axes[-values.ndim :]}
    if image.affine is not None:
        steps = image.affine[:3, :3]
        spacing = np.linalg.norm(steps, axis=0)
        position |= {"spacing": spacing, "origin": image.affine[:3, 3], "direction": steps / spacing, "space": "RAS"}
    zooms = image.header.get_zooms()
    if position["axes"] == "tzyx" and len(zooms) > 3 and zooms[3] > 0:
        units = image.header.get_xyzt_units() if hasattr(image.header, "get_xyzt_units") else ("mm", "sec")
        position["time_step"] = float(zooms[3]) * _SECONDS.get(units[1], 1.0)
    return values, position
