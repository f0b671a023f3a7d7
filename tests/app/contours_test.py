"""Runs the real program on contours.

usage: contours_test.py PROGRAM [unittest options]
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import threading
import unittest

PROGRAM = ""


def ball(slices=6, points=24):
    """Contours of a unit sphere as text."""
    rows = ["x,y,z,contour"]
    for k in range(slices):
        z = -1 + 2 * (k + 0.5) / slices
        r = math.sqrt(1 - z * z)
        for i in range(points):
            angle = 2 * math.pi * i / points
            rows.append("%.6f,%.6f,%.6f,%d" % (r * math.cos(angle), r * math.sin(angle), z, k))
    return "\n".join(rows) + "\n"


class Contours(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, text):
        with open(os.path.join(self.folder.name, name), "w") as file:
            file.write(text)

    def run_program(self, *arguments, status=0, stdin=None):
        done = subprocess.run(
            [PROGRAM, *arguments], cwd=self.folder.name, capture_output=True, text=True, input=stdin, check=False
        )
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def report(self, *arguments, stdin=None):
        self.run_program(*arguments, "--report", "report.json", stdin=stdin)
        with open(os.path.join(self.folder.name, "report.json")) as file:
            return json.load(file)

    def test_a_table_with_a_column_contour_becomes_a_closed_surface(self):
        self.write("ball.csv", ball())
        report = self.report("reconstruct", "ball.csv", "-o", "ball.ply", "--resolution", "40", "--model", "ball.csrbf")
        result = report["result"]
        self.assertEqual(report["options"]["method"], "contours")
        self.assertEqual((result["contours"], result["slices"], result["points"]), (6, 6, 144))
        self.assertTrue(result["watertight"])
        self.assertEqual((result["components"], result["euler"]), (1, 2))
        self.assertLess(result["max_distance"], 1e-4)
        model = self.report("polygonize", "ball.csrbf", "-o", "again.ply", "--resolution", "40")
        self.assertEqual(model["result"]["vertices"], result["vertices"])

    def test_contours_come_from_standard_input_when_asked_for(self):
        report = self.report(
            "reconstruct", "-", "-o", "ball.ply", "--method", "contours", "--centers", "100", stdin=ball(5, 16)
        )
        self.assertEqual(report["result"]["contours"], 5)
        self.assertEqual(report["options"]["centers"], 100)

    def test_a_pipe_is_read_once(self):
        pipe = os.path.join(self.folder.name, "pipe.csv")
        os.mkfifo(pipe)
        for points in (ball(), ball().replace(",contour", ",number")):
            writer = threading.Thread(target=self.write, args=("pipe.csv", points), daemon=True)
            writer.start()
            done = subprocess.run(
                [PROGRAM, "reconstruct", pipe, "-o", "ball.ply", "--resolution", "16"],
                cwd=self.folder.name,
                capture_output=True,
                text=True,
                timeout=60,
            )
            writer.join(60)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_another_method_takes_the_points_alone(self):
        self.write("ball.csv", ball(12, 24))
        report = self.report("reconstruct", "ball.csv", "-o", "ball.ply", "--method", "hoppe", "--resolution", "16")
        self.assertEqual(report["result"]["method"], "hoppe")

    def test_what_does_not_fit_is_refused(self):
        self.write("ball.csv", ball())
        self.write("points.csv", "x,y,z\n1,2,3\n")
        for flags, message in [
            (["ball.csv", "--normals", "estimate"], "--normals is for points, not for contours"),
            (["ball.csv", "--tolerance", "0.1"], "--tolerance is for points"),
            (["ball.csv", "--trim", "3"], "--trim is for points"),
            (["points.csv", "--method", "contours"], 'no column is named "contour"'),
        ]:
            done = self.run_program("reconstruct", *flags, "-o", "out.ply", status=2)
            self.assertIn(message, done.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.folder.name, "out.ply")))


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
