from __future__ import annotations

import numpy as np

from csrbf._arrays import Floats, smoothing_or_none
from csrbf._rbf_interpolator import RBFInterpolator

_FOLDS = 5  # of cross-validation, conventional
_CANDIDATES = np.logspace(-6, 2, 9)  # of the smoothing, from near interpolation to little more than a plane
_MOST_SAMPLES = 1000  # in one system; beyond, that many nearest neighbours are used. Larger: slower; chosen by hand


def fit_spline(x: Floats, values: Floats, smoothing: str | float, weights: Floats | None) -> Standardized:
    """The polyharmonic spline of lowest order through, or near, samples of any dimension.

    "auto" chooses the candidate smoothing with the smallest cross-validation error. Samples of larger weight are
    smoothed less.
    """
    chosen = smoothing_or_none(smoothing)
    relative = np.ones(len(x)) if weights is None else weights.mean() / weights
    if chosen is None:
        errors = [_cross_validation_error(x, values, one * relative) for one in _CANDIDATES]
        chosen = float(_CANDIDATES[int(np.argmin(errors))])
    return Standardized(x, values, chosen * relative)


class Standardized:
    """An RBFInterpolator of features scaled to unit variance."""

    def __init__(self, x: Floats, values: Floats, smoothing: Floats) -> None:
        spread = x.std(axis=0)
        self.shift, self.scale = x.mean(axis=0), np.where(spread > 0, spread, 1.0)
        neighbors = _MOST_SAMPLES if len(x) > _MOST_SAMPLES else None
        scaled = (x - self.shift) / self.scale
        self.interpolator = RBFInterpolator(scaled, values, neighbors, smoothing, kernel="linear")

    def __call__(self, x: Floats) -> Floats:
        values: Floats = self.interpolator((x - self.shift) / self.scale)
        return values


def _cross_validation_error(x: Floats, values: Floats, smoothing: Floats) -> float:
    sample = np.arange(len(x))[: 2 * _MOST_SAMPLES]
    error = 0.0
    for fold in range(_FOLDS):
        out = sample % _FOLDS == fold
        if out.all() or not out.any():
            continue
        inside = sample[~out]
        predicted = Standardized(x[inside], values[inside], smoothing[inside])(x[sample[out]])
        error += float(((predicted - values[sample[out]]) ** 2).sum())
    return error
