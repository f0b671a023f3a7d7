"""A scikit-learn estimator for the functions of csrbf."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils.validation import _check_sample_weight, check_is_fitted

from csrbf._fit import fit
from csrbf._function import Function
from csrbf._masks import mask_of
from csrbf._options import Extrapolation, FitMethod, Kernel, Loss, Smoothing, Transform
from csrbf._spline import fit_spline

try:
    from sklearn.utils.validation import validate_data as _validate
except ImportError:  # before scikit-learn 1.6
    _validate = BaseEstimator._validate_data

_MOST_FEATURES = 20  # dimensions that `fit` supports


class CSRBFRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """Regression by `csrbf.fit`: a smooth function of the features.

    For up to twenty features. For more, which `fit` does not support, a single polyharmonic spline of all samples is
    used (`csrbf.RBFInterpolator`, kernel "linear"), with its smoothing chosen by cross-validation.

    Parameters
    ----------
    method, tolerance, centers, smoothing, kernel, kernel_parameter, degree, periods, sphere, drift, faults,
    extrapolation, loss, missing, scale_axes, standard_deviation
        See `csrbf.fit`. Only `smoothing` matters for more than twenty features.
    target_transform : "auto", "none", "sqrt" or "log"
        The `transform` of `csrbf.fit`, a name that scikit-learn keeps for methods.

    Attributes
    ----------
    function_ : csrbf.Function or csrbf.RBFInterpolator
        The fitted function.
    report_ : dict
        What the fit did; empty for more than twenty features.
    n_features_in_ : int
    feature_names_in_ : ndarray of str
        When the features have names.

    Examples
    --------
    >>> from csrbf.sklearn import CSRBFRegressor
    >>> X = np.random.default_rng(0).random((100, 2))
    >>> model = CSRBFRegressor().fit(X, np.sin(3 * X[:, 0]) * X[:, 1])
    >>> bool(model.score(X, np.sin(3 * X[:, 0]) * X[:, 1]) > 0.999)
    True
    """

    def __init__(
        self,
        method: FitMethod = "auto",
        tolerance: float | None = None,
        centers: int | None = None,
        smoothing: Smoothing = "auto",
        *,
        kernel: Kernel = "auto",
        kernel_parameter: float | None = None,
        degree: int | None = None,
        periods: Any = None,
        sphere: Any = False,
        drift: Any = (),
        faults: Any = (),
        extrapolation: Extrapolation = "auto",
        loss: Loss = "auto",
        target_transform: Transform = "auto",
        missing: float | None = None,
        scale_axes: bool = True,
        standard_deviation: bool = False,
    ) -> None:
        self.method = method
        self.tolerance = tolerance
        self.centers = centers
        self.smoothing = smoothing
        self.kernel = kernel
        self.kernel_parameter = kernel_parameter
        self.degree = degree
        self.periods = periods
        self.sphere = sphere
        self.drift = drift
        self.faults = faults
        self.extrapolation = extrapolation
        self.loss = loss
        self.target_transform = target_transform
        self.missing = missing
        self.scale_axes = scale_axes
        self.standard_deviation = standard_deviation

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        sample_weight: ArrayLike | None = None,
        derivatives: ArrayLike | None = None,
    ) -> CSRBFRegressor:
        """Fit the function to samples.

        Parameters
        ----------
        X : array_like (n, features)
        y : array_like (n,) or (n, outputs)
        sample_weight : array_like (n,), optional
            The inverse variances of the errors of `y`, up to a factor.
        derivatives : array_like (n, features) or (n, outputs, features), optional
            Gradients at `X`, as data; see `csrbf.fit`.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            As `csrbf.fit`.

        Examples
        --------
        >>> from csrbf.sklearn import CSRBFRegressor
        >>> CSRBFRegressor(smoothing="none").fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0])
        CSRBFRegressor(smoothing='none')
        """
        for array, name in ((X, "X"), (y, "y")):
            if mask_of(array) is not None:
                raise ValueError(f"{name}: entries are masked; leave these samples out")
        features, targets = _validate(self, X, y, dtype=np.float64, multi_output=True, y_numeric=True)
        weights = None if sample_weight is None else _check_sample_weight(sample_weight, features)
        if weights is not None:
            counts = weights > 0  # samples of zero weight have no effect
            features, targets, weights = features[counts], targets[counts], weights[counts]
            if derivatives is not None:
                derivatives = np.asarray(derivatives)[counts]
            if (weights == weights[:1]).all():
                weights = None
        targets = np.asarray(targets, dtype=np.float64)
        if features.shape[1] > _MOST_FEATURES:
            if derivatives is not None:
                raise ValueError(f"derivatives: are for at most {_MOST_FEATURES} features")
            self.function_: Any = fit_spline(features, targets, self.smoothing, weights)
            self.report_: dict[str, Any] = {}
        else:
            options = self.get_params()
            options["transform"] = options.pop("target_transform")
            self.function_ = fit(features, targets, weights=weights, derivatives=derivatives, **options)
            self.report_ = self.function_.report
        return self

    def predict(self, X: ArrayLike, return_std: bool = False) -> Any:
        """Values of the function.

        Parameters
        ----------
        X : array_like (m, features)
        return_std : bool
            Whether to return the standard deviations of samples there too; see `Function.standard_deviation`.

        Returns
        -------
        y : ndarray (m,) or (m, outputs)
        std : ndarray of the same shape
            Only with `return_std`.

        Raises
        ------
        ValueError
            For a different number of features, and for `return_std` when the method has no deviations.

        Examples
        --------
        >>> from csrbf.sklearn import CSRBFRegressor
        >>> model = CSRBFRegressor(smoothing="none").fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0])
        >>> model.predict([[1.0]]).round(6)
        array([1.])
        """
        check_is_fitted(self)
        features = _validate(self, X, dtype=np.float64, reset=False)
        values: NDArray[np.float64] = self.function_(features)
        if not return_std:
            return values
        if not isinstance(self.function_, Function):
            raise ValueError(f"return_std: there are no deviations for more than {_MOST_FEATURES} features")
        return values, self.function_.standard_deviation(features)

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags

    def _more_tags(self) -> dict[str, Any]:  # the same, before scikit-learn 1.6
        return {"multioutput": True}
