"""Names that options take, for checkers of types; the library checks them again when it is called."""

from __future__ import annotations

from typing import Literal, Union

FitMethod = Literal[
    "auto",
    "interpolate",
    "least-squares",
    "partition-of-unity",
    "multilevel",
    "pca-multiresolution",
    "fixed-budget",
    "error-bounded",
    "moving-least-squares",
    "along-tracks",
]
CompactKernel = Literal[
    "wendland-c0",
    "wendland-c2",
    "wendland-c4",
    "wendland-c6",
    "missing-wendland",
    "wu-c0",
    "wu-c2",
    "wu-c4",
    "wu-c6",
    "buhmann-c1",
    "buhmann-c2",
    "buhmann-c3",
]
GlobalKernel = Literal[
    "gaussian",
    "powered-exponential",
    "matern-c0",
    "matern-c2",
    "matern-c4",
    "matern-c6",
    "matern",
    "inverse-multiquadric",
    "inverse-quadratic",
    "multiquadric",
    "linear",
    "cubic",
    "quintic",
    "septic",
    "polyharmonic",
    "thin-plate",
    "thin-plate-r4",
]
Kernel = Union[Literal["auto"], CompactKernel, GlobalKernel]
ScipyKernel = Literal["thin_plate_spline", "inverse_multiquadric", "inverse_quadratic"]  # the others have our names
InterpolatorKernel = Union[ScipyKernel, CompactKernel, GlobalKernel]
Extrapolation = Literal["auto", "constant", "linear", "trend", "nan"]
Loss = Literal["auto", "squares", "huber", "student"]
Transform = Literal["auto", "none", "sqrt", "log"]
DeviationOf = Literal["sample", "function"]
Smoothing = Union[Literal["auto", "none"], float]

SurfaceMethod = Literal[
    "auto",
    "composite",
    "medial-axis",
    "multilevel",
    "adaptive",
    "mpu",
    "tobor",
    "hoppe",
    "adamson-alexa",
    "projection-mls",
    "morse",
    "carr",
    "turk-obrien",
    "savchenko",
    "dinh",
    "blobby",
    "3l",
    "gradient-one",
    "min-max",
    "min-var",
]
MeshMethod = Literal["auto", "marching-cubes", "marching-tetrahedra", "dual-contouring", "adaptive"]
Orientation = Literal["consistent", "viewpoint", "none"]
Operation = Literal["union", "intersection", "difference", "complement", "blend"]
NormalsFrom = Literal["auto", "file", "estimate"]
Blending = Literal["sharp", "r-function", "super-elliptic", "log-sum-exp"]
UpAxis = Literal["x", "y", "z"]
Space = Literal["unknown", "LPS", "RAS"]

Energy = Literal["auto", "chan-vese", "gaussian", "generalized-gaussian", "rayleigh", "gamma", "edge"]
Mode = Literal["global", "local"]
SegmentMethod = Literal["variational", "collocation", "finite-difference"]
Shading = Literal["auto", "none", "linear", "quadratic", "smooth", "objects", "background"]
Smoothness = Union[Literal["auto"], float]
