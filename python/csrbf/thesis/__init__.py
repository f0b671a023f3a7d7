"""The gallery: the figures and tables of the thesis that csrbf follows, reproduced.

`python3 -m csrbf.thesis --out DIR [FIGURE ...]` writes them as pictures and one page with the claims of the thesis, our
results, verdicts, and the errata. Needs matplotlib (Debian: python3-matplotlib); the models of chapter 6 come with the
package libcgal-demo, the slice of a head with mricron-data; without them, their figures are skipped.
"""

import time
from dataclasses import dataclass

import numpy as np

try:
    from csrbf.thesis import _figures
except ImportError as error:
    raise ImportError(
        "csrbf.thesis: this csrbf was built without its examples; build it with -DCSRBF_BUILD_EXAMPLES=ON"
    ) from error

VERDICTS = ("holds", "fails", "not comparable")


@dataclass
class Table:
    """Numbers of a curve or table; `table["name of a column"]` is a column."""

    columns: list
    rows: np.ndarray  # (n, columns)
    labels: list  # of the rows, or empty

    def __getitem__(self, column):
        return self.rows[:, column if isinstance(column, int) else self.columns.index(column)]


@dataclass
class Claim:
    """A claim of the thesis, our result, and one of VERDICTS."""

    what: str
    published: str
    ours: str
    verdict: str


@dataclass
class Figure:
    """What was computed for one or more figures or tables of the thesis."""

    name: str
    title: str
    text: str  # how the numbers were made
    tables: dict  # of Table, by their names
    pictures: dict  # of arrays (height, width) of numbers
    renders: list  # of (caption, (height, width, 3) array of bytes)
    claims: list  # of Claim
    missing: str  # unavailable data; then there is nothing else
    seconds: float  # of the computation


def names():
    """The names of all figures of the gallery, in the order of the thesis."""
    return _figures.names()


def compute(name, ultrasound="", bone=""):
    """Computes a figure of the gallery. Takes from milliseconds to a minute, and all cores.

    ultrasound, bone: files of your own images, 2D and 3D, that "figure-8.10" and "figure-8.8" segment as well.

    Raises ValueError for other names, listing them, and csrbf.IoError for files that cannot be read.
    """
    start = time.perf_counter()
    made = _figures.compute(name, str(ultrasound), str(bone))
    return Figure(
        name=made["name"],
        title=made["title"],
        text=made["text"],
        tables={key: Table(**table) for key, table in made["tables"].items()},
        pictures=made["pictures"],
        renders=[(render["caption"], render["image"]) for render in made["renders"]],
        claims=[Claim(**claim) for claim in made["claims"]],
        missing=made["missing"],
        seconds=time.perf_counter() - start,
    )
