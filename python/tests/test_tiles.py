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
        report = csrbf.fit_tiles(self.path("samples.npy"), self.path("wave.csrbf"), memory=158e6)
        self.assertGreater(report["tiles"], 1)
        self.assertEqual(report["tile_points"], -(-40000 // report["tiles"]))
        with self.assertRaisesRegex(ValueError, "is too little; give at least"):
            csrbf.fit_tiles(self.path("samples.npy"), self.path("wave.csrbf"), memory=100e6)

    def test_normals_and_edges_are_those_asked_for(self):
        cloud = csrbf.PointCloud(torus(6000))
        cloud = csrbf.estimate_normals(cloud)
        cloud.save(self.path("cloud.ply"))
        reports = {}
        for normals in ("file", "estimate"):
            reports[normals] = csrbf.reconstruct_tiles(
                self.path("cloud.ply"), self.path("mesh.ply"), 3000, normals=normals, resolution=30, sharp=False)
        self.assertEqual(reports["file"]["normals"], "file")
        self.assertEqual(reports["estimate"]["normals"], "estimated")
        cut = os.path.getsize(self.path("mesh.ply"))
        csrbf.reconstruct_tiles(self.path("cloud.ply"), self.path("mesh.ply"), 3000, resolution=30, sharp=True)
        self.assertNotEqual(os.path.getsize(self.path("mesh.ply")), cut)


if __name__ == "__main__":
    unittest.main()
