"""Every figure and table of the thesis, and its place in the gallery."""

from dataclasses import dataclass
from typing import Optional


@dataclass(frozen=True)
class Published:
    """A figure or table of the thesis, or a part of its text with a claim that can be checked."""

    number: str  # as printed: "Fig. 2.4"
    what: str
    figure: Optional[str] = None  # its name in the gallery
    reason: str = ""  # why it is missing there


CHAPTERS = (
    (
        "Part II, introduction",
        (
            Published("Fig. 1", "uniform and polar samples", "introduction"),
            Published("Fig. 2", "slice of a head with 75 % of its pixels missing", "figure-3.14"),
            Published("Fig. 3", "a uniformly sampled signal with gaps", "introduction"),
            Published("Perspectives of Part II: k-space", "images from samples on spokes and spirals", "k-space"),
        ),
    ),
    (
        "Chapter 1: multidimensional reconstruction",
        (
            Published("1.1, 1.4", "polynomials, band-limited functions, frames", "chapter-1"),
            Published("Fig. 1.1", "partition of unity", "figure-1.1"),
            Published("Fig. 1.2", "interpolation as a sum of basis functions", "figure-1.2"),
        ),
    ),
    (
        "Chapter 2: radial basis functions",
        (
            Published("Table 2.1", "strictly positive definite functions", "figure-2.1"),
            Published("Fig. 2.1", "Gaussian, inverse multiquadric", "figure-2.1"),
            Published("Table 2.2", "conditionally positive definite functions", "figure-2.1"),
            Published("Fig. 2.2", "multiquadric, thin plate", "figure-2.1"),
            Published("Table 2.3", "Wendland's functions", "figure-2.1"),
            Published("Fig. 2.3", "Wendland's functions for d = 3", "figure-2.1"),
            Published("Fig. 2.4", "supports too small and too large", "figure-2.4"),
            Published("Table 2.4", "costs with global and compact supports", "table-2.4"),
        ),
    ),
    (
        "Chapter 3: approximation with compact supports",
        (
            Published("Fig. 3.1", "clusters by principal components", "figure-3.1"),
            Published("Fig. 3.2", "centres and supports of the clusters of a level", "figure-3.1"),
            Published("Fig. 3.3", "the signal (3.5)", "figure-3.4"),
            Published("Fig. 3.4", "its approximation level by level", "figure-3.4"),
            Published("Fig. 3.5", "thresholds under noise", "figure-3.4"),
            Published("Fig. 3.6", "error against threshold", "figure-3.4"),
            Published("Fig. 3.7", "Matlab's peaks", "figure-3.9"),
            Published("Fig. 3.8", "positions of the samples of peaks", "figure-3.9"),
            Published("Fig. 3.9", "peaks level by level", "figure-3.9"),
            Published("Fig. 3.10", "furthest points", "figure-3.10"),
            Published("Fig. 3.11", "Voronoi diagram bounded by the domain", "figure-3.10"),
            Published("Fig. 3.12", "supports of the bounded cells", "figure-3.10"),
            Published("Fig. 3.13", "slice of a head and its samples", "figure-3.14"),
            Published("Fig. 3.14", "reconstructions with a budget", "figure-3.14"),
            Published("Fig. 3.15", "error against budget", "figure-3.14"),
            Published("Fig. 3.16", "reconstructions with bounded error", "figure-3.16"),
            Published("Perspectives of Part II: dimensions", "more than three dimensions", "dimensions"),
        ),
    ),
    (
        "Chapter 4: implicit surfaces",
        (
            Published("Fig. 3.17", "Michelangelo's David", reason="photograph and scan by others, not free"),
            Published("Fig. 3.18", "contours drawn on slices of a heart", "figure-4.1"),
            Published("Fig. 4.1", "implicit function and surface of an epicardium", "figure-4.1"),
        ),
    ),
    (
        "Chapter 5: earlier methods",
        (
            Published("5.1-5.6", "the methods, on one cloud", "chapter-5"),
            Published("Fig. 5.1", "points off the surface along normals", reason="sketch of a construction"),
            Published("Fig. 5.2", "one support on irregular samples", "chapter-5"),
            Published("Fig. 5.3", "extra zero sets of levels", "chapter-5"),
        ),
    ),
    (
        "Chapter 6: surfaces from points",
        (
            Published("Fig. 6.1", "noise, interpolated and regularised", "figure-6.1"),
            Published("Fig. 6.2", "cover of centres, local functions, blend", "figure-1.1"),
            Published("Fig. 6.3", "decay functions", "figure-6.3"),
            Published("Fig. 6.4", "bunny from ridges and valleys, 500 centres", "figure-6.4"),
            Published("Fig. 6.5", "Venus with 15, 100 and 700 centres", "figure-6.5"),
            Published("Fig. 6.6", "offset error and choice of centres", "figure-6.6"),
            Published("Fig. 6.7", "Taubin's error and choice of centres", "figure-6.6"),
            Published("Fig. 6.8", "error against regularisation", "figure-6.8"),
            Published("Fig. 6.9", "Voronoi diagram, Delaunay triangulation", "figure-6.9"),
            Published("Fig. 6.10", "supports (6.21) and (6.22) on the bunny", "figure-6.10"),
            Published("Fig. 6.11", "supports on vessels, knot, squirrel", "figure-6.10"),
            Published("Fig. 6.12", "supports on the dragon", "figure-6.10"),
            Published("Fig. 6.13", "supports on Venus", "figure-6.10"),
            Published("Fig. 6.14", "Lucy with increasing numbers of centres", "figure-6.17"),
            Published("Fig. 6.15", "vessels with increasing numbers of centres", "figure-6.17"),
            Published("Fig. 6.16", "dragon with increasing numbers of centres", "figure-6.17"),
            Published("Fig. 6.17", "error against centres", "figure-6.17"),
            Published("Fig. 6.18", "dragon with holes", "figure-6.18"),
            Published("Fig. 6.19", "bunny from ridges and valleys, artefacts", "figure-6.4"),
            Published("Fig. 6.20", "knot with holes", "figure-6.18"),
            Published("Fig. 6.21", "noisy squirrel, 500 centres", "figure-6.21"),
            Published("Fig. 6.22", "noisy squirrel, 1000 centres", "figure-6.21"),
            Published("Fig. 6.23", "condition number against regularisation", "figure-6.21"),
        ),
    ),
    (
        "Chapter 7: active contours",
        (
            Published("Fig. 6.24", "stenosis of a renal artery", reason="image of a patient, nothing computed"),
            Published("Fig. 6.25", "tumour of a lung", reason="image of a patient, nothing computed"),
            Published("Fig. 7.1", "a contour finds a shape with two holes", "figure-7.1"),
            Published("Fig. 7.2", "level set function as a relief, its regions", "figure-7.1"),
            Published("Fig. 7.3", "evolution of function and contour", "figure-7.1"),
        ),
    ),
    (
        "Chapter 8: level sets with CSRBFs",
        (
            Published("Fig. 8.1", "lattices of squares and triangles", "figure-8.1"),
            Published("Fig. 8.2", "segmentation under noise", "figure-8.2"),
            Published("Fig. 8.3", "larger supports", "figure-8.2"),
            Published("Fig. 8.4", "f with and without normalisation", "figure-8.4"),
            Published("Fig. 8.5", "coefficients and energy against iterations", "figure-8.4"),
            Published("Fig. 8.6", "number of centres", "figure-8.6"),
            Published("Fig. 8.7", "centres along the shape", "figure-8.6"),
            Published("Fig. 8.8", "bone in 3D", "figure-8.8"),
            Published("Fig. 8.9", "curvatures of its surface", "figure-8.8"),
            Published("Fig. 8.10", "echocardiography, from start to end", "figure-8.10"),
            Published("Fig. 8.11", "echocardiography in vivo", "figure-8.10"),
            Published("Table 8.1", "times of the preparation", "table-8.1"),
            Published("Table 8.2", "times of the evolution", "table-8.1"),
        ),
    ),
)


def published_in(name):
    """What a figure of the gallery covers, in the order of the thesis."""
    return [entry for _, entries in CHAPTERS for entry in entries if entry.figure == name]


def chapter_of(name):
    """The chapter of a figure of the gallery: that of its number, else the first that names it."""
    owners = [(title, entry) for title, entries in CHAPTERS for entry in entries if entry.figure == name]
    own = [title for title, entry in owners if name.split("-")[-1] == entry.number.split()[-1]]
    return (own or [title for title, _ in owners])[0]
