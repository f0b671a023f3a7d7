"""fit, Function and load: values, derivatives, shapes, files, pickles, interruption and errors."""

import math
import os
import pickle
import signal
import tempfile
import threading
import time
import unittest

import numpy as np

import csrbf


def samples(n, d=2, seed=1):
    x = np.random.default_rng(seed).random((n, d))
    return x, np.sin(2 * x[:, 0]) + (x**2).sum(axis=1)


def timeless(report):
    """Without what files do not keep."""
    return {key: value for key, value in report.items() if not key.endswith("_seconds")}


# A fit that takes no time to choose its kernel, for tests of everything else.
QUICK = {"kernel": "quintic"}

# Background jobs ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Values(unittest.TestCase):
    def test_samples_are_named_by_their_rows_where_others_are_masked(self):
        x = np.random.default_rng(0).random((200, 2))
        values = np.ma.array(np.sin(3 * x[:, 0]) + x[:, 1], mask=np.isin(np.arange(200), (3, 40)))
        values[150] += 50
        report = csrbf.fit(x, values).report
        self.assertEqual((report["gross_errors"], report["missing"]), ([150], 2))
        self.assertIn("(number 151)", report["warnings"][0])

    def test_one_variable_may_be_plain_numbers(self):
        x = np.linspace(0, 3, 40)
        f = csrbf.fit(x, np.sin(x))
        whole = csrbf.fit(x[:, np.newaxis], np.sin(x))
        at = np.array([[0.2, 1.4, 2.9], [0.5, 0.6, 0.7]])
        self.assertEqual(f(at).shape, (2, 3))
        np.testing.assert_array_equal(f(at), whole(at[..., np.newaxis]))
        np.testing.assert_array_equal(f.standard_deviation(at), whole.standard_deviation(at[..., np.newaxis]))
        self.assertEqual(f.gradient(at).shape, (2, 3, 1))
        self.assertEqual(np.shape(f(0.3)), ())
        self.assertAlmostEqual(f(0.3), np.sin(0.3), delta=1e-4)
        hidden = np.ma.masked_greater(at[0], 2)
        np.testing.assert_array_equal(f(hidden).mask, hidden.mask)
        left_out = csrbf.fit(np.ma.masked_less(x, 0.05), np.sin(x))
        self.assertEqual(left_out.report["missing"], 1)
        with self.assertRaisesRegex(ValueError, r"values: has shape \(39,\); must be \(40,\)"):
            csrbf.fit(x, np.sin(x)[1:])
        with self.assertRaisesRegex(ValueError, r"faults: a line has shape \(1, 1\); must be \(m, 2\)"):
            csrbf.fit(x, np.sin(x), faults=[[[1.5]]])
        with self.assertRaisesRegex(ValueError, "faults = given: they are for two coordinates"):
            csrbf.fit(x, np.sin(x), faults=[[[1.5, 0], [1.5, 1]]])

    def test_samples_of_a_smooth_function_come_back(self):
        x, v = samples(1500)
        f = csrbf.fit(x, v)
        at, expected = samples(200, seed=2)
        inside = ((at > 0.05) & (at < 0.95)).all(axis=1)
        self.assertEqual(f(at).shape, (200,))
        # Far below the variation of the values, 2, and far above what smooth kernels reach.
        np.testing.assert_allclose(f(at)[inside], expected[inside], atol=1e-3)

    def test_derivatives_are_those_of_the_values(self):
        x, v = samples(600)
        f = csrbf.fit(x, v, **QUICK)
        at = 0.2 + 0.6 * samples(30, seed=3)[0]
        h = 1e-4
        steps = h * np.eye(2)
        gradient = np.stack([(f(at + s) - f(at - s)) / (2 * h) for s in steps], axis=-1)
        hessian = np.stack([(f.gradient(at + s) - f.gradient(at - s)) / (2 * h) for s in steps], axis=-1)
        # Central differences err by h^2 times the third derivatives, and by roundings over h.
        np.testing.assert_allclose(f.gradient(at), gradient, atol=1e-6 * np.abs(gradient).max())
        np.testing.assert_allclose(f.hessian(at), hessian, atol=1e-4 * np.abs(hessian).max())
        np.testing.assert_array_equal(f.hessian(at), np.swapaxes(f.hessian(at), -1, -2))

    def test_works_in_one_to_six_dimensions(self):
        for d in range(1, 7):
            x, v = samples(200, d)
            f = csrbf.fit(x, v, smoothing="none")
            self.assertEqual(f.dimension, d)
            self.assertEqual(f.gradient(x).shape, (200, d))
            self.assertEqual(f.hessian(x[:5]).shape, (5, d, d))
            np.testing.assert_allclose(f(x), v, atol=1e-4)

    def test_vector_valued_samples_are_fitted_together(self):
        x, v = samples(500)
        f = csrbf.fit(x, np.column_stack([v, 2 * v, -v]), **QUICK)
        at = samples(40, seed=4)[0]
        self.assertEqual(f(at).shape, (40, 3))
        self.assertEqual(f.gradient(at).shape, (40, 3, 2))
        self.assertEqual(f.hessian(at).shape, (40, 3, 2, 2))
        np.testing.assert_allclose(f(at)[:, 1], 2 * f(at)[:, 0], rtol=1e-6)
        np.testing.assert_allclose(f.gradient(at)[:, 2], -f.gradient(at)[:, 0], rtol=1e-6, atol=1e-9)
        self.assertEqual(csrbf.fit(x, v[:, None], **QUICK)(at).shape, (40, 1))

    def test_queries_keep_the_shape_of_their_array(self):
        x, v = samples(300)
        f = csrbf.fit(x, v, **QUICK)
        grid = np.stack(np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 7)), axis=-1)
        self.assertEqual(f(grid).shape, (7, 5))
        self.assertEqual(f.gradient(grid).shape, (7, 5, 2))
        np.testing.assert_array_equal(f(grid).ravel(), f(grid.reshape(-1, 2)))
        self.assertEqual(f(grid[0, 0]).shape, ())
        self.assertEqual(f(np.empty((0, 2))).shape, (0,))

    def test_grids_have_the_values_at_their_nodes(self):
        points, _ = samples(900, 3)
        values = np.stack([points.sum(axis=1), points[:, 0]], axis=1)
        x, y, z = np.linspace(0, 1, 7), np.linspace(0.1, 0.9, 5), [0.5, 0.2]
        nodes = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
        for v in (values, values[:, 0]):
            f = csrbf.fit(points, v, method="partition-of-unity")
            grid = f.evaluate_grid(x, y, z)
            self.assertEqual(grid.shape, (7, 5, 2) + v.shape[1:])
            np.testing.assert_allclose(grid, f(nodes), rtol=0, atol=1e-12)
            single = f.evaluate_grid(x, y, z, dtype=np.float32)
            self.assertEqual(single.dtype, np.float32)
            np.testing.assert_array_equal(single, grid.astype(np.float32))
            self.assertEqual(f.evaluate_grid(x, [], z).shape, (7, 0, 2) + v.shape[1:])
        with self.assertRaisesRegex(ValueError, "dtype = int64: must be float64 or float32"):
            f.evaluate_grid(x, y, z, dtype=int)
        with self.assertRaisesRegex(ValueError, "2 axes were given; the function has 3 variables"):
            f.evaluate_grid(x, y)

    def test_other_layouts_and_types_give_the_same_function(self):
        x, v = samples(300)
        x = x.astype(np.float32).astype(float)
        expected = csrbf.fit(x, v, **QUICK)(x)
        np.testing.assert_array_equal(csrbf.fit(np.asfortranarray(x), v, **QUICK)(x), expected)
        single = csrbf.fit(x.astype(np.float32), v, **QUICK)
        np.testing.assert_array_equal(single(np.repeat(x, 2, axis=0)[::2]), expected)
        np.testing.assert_array_equal(csrbf.fit(x.tolist(), v.tolist(), **QUICK)(x.tolist()), expected)


