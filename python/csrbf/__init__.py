"""Smooth functions and surfaces from scattered data.

    f = csrbf.fit(points, values)         # points (n, d), values (n,) or (n, k)
    f(x), f.gradient(x), f.hessian(x)     # anywhere
    f.standard_deviation(x)               # how far f may be from a sample there
    s = csrbf.reconstruct(points)         # an implicit surface from points in space
    s.polygonize().save("mesh.ply")
    g = csrbf.segment(image)              # labels and contours of an image, g.labels, g.field(x), g.contour()
    t = csrbf.track(frames)               # the same through a sequence, t[0].labels, t.volumes()
    (s - t).save("cut.csrbf")             # also s | t, s & t, ~s and csrbf.combine("blend", s, t)

Arrays of points have one point a row; C-contiguous float64 arrays are not copied. Computations use all cores
(`set_thread_count`), release the interpreter lock and stop on Ctrl-C. Objects can be pickled. Wrong arguments raise
ValueError, unreadable or unwritable files `IoError`, valid data without a result of the requested quality
`SolverFailure`.
"""

import os

from csrbf import _csrbf
from csrbf._csrbf import IoError, SolverFailure, set_thread_count, thread_count
from csrbf._function import Function, fit
from csrbf._rbf_interpolator import RBFInterpolator
from csrbf._segmentation import Segmentation, Tracking, segment, track
from csrbf._surface import Curvature, Mesh, Surface, combine, reconstruct, reconstruct_contours

__version__ = _csrbf.version
__all__ = [
    "Curvature",
    "Function",
    "IoError",
    "Mesh",
    "RBFInterpolator",
    "Segmentation",
    "SolverFailure",
    "Surface",
    "Tracking",
    "combine",
    "fit",
    "load",
    "reconstruct",
    "reconstruct_contours",
    "segment",
    "set_thread_count",
    "thread_count",
    "track",
]


def load(path):
    """The Function or Surface that a .csrbf file holds, written by `save` or by the program csrbf."""
    path = os.fspath(path)
    if _csrbf.is_function_file(path):
        return Function(_csrbf.read_function(path))
    return Surface(_csrbf.read_surface(path))
