"""Pickles: copies of all objects that give the same values."""

import copy
import pickle
import unittest

import numpy as np

import csrbf


def again(thing):
    return pickle.loads(pickle.dumps(thing))


def timeless(report):
    """Without what files do not keep."""
    return {key: value for key, value in report.items() if not key.endswith("_seconds")}


def sphere(n):
    x = np.random.default_rng(0).normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def disc(noise=0.0, radius=12):
    y, x = np.mgrid[:48, :64]
    image = np.where((x - 30) ** 2 + (y - 20) ** 2 < radius**2, 10.0, 1.0)
    return image + noise * np.random.default_rng(1).normal(size=image.shape)


class Pickles(unittest.TestCase):
    def test_functions_of_every_method(self):
        x = np.random.default_rng(0).random((300, 2))
        at = np.random.default_rng(1).random((40, 2))
        for method in ("interpolate", "least-squares", "partition-of-unity", "multilevel", "pca-multiresolution",
                       "fixed-budget", "error-bounded", "moving-least-squares", "along-tracks"):
            with self.subTest(method):
                options = {"tolerance": 0.1} if method == "error-bounded" else {}
                f = csrbf.fit(x, np.sin(3 * x[:, 0]) + x[:, 1], method=method, **options)
                g = again(f)
                np.testing.assert_array_equal(g(at), f(at))
                np.testing.assert_equal(timeless(g.report), timeless(f.report))
                self.assertEqual(repr(g), repr(f))

    def test_surfaces_with_their_points_and_normals(self):
        ball = csrbf.reconstruct(sphere(1500))
        by_budget = csrbf.reconstruct(sphere(500), method="medial-axis")
        for surface in (ball, by_budget, ball - ~by_budget):
            other = again(surface)
            at = np.random.default_rng(1).uniform(-1.5, 1.5, (200, 3))
            np.testing.assert_array_equal(other(at), surface(at))
            np.testing.assert_array_equal(other.points, surface.points)
            self.assertEqual(other.report, surface.report)

    def test_segmentations_in_the_plane_and_in_space(self):
        z, y, x = np.mgrid[:18, :22, :20]
        ball = np.where((x - 10) ** 2 + (y - 11) ** 2 + (z - 9) ** 2 < 36, 100.0, 20.0)
        three = disc() + np.where(np.arange(64) > 50, 5.0, 0.0)
        for image, options in (
            (disc(), {}),
            (csrbf.Image(disc(), 0.5, (7, 8)), {"method": "finite-difference"}),
            (disc(), {"method": "collocation"}),
            (three, {"regions": 3}),
            (ball, {"voxel_size": (1.0, 1.0, 2.0)}),
        ):
            with self.subTest(options=options):
                g = csrbf.segment(image, **options)
                h = again(g)
                np.testing.assert_array_equal(h.labels, g.labels)
                self.assertEqual(h.report, g.report)
                self.assertEqual(h.measure(), g.measure())
                at = np.random.default_rng(1).uniform(3, 15, (50, g.field.dimension))
                np.testing.assert_array_equal(h.field(at), g.field(at))
                if image is ball:
                    np.testing.assert_array_equal(h.contour().vertices, g.contour().vertices)
                else:
                    np.testing.assert_array_equal(h.contour()[0], g.contour()[0])

    def test_sequences(self):
        t = csrbf.track([disc(radius=r) for r in (10, 11)])
        u = again(t)
        self.assertIsInstance(u, csrbf.Tracking)
        self.assertEqual(u.measures, t.measures)
        np.testing.assert_array_equal(u.volumes(), t.volumes())
        np.testing.assert_array_equal(u[1].labels, t[1].labels)
        self.assertEqual(len(copy.copy(t)), 2)

    def test_interpolators_meshes_clouds_images_and_curvatures(self):
        x = sphere(100)
        f = csrbf.RBFInterpolator(x, x[:, 0])
        np.testing.assert_array_equal(again(f)(x), f(x))
        ball = csrbf.reconstruct(sphere(1500))
        mesh, curvature = ball.polygonize(20), ball.curvature(x)
        np.testing.assert_array_equal(again(mesh).faces, mesh.faces)
        np.testing.assert_array_equal(again(curvature).k1, curvature.k1)
        np.testing.assert_array_equal(again(csrbf.PointCloud(x, x)).normals, x)
        np.testing.assert_array_equal(again(csrbf.Image(disc(), 2.0)).spacing, (2, 2, 1))

    def test_errors(self):
        with self.assertRaises(csrbf.IoError) as caught:
            csrbf.load("nowhere.csrbf")
        self.assertEqual(str(again(caught.exception)), str(caught.exception))


if __name__ == "__main__":
    unittest.main()