class Replicates(unittest.TestCase):
    def test_models_keep_the_noise_of_replicates(self):
        rng = np.random.default_rng(1)
        for places in (3, 3000):
            x = np.repeat(rng.random((places, 2)), 6, axis=0)
            f = csrbf.fit(x, np.sin(5 * x[:, 0]) + 0.2 * rng.standard_normal(len(x)))
            with tempfile.TemporaryDirectory() as folder:
                f.save(os.path.join(folder, "f.csrbf"))
                again = csrbf.load(os.path.join(folder, "f.csrbf"))
            self.assertAlmostEqual(f.standard_deviation(x[:9]).mean(), 0.2, delta=0.08)
            np.testing.assert_array_equal(again.standard_deviation(x[:9]), f.standard_deviation(x[:9]))


class StandardDeviations(unittest.TestCase):
    def test_of_interpolation_are_zero_at_the_samples_and_grow_between_them(self):
        x, v = samples(150)
        x = x[(np.abs(x - 0.5) > 0.2).any(axis=1)]  # a gap in the middle
        f = csrbf.fit(x, np.column_stack([v[: len(x)], -v[: len(x)]]), kernel="matern-c2", smoothing="none")
        at_samples, middle = f.standard_deviation(x), f.standard_deviation([0.5, 0.5])
        self.assertEqual(at_samples.shape, (len(x), 2))
        self.assertEqual(middle.shape, (2,))
        self.assertLess(at_samples.max(), 1e-3 * middle.min())
        np.testing.assert_allclose(middle[0], middle[1], rtol=1e-9)
        self.assertTrue((f.standard_deviation([[9.0, 9.0]]) > middle).all())

    def test_are_those_of_samples_or_of_the_function(self):
        x, v = samples(400)
        noisy = v + 0.1 * np.random.default_rng(3).standard_normal(400)
        f = csrbf.fit(x, noisy)
        both, own = f.standard_deviation(x), f.standard_deviation(x, of="function")
        self.assertAlmostEqual(f.report["noise"][0], 0.1, delta=0.03)
        np.testing.assert_allclose(both**2 - own**2, f.report["noise"][0] ** 2, rtol=1e-6)
        with self.assertRaisesRegex(ValueError, "must be sample or function"):
            f.standard_deviation(x, of="both")

    def test_of_replicates_keep_their_scatter(self):
        x, v = samples(60)
        x, v = np.repeat(x, 6, axis=0), np.repeat(v, 6)
        f = csrbf.fit(x, v + 0.3 * np.random.default_rng(3).standard_normal(len(v)))
        self.assertAlmostEqual(f.report["noise"][0], 0.3, delta=0.05)

    def test_of_noisy_samples_are_their_noise(self):
        x, v = samples(3000)
        v = v + 0.1 * np.random.default_rng(3).standard_normal(3000)
        for asked, method in (("auto", "interpolate"), ("partition-of-unity",) * 2):
            f = csrbf.fit(x, v, method=asked)
            self.assertEqual(f.report["method"], method)
            deviation = f.standard_deviation(0.1 + 0.8 * samples(400, seed=2)[0])
            self.assertEqual(deviation.shape, (400,))
            self.assertAlmostEqual(np.sqrt((deviation**2).mean()), 0.1, delta=0.015)

    def test_are_saved(self):
        x, v = samples(200)
        for method in ("interpolate", "partition-of-unity"):
            f = csrbf.fit(x, v, method=method, kernel="wendland-c2")
            copy = pickle.loads(pickle.dumps(f))
            np.testing.assert_array_equal(copy.standard_deviation(x + 0.01), f.standard_deviation(x + 0.01))

    def test_other_methods_have_them_on_request(self):
        x, v = samples(200)
        with self.assertRaisesRegex(ValueError, "method = multilevel: this fit has none; give standard_deviation"):
            csrbf.fit(x, v, method="multilevel").standard_deviation(x)
        f = csrbf.fit(x, v, method="multilevel", standard_deviation=True)
        copy = pickle.loads(pickle.dumps(f))
        np.testing.assert_array_equal(copy.standard_deviation(x + 0.01), f.standard_deviation(x + 0.01))
        self.assertGreater(f.standard_deviation(x).min(), 0)
        one = csrbf.fit([[1.0, 2.0]], [3.0], standard_deviation=True)
        with self.assertRaisesRegex(ValueError, "samples at a single place tell none; give more"):
            one.standard_deviation([[1.0, 2.0]])


