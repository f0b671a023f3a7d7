"""Mesh: files, measures, pictures, comparison and the bridges to other packages."""

import os
import pickle
import sys
import tempfile
import types
import unittest
from unittest import mock

import numpy as np

import csrbf


def sphere(n):
    x = np.random.default_rng(0).normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def cube(size=1.0):
    corners = size * np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return csrbf.Mesh(corners, [t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))])


class Measures(unittest.TestCase):
    def test_of_a_cube(self):
        mesh = cube(2.0)
        self.assertAlmostEqual(mesh.area, 24)
        self.assertAlmostEqual(mesh.volume, 8)
        self.assertEqual((mesh.topology["watertight"], mesh.topology["euler"]), (True, 2))
        far = csrbf.Mesh(mesh.vertices + 1e6, mesh.faces)
        self.assertAlmostEqual(far.volume, 8, delta=1e-6)
        opened = csrbf.Mesh(mesh.vertices, mesh.faces[1:])
        self.assertEqual((opened.topology["watertight"], opened.topology["boundary_edges"]), (False, 3))


    def test_need_triangles_of_their_vertices(self):
        corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        for faces, message in (([[0, 1, -1]], "-1 is no index"), ([[0, 1, 3]], "from 0 to 2"), ([[0, 1]], "shape")):
            with self.assertRaisesRegex(ValueError, "faces: .*" + message):
                csrbf.Mesh(corners, faces)


class Files(unittest.TestCase):
    def test_meshes_come_back_with_normals_and_properties(self):
        mesh = cube()
        normals = (mesh.vertices - 0.5) / np.sqrt(0.75)
        mesh = csrbf.Mesh(mesh.vertices, mesh.faces, normals, {"red": np.arange(8, dtype=np.uint8)})
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "cube.ply")
            mesh.save(path)
            found = csrbf.read_mesh(path)
            np.testing.assert_array_equal(found.vertices, mesh.vertices)
            np.testing.assert_array_equal(found.faces, mesh.faces)
            np.testing.assert_allclose(found.normals, normals, atol=1e-7)
            np.testing.assert_array_equal(found.properties["red"], np.arange(8))
            for name in ("cube.obj", "cube.off", "cube.stl"):
                cube().save(os.path.join(folder, name))
                self.assertAlmostEqual(csrbf.read_mesh(os.path.join(folder, name)).volume, 1)
        copy = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(copy.normals, mesh.normals)

    def test_say_in_which_space_they_are(self):
        mesh = csrbf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.ply")
            for space, told in (("unknown", False), ("RAS", True), ("LPS", True)):
                mesh.space = space
                mesh.save(path)
                with open(path, "rb") as file:
                    self.assertEqual(f"SPACE={space}".encode() in file.read(), told, space)
                self.assertEqual(csrbf.read_mesh(path).space, space)
            mesh.space = "ras"
            with self.assertRaisesRegex(ValueError, 'space: "ras" is neither'):
                mesh.save(path)

    def test_stl_far_from_the_origin_warns(self):
        far = csrbf.Mesh(cube().vertices + [500000.3, 5300000.1, 300], cube().faces)
        with tempfile.TemporaryDirectory() as folder:
            far.save(os.path.join(folder, "cube.ply"))
            found = csrbf.read_mesh(os.path.join(folder, "cube.ply"))
            np.testing.assert_array_equal(found.vertices, far.vertices)
            with self.assertWarnsRegex(UserWarning, "cube.stl: .stl holds single precision"):
                far.save(os.path.join(folder, "cube.stl"))

    def test_polygonized_surfaces_have_outward_normals(self):
        x = sphere(2000)
        mesh = csrbf.reconstruct(x).polygonize(30)
        np.testing.assert_allclose((mesh.normals * mesh.vertices).sum(axis=1), 1, atol=0.01)

    def test_trimmed_meshes_end_where_the_data_do(self):
        x = sphere(4000)
        x = x[x[:, 2] > 0]
        s = csrbf.reconstruct(x, x)
        self.assertTrue(s.polygonize(40).topology["watertight"])
        cup = s.polygonize(40, trim=3)
        self.assertGreater(cup.topology["boundary_edges"], 20)
        self.assertGreater(cup.vertices[:, 2].min(), -0.4)
        copy = pickle.loads(pickle.dumps(s))
        np.testing.assert_array_equal(copy.polygonize(40, trim=3).vertices, cup.vertices)
        with self.assertRaisesRegex(ValueError, "trim"):
            (~s).polygonize(40, trim=3)


