"""Smooth functions and surfaces from scattered data.

    f = csrbf.fit(points, values)         # points (n, d), values (n,) or (n, k)
    f(x), f.gradient(x), f.hessian(x)     # anywhere
    f.standard_deviation(x)               # of a sample there from f
    s = csrbf.reconstruct(points)         # an implicit surface from points in space
    s.polygonize().save("mesh.ply")
    s.render("picture.png")
    g = csrbf.segment(image)              # labels and contours of an image, g.labels, g.field(x), g.contour()
    t = csrbf.track(frames)               # the same for a sequence, t[0].labels, t.volumes()
    csrbf.inpaint(image, mask)            # an image with its holes filled
    (a - b).save("cut.csrbf")             # surfaces: also a | b, a & b, ~a and csrbf.combine("blend", a, b)

Arrays of points have one point per row; C-contiguous float64 arrays are not copied. Computations use all cores
(`set_thread_count`), release the interpreter lock, stop on Ctrl-C and show progress with ``progress=True``. Objects can
be pickled. Invalid arguments raise ValueError, unreadable or unwritable files `IoError`, valid data without a result of
the requested quality `SolverFailure`. The examples of all functions assume ``import csrbf`` and
``import numpy as np``.
"""

from csrbf import _csrbf
from csrbf._combine import combine
from csrbf._compare import compare
from csrbf._csrbf import IoError, SolverFailure, set_thread_count, thread_count
from csrbf._curvature import Curvature
from csrbf._evaluate import evaluate
from csrbf._fit import fit
from csrbf._fit_tiles import fit_tiles
from csrbf._function import Function
from csrbf._image import Image, read_image
from csrbf._inpaint import inpaint
from csrbf._inpaint_slices import inpaint_slices
from csrbf._load import load
from csrbf._mesh import Mesh, read_mesh
from csrbf._points import PointCloud, estimate_normals, farthest_points, read_points
from csrbf._polylines import Polylines
from csrbf._rbf_interpolator import RBFInterpolator
from csrbf._reconstruct import reconstruct, reconstruct_contours
from csrbf._reconstruct_tiles import reconstruct_tiles
from csrbf._segment import segment, track
from csrbf._segmentation import Segmentation, Tracking
from csrbf._surface import Surface

__version__: str = _csrbf.version
__all__ = [
    "Curvature",
    "Function",
    "Image",
    "IoError",
    "Mesh",
    "PointCloud",
    "Polylines",
    "RBFInterpolator",
    "Segmentation",
    "SolverFailure",
    "Surface",
    "Tracking",
    "combine",
    "compare",
    "estimate_normals",
    "evaluate",
    "farthest_points",
    "fit",
    "fit_tiles",
    "inpaint",
    "inpaint_slices",
    "load",
    "read_image",
    "read_mesh",
    "read_points",
    "reconstruct",
    "reconstruct_contours",
    "reconstruct_tiles",
    "segment",
    "set_thread_count",
    "thread_count",
    "track",
]