class Options(unittest.TestCase):
    def test_a_tolerance_holds_at_every_sample(self):
        x, v = samples(800)
        f = csrbf.fit(x, v, tolerance=0.01)
        self.assertLessEqual(np.abs(f(x) - v).max(), 0.01)

    def test_a_budget_of_centers_is_kept(self):
        x, v = samples(800)
        self.assertLessEqual(csrbf.fit(x, v, centers=50).report["centers"], 50)

    def test_weights_of_zero_leave_samples_out(self):
        x, v = samples(200)
        bad = v.copy()
        bad[::10] += 5
        weights = np.ones(200)
        weights[::10] = 0
        f = csrbf.fit(x, bad, weights=weights)
        self.assertLess(np.abs(f(x) - v).max(), 0.1)

    def test_periodic_axes_repeat(self):
        angle = np.random.default_rng(1).random(200) * 360
        f = csrbf.fit(angle[:, None], np.cos(np.radians(angle)), periods=[360])
        at = np.linspace(0, 360, 50)[:, None]
        np.testing.assert_allclose(f(at + 360), f(at), atol=1e-9)

    def test_longitudes_and_latitudes_are_places_on_a_sphere(self):
        rng = np.random.default_rng(1)
        places = np.column_stack([rng.uniform(0, 360, 200), np.degrees(np.arcsin(rng.uniform(-1, 1, 200)))])
        lon, lat = np.radians(places.T)
        v = np.sin(2 * np.cos(lon) * np.cos(lat)) + np.sin(lat)
        f = csrbf.fit(places, v, sphere=True)
        self.assertAlmostEqual(f([10.0, 90.0]), f([200.0, 90.0]), places=9)
        self.assertAlmostEqual(f([10.0, 90.0]), 1.0, places=3)
        turned = csrbf.fit(places[:, ::-1], v, sphere=(1, 0))
        self.assertAlmostEqual(f([-50.0, 20.0]), turned([20.0, 310.0]), places=5)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(f))(places), f(places))
        self.assertTrue(f.covered([0.0, 0.0], "distance:20"))
        with self.assertRaisesRegex(ValueError, "sphere"):
            csrbf.fit(places, v, sphere=(0, 5))
        for evaluate in (f, f.gradient, f.standard_deviation, lambda x: csrbf.evaluate(f, x)):
            with self.assertRaisesRegex(ValueError, "latitude 170 is beyond 90 degrees; the coordinates are x, y"):
                evaluate([[10, 80], [10, 170]])

    def test_covariates_enter_linearly(self):
        x, v = samples(150)
        z = np.random.default_rng(2).random(150)
        f = csrbf.fit(np.column_stack([x, z]), v + 4 * z, drift=[-1])
        self.assertAlmostEqual(f.report["drift"][0], 4, places=3)
        self.assertAlmostEqual(f([0.5, 0.5, 10.0]) - f([0.5, 0.5, 0.0]), 10 * f.report["drift"][0], places=9)
        with self.assertRaisesRegex(ValueError, "does not tell the z of its nodes, a covariate"):
            csrbf.evaluate(f, grid=3)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(f))(np.ones((1, 3))), f(np.ones((1, 3))))
        self.assertGreater(f.standard_deviation([0.5, 0.5, 100.0]), f.standard_deviation([0.5, 0.5, 0.5]))

    def test_derivatives_are_data(self):
        x = np.random.default_rng(1).random((40, 2))
        v, g = x[:, 0] ** 2 + np.sin(x[:, 1]), np.column_stack([2 * x[:, 0], np.cos(x[:, 1])])
        f = csrbf.fit(x, v, derivatives=g)
        np.testing.assert_allclose(f.gradient(x), g, atol=1e-4)
        self.assertAlmostEqual(f([0.5, 0.5]), 0.25 + np.sin(0.5), places=5)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(f))(x), f(x))
        with self.assertRaisesRegex(ValueError, "derivatives"):
            csrbf.fit(x, v, derivatives=g[:, :1])

    def test_faults_are_not_smoothed_across(self):
        x, v = samples(300)
        v = v + 5 * (x[:, 0] > 0.5)
        f = csrbf.fit(x, v, faults=[[[0.5, -1.0], [0.5, 2.0]]])
        self.assertAlmostEqual(f([0.5001, 0.5]) - f([0.4999, 0.5]), 5, places=1)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(f))(x), f(x))

    def test_values_that_differ_have_kernels_of_their_own(self):
        x, v = samples(500)
        f = csrbf.fit(x, np.column_stack([v, np.floor(3 * x[:, 0])]))
        alone = csrbf.fit(x, v)
        self.assertEqual(len(f.report["value_kernels"]), 2)
        at = 0.1 + 0.8 * np.random.default_rng(5).random((200, 2))
        np.testing.assert_allclose(f(at)[:, 0], alone(at), atol=1e-9)

    def test_axes_are_scaled_unless_told_otherwise(self):
        x, v = samples(200)
        x[:, 1] *= 1000
        self.assertGreater(csrbf.fit(x, v, **QUICK).report["axis_scales"][1], 100)
        self.assertEqual(csrbf.fit(x, v, scale_axes=False, **QUICK).report["axis_scales"], [1, 1])

    def test_few_samples_keep_their_peaks(self):
        x = np.linspace(0, 1, 12)
        report = csrbf.fit(x[:, None], np.exp(6 * x)).report
        self.assertEqual((report["gross_errors"], report["suspects"][-1]), ([], 11))
        self.assertTrue(any("not from what all others do" in text for text in report["warnings"]))

    def test_progress_is_told_and_may_end_the_fit(self):
        x, v = samples(2000)
        told = []
        csrbf.fit(x, v, progress=lambda stage, fraction: told.append((stage, fraction)))
        self.assertGreater(len(told), 3)
        self.assertTrue(all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in told))

        def stop(stage, fraction):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            csrbf.fit(x, v, progress=stop)

    def test_outside_the_data_values_are_constant_or_nan(self):
        x, v = samples(300)
        f = csrbf.fit(x, v, **QUICK)
        box = f.bounds
        np.testing.assert_allclose(box, [x.min(axis=0), x.max(axis=0)])
        np.testing.assert_array_equal(f([[9.0, 9.0]]), f([[19.0, 19.0]]))
        constant = csrbf.fit(x, v, extrapolation="constant", **QUICK)
        np.testing.assert_array_equal(constant([[9.0, 9.0]]), f(box[1:]))
        self.assertTrue(np.isnan(csrbf.fit(x, v, extrapolation="nan", **QUICK)([[9.0, 9.0]])[0]))

    def test_the_report_says_what_was_done(self):
        x, v = samples(300)
        report = csrbf.fit(np.repeat(x, 2, axis=0), np.repeat(v, 2)).report
        self.assertEqual(report["merged_duplicates"], 300)
        self.assertNotEqual(report["method"], "auto")
        for key in ("samples", "centers", "levels", "rmse", "max_error", "smoothing", "cross_validation_rmse"):
            self.assertTrue(math.isfinite(report[key]) or key == "cross_validation_rmse", key)


