from __future__ import annotations

from dataclasses import dataclass

from csrbf._arrays import Floats


@dataclass
class Curvature:
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