class Lines(unittest.TestCase):
    def test_of_ridges_run_along_the_rim_of_a_lens(self):
        x = sphere(3000)
        lens = csrbf.reconstruct(x * [1, 1, 0.3])
        mesh = lens.polygonize(50)
        lines = lens.ridges(mesh)
        ridge = lines.properties["kind"] == 1
        self.assertGreater(ridge.sum(), 50)
        np.testing.assert_allclose(np.linalg.norm(lines.vertices[ridge], axis=1), 1, atol=0.05)
        np.testing.assert_allclose(lines.vertices[ridge, 2], 0, atol=0.1)
        # The ellipse of half axes 1 and 0.3 has curvature 1 / 0.3^2 at its end.
        self.assertAlmostEqual(np.median(lines.properties["curvature"][ridge]), 1 / 0.09, delta=1.5)
        self.assertEqual(len(lens.ridges(mesh, least_turning=100).edges), 0)
        with tempfile.TemporaryDirectory() as folder:
            lines.save(os.path.join(folder, "lines.ply"))
            self.assertEqual(len(csrbf.read_points(os.path.join(folder, "lines.ply"))), len(lines.vertices))
            with self.assertRaises(csrbf.IoError):
                lines.save(os.path.join(folder, "lines.stl"))
        copy = pickle.loads(pickle.dumps(lines))
        np.testing.assert_array_equal(copy.edges, lines.edges)