class Files(unittest.TestCase):
    def test_loaded_and_unpickled_functions_give_the_same_values(self):
        x, v = samples(400)
        at = samples(50, seed=5)[0]
        for values in (v, v[:, None], np.column_stack([v, -v])):
            f = csrbf.fit(x, values, **QUICK)
            copy = pickle.loads(pickle.dumps(f))
            np.testing.assert_array_equal(copy(at), f(at))
            np.testing.assert_equal(timeless(copy.report), timeless(f.report))
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "f.csrbf")
                f.save(path)
                np.testing.assert_array_equal(csrbf.load(path)(at).ravel(), f(at).ravel())

    def test_files_that_cannot_be_read_or_written_raise_io_errors(self):
        x, v = samples(50)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "f.csrbf")
            with self.assertRaisesRegex(csrbf.IoError, "f.csrbf"):
                csrbf.load(path)
            with open(path, "wb") as file:
                file.write(b"no model")
            with self.assertRaisesRegex(csrbf.IoError, "f.csrbf"):
                csrbf.load(path)
            with self.assertRaises(OSError):
                csrbf.fit(x, v, **QUICK).save(os.path.join(folder, "missing", "f.csrbf"))


class Running(unittest.TestCase):
    def test_other_threads_run_during_a_fit(self):
        x, v = samples(100000)
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.perf_counter()
        csrbf.fit(x, v)(x)
        end = time.perf_counter()
        done.set()
        thread.join()
        during = [t for t in ticks if begin < t < end]
        self.assertGreater(len(during), 3)

    def test_ctrl_c_stops_a_fit_and_an_evaluation(self):
        x, v = samples(3000)
        slow = np.random.default_rng(2).random((300000, 2))
        interpolant = csrbf.RBFInterpolator(x, v)
        big = samples(400000)
        cases = {
            "evaluation": lambda: [interpolant(slow) for _ in range(20)],
            "fit": lambda: [csrbf.fit(*big) for _ in range(20)],
        }
        for name, work in cases.items():
            with self.subTest(work=name):
                timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
                begin = time.perf_counter()
                timer.start()
                with self.assertRaises(KeyboardInterrupt):
                    work()
                self.assertLess(time.perf_counter() - begin, 15)


