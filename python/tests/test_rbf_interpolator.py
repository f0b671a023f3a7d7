"""RBFInterpolator against the class of that name in SciPy, and by itself where SciPy is not installed."""

import pickle
import unittest
import warnings

import numpy as np

import csrbf

try:
    from scipy.interpolate import RBFInterpolator as Reference
except ImportError:
    Reference = None

SAME = 1e-9  # relative, for systems whose condition number stays below about 1e6
NEARLY_SAME = 1e-7  # for those of quintics and of degrees below the smallest, with condition numbers up to 1e9
KERNELS = {
    "linear": None,
    "thin_plate_spline": None,
    "cubic": None,
    "quintic": None,
    "multiquadric": 6.0,
    "inverse_multiquadric": 6.0,
    "inverse_quadratic": 6.0,
    "gaussian": 8.0,
}


def halton(n, d):
    """Quasi-random points in the unit cube: well separated, so that the systems are well conditioned."""
    result = np.empty((n, d))
    for axis, base in enumerate([2, 3, 5, 7, 11, 13, 17, 19][:d]):
        for i in range(n):
            fraction, rest, digit = 1.0, i + 1, 0.0
            while rest > 0:
                fraction /= base
                digit += fraction * (rest % base)
                rest //= base
            result[i, axis] = digit
    return result


def smooth(x):
    return np.sin(3 * x[:, 0]) + np.cos(2 * x.sum(axis=1))


def assert_close(found, expected, tolerance=SAME):
    scale = np.abs(expected).max(initial=0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * scale)


class Exact(unittest.TestCase):
    def test_every_kernel_interpolates(self):
        y = halton(60, 2)
        for kernel, epsilon in KERNELS.items():
            with self.subTest(kernel=kernel):
                f = csrbf.RBFInterpolator(y, smooth(y), kernel=kernel, epsilon=epsilon)
                assert_close(f(y), smooth(y))

    def test_polynomials_of_the_degree_are_reproduced_everywhere(self):
        y, x = halton(80, 2), 3 * halton(50, 2) - 1

        def p(z):
            return 1 + z[:, 0] - 2 * z[:, 0] * z[:, 1]

        for neighbors in (None, 20):
            for kernel, epsilon in KERNELS.items():
                with self.subTest(kernel=kernel, neighbors=neighbors):
                    f = csrbf.RBFInterpolator(y, p(y), neighbors, kernel=kernel, epsilon=epsilon, degree=2)
                    assert_close(f(x), p(x), 1e-8)

    def test_as_many_points_as_coefficients_give_the_polynomial(self):
        y = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        for neighbors in (None, 3):
            f = csrbf.RBFInterpolator(y, [1.0, 2.0, 4.0], neighbors)
            assert_close(f([[0.5, 0.5], [2.0, 2.0]]), [3.0, 9.0])


class Properties(unittest.TestCase):
    def test_results_do_not_depend_on_the_number_of_threads(self):
        y, x = halton(300, 3), halton(1500, 3)
        results = []
        for threads in (1, 3):
            csrbf.set_thread_count(threads)
            results.append([csrbf.RBFInterpolator(y, smooth(y), k)(x) for k in (None, 15)])
        csrbf.set_thread_count(0)
        np.testing.assert_array_equal(results[0][0], results[1][0])
        np.testing.assert_array_equal(results[0][1], results[1][1])

    def test_a_query_gets_the_same_value_alone_and_among_others(self):
        y, x = halton(200, 2), halton(700, 2)
        for neighbors in (None, 12):
            f = csrbf.RBFInterpolator(y, smooth(y), neighbors)
            together = f(x)
            for i in (0, 3, 255, 256, 511, 699):
                np.testing.assert_array_equal(f(x[i : i + 1]), together[i : i + 1])

    def test_scaled_points_give_the_same_values(self):
        y, x = halton(80, 2), halton(30, 2)
        for kernel in ("linear", "thin_plate_spline", "cubic", "quintic"):
            expected = csrbf.RBFInterpolator(y, smooth(y), kernel=kernel)(x)
            for scale in (1e-20, 1e20):
                with self.subTest(kernel=kernel, scale=scale):
                    f = csrbf.RBFInterpolator(scale * y, smooth(y), kernel=kernel)
                    assert_close(f(scale * x), expected)
                    g = csrbf.RBFInterpolator(scale * y, smooth(y), 20, kernel=kernel)
                    assert_close(g(scale * x), csrbf.RBFInterpolator(y, smooth(y), 20, kernel=kernel)(x))

    def test_pickles_give_the_same_values(self):
        y, x = halton(100, 2), halton(50, 2)
        for neighbors in (None, 10):
            f = csrbf.RBFInterpolator(y, smooth(y) + 1j, neighbors, kernel="gaussian", epsilon=8.0)
            g = pickle.loads(pickle.dumps(f))
            np.testing.assert_array_equal(g(x), f(x))
            self.assertEqual(g.epsilon, 8.0)

    def test_points_that_are_contiguous_doubles_are_not_copied(self):
        y = halton(20, 2)
        self.assertIs(csrbf.RBFInterpolator(y, smooth(y)).y, y)

    def test_kernels_that_scipy_does_not_have_work_too(self):
        y = halton(60, 2)
        f = csrbf.RBFInterpolator(y, smooth(y), kernel="wendland-c2", epsilon=2.0)
        assert_close(f(y), smooth(y))


