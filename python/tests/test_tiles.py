"""Work in tiles from file to file: memory says how large they are, options mean what they mean without tiles."""

import filecmp
import os
import tempfile
import unittest

import numpy as np

import csrbf


def torus(n, noise=0.0):
    random = np.random.default_rng(0)
    u, v = 2 * np.pi * random.random((2, n))
    ring = 1 + 0.4 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], axis=1)
    return points + noise * random.normal(size=points.shape)


class Tiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = lambda name: os.path.join(folder.name, name)

    def test_memory_says_how_large_tiles_of_points_are(self):
        np.save(self.path("points.npy"), torus(15000))
        report = csrbf.reconstruct_tiles(self.path("points.npy"), self.path("a.ply"), memory=80e6, resolution=40)
        self.assertTrue(10000 <= report["tile_points"] < 15000, report["tile_points"])
        self.assertEqual((report["tiles"], report["watertight"], report["euler"]), (2, True, 0))
        same = csrbf.reconstruct_tiles(self.path("points.npy"), self.path("b.ply"), report["tile_points"], resolution=40)
        self.assertEqual(same["tile_points"], report["tile_points"])
        self.assertTrue(filecmp.cmp(self.path("a.ply"), self.path("b.ply"), shallow=False))
        with self.assertRaisesRegex(ValueError, "memory = 70 MB: is too little; give at least 79 MB"):
            csrbf.reconstruct_tiles(self.path("points.npy"), self.path("a.ply"), memory=70e6)

    def test_memory_says_how_large_tiles_of_samples_are(self):
        x = np.random.default_rng(0).random((40000, 2))
        np.save(self.path("samples.npy"), np.column_stack([x, np.sin(3 * x[:, 0]) * x[:, 1]]))
        report = csrbf.fit_tiles(self.path("samples.npy"), self.path("wave.csrbf"), memory=180e6)
        self.assertGreater(report["tiles"], 1)
        self.assertEqual(report["tile_points"], -(-40000 // report["tiles"]))
        with self.assertRaisesRegex(ValueError, "is too little; give at least"):
            csrbf.fit_tiles(self.path("samples.npy"), self.path("wave.csrbf"), memory=100e6)

    def test_normals_and_edges_are_those_asked_for(self):
        points = torus(6000)
        csrbf.PointCloud(points, csrbf.estimate_normals(points)).save(self.path("cloud.ply"))
        reports = {}
        for normals in ("file", "estimate"):
            reports[normals] = csrbf.reconstruct_tiles(
                self.path("cloud.ply"), self.path("mesh.ply"), 3000, normals=normals, resolution=30, sharp=False)
        self.assertEqual(reports["file"]["normals"], "file")
        self.assertEqual(reports["estimate"]["normals"], "estimated")
        os.rename(self.path("mesh.ply"), self.path("cut.ply"))
        for sharp in (False, True):
            csrbf.reconstruct_tiles(
                self.path("cloud.ply"), self.path("mesh.ply"), 3000, normals="estimate", resolution=30, sharp=sharp)
            self.assertEqual(filecmp.cmp(self.path("mesh.ply"), self.path("cut.ply"), shallow=False), not sharp)

    def test_volumes_are_filled_by_blocks_of_slices(self):
        z, y, x = np.mgrid[:120, :40, :48]
        truth = 1000 + 500 * np.sin(x / 8 + z / 10) * np.cos(y / 9 - z / 14)
        truth += np.random.default_rng(2).normal(0, 20, truth.shape)
        mask = np.zeros(truth.shape, np.uint8)
        for k in range(11):
            mask[(x - 4 * k) ** 2 + (y - 20) ** 2 + (z - 5 - 11 * k) ** 2 < 16] = 1
        np.save(self.path("image.npy"), np.where(mask, 0, truth).astype(np.int16))
        np.save(self.path("mask.npy"), mask)
        report = csrbf.inpaint_slices(self.path("image.npy"), self.path("out.npy"), 45e6, self.path("mask.npy"))
        self.assertEqual(report["missing"], mask.sum())
        self.assertGreater(report["slice_blocks"], 1)
        found = np.load(self.path("out.npy"))
        self.assertEqual(found.dtype, np.int16)
        self.assertTrue((found == truth.astype(np.int16))[mask == 0].all())
        self.assertLess(np.sqrt(np.mean((found - truth)[mask > 0] ** 2)), 1.3 * 20)
        with self.assertRaisesRegex(ValueError, "is too little; give at least"):
            csrbf.inpaint_slices(self.path("image.npy"), self.path("out.npy"), 31e6, self.path("mask.npy"))

    def test_volumes_without_anything_missing_are_copied_with_a_warning(self):
        image = np.arange(4 * 5 * 6, dtype=np.int16).reshape(4, 5, 6)
        np.save(self.path("image.npy"), image)
        with self.assertWarnsRegex(UserWarning, "nothing is missing; give mask or missing"):
            report = csrbf.inpaint_slices(self.path("image.npy"), self.path("out.npy"))
        self.assertEqual((report["missing"], report["slice_blocks"]), (0, 0))
        self.assertTrue((np.load(self.path("out.npy")) == image).all())


if __name__ == "__main__":
    unittest.main()
