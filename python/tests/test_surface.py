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


class Contours(unittest.TestCase):
    def test_circles_on_slices_make_a_sphere(self):
        angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
        heights = np.array([-0.85, -0.5, -0.2, 0.1, 0.5, 0.8])
        contours = [
            np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(24, z)])
            for r, z in zip(np.sqrt(1 - heights**2), heights)
        ]
        s = csrbf.reconstruct_contours(contours, centers=200)
        self.assertEqual((s.report["contours"], s.report["slices"], s.report["points"]), (6, 6, 144))
        x = sphere(500)
        # Most of the error is at the poles, beyond the last slices.
        self.assertLess(np.sqrt(np.mean(s(x) ** 2)), 0.02)
        self.assertEqual(s.contains([[0, 0, 0], [0, 0, 1.2]]).tolist(), [True, False])
        with self.assertRaisesRegex(ValueError, "at least two planes"):
            csrbf.reconstruct_contours(contours[:1])
        with self.assertRaisesRegex(ValueError, "at least two closed curves"):
            csrbf.reconstruct_contours([])


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

    def test_curvatures_are_those_of_the_sphere(self):
        c = self.surface.curvature(self.points.reshape(2, 1500, 3))
        self.assertEqual((c.k1.shape, c.direction1.shape), ((2, 1500), (2, 1500, 3)))
        # The median is not drawn by the noise of second derivatives.
        for k, exact in ((c.k1, 1), (c.k2, 1), (c.mean, 1), (c.gaussian, 1)):
            self.assertAlmostEqual(np.median(k), exact, delta=0.02)
        self.assertTrue((c.k1 >= c.k2).all())
        n = self.surface.normal(self.points.reshape(2, 1500, 3))
        np.testing.assert_allclose(np.cross(c.direction1, c.direction2), n, atol=1e-12)

    def test_rays_meet_the_surface_where_the_function_is_zero(self):
        directions = 3 * np.random.default_rng(3).normal(size=(40, 50, 3))
        t, normals = self.surface.raycast(np.zeros(3), directions)
        self.assertEqual((t.shape, normals.shape), ((40, 50), (40, 50, 3)))
        unit = directions / np.linalg.norm(directions, axis=2, keepdims=True)
        np.testing.assert_allclose(t, 1, atol=1e-3)
        np.testing.assert_allclose(self.surface(t[..., None] * unit), 0, atol=1e-12)
        np.testing.assert_allclose(normals, unit, atol=0.05)
        t, normals = self.surface.raycast([[0, 0, 5], [0, 3, 5]], [[0, 0, -1], [0, 0, -1]])
        self.assertAlmostEqual(t[0], 4, delta=1e-3)
        self.assertEqual(t[1], np.inf)
        self.assertTrue(np.isnan(normals[1]).all())
        t, normals = self.surface.raycast([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
        self.assertEqual((t[0].round(2), t[1], normals.shape), (4, np.inf, (2, 3)))
        with self.assertRaisesRegex(ValueError, "direction"):
            self.surface.raycast([0, 0, 0], [[0, 0, 0]])
        with self.assertRaisesRegex(ValueError, r"origins and directions: have shapes \(3, 3\) and \(2, 3\)"):
            self.surface.raycast([[0, 0, 0]] * 3, [[0, 0, 1]] * 2)

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

    def test_meshes_by_every_method_are_closed(self):
        triangles = {}
        for method in ("marching-cubes", "marching-tetrahedra", "dual-contouring", "adaptive"):
            m = self.surface.polygonize(resolution=40, method=method)
            edges = np.sort(np.concatenate([m.faces[:, [0, 1]], m.faces[:, [1, 2]], m.faces[:, [2, 0]]]), axis=1)
            self.assertTrue((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())
            triangles[method] = len(m.faces)
        self.assertGreater(triangles["marching-tetrahedra"], 2 * triangles["marching-cubes"])
        self.assertLess(triangles["adaptive"], triangles["dual-contouring"] / 2)
        coarse = self.surface.polygonize(resolution=40, method="adaptive", tolerance=0.02)
        self.assertLess(len(coarse.faces), triangles["adaptive"] / 2)
        with self.assertRaisesRegex(ValueError, "polygonize: method = guesswork: must be auto, marching-cubes"):
            self.surface.polygonize(method="guesswork")
        with self.assertRaisesRegex(ValueError, "polygonize: tolerance = -1: must be a fraction"):
            self.surface.polygonize(method="adaptive", tolerance=-1)

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
            with self.assertRaisesRegex(ValueError, "no index of a vertex"):
                csrbf.Mesh(m.vertices[:4], m.faces, m.normals[:4]).save(os.path.join(folder, "m.ply"))

    def test_wrong_arguments_raise_value_errors(self):
        p = self.points
        cases = [
            ("3 columns", (p[:, :2],), {}),
            ("normals are given apart", (np.hstack([p, p]),), {}),
            ("tolerance: 0 is not positive", (p,), {"tolerance": 0}),
            ("one point per row", (p[0],), {}),
            ("one for each point", (p, p[1:]), {}),
            ("method", (p,), {"method": "magic"}),
            ("centers = 0.5: must be a whole number", (p,), {"centers": 0.5}),
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


class Combination(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.a = csrbf.reconstruct(sphere(2000), sphere(2000))
        cls.b = csrbf.reconstruct(sphere(2000) + [1, 0, 0], sphere(2000))
        cls.x = np.random.default_rng(2).uniform(-1.2, 2.2, (500, 3))

    def test_operators_are_set_operations(self):
        a, b, x = self.a, self.b, self.x
        inside = a.contains(x), b.contains(x)
        np.testing.assert_array_equal((a | b).contains(x), inside[0] | inside[1])
        np.testing.assert_array_equal((a & b).contains(x), inside[0] & inside[1])
        np.testing.assert_array_equal((a - b).contains(x), inside[0] & ~inside[1])
        np.testing.assert_array_equal((~a)(x), -a(x))
        with self.assertRaises(TypeError):
            a | 3

    def test_combinations_are_meshed_saved_and_pickled(self):
        cut = self.a - self.b
        mesh = cut.polygonize(40)
        a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
        # Unit balls whose centres are 1 apart share a lens of 5 pi / 12; the sharp edge is cut off by about a cell.
        self.assertAlmostEqual(np.einsum("ij,ij->", a, np.cross(b, c)) / 6, (4 / 3 - 5 / 12) * np.pi, delta=0.05)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(cut))(self.x), cut(self.x))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "cut.csrbf")
            cut.save(path)
            np.testing.assert_array_equal(csrbf.load(path)(self.x), cut(self.x))

    def test_blends_hold_their_parts_and_round_the_edge(self):
        blend = csrbf.combine("blend", self.a, self.b, radius=0.1)
        union = self.a | self.b
        self.assertTrue(blend.contains(self.x)[union.contains(self.x)].all())
        edge = [[0.5, np.sqrt(0.75), 0]]
        self.assertLess(abs(union(edge)[0]), 1e-2)
        self.assertGreater(blend(edge)[0], 0.05)
        self.assertLess(abs(blend([[-1, 0, 0]])[0]), 1e-3)
        sharper = csrbf.combine("blend", self.a, self.b, radius=0.1, sharpness=20)
        self.assertLess(sharper(edge)[0], blend(edge)[0])
        lens = csrbf.combine("intersection", self.a, self.b, radius=0.1)
        self.assertTrue((self.a & self.b).contains(self.x)[lens.contains(self.x)].all())

    def test_wrong_arguments_raise_value_errors(self):
        for message, arguments, keywords in [
            ("operation", ("merge", self.a, self.b), {}),
            ("at least two", ("union", self.a), {}),
            ("complement", ("complement", self.a, self.b), {}),
            ("radius", ("blend", self.a, self.b), {"radius": -1}),
            ("no radius", ("union", self.a, self.b), {"radius": 0.1, "blending": "sharp"}),
            ("blending", ("union", self.a, self.b), {"blending": "soft"}),
            ("not a csrbf.Surface", ("union", self.a, 3), {}),
        ]:
            with self.subTest(message=message):
                with self.assertRaisesRegex(ValueError, message):
                    csrbf.combine(*arguments, **keywords)


if __name__ == "__main__":
    unittest.main()
