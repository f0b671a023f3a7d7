"""reconstruct, Surface and Mesh on points of a sphere."""

import os
import pickle
import tempfile
import unittest

import numpy as np

import csrbf


def sphere(n):
    """Points on the unit sphere along a Fibonacci spiral."""
    i = np.arange(n)
    z = 1 - (2 * i + 1) / n
    angle = np.pi * (3 - np.sqrt(5)) * i
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


class Reconstruction(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.points = sphere(3000)
        cls.surface = csrbf.reconstruct(cls.points)
        cls.with_normals = csrbf.reconstruct(cls.points, cls.points)

    def test_the_function_is_positive_inside_and_zero_on_the_points(self):
        for s in (self.surface, self.with_normals):
            # The distance between the samples is 0.06, and the sphere has curvature 1: fits err by far less than the
            # sagitta of that, 5e-4.
            self.assertLess(np.abs(s(self.points)).max(), 5e-4)
            inside = s.contains([[0, 0, 0], [0.9, 0, 0], [1.1, 0, 0], [9, 9, 9]])
            self.assertEqual(inside.tolist(), [True, True, False, False])
            self.assertEqual(s.contains(np.zeros(3)).shape, ())

    def test_normals_point_outwards(self):
        n = self.surface.normal(self.points)
        self.assertEqual(n.shape, (3000, 3))
        np.testing.assert_allclose(n, self.points, atol=0.02)
        np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, atol=1e-12)

    def test_the_mesh_is_a_closed_sphere(self):
        m = self.surface.polygonize(resolution=40)
        self.assertEqual(m.faces.dtype, np.int32)
        edges = np.sort(np.concatenate([m.faces[:, [0, 1]], m.faces[:, [1, 2]], m.faces[:, [2, 0]]]), axis=1)
        unique, counts = np.unique(edges, axis=0, return_counts=True)
        self.assertTrue((counts == 2).all())
        self.assertEqual(len(m.vertices) - len(unique) + len(m.faces), 2)
        np.testing.assert_allclose(np.linalg.norm(m.vertices, axis=1), 1, atol=1e-3)
        np.testing.assert_allclose(m.normals, m.vertices, atol=0.05)
        a, b, c = (m.vertices[m.faces[:, i]] for i in range(3))
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        self.assertAlmostEqual(volume, 4 * np.pi / 3, delta=0.05)
        self.assertGreater(len(self.surface.polygonize(resolution=80).faces), 3 * len(m.faces))

    def test_the_report_says_what_was_found(self):
        report = self.surface.report
        self.assertEqual((report["points"], report["points_used"]), (3000, 3000))
        self.assertEqual(report["normals"], "estimated")
        self.assertEqual(self.with_normals.report["normals"], "file")
        self.assertLess(report["rms_distance"], 1e-4)

    def test_loaded_and_unpickled_surfaces_give_the_same_values_and_meshes(self):
        at = np.random.default_rng(1).uniform(-1.5, 1.5, (500, 3))
        copy = pickle.loads(pickle.dumps(self.surface))
        np.testing.assert_array_equal(copy(at), self.surface(at))
        np.testing.assert_array_equal(copy.polygonize(20).vertices, self.surface.polygonize(20).vertices)
        self.assertEqual(copy.report, self.surface.report)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "s.csrbf")
            self.surface.save(path)
            loaded = csrbf.load(path)
            self.assertIsInstance(loaded, csrbf.Surface)
            np.testing.assert_array_equal(loaded(at), self.surface(at))
            np.testing.assert_array_equal(loaded.bounds, self.surface.bounds)

    def test_meshes_are_saved_in_the_format_of_the_name(self):
        m = self.surface.polygonize(20)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("m.ply", "m.obj", "m.off", "m.stl"):
                path = os.path.join(folder, name)
                m.save(path)
                self.assertGreater(os.path.getsize(path), 40 * len(m.vertices) / 2)
            with self.assertRaises(csrbf.IoError):
                m.save(os.path.join(folder, "m.magic"))
            with self.assertRaises(OSError):
                m.save(os.path.join(folder, "missing", "m.ply"))
            with self.assertRaisesRegex(ValueError, "numbers of vertices"):
                csrbf.Mesh(m.vertices[:4], m.faces, m.normals[:4]).save(os.path.join(folder, "m.ply"))

    def test_wrong_arguments_raise_value_errors(self):
        p = self.points
        cases = [
            ("3 columns", (p[:, :2],), {}),
            ("one point a row", (p[0],), {}),
            ("one for each point", (p, p[1:]), {}),
            ("method", (p,), {"method": "magic"}),
            ("", (p[:3],), {}),
            ("", (np.arange(30.0)[:, None] * [1, 1, 1],), {}),
        ]
        for message, arguments, keywords in cases:
            with self.subTest(message=message):
                with self.assertRaisesRegex(ValueError, message):
                    csrbf.reconstruct(*arguments, **keywords)
        with self.assertRaisesRegex(ValueError, "3 coordinates"):
            self.surface(np.zeros((2, 2)))
        with self.assertRaises(ValueError):
            self.surface.polygonize(resolution=-3)


if __name__ == "__main__":
    unittest.main()
