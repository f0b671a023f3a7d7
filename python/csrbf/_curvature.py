from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from csrbf._arrays import Floats
from csrbf._show import Page, Panel, Shown


@dataclass(repr=False)
class Curvature(Shown):
    """Curvature of a surface at points; NaN where its gradient is zero.

    Attributes
    ----------
    k1, k2 : ndarray (...)
        The larger and the smaller principal curvature, positive where the inside is convex.
    direction1, direction2 : ndarray (..., 3)
        Unit tangents along which the curvature is k1 and k2.

    Examples
    --------
    >>> c = csrbf.Curvature(np.array([2.0]), np.array([0.5]), np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]]))
    >>> c.mean, c.gaussian
    (array([1.25]), array([1.]))
    """

    k1: Floats
    k2: Floats
    direction1: Floats
    direction2: Floats

    @property
    def mean(self) -> Floats:
        """Mean curvature (k1 + k2) / 2.

        Examples
        --------
        >>> csrbf.Curvature(np.array([2.0]), np.array([0.5]), np.zeros((1, 3)), np.zeros((1, 3))).mean
        array([1.25])
        """
        return 0.5 * (self.k1 + self.k2)

    @property
    def gaussian(self) -> Floats:
        """Gaussian curvature k1 k2.

        Examples
        --------
        >>> csrbf.Curvature(np.array([2.0]), np.array([0.5]), np.zeros((1, 3)), np.zeros((1, 3))).gaussian
        array([1.])
        """
        return self.k1 * self.k2

    def plot(self, ax: Any = None, **options: Any) -> Any:
        """Histograms of the principal curvatures with matplotlib, of all but the outermost hundredth.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Those of a new figure when not given.
        **options
            Of ``hist``.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> c = csrbf.Curvature(np.array([2.0]), np.array([0.5]), np.zeros((1, 3)), np.zeros((1, 3)))
        >>> c.plot()  # doctest: +SKIP
        <Axes: xlabel='curvature', ylabel='points'>
        """
        from csrbf._plots import axes_for

        ax = axes_for(ax)
        known = [values[np.isfinite(values)] for values in (np.ravel(self.k1), np.ravel(self.k2))]
        if sum(map(len, known)) > 0:
            low, high = np.percentile(np.concatenate(known), [0.5, 99.5])
            bins = np.linspace(low, high if high > low else low + 1, 61)
            ax.hist(known, **{"bins": bins, "histtype": "step", "label": ["k1", "k2"], **options})
            ax.legend()
        ax.set(xlabel="curvature", ylabel="points")
        return ax

    def _page(self, large: bool) -> Page:
        from csrbf._plots import plot_picture

        facts = {"points": f"{np.size(self.k1):,}"}
        for name, values in {"k1": self.k1, "k2": self.k2, "mean": self.mean, "Gaussian": self.gaussian}.items():
            facts[name] = _range(values)
        picture = plot_picture(self.plot)
        return Page("Curvature", facts, [] if picture is None else [Panel(picture, "Principal curvatures.")])

    def __repr__(self) -> str:
        points = "one point" if np.size(self.k1) == 1 else f"{np.size(self.k1)} points"
        return f"<csrbf.Curvature at {points}, k1 {_range(self.k1)}, k2 {_range(self.k2)}>"


def _range(values: Floats) -> str:
    known = np.ravel(values)[np.isfinite(np.ravel(values))]
    if known.size == 0:
        return "unknown"
    low, high = known.min(), known.max()
    return f"{low:.3g}" if low == high else f"{low:.3g} ... {high:.3g}"
