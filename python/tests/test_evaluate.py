"""evaluate: tables of values and derivatives at points, on grids and at the voxels of images."""

import os
import tempfile
import unittest

import numpy as np

import csrbf


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        x = np.random.default_rng(1).random((400, 2))
        cls.f = csrbf.fit(x, np.column_stack([x[:, 0] * x[:, 1], x[:, 0] ** 2]), kernel="quintic")
        cls.x = 0.2 + 0.6 * np.random.default_rng(2).random((30, 2))

    def test_columns_are_values_gradients_and_upper_triangles(self):
        f, x = self.f, self.x
        table = csrbf.evaluate(f, x, gradient=True, hessian=True)
        self.assertEqual(table.shape, (30, 2 + 4 + 6))
        np.testing.assert_array_equal(table[:, :2], f(x))
        np.testing.assert_array_equal(table[:, 2:6], f.gradient(x).reshape(30, 4))
        h = f.hessian(x)
        upper = np.stack([h[:, k, i, j] for k in (0, 1) for i, j in ((0, 0), (0, 1), (1, 1))], axis=1)
        np.testing.assert_array_equal(table[:, 6:], upper)

    def test_grids_are_indexed_as_images(self):
        grid = csrbf.evaluate(self.f, grid=(5, 4), bounds=[[0.1, 0.5], [0.2, 0.8]])
        self.assertEqual(grid.shape, (4, 5, 2))
        np.testing.assert_allclose(grid[1, 3], self.f([0.4, 0.4]), atol=1e-12)
        self.assertEqual(csrbf.evaluate(self.f, grid=3).shape, (3, 3, 2))
        image = csrbf.Image(np.zeros((4, 5)), (0.1, 0.2), (0.1, 0.2))
        np.testing.assert_allclose(csrbf.evaluate(self.f, like=image), grid, atol=1e-12)

    def test_models_of_files_and_surfaces(self):
        x = np.random.default_rng(0).normal(size=(2000, 3))
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        s = csrbf.reconstruct(x)
        self.assertEqual(csrbf.evaluate(s, x, gradient=True).shape, (2000, 4))
        self.assertEqual(csrbf.evaluate(s, grid=4, labels=True).dtype, np.uint8)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "f.csrbf")
            self.f.save(path)
            np.testing.assert_array_equal(csrbf.evaluate(path, self.x), self.f(self.x))
        with self.assertRaisesRegex(ValueError, "hessian"):
            csrbf.evaluate(s, x, hessian=True)

    def test_labels_are_those_of_the_largest_component(self):
        labels = csrbf.evaluate(self.f, self.x, labels=True)
        np.testing.assert_array_equal(labels, self.f(self.x).argmax(axis=1))
        y, x = np.mgrid[:48, :64]
        image = np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0)
        g = csrbf.segment(image)
        np.testing.assert_array_equal(csrbf.evaluate(g.field, like=image, labels=True), g.labels)

    def test_wrong_arguments_are_value_errors(self):
        for message, arguments in (
            ("one of points", {}),
            ("one of points", {"points": self.x, "grid": 3}),
            ("needs grid", {"points": self.x, "bounds": [[0, 1], [0, 1]]}),
            ("labels", {"points": self.x, "labels": True, "gradient": True}),
            ("grid", {"grid": (2, 3, 4)}),
            ("grid", {"grid": 0}),
            ("grid", {"grid": 2.5}),
            ("bounds", {"grid": 2, "bounds": [[1, 0], [0, 1]]}),
            ("last axis", {"points": np.zeros((3, 5))}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                csrbf.evaluate(self.f, **arguments)


class LevelLines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.x = np.random.default_rng(3).random((400, 2))
        cls.f = csrbf.fit(cls.x, cls.x[:, 0] ** 2 + cls.x[:, 1])

    def test_they_lie_on_their_levels(self):
        lines = self.f.level_lines([0.5, 1.0])
        self.assertEqual([level for level, _ in lines], [0.5, 1.0])
        for level, line in lines:
            np.testing.assert_allclose(self.f(line), level, atol=1e-8)
        self.assertGreater(len({level for level, _ in self.f.level_lines()}), 3)
        self.assertEqual([level for level, _ in self.f.level_lines(step=0.75)], [0.75, 1.5])

    def test_a_mask_ends_them_and_closed_ones_come_back(self):
        (kept,) = self.f.level_lines([0.5], mask="distance:0.05")[:1]
        self.assertTrue(np.all(self.f.covered(kept[1], "distance:0.05")))
        bowl = csrbf.fit(self.x, ((self.x - 0.5) ** 2).sum(axis=1))
        ((_, circle),) = bowl.level_lines([0.04])
        np.testing.assert_array_equal(circle[0], circle[-1])

    def test_other_functions_are_refused(self):
        with self.assertRaisesRegex(ValueError, "must be one over two"):
            csrbf.fit(self.x, self.x).level_lines()
        with self.assertRaisesRegex(ValueError, "ascending"):
            self.f.level_lines([1.0, 0.5])


if __name__ == "__main__":
    unittest.main()