class Pictures(unittest.TestCase):
    def test_show_the_surface_on_its_background(self):
        ball = csrbf.reconstruct(sphere(2000))
        for thing in (ball, ball.polygonize(40)):
            picture = thing.render(size=(90, 60), background=(0, 0, 0), ground=False)
            self.assertEqual((picture.shape, picture.dtype), ((60, 90, 3), np.uint8))
            lit = picture.max(axis=2) > 0
            self.assertTrue(lit[30, 45])
            self.assertFalse(lit[0, 0] or lit[59, 89])
            # A disc that leaves the margin of 6 % of the shorter side free.
            self.assertAlmostEqual(lit.sum(), np.pi * (30 * 0.88) ** 2, delta=0.1 * 2190)

    def test_are_written_and_coloured(self):
        ball = csrbf.reconstruct(sphere(600))
        mesh = ball.polygonize(30)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "ball.png")
            picture = ball.render(path, size=(20, 15), color="normal")
            np.testing.assert_array_equal(csrbf.read_image(path), picture)
            reference = os.path.join(folder, "ball.ply")
            mesh.save(reference)
            expected = ball.render(size=(20, 15), color="error", reference=csrbf.read_mesh(reference))
            np.testing.assert_array_equal(ball.render(size=(20, 15), color=f"error:{reference}"), expected)
            with self.assertRaises(csrbf.IoError):
                ball.render(os.path.join(folder, "ball.magic"), size=(20, 15))
        self.assertFalse((picture == expected).all())
        views = [mesh.render(size=(20, 15), view=view, color="normal") for view in ((0, 0), (90, 0))]
        self.assertFalse((views[0] == views[1]).all())

    def test_wrong_options_are_named(self):
        mesh = cube()
        for message, options in (
            ("color", {"color": "pink"}),
            ("up", {"up": "w"}),
            ("size", {"size": 80}),
            ("width", {"size": (0, 60)}),
            ("view", {"view": (1, 2, 3)}),
            ("reference", {"color": "error"}),
            ("mean_curvature", {"color": "mean-curvature"}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                mesh.render(**{"size": (40, 30), **options})


class Comparison(unittest.TestCase):
    def test_of_meshes_points_and_files(self):
        small, large = cube(1.0), cube(1.1)
        same = csrbf.compare(small, cube(1.0))
        self.assertAlmostEqual(same["chamfer_mean"], 0, delta=1e-12)
        found = csrbf.compare(small, large, samples=20000)
        self.assertGreater(found["chamfer_mean"], 0.01)
        self.assertLessEqual(found["hausdorff99"], 0.1)  # sqrt(3) 0.1 of a diagonal of sqrt(3) 1.1
        self.assertEqual((found["watertight"], found["manifold"], found["components"]), (True, True, 1))
        points = np.array([[0.5, 0.5, 1.5], [0.5, 0.5, 1.0], [0, 0, 0]])
        to_points = csrbf.compare(small, points)
        self.assertAlmostEqual(to_points["distance"]["max"] * to_points["diagonal"], 0.5)
        self.assertEqual(csrbf.compare(points, small)["chamfer_mean"], to_points["chamfer_mean"])
        with tempfile.TemporaryDirectory() as folder:
            mesh, cloud = os.path.join(folder, "a.ply"), os.path.join(folder, "b.npy")
            small.save(mesh)
            csrbf.PointCloud(points).save(cloud)
            self.assertEqual(csrbf.compare(mesh, cloud)["chamfer_mean"], to_points["chamfer_mean"])
            self.assertEqual(csrbf.compare(small, cloud)["chamfer_mean"], to_points["chamfer_mean"])
        with self.assertRaises(ValueError):
            csrbf.compare(csrbf.Mesh(points, np.empty((0, 3), int)), points)


class Bridges(unittest.TestCase):
    """With stand-ins that keep what they are given, and with the packages themselves where they are installed."""

    def test_packages_that_are_missing_are_named(self):
        for name in ("trimesh", "pyvista", "open3d"):
            with mock.patch.dict(sys.modules, {name: None}):
                with self.assertRaisesRegex(ImportError, f"Mesh.to_{name} needs the package {name}"):
                    getattr(cube(), f"to_{name}")()

    def test_trimesh_gets_vertices_faces_and_normals(self):
        module = types.ModuleType("trimesh")
        module.Trimesh = lambda vertices, faces, **options: (vertices, faces, options)
        mesh = cube()
        mesh.normals = mesh.vertices.copy()
        with mock.patch.dict(sys.modules, {"trimesh": module}):
            vertices, faces, options = mesh.to_trimesh()
        np.testing.assert_array_equal(vertices, mesh.vertices)
        np.testing.assert_array_equal(faces, mesh.faces)
        np.testing.assert_array_equal(options["vertex_normals"], mesh.normals)
        self.assertFalse(options["process"])  # which would merge and reorder vertices

    def test_pyvista_gets_faces_with_their_sizes(self):
        module = types.ModuleType("pyvista")
        module.PolyData = lambda vertices, faces: types.SimpleNamespace(points=vertices, faces=faces, point_data={})
        mesh = cube()
        mesh.properties["k1"] = np.arange(8.0)
        with mock.patch.dict(sys.modules, {"pyvista": module}):
            found = mesh.to_pyvista()
        self.assertEqual(found.faces[:4].tolist(), [3] + mesh.faces[0].tolist())
        self.assertEqual(found.faces.size, 4 * len(mesh.faces))
        np.testing.assert_array_equal(found.point_data["k1"], np.arange(8.0))

    def test_the_packages_themselves(self):
        ball = csrbf.reconstruct(sphere(2000)).polygonize(20)
        tried = 0
        for name, count in (("trimesh", "vertices"), ("pyvista", "points"), ("open3d", "vertices")):
            try:
                found = getattr(ball, f"to_{name}")()
            except ImportError:
                continue
            tried += 1
            self.assertEqual(len(getattr(found, count)), len(ball.vertices), name)
        if tried == 0:
            self.skipTest("neither trimesh nor pyvista nor open3d is installed")


if __name__ == "__main__":
    unittest.main()
