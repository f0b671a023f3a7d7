from __future__ import annotations

from csrbf import _csrbf
from csrbf._options import Blending, Operation
from csrbf._progress import Progress, listening
from csrbf._surface import Surface


def combine(
    operation: Operation,
    *surfaces: Surface,
    radius: float | None = None,
    sharpness: float | None = None,
    blending: Blending | None = None,
    progress: Progress = None,
) -> Surface:
    """Unite, intersect, subtract or blend surfaces.

    Parameters
    ----------
    operation : str
        "union", "intersection", "difference" (the first minus the others), "complement" (of one surface) or "blend"
        (a union with rounded edges).
    *surfaces : Surface
    radius : float, optional
        Range of the blend, as a fraction of the diagonal of the box of all surfaces; surfaces further apart keep their
        shape. Default: 0.05 for "blend", else edges are sharp.
    sharpness : float, optional
        How closely the blend follows the edge, 1 (a chamfer) or more; default 3.
    blending : str, optional
        "sharp", "r-function" (the same edges, smooth elsewhere), "super-elliptic" (the default with a radius) or
        "log-sum-exp" (rounds edges, and swells a little everywhere).
    progress : bool or callable, optional
        See `fit`.

    Returns
    -------
    Surface

    Raises
    ------
    ValueError
        For unknown operations, too few surfaces and incompatible options.

    Examples
    --------
    >>> x = np.random.default_rng(0).normal(size=(2000, 3))
    >>> x /= np.linalg.norm(x, axis=1, keepdims=True)
    >>> a, b = csrbf.reconstruct(x), csrbf.reconstruct(x + [1, 0, 0])
    >>> csrbf.combine("blend", a, b, radius=0.1).contains([[-0.9, 0, 0], [1.9, 0, 0]])
    array([ True,  True])
    >>> (a - b).contains([[-0.9, 0, 0], [0.5, 0, 0]])
    array([ True, False])
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
    with listening(progress) as listener:
        return Surface(_csrbf.combine(operation, parts, blending, radius, sharpness, listener))
