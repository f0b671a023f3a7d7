"""estimate_normals, farthest_points, read_points and PointCloud."""

import inspect
import os
import pickle
import tempfile
import unittest

import numpy as np

import csrbf


def sphere(n, seed=0):
    x = np.random.default_rng(seed).normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


class Normals(unittest.TestCase):
    def test_of_a_sphere_point_outwards(self):
        x = sphere(3000)
        n = csrbf.estimate_normals(x)
        self.assertEqual((n.shape, n.dtype), ((3000, 3), np.float64))
        np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, atol=1e-12)
        self.assertGreater((n * x).sum(axis=1).min(), 0.99)

    def test_point_to_the_viewpoint(self):
        x = sphere(2000)
        scanner = np.array([0.0, 0.0, 9.0])
        n = csrbf.estimate_normals(x, neighbors=20, orient="viewpoint", viewpoint=scanner)
        self.assertTrue((((scanner - x) * n).sum(axis=1) >= 0).all())
        aside = csrbf.estimate_normals(x, orient="none")
        np.testing.assert_allclose(np.abs((aside * x).sum(axis=1)), 1, atol=0.01)

    def test_wrong_arguments_are_value_errors(self):
        x = sphere(100)
        for message, arguments in (
            ("orient", {"orient": "up"}),
            ("viewpoint", {"orient": "viewpoint"}),
            ("viewpoint", {"viewpoint": [0, 0, 1]}),
            ("3 columns", {"points": x[:, :2]}),
            ("neighbors", {"neighbors": 2}),
            ("finite", {"points": x * np.nan}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                csrbf.estimate_normals(**{"points": x, **arguments})


class Farthest(unittest.TestCase):
    def test_each_is_farthest_from_those_before(self):
        for d in range(1, 7):
            x = np.random.default_rng(d).random((300, d))
            picks = csrbf.farthest_points(x, 20)
            self.assertEqual((picks.shape, picks.dtype), ((20,), np.int64))
            nearest = np.full(300, np.inf)
            for before, pick in zip(picks, picks[1:]):
                nearest = np.minimum(nearest, np.linalg.norm(x - x[before], axis=1))
                self.assertEqual(nearest[pick], nearest.max())

    def test_starts_where_told_and_ends_with_the_different_points(self):
        x = np.array([[0.0], [1.0], [1.0], [4.0]])
        self.assertEqual(csrbf.farthest_points(x, 10, first=1).tolist(), [1, 3, 0])
        self.assertEqual(csrbf.farthest_points(x, 0).tolist(), [])

    def test_wrong_arguments_are_value_errors(self):
        for message, arguments in (
            ("count", (np.zeros((4, 2)), -1)),
            ("1 to 6", (np.zeros((4, 7)), 2)),
            ("finite", (np.full((4, 2), np.nan), 2)),
            ("one point per row", (np.zeros(4), 2)),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                csrbf.farthest_points(*arguments)
        with self.assertRaisesRegex(ValueError, "first"):
            csrbf.farthest_points(np.zeros((4, 2)), 2, first=4)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_points_normals_and_colours_come_back(self):
        x = sphere(50).astype(np.float32).astype(float)
        colours = {name: np.arange(50, dtype=np.uint8) for name in ("red", "green", "blue")}
        csrbf.PointCloud(x, x, {**colours, "quality": np.linspace(0, 1, 50, dtype=np.float32)}).save(self.path("x.ply"))
        cloud = csrbf.read_points(self.path("x.ply"))
        np.testing.assert_array_equal(cloud.points, x)
        np.testing.assert_array_equal(cloud.normals, x)
        self.assertEqual(cloud.properties["red"].dtype, np.uint8)
        self.assertEqual(cloud.properties["quality"].dtype, np.float32)
        np.testing.assert_array_equal(cloud.properties["blue"], colours["blue"])

    def test_properties_without_a_place_are_a_warning(self):
        cloud = csrbf.PointCloud(sphere(5), properties={"quality": np.zeros(5, dtype=np.float32)})
        with self.assertWarnsRegex(UserWarning, "has no place for quality"):
            cloud.save(self.path("x.xyz"))

    def test_every_format_holds_points(self):
        x = sphere(40)
        for name in ("x.ply", "x.xyz", "x.pts", "x.txt", "x.csv", "x.obj", "x.off", "x.npy"):
            csrbf.PointCloud(x).save(self.path(name))
            cloud = csrbf.read_points(self.path(name))
            np.testing.assert_allclose(cloud, x, atol=1e-6)
            self.assertIsNone(cloud.normals, name)

    def test_clouds_are_arrays_to_numpy(self):
        cloud = csrbf.PointCloud(sphere(30), sphere(30))
        self.assertEqual((cloud.shape, len(cloud), cloud.ndim, cloud.dtype), ((30, 3), 30, 2, np.float64))
        self.assertIs(np.asarray(cloud), cloud.points)
        np.testing.assert_array_equal(2 * cloud + 1, 2 * cloud.points + 1)
        np.testing.assert_array_equal(cloud[:, 0] > 0, cloud.points[:, 0] > 0)
        self.assertIsInstance(cloud - cloud, np.ndarray)
        np.testing.assert_array_equal(np.linalg.norm(cloud, axis=1), np.linalg.norm(cloud.points, axis=1))
        before = cloud.points.copy()
        cloud += 1
        np.testing.assert_array_equal(cloud.points, before + 1)
        self.assertIsInstance(cloud, csrbf.PointCloud)

    def test_surfaces_take_clouds_and_file_names(self):
        x = sphere(1500)
        csrbf.PointCloud(x, x).save(self.path("x.npy"))
        cloud = csrbf.read_points(self.path("x.npy"))
        for given in (cloud, self.path("x.npy")):
            self.assertEqual(csrbf.reconstruct(given).report["normals"], "file")
        copy = pickle.loads(pickle.dumps(cloud))
        np.testing.assert_array_equal(copy.normals, x)

    def test_files_that_do_not_fit_are_errors(self):
        with self.assertRaisesRegex(csrbf.IoError, "nowhere.ply"):
            csrbf.read_points(self.path("nowhere.ply"))
        with open(self.path("bad.xyz"), "w") as file:
            file.write("1 2 3\n4 5\n")
        with self.assertRaisesRegex(csrbf.IoError, "bad.xyz:2"):
            csrbf.read_points(self.path("bad.xyz"))
        with self.assertRaisesRegex(ValueError, "one for each"):
            csrbf.PointCloud(sphere(5), sphere(4)).save(self.path("x.ply"))
        with self.assertRaisesRegex(ValueError, "size of the property"):
            csrbf.PointCloud(sphere(5), properties={"a": np.zeros(4)}).save(self.path("x.ply"))
        self.assertEqual(os.listdir(self.folder), ["bad.xyz"])


class Contract(unittest.TestCase):
    def test_arguments_have_their_names_and_defaults(self):
        expected = {
            csrbf.fit: "points, values=None, method='auto', tolerance=None, centers=None, smoothing='auto'",
            csrbf.RBFInterpolator: "y, d, neighbors=None, smoothing=0.0, kernel='thin_plate_spline', epsilon=None, "
            "degree=None",
            csrbf.reconstruct: "points, normals=None, method='auto', centers=None, tolerance=None",
            csrbf.segment: "image, voxel_size=None, init='auto', energy='auto', regions=2",
            csrbf.estimate_normals: "points",
            csrbf.farthest_points: "points, n",
            csrbf.read_points: "path",
            csrbf.read_image: "path",
            csrbf.load: "path",
            csrbf.Surface.polygonize: "self, resolution=None",
            csrbf.Surface.raycast: "self, origins, directions",
            csrbf.Surface.render: "self, path=None",
        }
        for function, arguments in expected.items():
            found = [
                str(p.replace(annotation=inspect.Parameter.empty))
                for p in inspect.signature(function).parameters.values()
            ]
            self.assertEqual(", ".join(found[: arguments.count(",") + 1]), arguments, function)

    def test_every_name_is_there(self):
        for owner, names in {
            csrbf: csrbf.__all__ + ["track", "SolverFailure", "IoError", "__version__"],
            csrbf.Function: ["__call__", "gradient", "hessian", "save"],
            csrbf.Surface: ["__call__", "normal", "curvature", "contains", "raycast", "render", "polygonize", "save",
                            "__or__", "__and__", "__sub__"],
            csrbf.Mesh: ["to_trimesh", "to_pyvista", "to_open3d", "save"],
            csrbf.Segmentation: ["contour", "energy"],
        }.items():
            for name in names:
                self.assertTrue(hasattr(owner, name), name)
        self.assertTrue(issubclass(csrbf.IoError, OSError))


if __name__ == "__main__":
    unittest.main()