@unittest.skipIf(Reference is None, "SciPy is not installed")
class SameAsSciPy(unittest.TestCase):
    def compare(self, y, d, x, tolerance=SAME, **arguments):
        expected = Reference(y, d, **arguments)(x)
        found = csrbf.RBFInterpolator(y, d, **arguments)(x)
        self.assertEqual(found.shape, expected.shape)
        self.assertEqual(found.dtype, expected.dtype)
        assert_close(found, expected, tolerance)

    def test_for_every_kernel_dimension_and_degree(self):
        for kernel, epsilon in KERNELS.items():
            for dimension in (1, 2, 3, 5):
                y, x = 4 * halton(70, dimension) - 1, 5 * halton(40, dimension) - 1.5
                smallest = {"thin_plate_spline": 1, "cubic": 1, "quintic": 2}.get(kernel, 0)
                for degree in (None, smallest, smallest + 1):
                    with self.subTest(kernel=kernel, dimension=dimension, degree=degree):
                        tolerance = NEARLY_SAME if kernel == "quintic" else SAME
                        self.compare(y, smooth(y), x, tolerance, kernel=kernel, epsilon=epsilon, degree=degree)

    def test_without_polynomial(self):
        y, x = halton(70, 2), halton(40, 2)
        for kernel in ("gaussian", "inverse_quadratic", "inverse_multiquadric"):
            self.compare(y, smooth(y), x, kernel=kernel, epsilon=8.0, degree=-1)

    def test_for_degrees_below_the_smallest_and_with_a_warning(self):
        y, x = halton(50, 2), halton(30, 2)
        too_low = {"linear": -1, "multiquadric": -1, "thin_plate_spline": 0, "cubic": -1, "quintic": 1}
        for kernel, degree in too_low.items():
            for neighbors in (None, 12):
                with self.subTest(kernel=kernel, neighbors=neighbors):
                    arguments = {"neighbors": neighbors, "kernel": kernel, "epsilon": 3.0, "degree": degree}
                    with self.assertWarnsRegex(UserWarning, "degree"):
                        csrbf.RBFInterpolator(y, smooth(y), **arguments)
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        self.compare(y, smooth(y), x, NEARLY_SAME, **arguments)

    def test_with_smoothing(self):
        y, x = halton(70, 2), halton(40, 2)
        each = np.linspace(0, 2, len(y))
        for kernel, epsilon in KERNELS.items():
            for smoothing in (1e-3, 0.5, each):
                for neighbors in (None, 15):
                    with self.subTest(kernel=kernel, neighbors=neighbors):
                        self.compare(
                            y, smooth(y), x, kernel=kernel, epsilon=epsilon, smoothing=smoothing, neighbors=neighbors
                        )

    def test_for_values_of_any_shape_and_type(self):
        y, x = halton(50, 2), halton(30, 2)
        for shape in ((), (1,), (3,), (2, 3), (0,)):
            d = np.random.default_rng(1).standard_normal((50,) + shape)
            for neighbors in (None, 9):
                with self.subTest(shape=shape, neighbors=neighbors):
                    self.compare(y, d, x, neighbors=neighbors)
                    self.compare(y, d + 1j * d[::-1], x, neighbors=neighbors)
        self.compare(y, np.arange(50), x)
        self.compare(y.astype(np.float32), np.arange(50), x[::-1].astype(np.float32))

    def test_with_neighbors(self):
        rng = np.random.default_rng(5)  # no ties: equal distances leave the neighbors open
        for dimension, neighbors in ((1, 5), (2, 12), (3, 30), (3, 250), (7, 20)):
            queries = 300 if neighbors < 100 else 60
            y, x = rng.random((400, dimension)), rng.random((queries, dimension))
            near = slice(queries // 3, 2 * queries // 3)
            x[near] = x[queries // 3] + 1e-6 * x[near]  # the same neighbors
            for kernel in ("linear", "thin_plate_spline", "cubic", "gaussian"):
                with self.subTest(kernel=kernel, dimension=dimension, neighbors=neighbors):
                    if kernel == "gaussian" and dimension == 1:
                        continue
                    self.compare(y, smooth(y), x, neighbors=neighbors, kernel=kernel, epsilon=20.0, tolerance=1e-8)

    def test_with_neighbors_in_one_to_six_dimensions(self):
        rng = np.random.default_rng(8)
        for dimension in range(1, 7):
            y, x = rng.random((150, dimension)), rng.random((60, dimension))
            for kernel, epsilon in KERNELS.items():
                if epsilon is not None:
                    epsilon = 300.0 if dimension == 1 else 20.0  # for the condition of systems of points at random
                with self.subTest(kernel=kernel, dimension=dimension):
                    self.compare(y, smooth(y), x, 1e-6, neighbors=40, kernel=kernel, epsilon=epsilon)

    def test_far_away_and_at_any_scale(self):
        y, x = halton(100, 2), halton(60, 2)
        for kernel, epsilon in KERNELS.items():
            near = csrbf.RBFInterpolator(y, smooth(y), kernel=kernel, epsilon=epsilon)(x)
            for scale in (1e-50, 1e50):
                with self.subTest(kernel=kernel, scale=scale):
                    shift = 1e5 * scale
                    e = 1.0 if epsilon is None else epsilon / scale
                    arguments = {"kernel": kernel, "epsilon": e}
                    # The shift takes five of sixteen digits from the points, the systems about six more.
                    far = csrbf.RBFInterpolator(scale * y + shift, smooth(y), **arguments)(scale * x + shift)
                    assert_close(far, near, 1e-4)
                    some = csrbf.RBFInterpolator(scale * y + shift, smooth(y), 30, **arguments)(scale * x + shift)
                    assert_close(some, smooth(x), 0.1)
                    self.compare(y, scale * smooth(y), x, NEARLY_SAME, kernel=kernel, epsilon=epsilon)

    def test_for_lists_masks_and_other_types(self):
        y, x = halton(40, 2), halton(20, 2)
        d = smooth(y)
        for values in (d.tolist(), d > 0, d.astype(object), np.ma.masked_array(d), d.astype(np.float32)):
            self.compare(y, values, x)
        self.compare(y.tolist(), d, x.tolist())
        self.compare(np.asfortranarray(y), d[::-1], np.repeat(x, 2, axis=0)[::2])
        self.compare(y, d, x, degree=1.7)  # which counts as 1
        self.compare(y, d, x, neighbors=12.5)
        self.compare(y, d, x, kernel="gaussian", epsilon=-8.0)

    def test_repeated_points_are_fine_with_smoothing(self):
        y = np.repeat(halton(20, 2), 3, axis=0)
        self.compare(y, np.arange(60.0), halton(30, 2), smoothing=0.1)

    def test_for_more_neighbors_than_points_and_for_no_query(self):
        y, x = halton(30, 2), halton(20, 2)
        self.compare(y, smooth(y), x, neighbors=1000)
        for neighbors in (None, 9):
            f = csrbf.RBFInterpolator(y, smooth(y), neighbors)
            self.assertEqual(f(np.empty((0, 2))).shape, (0,))

    def test_has_the_same_attributes(self):
        y = halton(30, 2)
        expected = Reference(y, smooth(y), 12.7, 0.5, "Quintic", degree=3)
        found = csrbf.RBFInterpolator(y, smooth(y), 12.7, 0.5, "Quintic", degree=3)
        for name in ("y", "d", "d_shape", "d_dtype", "neighbors", "smoothing", "kernel", "epsilon", "powers"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)

    def test_queries_that_are_not_finite(self):
        y = halton(30, 2)
        x = np.array([[0.5, np.nan], [0.5, 0.5]])
        self.assertEqual(np.isnan(csrbf.RBFInterpolator(y, smooth(y))(x)).tolist(), [True, False])
        with self.assertRaisesRegex(ValueError, "finite"):
            csrbf.RBFInterpolator(y, smooth(y), 9)(x)

    def test_misuse_raises_the_same_errors(self):
        y = halton(20, 2)
        d = smooth(y)
        double = np.repeat(y[:10], 2, axis=0)
        line = np.column_stack([np.arange(20.0), np.arange(20.0)])
        cases = [
            (ValueError, (y[0], d), {}),
            (ValueError, (y, d[1:]), {}),
            (ValueError, (y, d), {"smoothing": [1.0, 2.0]}),
            (ValueError, (y, d), {"kernel": "magic"}),
            (ValueError, (y, d), {"kernel": "gaussian"}),
            (ValueError, (y, d), {"degree": -2}),
            (ValueError, (y, d), {"degree": 5}),
            (ValueError, (y, d), {"degree": 2, "neighbors": 5}),
            (ValueError, (np.array([["a", "b"]]), d[:1]), {}),
            (ValueError, (y[None], d), {}),
            (ValueError, (y, d), {"smoothing": np.zeros((20, 1))}),
            (ValueError, (y, d), {"smoothing": [1.0]}),
            (ValueError, (y, d), {"kernel": "gaussian", "epsilon": "a"}),
            (ValueError, (y, d), {"neighbors": 0}),
            (ValueError, (y, d), {"neighbors": 2}),
            (ValueError, (np.empty((0, 2)), d[:0]), {}),
            (np.linalg.LinAlgError, (y, d), {"kernel": "gaussian", "epsilon": 0.0}),
            (np.linalg.LinAlgError, (double, d), {}),
            (np.linalg.LinAlgError, (line, d), {}),
        ]
        for expected, arguments, keywords in cases:
            for interpolator in (Reference, csrbf.RBFInterpolator):
                with self.subTest(keywords=keywords, interpolator=interpolator.__module__):
                    with self.assertRaises(expected):
                        interpolator(*arguments, **keywords)
        for interpolator in (Reference, csrbf.RBFInterpolator):
            f = interpolator(y, d)
            for x in (y[0], y[:, :1], np.empty((3, 3))):
                with self.assertRaises(ValueError):
                    f(x)
            with self.assertRaises(np.linalg.LinAlgError):
                interpolator(double, d, 8)(y)


class Failures(unittest.TestCase):
    def test_messages_say_what_to_do(self):
        y = halton(20, 2)
        d = smooth(y)
        nan = d.copy()
        nan[3] = np.nan
        cases = [
            (ValueError, "one point per row", (y[0], d), {}),
            (ValueError, "first axis of `d`", (y, d[1:]), {}),
            (ValueError, "scalar or have shape \\(20,\\)", (y, d), {"smoothing": [1.0, 2.0]}),
            (ValueError, "thin-plate", (y, d), {"kernel": "magic"}),
            (ValueError, "needs a scale", (y, d), {"kernel": "gaussian"}),
            (ValueError, "must be finite", (y, d), {"kernel": "gaussian", "epsilon": np.inf}),
            (ValueError, "must be -1", (y, d), {"degree": -2}),
            (ValueError, "At least 21 data points", (y, d), {"degree": 5}),
            (ValueError, "At least 6 data points", (y, d), {"degree": 2, "neighbors": 5}),
            (ValueError, "at least 1", (y, d), {"neighbors": 0}),
            (ValueError, "every value must be finite", (y, nan), {}),
            (ValueError, "every coordinate must be finite", (y * [1, np.inf], d), {}),
            (ValueError, "real numbers", (y + 1j, d), {}),
            (csrbf.SolverFailure, "merge coincident points", (np.repeat(y[:10], 2, axis=0), d), {}),
            (csrbf.SolverFailure, "2/3", (np.column_stack([d, d]), d), {}),
        ]
        for error, message, arguments, keywords in cases:
            with self.subTest(message=message):
                with self.assertRaisesRegex(error, message):
                    csrbf.RBFInterpolator(*arguments, **keywords)


if __name__ == "__main__":
    unittest.main()
