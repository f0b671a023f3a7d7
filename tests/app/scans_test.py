"""Runs the real program on scans and meshes as other programs write them: nothing is lost or taken amiss silently.

usage: scans_test.py PROGRAM [unittest options]
"""

import os
import sys
import unittest

import command_line_test as base
from command_line_test import OCTAHEDRON, ply, sphere


class Outputs(base.CommandLine):
    def test_a_mesh_does_not_replace_the_scan_that_it_is_made_from(self):
        scan = self.write("scan.ply", ply(sphere(300)))
        for output in (scan, "scan.ply", "./scan.ply"):
            self.fail_with(2, "is the input, or another output, which would be lost", "reconstruct", scan, "-o", output)
        with open(scan) as file:
            self.assertEqual(file.read(), ply(sphere(300)))

    def test_no_other_command_replaces_what_it_reads(self):
        table = self.write("s.csv", "x,y,z\n" + "".join(f"{i % 7},{i // 7},{i}\n" for i in range(49)))
        model = self.path("f.csrbf")
        self.succeed("fit", table, "-o", model)
        lost = "is the input, or another output, which would be lost"
        self.fail_with(2, table + ": " + lost, "evaluate", model, "--points", table, "-o", table)
        self.fail_with(2, model + ": " + lost, "combine", "union", model, model, "-o", model)
        image = self.write("image.pgm", "P2 4 4 255\n" + "0 0 200 200\n" * 4)
        for arguments in (("-o", image), ("-o", self.path("l.png"), "--preview", self.path("l.png"))):
            self.fail_with(2, lost, "segment", image, *arguments)
        hole = self.write("hole.pgm", "P2 4 4 1\n" + "0 0 0 1\n" * 4)
        self.fail_with(2, hole + ": " + lost, "inpaint", image, "-o", hole, "--mask", hole)
        with open(hole) as file:
            self.assertTrue(file.read().startswith("P2"))

    def test_normals_may_replace_the_cloud_that_they_are_of(self):
        scan = self.write("scan.ply", ply(sphere(300)))
        self.succeed("estimate-normals", scan, "-o", scan)

    def test_a_mesh_that_is_trimmed_to_nothing_is_no_result(self):
        scan = self.write("scan.ply", ply(sphere(300)))
        self.fail_with(1, "raise --trim", "reconstruct", scan, "-o", self.path("a.ply"), "--trim", "0.01", "-q")

    def test_what_the_file_of_normals_has_no_place_for_is_told(self):
        mesh = self.write("mesh.off", OCTAHEDRON)
        run = self.succeed("estimate-normals", mesh, "-o", self.path("a.ply"))
        self.assertIn("holds points only: 8 triangles left out", run.stderr)
        scan = self.write("scan.ply", ply(sphere(300), colored=True))
        run = self.succeed("estimate-normals", scan, "-o", self.path("a.xyz"))
        self.assertIn("has no place for red, green, blue", run.stderr)
        for name in ("a.ply", "a.obj", "a.off", "a.csv"):
            self.assertEqual(self.succeed("estimate-normals", scan, "-o", self.path(name)).stderr, "", name)


class Inputs(base.CommandLine):
    def test_a_column_that_numbers_the_points_is_no_x(self):
        rows = ["%d %.6f %.6f %.6f" % (i, *p) for i, p in enumerate(sphere(200))]
        scan = self.write("scan.xyz", "\n".join(rows) + "\n")
        run = self.succeed("estimate-normals", scan, "-o", self.path("a.ply"))
        self.assertIn("x numbers the points from 0 on", run.stderr)
        scan = self.write("named.csv", "id,x,y,z\n" + "\n".join(rows).replace(" ", ",") + "\n")
        self.assertEqual(self.succeed("estimate-normals", scan, "-o", self.path("a.ply")).stderr, "")

    def test_names_of_columns_that_are_not_known_are_listed(self):
        scan = self.write("scan.csv", "a,b,depth\n1,2,3\n")
        self.fail_with(2, 'the columns are "a", "b", "depth": rename those of the coordinates to x, y and z',
                       "reconstruct", scan, "-o", self.path("a.ply"))

    def test_a_mesh_is_told_from_a_model(self):
        mesh = self.write("mesh.off", OCTAHEDRON)
        for command in ("polygonize", "curvature"):
            self.fail_with(2, "a mesh or points, not a csrbf model: csrbf reconstruct", command, mesh, "-o", self.path("a.ply"))

    def test_points_without_a_place_are_left_out_of_a_comparison(self):
        mesh = self.write("mesh.off", OCTAHEDRON)
        scan = self.write("scan.xyz", "1 0 0\nnan nan nan\n0 1 0\n0 0 -1\n")
        run = self.succeed("compare", mesh, scan, "--report", self.path("report.json"))
        self.assertIn("1 points with NaN", run.stderr)
        self.assertLess(self.report()["result"]["chamfer_mean"], 1e-12)


class Options(base.CommandLine):
    def test_flags_that_a_method_does_not_take_are_told(self):
        scan = self.write("scan.ply", ply(sphere(300)))
        flags = ["--centers", "50", "--smoothing", "0.1", "--resolution", "20"]
        run = self.succeed("reconstruct", scan, "-o", self.path("a.ply"), "--method", "hoppe", *flags)
        self.assertIn("the method hoppe has no budget of centers", run.stderr)
        self.assertIn("the method hoppe has no smoothing", run.stderr)
        run = self.succeed("reconstruct", scan, "-o", self.path("a.ply"), "--method", "medial-axis", *flags)
        self.assertNotIn("ignored", run.stderr)

    def test_a_line_with_rounded_coordinates_is_no_surface(self):
        line = self.write("line.xyz", "".join("%.6f %.6f %.6f\n" % (t / 499, 2 * t / 499, 3 * t / 499) for t in range(500)))
        self.fail_with(2, "all lie on one line", "reconstruct", line, "-o", self.path("a.ply"))


if __name__ == "__main__":
    base.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
