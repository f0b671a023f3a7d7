"""Runs track of the real program on generated sequences.

usage: track_test.py PROGRAM [unittest options]
"""

import csv
import math
import os
import random
import signal
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import CommandLine
from fit_test import npy_bytes, read_npy

WIDTH, HEIGHT, FRAMES = 48, 40, 5


def radius(t):
    return 11 + 2 * math.cos(2 * math.pi * t / FRAMES)


def frame(t, noise=0.5):
    """A bright disc on a dark ground."""
    draw = random.Random(t)
    return [(10.0 if math.hypot(x - 24, y - 20) < radius(t) else 1.0) + draw.gauss(0, noise)
            for y in range(HEIGHT) for x in range(WIDTH)]


class Track(CommandLine):
    def write_array(self, name, values, shape):
        with open(self.path(name), "wb") as file:
            file.write(npy_bytes(shape, values, "<f4"))
        return self.path(name)

    def frame_files(self):
        return [self.write_array("frame%d.npy" % t, frame(t), (HEIGHT, WIDTH)) for t in range(FRAMES)]

    def sequence(self):
        return self.write_array("cine.npy", [v for t in range(FRAMES) for v in frame(t)], (FRAMES, HEIGHT, WIDTH))

    def measures(self, folder="beat"):
        with open(os.path.join(self.path(folder), "measures.csv"), newline="") as file:
            return list(csv.DictReader(file))

    def check_results(self, extension=".npy"):
        names = sorted(os.listdir(self.path("beat")))
        self.assertEqual(names, ["labels_%04d%s" % (t, extension) for t in range(FRAMES)] + ["measures.csv", "models"])
        rows = self.measures()
        self.assertEqual([int(row["frame"]) for row in rows], list(range(FRAMES)))
        for t, row in enumerate(rows):
            self.assertEqual(row["region"], "1")
            # a third of a pixel: the disc has sharp edges, and its neighbours in time draw at it
            self.assertAlmostEqual(math.sqrt(float(row["volume"]) / math.pi), radius(t), delta=0.3)
            self.assertAlmostEqual(float(row["area"]) / (2 * math.pi * radius(t)), 1, delta=0.05)
            self.assertAlmostEqual(float(row["mean"]), 10, delta=0.5)

    def test_files_that_are_frames(self):
        done = self.succeed("track", *self.frame_files(), "-o", self.path("beat"), "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        self.check_results()
        for t, row in enumerate(self.measures()):
            shape, kind, labels = read_npy(os.path.join(self.path("beat"), "labels_%04d.npy" % t))
            self.assertEqual((shape, kind, sum(labels)), ((HEIGHT, WIDTH), "|u1", int(row["voxels"])))
        report = self.report()
        self.assertEqual(report["result"]["frames"], FRAMES)
        self.assertEqual(len(report["result"]["measures"]), FRAMES)
        self.assertEqual(report["options"]["persistence"], 1)
        self.assertEqual(report["options"]["sweeps"], 2)
        for stage in ("read", "evolve", "write", "total"):
            self.assertIn(stage, report["time"])

    def test_an_array_whose_first_axis_is_time(self):
        self.succeed("track", self.sequence(), "-o", self.path("beat"), "--slices-are-frames")
        self.check_results()

    def test_a_time_axis_and_the_format_of_the_labels(self):
        values = [v for t in range(2) for z in range(8) for v in frame(t)]
        cine = self.write_array("cine.npy", values, (2, 8, HEIGHT, WIDTH))
        self.succeed("track", cine, "-o", self.path("beat"), "--format", "nii.gz", "--sweeps", "1", "--init",
                     "sphere:24,20,4,6")
        self.assertEqual(sorted(os.listdir(self.path("beat")))[:2], ["labels_0000.nii.gz", "labels_0001.nii.gz"])
        for row in self.measures():
            t = int(row["frame"])
            self.assertAlmostEqual(float(row["volume"]) / (8 * math.pi * radius(t) ** 2), 1, delta=0.05)

    def test_models_hold_the_level_sets(self):
        self.succeed("track", *self.frame_files(), "-o", self.path("beat"))
        model = os.path.join(self.path("beat"), "models", "frame_0000.csrbf")
        self.succeed("evaluate", model, "-o", self.path("values.npy"), "--grid", "3,1", "--bounds", "2:46,19.99:20.01")
        values = read_npy(self.path("values.npy"))[2]
        self.assertLess(values[0], 0)
        self.assertGreater(values[1], 0)
        self.assertLess(values[2], 0)

    def test_contours_are_finer_than_pixels(self):
        cine = self.sequence()
        self.succeed("track", cine, "-o", self.path("beat"), "--slices-are-frames", "--contour", "csv")
        for t in range(FRAMES):
            with open(os.path.join(self.path("beat"), "contours_%04d.csv" % t), newline="") as file:
                places = [(float(row["x"]), float(row["y"])) for row in csv.DictReader(file)]
            away = [math.hypot(x - 24, y - 20) for x, y in places]
            self.assertGreater(len(away), 50)
            self.assertLess(max(abs(r - radius(t)) for r in away), 0.7)
            self.assertAlmostEqual(sum(away) / len(away), radius(t), delta=0.3)
        self.succeed("track", cine, "-o", self.path("beat"), "--slices-are-frames", "--contour", ".svg")
        names = [name for name in sorted(os.listdir(self.path("beat"))) if name.startswith("contours")]
        self.assertEqual(names, ["contours_%04d.svg" % t for t in range(FRAMES)])
        self.fail_with(2, '--contour contours_0000.stl: unknown extension ".stl"; contours in the plane are .svg',
                       "track", cine, "-o", self.path("beat"), "--slices-are-frames", "--contour", "stl")
        for extension in ("beat.svg", "a/b.ply", "doc"):
            self.fail_with(2, "--contour " + extension, "track", cine, "-o", self.path("no"), "--slices-are-frames", "--contour", extension)
        volumes = self.write_array("ball.npy", [float(math.dist((x, y, z), (6, 6, 6)) < 3 + t)
                                                for t in range(2) for z in range(12) for y in range(12) for x in range(12)],
                                   (2, 12, 12, 12))
        self.succeed("track", volumes, "-o", self.path("beat"), "--contour", "ply")
        self.succeed("info", os.path.join(self.path("beat"), "contours_0001.ply"))
        self.assertFalse(os.path.exists(os.path.join(self.path("beat"), "contours_0002.svg")))
        head = b"NRRD0004\ntype: float\ndimension: 3\nsizes: 12 12 12\nspace dimension: 3\nspace origin: (5e5,5e6,0)\n"
        head += b"space directions: (0.01,0,0) (0,0.01,0) (0,0,0.01)\nencoding: raw\nendian: little\n\n"
        with open(self.path("ball.npy"), "rb") as file:
            balls = file.read()[-2 * 4 * 12 ** 3:]
        for t in range(2):
            with open(self.path("far%d.nrrd" % t), "wb") as file:
                file.write(head + balls[t * 4 * 12 ** 3:(t + 1) * 4 * 12 ** 3])
        told = self.succeed("track", self.path("far0.nrrd"), self.path("far1.nrrd"), "-o", self.path("far"), "--contour", "stl")
        self.assertEqual(told.stderr.count("contours_0000.stl: .stl holds single precision"), 1, told.stderr)
        self.assertNotIn(".csrbf-", told.stderr)

    def test_errors_name_the_frame_and_leave_nothing(self):
        files = self.frame_files()
        constant = self.write_array("constant.npy", [3.0] * (WIDTH * HEIGHT), (HEIGHT, WIDTH))
        small = self.write_array("small.npy", frame(0)[: WIDTH * 20], (20, WIDTH))
        out = ("-o", self.path("beat"))
        self.fail_with(2, "frame 3", "track", *files[:3], constant, *out)
        self.fail_with(2, "small.npy: has 48 x 20 voxels, %s 48 x 40" % files[0], "track", *files[:2], small, *out)
        values = frame(2)
        values[5] = math.nan
        nan = self.write_array("nan.npy", values, (HEIGHT, WIDTH))
        self.fail_with(2, "nan.npy: voxel 5, 0 is nan", "track", *files[:2], nan, *out)
        self.fail_with(2, "one frame", "track", files[0], *out)
        self.fail_with(2, "--format doc", "track", *files, *out, "--format", "doc")
        self.fail_with(2, "is a file", "track", *files, "-o", files[0])

    def test_interruption_gives_130_and_keeps_the_results_of_before(self):
        files = self.frame_files()
        self.succeed("track", *files, "-o", self.path("beat"))
        before = self.measures()
        process = subprocess.Popen([command_line_test.PROGRAM, "track", *(files * 200), "-o", self.path("beat"),
                                    "--progress", "always"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            if line.startswith("evolve"):
                break
        process.send_signal(signal.SIGINT)
        messages = process.communicate(timeout=120)[1]
        self.assertEqual(process.returncode, 130, messages)
        self.assertIn("interrupted", messages)
        self.assertEqual(self.measures(), before)
        self.check_results()

    def test_frames_of_a_longer_run_before_are_removed_and_nothing_else(self):
        files = self.frame_files()
        self.succeed("track", *files, "-o", self.path("beat"))
        others = ["labels_0003.txt", "labels_0003.csv", "contours_0003.nrrd", "labels_3.npy", "labels_0003_edited.npy", "notes.npy", "models/mine_0003.csrbf",
                  "models/frame_0003.ply"]
        for name in others:
            self.write(os.path.join("beat", name), "mine")
        self.succeed("track", *files[:2], "-o", self.path("beat"), "--format", "nii.gz")
        expected = ["labels_0000.nii.gz", "labels_0001.nii.gz", "measures.csv", "models", *others[:6]]
        self.assertEqual(sorted(os.listdir(self.path("beat"))), sorted(expected))
        self.assertEqual(sorted(os.listdir(os.path.join(self.path("beat"), "models"))),
                         ["frame_0000.csrbf", "frame_0001.csrbf", "frame_0003.ply", "mine_0003.csrbf"])

    def test_a_failure_keeps_the_results_of_before(self):
        files = self.frame_files()
        self.succeed("track", *files, "-o", self.path("beat"))
        before = self.measures()
        constant = self.write_array("constant.npy", [3.0] * (WIDTH * HEIGHT), (HEIGHT, WIDTH))
        self.fail_with(2, "frame 2", "track", *files[:2], constant, "-o", self.path("beat"), "--sweeps", "1")
        self.assertEqual(self.measures(), before)
        self.check_results()


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
