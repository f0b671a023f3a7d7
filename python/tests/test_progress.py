"""Progress of all long work: functions, bars, lines, and interruption."""

import contextlib
import io
import os
import signal
import sys
import threading
import time
import types
import unittest
from unittest import mock

import numpy as np

import csrbf


def sphere(n):
    x = np.random.default_rng(0).normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def discs(n, size=64):
    y, x = np.mgrid[:size, :size]
    noise = np.random.default_rng(1).normal(size=(n, size, size))
    return np.where((x - size / 2) ** 2 + (y - size / 2) ** 2 < size**2 / 9, 10.0, 1.0) + noise


def works(scale=1):
    """Calls of everything that may take long, by name; each takes the keyword `progress`."""
    rng = np.random.default_rng(2)
    x = rng.random((3000 * scale, 2))
    values = np.sin(9 * x[:, 0]) * x[:, 1] + 0.01 * rng.normal(size=len(x))
    points = sphere(2000 * scale)
    image = discs(1, 64 * int(np.sqrt(scale)))[0]
    holes = rng.random(image.shape) < 0.3
    ball = csrbf.reconstruct(sphere(2000))
    mesh = ball.polygonize(40)
    return {
        "fit": lambda **keywords: csrbf.fit(x, values, **keywords),
        "reconstruct": lambda **keywords: csrbf.reconstruct(points, **keywords),
        "estimate_normals": lambda **keywords: csrbf.estimate_normals(points, **keywords),
        "farthest_points": lambda **keywords: csrbf.farthest_points(points, 500 * scale, **keywords),
        "inpaint": lambda **keywords: csrbf.inpaint(image, holes, **keywords),
        "segment": lambda **keywords: csrbf.segment(image, **keywords),
        "track": lambda **keywords: csrbf.track(np.stack([image] * 3), **keywords),
        "polygonize": lambda **keywords: ball.polygonize(60 * scale, **keywords),
        "render": lambda **keywords: ball.render(size=(80 * scale, 60 * scale), **keywords),
        "render of a mesh": lambda **keywords: mesh.render(size=(80 * scale, 60 * scale), **keywords),
        "compare": lambda **keywords: csrbf.compare(mesh, mesh, samples=20000 * scale, **keywords),
    }


# Background jobs ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)


class Functions(unittest.TestCase):
    def test_are_told_stages_and_fractions(self):
        for name, work in works().items():
            with self.subTest(name):
                told = []
                work(progress=lambda stage, fraction: told.append((stage, fraction)))
                self.assertGreater(len(told), 0)
                for stage, fraction in told:
                    self.assertIsInstance(stage, str)
                    self.assertTrue(0 <= fraction <= 1, (stage, fraction))

    def test_may_end_the_work(self):
        def stop(stage, fraction):
            raise RuntimeError("enough")

        for name, work in works().items():
            with self.subTest(name), self.assertRaisesRegex(RuntimeError, "enough"):
                work(progress=stop)

    def test_other_things_are_value_errors(self):
        for name, work in works().items():
            with self.subTest(name), self.assertRaisesRegex(ValueError, "progress: must be True, False or a function"):
                work(progress=5)


class Displays(unittest.TestCase):
    def test_a_bar_of_tqdm_begins_anew_with_every_stage(self):
        class Bar:
            stages, desc, n = [], "", 0.0

            def __init__(self, **options):
                pass

            def __enter__(self):
                return self

            def __exit__(self, *error):
                Bar.stages.append("closed")

            def reset(self, total):
                self.n = 0.0

            def set_description_str(self, stage, refresh):
                self.desc = stage
                Bar.stages.append(stage)

            def update(self, step):
                self.n += step
                assert -1e-9 <= self.n <= 100 + 1e-9, self.n

        with mock.patch.dict(sys.modules, {"tqdm": types.SimpleNamespace(tqdm=Bar)}):
            csrbf.reconstruct(sphere(2000), progress=True)
        self.assertGreater(len(Bar.stages), 2)
        self.assertEqual(Bar.stages[-1], "closed")

    def test_the_bar_of_tqdm_itself_goes_to_standard_error(self):
        try:
            import tqdm  # noqa: F401
        except ImportError:
            self.skipTest("tqdm is not installed")
        shown = io.StringIO()
        with contextlib.redirect_stderr(shown):
            csrbf.reconstruct(sphere(2000), progress=True)
        self.assertIn(" %|", shown.getvalue())

    def test_lines_take_its_place_where_it_is_missing(self):
        shown = io.StringIO()
        with mock.patch.dict(sys.modules, {"tqdm": None}), contextlib.redirect_stderr(shown):
            csrbf.reconstruct(sphere(2000), progress=True)
        lines = shown.getvalue().splitlines()
        self.assertGreater(len(lines), 1)
        for line in lines:
            self.assertRegex(line, r"^[a-z ]+ \d+ %$")

    def test_nothing_is_shown_unless_asked_for(self):
        for progress in (None, False):
            shown = io.StringIO()
            with contextlib.redirect_stderr(shown):
                csrbf.reconstruct(sphere(2000), progress=progress)
            self.assertEqual(shown.getvalue(), "")


class Interruption(unittest.TestCase):
    def test_ctrl_c_stops_all_long_work(self):
        for name, work in works(4).items():
            with self.subTest(name):
                timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
                begin = time.perf_counter()
                timer.start()
                with self.assertRaises(KeyboardInterrupt):
                    while time.perf_counter() < begin + 60:
                        work()
                self.assertLess(time.perf_counter() - begin, 20)


if __name__ == "__main__":
    unittest.main()
