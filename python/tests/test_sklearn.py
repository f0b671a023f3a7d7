"""CSRBFRegressor by the checks of scikit-learn itself, and what it adds."""

import pickle
import subprocess
import sys
import unittest

import numpy as np

try:
    import sklearn  # noqa: F401
except ImportError:
    print("skipped: scikit-learn is not installed")
    sys.exit(77)

from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import check_estimator

import csrbf
from csrbf.sklearn import CSRBFRegressor


def samples(n, features, noise=0.0):
    rng = np.random.default_rng(0)
    X = rng.random((n, features))
    return X, np.sin(3 * X[:, 0]) + X.sum(axis=1) ** 2 / features + noise * rng.normal(size=n)


class Estimator(unittest.TestCase):
    def test_passes_the_checks_of_scikit_learn(self):
        for estimator, check in check_estimator(CSRBFRegressor(), generate_only=True):
            with self.subTest(check.func.__name__):
                check(estimator)

    def test_predicts_what_the_function_says(self):
        X, y = samples(400, 3)
        model = CSRBFRegressor(kernel="quintic", smoothing="none").fit(X, y)
        f = csrbf.fit(X, y, kernel="quintic", smoothing="none")
        at = samples(50, 3)[0] * 0.9 + 0.05
        np.testing.assert_array_equal(model.predict(at), f(at))
        self.assertEqual(model.report_["samples"], 400)
        self.assertIsInstance(model.function_, csrbf.Function)
        both = CSRBFRegressor(kernel="quintic").fit(X, np.column_stack([y, -y]))
        self.assertEqual(both.predict(at).shape, (50, 2))

    def test_has_the_options_of_fit(self):
        import inspect

        own = {name.removeprefix("target_") for name in CSRBFRegressor().get_params()}
        those = set(inspect.signature(csrbf.fit).parameters)
        self.assertEqual(those - own, {"points", "values", "coordinates", "weights", "derivatives", "progress"})
        X, y = samples(60, 2)
        z = np.linspace(0, 1, 60) ** 2
        model = CSRBFRegressor(drift=[2]).fit(np.column_stack([X, z]), y + 3 * z)
        self.assertAlmostEqual(model.report_["drift"][0], 3, delta=0.1)
        slopes = np.column_stack([3 * np.cos(3 * X[:, 0]) + X.sum(axis=1), X.sum(axis=1)])
        self.assertLess(np.abs(CSRBFRegressor().fit(X, y, derivatives=slopes).predict(X) - y).max(), 1e-4)

    def test_tells_standard_deviations(self):
        X, y = samples(2000, 2, noise=0.1)
        model = CSRBFRegressor(method="partition-of-unity").fit(X, y)
        _, deviation = model.predict(0.1 + 0.8 * X[:300], return_std=True)
        self.assertAlmostEqual(np.sqrt((deviation**2).mean()), 0.1, delta=0.02)
        with self.assertRaisesRegex(ValueError, "return_std"):
            CSRBFRegressor().fit(*samples(50, 21)).predict(samples(5, 21)[0], return_std=True)

    def test_eight_features_are_those_of_fit(self):
        for noise, best in ((0.0, 0.999), (0.3, 0.7)):
            X, y = samples(900, 8, noise)
            model = CSRBFRegressor().fit(X[:600], y[:600])
            self.assertEqual(model.report_["method"], "interpolate")
            self.assertGreater(model.score(X[600:], y[600:]), best)
            _, deviation = model.predict(X[600:], return_std=True)
            self.assertGreaterEqual(deviation.min(), 0.9 * noise)

    def test_more_than_twenty_features_are_answered_by_a_spline(self):
        for noise, best in ((0.0, 0.95), (0.3, 0.6)):
            X, y = samples(900, 21, noise)
            model = CSRBFRegressor().fit(X[:600], y[:600])
            self.assertIsInstance(model.function_.interpolator, csrbf.RBFInterpolator)
            self.assertGreater(model.score(X[600:], y[600:]), best)
        X, y = samples(300, 21)
        exact = CSRBFRegressor(smoothing="none").fit(X, y)
        np.testing.assert_allclose(exact.predict(X), y, atol=1e-8)

    def test_weights_count(self):
        for features in (2, 21):
            X, y = samples(200, features)
            bad = y.copy()
            bad[::4] += 5
            weights = np.where(np.arange(200) % 4 == 0, 0.0, 1.0)
            model, without = CSRBFRegressor(smoothing=1e-6), CSRBFRegressor(smoothing=1e-6)
            kept = weights > 0
            expected = without.fit(X[kept], y[kept]).predict(X)
            np.testing.assert_allclose(model.fit(X, bad, weights).predict(X), expected)

    def test_works_with_the_tools_of_scikit_learn(self):
        X, y = samples(200, 2, noise=0.05)
        options = {"method": "partition-of-unity", "kernel": "wendland-c2"}
        pipeline = make_pipeline(StandardScaler(), CSRBFRegressor(**options))
        self.assertGreater(cross_val_score(pipeline, X, y, cv=3).min(), 0.9)
        search = GridSearchCV(CSRBFRegressor(kernel="cubic"), {"smoothing": [1e-3, 1e6]}, cv=3).fit(X, y)
        self.assertEqual(search.best_params_["smoothing"], 1e-3)
        model = search.best_estimator_
        self.assertEqual(clone(model).get_params(), model.get_params())
        copy = pickle.loads(pickle.dumps(model))
        np.testing.assert_array_equal(copy.predict(X), model.predict(X))

    def test_needs_no_private_method_that_newer_versions_lack(self):
        script = """
from sklearn.base import BaseEstimator
from sklearn.utils import validation

inside = []
old = getattr(validation, "validate_data", None) or BaseEstimator._validate_data


def validate_data(*given, **named):
    inside.append(True)
    try:
        return old(*given, **named)
    finally:
        inside.pop()


def hide(name):
    method = getattr(BaseEstimator, name)

    def get(self):
        if not inside:
            raise AttributeError(name)
        return method.__get__(self)

    setattr(BaseEstimator, name, property(get))


validation.validate_data = validate_data  # as from 1.6 on, which has none of these
for name in ("_validate_data", "_check_feature_names", "_check_n_features"):
    if hasattr(BaseEstimator, name):
        hide(name)

from csrbf.sklearn import CSRBFRegressor

model = CSRBFRegressor().fit([[0.0], [1.0], [2.0]], [0.0, 1.0, 4.0])
assert model.predict([[1.0]]).shape == (1,) and model.n_features_in_ == 1
"""
        run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_wrong_options_are_errors_when_fitting(self):
        X, y = samples(50, 2)
        with self.assertRaisesRegex(ValueError, "method"):
            CSRBFRegressor(method="magic").fit(X, y)


if __name__ == "__main__":
    unittest.main()
