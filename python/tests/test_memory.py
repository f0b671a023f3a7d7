"""Arrays that need no conversion are not copied: memory of a fit of a million samples."""

import gc
import tracemalloc
import unittest

import numpy as np

import csrbf

N = 1_000_000
# A loose tolerance and a given kernel: what the library itself does takes a second.
QUICK = {"tolerance": 0.5, "kernel": "wendland-c2", "smoothing": "none"}


def samples():
    x = np.random.default_rng(0).random((N, 2))
    return x, np.sin(3 * x[:, 0]) * x[:, 1]


def allocated(work):
    """Largest number of bytes that numpy and Python had allocated for it at one time."""
    gc.collect()
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


class Copies(unittest.TestCase):
    def test_of_a_million_samples_are_not_made(self):
        x, v = samples()
        self.assertLess(allocated(lambda: csrbf.fit(x, v, **QUICK)), 100_000)
        # As a check that copies are seen, and made once where they are needed.
        fortran = np.asfortranarray(x)
        copied = allocated(lambda: csrbf.fit(fortran, v, **QUICK))
        self.assertTrue(x.nbytes <= copied < 1.1 * x.nbytes, copied)

    def test_of_results_are_not_made(self):
        x, v = samples()
        f = csrbf.fit(x, v, **QUICK)
        # The result, and nothing else.
        self.assertLess(allocated(lambda: f(x)), 1.02 * v.nbytes)
        self.assertLess(allocated(lambda: f.gradient(x)), 1.02 * (v.nbytes + x.nbytes))

    def test_of_points_in_space_are_not_made(self):
        x = np.random.default_rng(0).normal(size=(20000, 3))
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        self.assertLess(allocated(lambda: csrbf.estimate_normals(x)), 1.1 * x.nbytes)
        self.assertLess(allocated(lambda: csrbf.farthest_points(x, 10)), 50_000)

    def test_results_own_their_memory(self):
        x, v = np.random.default_rng(0).random((300, 2)), np.arange(300.0)
        f = csrbf.fit(x, v)
        bounds = f.bounds
        values = f(x)
        copy = values.copy()
        del f
        gc.collect()
        np.testing.assert_array_equal(values, copy)
        self.assertTrue(np.isfinite(bounds).all())
        values += 1  # and may be written to
        self.assertTrue(values.flags.c_contiguous)


if __name__ == "__main__":
    unittest.main()