class Failures(unittest.TestCase):
    def test_wrong_arguments_raise_value_errors_that_say_what_to_do(self):
        x, v = samples(50)
        nan = v.copy()
        nan[7] = np.nan
        cases = [
            ("one point per row", (x[np.newaxis], v), {}),
            ("must be \\(50,\\)", (x, v[1:]), {}),
            ("finite", (x, nan), {}),
            ("finite", (x * np.inf, v), {}),
            ("partition-of-unity", (x, v), {"method": "magic"}),
            ("wendland", (x, v), {"kernel": "magic"}),
            ("weights", (x, v), {"weights": -np.ones(50)}),
            ("weights", (x, v), {"weights": np.ones(49)}),
            ("extrapolation = mirror: unknown; use one of auto, constant", (x, v), {"extrapolation": "mirror"}),
            ("loss = least: unknown; use one of auto", (x, v), {"loss": "least"}),
            ("transform = ln: unknown; use one of auto", (x, v), {"transform": "ln"}),
            ("neither", (x, v), {"smoothing": "much"}),
            ("progress", (x, v), {"progress": 5}),
            ("centers = 'many': is of the wrong type", (x, v), {"centers": "many"}),
            ("tolerance = .*: is of the wrong type", (x, v), {"tolerance": [1, 2]}),
            ("extrapolation = 5: is of the wrong type", (x, v), {"extrapolation": 5}),
            ("missing = 'none': is of the wrong type", (x, v), {"missing": "none"}),
            ("real", (x, v + 1j), {}),
            ("", (np.zeros((50, 21)), v), {}),
            ("", (x[:0], v[:0]), {}),
            ("points: must be real numbers; the array is of type <U1", (np.array([["a", "b"]]), v[:1]), {}),
        ]
        for message, arguments, keywords in cases:
            with self.subTest(message=message, keywords=keywords):
                with self.assertRaisesRegex(ValueError, message):
                    csrbf.fit(*arguments, **keywords)
        with self.assertRaisesRegex(ValueError, "2 coordinates"):
            csrbf.fit(x, v)(np.zeros((3, 3)))


if __name__ == "__main__":
    unittest.main()
