"""Runs segment of the real program on generated images.

usage: segment_test.py PROGRAM [unittest options]
"""

import gzip
import json
import math
import os
import random
import struct
import sys
import unittest

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import CommandLine, read_ply, read_png
from fit_test import npy_bytes, read_npy


def fibonacci(n, radius, center):
    """Points on a sphere."""
    return [tuple(c + radius * p for c, p in zip(center, point)) for point in command_line_test.sphere(n)]


class Segment(CommandLine):
    def write_bytes(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def disc(self, name="disc.npy", cx=30, cy=20, r=12, width=64, height=48, shape=None):
        """A bright disc on a dark ground."""
        values = [10.0 if (x - cx) ** 2 + (y - cy) ** 2 < r * r else 1.0 for y in range(height) for x in range(width)]
        return self.write_bytes(name, npy_bytes(shape or (height, width), values, "<f4"))

    def ball(self, name="ball.mha"):
        """A bright ball of radius 12 mm about (10, 20, 30) in voxels of 1.5 x 1.5 x 2 mm."""
        size, spacing, offset = (28, 26, 20), (1.5, 1.5, 2.0), (-10.0, 1.0, 11.0)
        values = []
        for z in range(size[2]):
            for y in range(size[1]):
                for x in range(size[0]):
                    p = [o + s * i for o, s, i in zip(offset, spacing, (x, y, z))]
                    values.append(100 if math.dist(p, (10, 20, 30)) < 12 else 20)
        head = "ObjectType = Image\nNDims = 3\nDimSize = %d %d %d\n" % size
        head += "ElementSpacing = %g %g %g\nOffset = %g %g %g\n" % (spacing + offset)
        head += "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
        return self.write_bytes(name, head.encode() + struct.pack("<%dh" % len(values), *values))

    def labels(self, *arguments):
        """Runs segment into an array and returns the labels and the report."""
        self.succeed("segment", *arguments, "-o", self.path("labels.npy"), "--report", self.path("report.json"))
        _, kind, labels = read_npy(self.path("labels.npy"))
        self.assertEqual(kind, "|u1")
        return labels, self.report()

    def dice(self, a, b):
        self.succeed("compare", a, b, "--report", self.path("compare.json"), "-q")
        return self.report("compare.json")["result"]["dice"]


class Plane(Segment):
    def test_objects_and_their_table(self):
        values = [10.0 if min(math.hypot(x - 20, y - 24), math.hypot(x - 40, y - 24)) < 11 else 1.0
                  for y in range(48) for x in range(64)]
        image = self.write_bytes("two.npy", npy_bytes((48, 64), values, "<f4"))
        labels, report = self.labels(image, "--objects", "--min-size", "20", "--table", self.path("table.csv"))
        self.assertEqual((labels[24 * 64 + 20], labels[24 * 64 + 40], labels[0]), (1, 2, 0))
        self.assertEqual(report["result"]["objects"], 2)
        with open(self.path("table.csv")) as file:
            head, first, second = file.read().split()
        self.assertEqual(head, "label,voxels,area,length,x,y,major_axis,minor_axis,mean,sphericity")
        row = dict(zip(head.split(","), map(float, second.split(","))))
        self.assertAlmostEqual(row["x"], 40, delta=0.5)
        self.assertAlmostEqual(row["area"], math.pi * 121, delta=15)
        self.assertAlmostEqual(row["mean"], 10, delta=0.5)

    def test_seeds_keep_their_labels(self):
        values = [(0.0, 5.0, 10.0)[x // 20] + 0.1 * (7 * x * y % 11) for y in range(40) for x in range(60)]
        image = self.write_bytes("bands.npy", npy_bytes((40, 60), values, "<f4"))
        with open(self.path("seeds.csv"), "w") as file:  # the order is not that of the means
            file.write("x,y,label\n10,20,3\n30,20,1\n50,20,2\n55,5,1\n")
        labels, report = self.labels(image, "--seeds", self.path("seeds.csv"))
        self.assertEqual([labels[20 * 60 + x] for x in (10, 30, 50)], [2, 0, 1])
        self.assertEqual(labels[5 * 60 + 55], 0)  # a seed against its intensity
        self.assertEqual(report["options"]["regions"], 3)
        with open(self.path("seeds.csv"), "w") as file:
            file.write("x,y,label\n10,20,1\n99,20,2\n")
        self.fail_with(2, "point 2 is outside the image", "segment", image, "-o", self.path("l.npy"), "--seeds",
                       self.path("seeds.csv"))
        self.write_bytes("one.npy", npy_bytes((40, 60), [1] + [0] * 2399, "|u1"))
        self.fail_with(2, "must mark every region", "segment", image, "-o", self.path("l.npy"), "--seeds",
                       self.path("one.npy"))

    def test_names_tell_the_columns_of_seeds(self):
        values = [(0.0, 5.0, 10.0)[x // 20] + 0.1 * (7 * x * y % 11) for y in range(60) for x in range(60)]
        image = self.write_bytes("bands.npy", npy_bytes((60, 60), values, "<f4"))
        for text in ("y,x,label\n5,10,3\n20,30,1\n20,50,2\n", "label,x,y\n3,10,5\n1,30,20\n2,50,20\n",
                     "10 5 3\n30 20 1\n50 20 2\n", "X,Y,Confidence,Label\n10,5,1,3\n30,20,1,1\n50,20,1,2\n"):
            with open(self.path("seeds.csv"), "w") as file:
                file.write(text)
            labels, _ = self.labels(image, "--seeds", self.path("seeds.csv"))
            self.assertEqual([labels[20 * 60 + x] for x in (10, 30, 50)], [2, 0, 1], text)
        for text, message in (("x,y,label\n5,5,1\n50,5,2\n5,5,2\n", "point 3 and one before it give the same voxel"),
                              ("x,y,z,label\n5,5,0,1\n50,5,0,2\n", "it has x, y, z, label")):
            with open(self.path("seeds.csv"), "w") as file:
                file.write(text)
            self.fail_with(2, message, "segment", image, "-o", self.path("l.npy"), "--seeds", self.path("seeds.csv"))

    def test_uncertain_seeds_yield_to_clear_intensities(self):
        values = [(0.0, 10.0)[x // 20] + 0.1 * (7 * x * y % 11) for y in range(40) for x in range(40)]
        image = self.write_bytes("bands.npy", npy_bytes((40, 40), values, "<f4"))
        wrong = 20 * 40 + 35
        with open(self.path("seeds.csv"), "w") as file:
            file.write("x,y,label\n10,20,1\n30,20,2\n35,20,1\n")
        seeds = ("--seeds", self.path("seeds.csv"))
        self.assertEqual(self.labels(image, *seeds)[0][wrong], 0)
        labels, report = self.labels(image, *seeds, "--seed-confidence", "0.9")
        self.assertEqual(labels[wrong], 1)
        self.assertEqual(report["options"]["seed_confidence"], "0.9")
        each = self.write_bytes("p.npy", npy_bytes((40, 40), [0.9] * wrong + [1] * (1600 - wrong), "<f4"))
        self.assertEqual(self.labels(image, *seeds, "--seed-confidence", each)[0][wrong], 0)
        with open(self.path("seeds.csv"), "w") as file:
            file.write("x,y,label,confidence\n10,20,1,1\n30,20,2,1\n35,20,1,0.6\n")
        self.assertEqual(self.labels(image, *seeds)[0][wrong], 1)
        self.fail_with(2, "confidences of its own", "segment", image, "-o", self.path("l.npy"), *seeds,
                       "--seed-confidence", "0.5")
        self.fail_with(2, "add --seeds", "segment", image, "-o", self.path("l.npy"), "--seed-confidence", "0.5")
        with open(self.path("seeds.csv"), "w") as file:
            file.write("x,y,label,confidence\n10,20,1,1\n30,20,2,7\n")
        self.fail_with(2, "is no confidence", "segment", image, "-o", self.path("l.npy"), *seeds)

    def test_a_contour_starts_at_seeds(self):
        values = [10.0 if min(math.hypot(x - 20, y - 24), math.hypot(x - 45, y - 24)) < 9 else 1.0 for y in range(48)
                  for x in range(64)]
        image = self.write_bytes("two.npy", npy_bytes((48, 64), values, "<f4"))
        with open(self.path("seeds.csv"), "w") as file:
            file.write("x,y,label\n" + "".join(f"{x},{y},2\n" for x in (19, 20, 21) for y in (23, 24, 25)))
        labels, _ = self.labels(image, "--seeds", self.path("seeds.csv"), "--mode", "local")
        self.assertEqual([labels[24 * 64 + x] for x in (14, 20, 45, 60)], [1, 1, 0, 0])

    def test_labels_have_hints(self):
        image = self.disc()
        self.succeed("segment", image, "-o", self.path("labels.npy"))
        for verb, output in (("polygonize", "a.ply"), ("curvature", "a.ply"), ("render", "a.png")):
            self.fail_with(2, "labels.npy: an image, not a csrbf model: csrbf segment", verb, self.path("labels.npy"),
                           "-o", self.path(output))
        two = self.write_bytes("a.npy", npy_bytes((1, 6), [0, 1, 1, 0, 2, 2], "|u1"))
        other = self.write_bytes("b.npy", npy_bytes((1, 6), [0, 2, 2, 0, 1, 0], "|u1"))
        self.assertIn("whether they have one, the Dice is 0.8571", self.succeed("compare", two, other).stderr)
        self.assertNotIn("whether they have one", self.succeed("compare", two, two).stderr)

    def test_means_have_the_digits_that_tell_them_apart(self):
        values = [30050.25 if (x - 30) ** 2 + (y - 20) ** 2 < 144 else 30050.0 for y in range(48) for x in range(64)]
        image = self.write_bytes("image.npy", npy_bytes((48, 64), values, "<f4"))
        said = self.succeed("segment", image, "-o", self.path("labels.npy")).stdout
        self.assertIn("mean 30050,", said)
        self.assertIn("mean 30050.25,", said)

    def test_mask_is_a_box(self):
        values = [10.0 if math.hypot(x - 20, y - 24) < 9 else 30.0 if x > 45 else 1.0 for y in range(48)
                  for x in range(64)]
        image = self.write_bytes("two.npy", npy_bytes((48, 64), values, "<f4"))
        labels, _ = self.labels(image, "--mask", "box:0,0,40,47")
        self.assertEqual([labels[24 * 64 + x] for x in (20, 35, 60)], [1, 0, 0])
        self.fail_with(2, "--mask box:90,0,99,9: covers no voxel", "segment", image, "-o", self.path("l.npy"), "--mask",
                       "box:90,0,99,9")

    def test_what_lies_elsewhere_in_the_patient_is_refused(self):
        ball = self.ball()
        with open(ball, "rb") as file:
            moved = file.read().replace(b"Offset = -10 ", b"Offset = -16 ")
        moved = self.write_bytes("moved.mha", moved)
        for flags in (["--mask", moved], ["--seeds", moved], ["--init", "mask:" + moved]):
            self.fail_with(2, "are not where those of the image are: spacing (1.5, 1.5, 2) and (1.5, 1.5, 2), origin "
                           "(-16, 1, 11) and (-10, 1, 11)", "segment", ball, "-o", self.path("labels.mha"), *flags)
        self.fail_with(2, "are not where those of the image are", "inpaint", ball, "-o", self.path("filled.mha"),
                       "--mask", moved)
        mask = self.write_bytes("mask.npy", npy_bytes((20, 26, 28), [1.0] * 28 * 26 * 20, "<f4"))
        self.succeed("segment", ball, "-o", self.path("labels.mha"), "--mask", mask)

    def test_table_needs_objects(self):
        self.fail_with(2, "--objects", "segment", self.disc(), "-o", self.path("l.npy"), "--table", self.path("t.csv"))

    def test_labels_report_and_summary(self):
        image = self.disc()
        done = self.succeed("segment", image, "-o", self.path("l.npy"), "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        shape, kind, labels = read_npy(self.path("l.npy"))
        self.assertEqual((shape, kind), ((48, 64), "|u1"))
        truth = [1 if (x - 30) ** 2 + (y - 20) ** 2 < 144 else 0 for y in range(48) for x in range(64)]
        wrong = sum(a != b for a, b in zip(labels, truth))
        self.assertLess(wrong, 8)  # a tenth of the border voxels
        report = self.report()
        result = report["result"]
        self.assertTrue(result["converged"])
        self.assertGreaterEqual(result["iterations"], 1)
        self.assertEqual(result["components"], 1)
        self.assertEqual(result["energy"], sorted(result["energy"], reverse=True))
        self.assertEqual([r["voxels"] for r in result["regions"]], [64 * 48 - sum(labels), sum(labels)])
        self.assertAlmostEqual(result["regions"][1]["mean"], 10, delta=0.2)
        for stage in ("read", "prepare", "evolve", "write"):
            self.assertIn(stage, report["time"])
        for option in ("energy", "init", "regions", "center_spacing", "support", "kernel", "smoothness", "window",
                       "shading", "balloon", "fill_holes", "mask", "mode", "method", "iterations", "contour", "model"):
            self.assertIn(option, report["options"])
        # The contour is smooth: it has the area of the voxels inside, and the length of a circle of that area.
        contour = result["contour"]
        area = sum(labels)
        self.assertLess(abs(contour["area"] - area), 0.01 * area)
        self.assertLess(abs(contour["length"] - math.sqrt(4 * math.pi * area)), 0.01 * contour["length"])
        self.assertLess(contour["area_error"], 0.01 * area)

    def test_contours_are_svg_csv_and_ply(self):
        image = self.disc()
        for extension in ("svg", "csv", "ply"):
            self.succeed("segment", image, "-o", self.path("l.npy"), "--contour", self.path("c." + extension), "-q")
        with open(self.path("c.csv")) as file:
            names, *rows = file.read().splitlines()
        self.assertEqual(names, "x,y,z,contour")
        radii = [math.dist([float(c) for c in row.split(",")[:2]], (30, 20)) for row in rows]
        self.assertLess(max(abs(r - 12) for r in radii), 1)
        with open(self.path("c.svg")) as file:
            self.assertIn("<path", file.read())
        self.assertEqual(len(read_ply(self.path("c.ply"))[0]), len(rows))

    def test_the_seed_says_what_is_inside(self):
        image = self.disc()
        bright, _ = self.labels(image, "--init", "sphere:30,20,5")
        dark, _ = self.labels(image, "--init", "sphere:58,40,4")
        self.assertEqual([1 - label for label in bright], dark)
        self.assertEqual(bright[20 * 64 + 30], 1)
        boxed, _ = self.labels(image, "--init", "box:33,24,27,16")
        self.assertEqual(boxed, bright)
        self.write_bytes("start.npy", npy_bytes((48, 64), [1 if 25 < i % 64 < 35 and 15 < i // 64 < 25 else 0
                                                           for i in range(64 * 48)], "|u1"))
        masked, _ = self.labels(image, "--init", "mask:" + self.path("start.npy"))
        self.assertEqual(masked, bright)
        corners = "".join("%g,%g\n" % (30 + 8 * math.cos(a), 20 + 8 * math.sin(a)) for a in (0, 4, 1, 5, 2, 3))
        around, _ = self.labels(image, "--init", "points:" + self.write("points.csv", "x,y\n" + corners))
        self.assertEqual(around, bright)

    def test_local_mode_keeps_to_the_part_it_starts_in(self):
        values = [10.0 if min(math.dist((i % 64, i // 64), c) for c in ((16, 24), (48, 24))) < 9 else 1.0
                  for i in range(64 * 48)]
        image = self.write_bytes("two.npy", npy_bytes((48, 64), values, "<f4"))
        both, report = self.labels(image)
        self.assertEqual(report["result"]["components"], 2)
        one, report = self.labels(image, "--mode", "local", "--init", "sphere:16,24,5")
        self.assertEqual(report["result"]["components"], 1)
        self.assertEqual(one[24 * 64 + 16], 1)
        self.assertEqual(one[24 * 64 + 48], 0)
        self.assertTrue(report["options"]["fill_holes"])

    def test_a_model_starts_the_next_segmentation_and_gives_labels_at_any_resolution(self):
        image = self.disc()
        labels, _ = self.labels(image, "--model", self.path("disc.csrbf"))
        again, report = self.labels(image, "--init", self.path("disc.csrbf"))
        self.assertEqual(again, labels)
        self.assertEqual(report["options"]["init"], self.path("disc.csrbf"))
        self.succeed("evaluate", self.path("disc.csrbf"), "-o", self.path("same.npy"), "--like", image, "--labels")
        self.assertEqual(read_npy(self.path("same.npy"))[2], labels)
        self.succeed("evaluate", self.path("disc.csrbf"), "-o", self.path("fine.npy"), "--grid", "253,189", "--bounds",
                     "0:63,0:47", "--labels")
        shape, kind, fine = read_npy(self.path("fine.npy"))
        self.assertEqual((shape, kind), ((189, 253), "|u1"))
        self.assertEqual([fine[4 * y * 253 + 4 * x] for y in range(48) for x in range(64)], labels)
        self.assertLess(abs(sum(fine) / 16 - sum(labels)), 0.01 * sum(labels))
        self.assertIn("1 level set of x, y", self.succeed("info", self.path("disc.csrbf")).stdout)

    def test_several_regions_have_labels_and_contours_of_their_own(self):
        values = [20.0 if math.dist((i % 64, i // 64), (20, 24)) < 10 else
                  10.0 if math.dist((i % 64, i // 64), (46, 24)) < 10 else 1.0 for i in range(64 * 48)]
        image = self.write_bytes("three.npy", npy_bytes((48, 64), values, "<f4"))
        labels, report = self.labels(image, "--regions", "3", "--model", self.path("three.csrbf"), "--contour",
                                     self.path("three.csv"))
        self.assertEqual((labels[0], labels[24 * 64 + 46], labels[24 * 64 + 20]), (0, 1, 2))
        contour = report["result"]["contour"]
        self.assertEqual([r["label"] for r in contour["regions"]], [1, 2])
        self.assertEqual(contour["lines"], sum(r["lines"] for r in contour["regions"]))
        self.succeed("evaluate", self.path("three.csrbf"), "-o", self.path("l.npy"), "--like", image, "--labels")
        # Each level set is scaled by itself, so the model may draw the borders a little differently.
        same = sum(a == b for a, b in zip(read_npy(self.path("l.npy"))[2], labels))
        self.assertGreater(same, 0.97 * len(labels))

    def test_a_label_without_voxels_is_reported_once(self):
        values = [10.0 if math.dist((i % 64, i // 64), (30, 20)) < 12 else 1.0 for i in range(64 * 48)]
        values[5 * 64 + 5] = 100.0  # a class of its own, too small for a region
        image = self.write_bytes("speck.npy", npy_bytes((48, 64), values, "<f4"))
        _, report = self.labels(image, "--regions", "3", "--energy", "chan-vese", "--smoothness", "0.1")
        self.assertEqual(report["result"]["regions"][2]["voxels"], 0)
        self.assertEqual(len(report["warnings"]), 1)
        self.assertIn("label 2", report["warnings"][0])

    def test_the_preview_shows_the_contour_on_the_image(self):
        self.succeed("segment", self.disc(), "-o", self.path("l.npy"), "--preview", self.path("p.png"))
        width, height, raw = read_png(self.path("p.png"))
        self.assertGreaterEqual(max(width, height), 512)
        pixels = [raw[1 + y * (1 + 3 * width) + 3 * x:][:3] for y in range(0, height, 2) for x in range(0, width, 2)]
        self.assertTrue(any(p[0] > p[1] + 100 for p in pixels))

    def test_the_mask_leaves_voxels_out(self):
        image = self.disc()
        mask = self.write_bytes("mask.npy", npy_bytes((48, 64), [1 if i % 64 < 30 else 0 for i in range(64 * 48)], "|u1"))
        labels, _ = self.labels(image, "--mask", mask, "--init", "sphere:25,20,3")
        self.assertEqual(sum(labels[i] for i in range(64 * 48) if i % 64 >= 30), 0)
        self.assertGreater(sum(labels), 150)

    def test_missing_voxels_are_left_out(self):
        values = [(10 if math.hypot(x - 20, y - 24) < 9 else 1) + 0.01 * (x * y % 29) for y in range(48) for x in range(64)]
        want, _ = self.labels(self.write_bytes("whole.npy", npy_bytes((48, 64), values, "<f4")))
        self.assertIn(sum(want), range(240, 270))
        for number, (value, *flags) in enumerate(((math.nan,), (-9999,), (-9999, "--missing", "-9999"),
                                                  (4, "--missing", "4"))):
            image = [value if i % 64 > 50 else v for i, v in enumerate(values)]
            path = self.write_bytes(f"missing{number}.npy", npy_bytes((48, 64), image, "<f4"))
            labels, report = self.labels(path, *flags)
            self.assertEqual(labels, want)
            self.assertAlmostEqual(report["result"]["missing"], 13 / 64)
            self.assertEqual(len(report["warnings"]), 1 if number == 1 else 0)
            self.assertEqual(report["options"]["missing"], None if number == 0 else value)
        self.fail_with(2, "--missing none: expected", "segment", path, "-o", self.path("l.npy"), "--missing", "none")
        everything = ["segment", self.write_bytes("nan.npy", npy_bytes((4, 5), [math.nan] * 19 + [1], "<f4")), "-o",
                      self.path("l.npy"), "--missing", "1"]
        self.fail_with(2, "missing", *everything)

    def test_a_volume_of_one_slice_is_the_image_it_is(self):
        plane, _ = self.labels(self.disc())
        slab, report = self.labels(self.disc("slab.npy", shape=(1, 48, 64)))
        self.assertEqual(slab, plane)
        self.assertIn("length", report["result"]["contour"])
        self.assertEqual(read_npy(self.path("labels.npy"))[0], (1, 48, 64))

    def test_results_do_not_depend_on_the_number_of_threads(self):
        image = self.disc()
        for threads in "1", "3":
            self.succeed("segment", image, "-o", self.path("l%s.npy" % threads), "--model",
                         self.path("m%s.csrbf" % threads), "--threads", threads)
        for name in ("l%s.npy", "m%s.csrbf"):
            with open(self.path(name % 1), "rb") as a, open(self.path(name % 3), "rb") as b:
                self.assertEqual(a.read(), b.read())


class Space(Segment):
    def test_physical_units_are_honoured_and_kept(self):
        image = self.ball()
        self.succeed("segment", image, "-o", self.path("l.mha"), "--init", "sphere:10,20,30,6", "--mode", "local",
                     "--contour", self.path("c.ply"), "--model", self.path("m.csrbf"), "--report",
                     self.path("report.json"))
        with open(self.path("l.mha"), "rb") as file:
            head = file.read(1000).decode("latin-1")
        self.assertRegex(head, r"ElementSpacing *= *1.5 1.5 2\b")
        self.assertRegex(head, r"(Offset|Position|Origin) *= *-10 1 11\b")
        self.assertIn("MET_UCHAR", head)
        contour = self.report()["result"]["contour"]
        volume, area = 4 / 3 * math.pi * 12 ** 3, 4 * math.pi * 144
        self.assertLess(abs(contour["volume"] - volume), 0.03 * volume)
        self.assertLess(abs(contour["area"] - area), 0.05 * area)
        vertices, _ = read_ply(self.path("c.ply"))
        radii = [math.dist((v["x"], v["y"], v["z"]), (10, 20, 30)) for v in vertices]
        self.assertLess(max(abs(r - 12) for r in radii), 1.5)
        # The model is a surface.
        self.succeed("polygonize", self.path("m.csrbf"), "-o", self.path("p.stl"))
        self.succeed("curvature", self.path("m.csrbf"), "-o", self.path("k.ply"))
        self.succeed("render", self.path("m.csrbf"), "-o", self.path("r.png"), "--size", "80x60")
        self.succeed("evaluate", self.path("m.csrbf"), "-o", self.path("e.mha"), "--like", image, "--labels")
        self.assertEqual(self.dice(self.path("e.mha"), self.path("l.mha")), 1)

    def test_axes_that_are_not_at_right_angles(self):
        size, rows = (32, 26, 20), ((1.5, 0.4, 0.0, -14.0), (0.0, 1.4, 0.5, -2.0), (0.0, 0.0, 2.0, 11.0))
        values = []
        for z in range(size[2]):
            for y in range(size[1]):
                for x in range(size[0]):
                    p = [r[0] * x + r[1] * y + r[2] * z + r[3] for r in rows]
                    values.append(100 if math.dist(p, (14, 20, 30)) < 12 else 20)
        head = bytearray(352)
        struct.pack_into("<i", head, 0, 348)
        struct.pack_into("<4h", head, 40, 3, *size)
        struct.pack_into("<4h", head, 48, 1, 1, 1, 1)
        struct.pack_into("<2h", head, 70, 4, 16)
        struct.pack_into("<4f", head, 76, 1, 1.5, 1.456, 2.06)
        struct.pack_into("<f", head, 108, 352)
        head[123] = 2  # mm
        struct.pack_into("<2h", head, 252, 0, 1)
        struct.pack_into("<12f", head, 280, *(number for row in rows for number in row))
        head[344:348] = b"n+1\0"
        image = self.write_bytes("sheared.nii", bytes(head) + struct.pack("<%dh" % len(values), *values))
        run = self.succeed("segment", image, "-o", self.path("l.nii"), "--objects", "--table", self.path("t.csv"), "--contour",
                           self.path("c.ply"), "--report", self.path("report.json"))
        self.assertRegex(run.stderr, "the axes of the image are up to 1[4-6].* degrees off right angles")
        voxels = sum(value > 50 for value in values)
        result = self.report()["result"]
        self.assertAlmostEqual(result["regions"][1]["volume"] / (1.5 * 1.4 * 2), voxels, delta=0.01 * voxels)
        volume, area = 4 / 3 * math.pi * 12 ** 3, 4 * math.pi * 144
        self.assertAlmostEqual(result["contour"]["volume"], volume, delta=0.02 * volume)
        self.assertAlmostEqual(result["contour"]["area"], area, delta=0.03 * area)
        with open(self.path("t.csv")) as file:
            head, row = file.read().split()
        row = dict(zip(head.split(","), map(float, row.split(","))))
        self.assertAlmostEqual(row["volume"], volume, delta=0.02 * volume)
        self.assertAlmostEqual(row["area"], area, delta=0.05 * area)
        for name in ("major_axis", "middle_axis", "minor_axis"):
            self.assertAlmostEqual(row[name], 24, delta=0.5)
        vertices, _ = read_ply(self.path("c.ply"))
        self.assertLess(max(abs(math.dist((v["x"], v["y"], v["z"]), (14, 20, 30)) - 12) for v in vertices), 1.5)

    def test_points_on_the_boundary_start_it(self):
        image = self.ball()
        points = self.write("points.xyz", command_line_test.xyz(fibonacci(24, 9, (10, 20, 30))))
        self.succeed("segment", image, "-o", self.path("a.mha"), "--init", "points:" + points, "--mode", "local")
        self.succeed("segment", image, "-o", self.path("b.mha"), "--init", "sphere:10,20,30,9", "--mode", "local")
        self.assertGreater(self.dice(self.path("a.mha"), self.path("b.mha")), 0.99)


    def large(self, name, spoil=b""):
        """A bright block in noise, of more than 8 million voxels, as bytes."""
        nx, ny, nz = 216, 210, 190
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, nx, ny, nz, 1, 1, 1, 1)
        struct.pack_into("<hh", header, 70, 2, 8)
        struct.pack_into("<8f", header, 76, 1, 1, 1, 2, 1, 1, 1, 1)
        struct.pack_into("<f", header, 108, 352)
        header[344:348] = b"n+1\0"
        dark, bright = (bytes(base + sum(i >> k & 1 for k in range(8)) * 8 for i in range(256)) for base in (40, 120))
        chance = random.Random(1)
        with open(self.path(name), "wb") as file:
            file.write(header)
            for row in range(ny * nz):
                noise, (z, y) = chance.randbytes(nx), divmod(row, ny)
                inside = 50 <= y < 160 and 30 <= z < 150
                part = noise[60:150].translate(bright if inside else dark)
                file.write(noise[:60].translate(dark) + part + noise[150:].translate(dark))
        return self.path(name)

    def test_large_images_are_the_same_slice_by_slice(self):
        image, report = self.large("large.nii"), self.path("report.json")
        packed = self.path("large.nii.gz")
        with open(image, "rb") as file, gzip.open(packed, "wb", compresslevel=1) as to:
            to.write(file.read())
        results = []
        for name, labels in (("large.nii", "labels.nii"), ("large.nii", "labels.npy"), ("large.nii.gz", "labels.nii.gz"),
                             ("large.nii", "labels.mha")):
            image, labels = self.path(name), self.path(labels)
            self.succeed("segment", image, "-o", labels, "--model", self.path("model.csrbf"), "--report", report)
            with open(report) as file:
                results.append(json.load(file))
            with (gzip.open(labels) if labels.endswith(".gz") else open(labels, "rb")) as file:
                content = file.read()
            results[-1]["labels"] = content[-216 * 210 * 190:]
            with open(self.path("model.csrbf"), "rb") as file:
                results[-1]["model"] = file.read()
            results[-1]["input"].pop("file")
        whole = results.pop()  # .mha is written whole
        self.assertEqual(whole["labels"].count(1), 90 * 110 * 120)
        self.assertEqual(whole["result"]["components"], 1)
        for each in results:
            self.assertEqual(each["labels"], whole["labels"])
            self.assertEqual(each["model"], whole["model"])
            self.assertEqual(each["options"] | {"output": ""}, whole["options"] | {"output": ""})
            self.assertEqual(each["input"], whole["input"])
            for key in ("iterations", "converged", "components"):
                self.assertEqual(each["result"][key], whole["result"][key])
            for one, other in zip(each["result"]["regions"], whole["result"]["regions"]):
                self.assertEqual(one["voxels"], other["voxels"])
                for key in ("volume", "mean", "sd"):
                    single = 1e-4  # sums of slices are in single precision
                    self.assertAlmostEqual(one[key], other[key], delta=single * other[key])

    def test_large_images_that_end_early(self):
        image = self.large("large.nii")
        os.truncate(image, os.path.getsize(image) - 1)
        self.fail_with(2, "the file is truncated", "segment", image, "-o", self.path("labels.nii"))


class Errors(Segment):
    def refused(self, message, *arguments):
        self.fail_with(2, message, "segment", *arguments, "-o", self.path("out.nii.gz"))

    def test_images_without_anything_to_tell_apart(self):
        constant = self.write_bytes("constant.npy", npy_bytes((4, 5), [3] * 20, "<f4"))
        self.refused("all voxels have the value 3: there is nothing to segment", constant)
        inf = self.write_bytes("inf.npy", npy_bytes((4, 5), list(range(19)) + [math.inf], "<f4"))
        self.refused("inf.npy: voxel 4, 3 is inf; fill such voxels with csrbf inpaint, or exclude them with --mask",
                     inf)

    def test_center_spacings_beyond_the_image(self):
        self.refused("--center-spacing 1000: must be at most 32 voxels for this image", self.disc(), "--center-spacing",
                     "1000")

    def test_starts_outside_the_image_or_of_another_form(self):
        image = self.disc()
        self.refused("covers no voxel of the image, which has x from -0.5 to 63.5, y from -0.5 to 47.5", image, "--init",
                     "sphere:100,100,5")
        self.refused("expected sphere:X,Y,R for an image of 2 axes", image, "--init", "sphere:30,20")
        self.refused("expected sphere:X,Y,Z,R for an image of 3 axes", self.ball(), "--init", "sphere:30,20,5")
        self.refused("expected 3 numbers", image, "--init", "sphere:a,b,c")
        self.refused("the radius must be positive", image, "--init", "sphere:30,20,-1")
        self.refused("expected box:X,Y,X,Y, two opposite corners", image, "--init", "box:1,2,3")
        self.refused("expected auto, sphere:X,Y[,Z],R, box:", image, "--init", "disc:1,2,3")
        self.refused("cannot read the file", image, "--init", "points:" + self.path("none.csv"))
        self.refused("2 points are too few", image, "--init", "points:" + self.write("p.csv", "x,y\n1,2\n3,4\n"))
        self.refused("a contour on edges needs a start: give --init", image, "--energy", "edge")
        self.refused("are for two regions", image, "--regions", "3", "--init", "sphere:30,20,5")

    def test_models_of_other_dimensions(self):
        self.succeed("segment", self.ball(), "-o", self.path("l.mha"), "--model", self.path("ball.csrbf"))
        self.refused("the model has 3 variables and 1 component; expected 2 variables", self.disc(), "--init",
                     self.path("ball.csrbf"))

    def test_masks_that_are_empty_or_of_another_size(self):
        image = self.disc()
        empty = self.write_bytes("empty.npy", npy_bytes((48, 64), [0] * 48 * 64, "|u1"))
        small = self.write_bytes("small.npy", npy_bytes((24, 64), [1] * 24 * 64, "|u1"))
        self.refused("--mask empty: must be set in some voxels", image, "--mask", empty)
        self.refused("it has 64 x 24 voxels, the image 64 x 48", image, "--mask", small)
        self.refused("covers no voxel of the image", image, "--init", "mask:" + empty)
        self.refused("it has 64 x 24 voxels, the image 64 x 48", image, "--init", "mask:" + small)

    def test_images_of_other_shapes(self):
        self.refused("the image has one voxel along y (64 x 1 x 48); a slice must be thin along its last axis",
                     self.disc("thin.npy", shape=(48, 1, 64)))
        self.refused("the image has one axis only (3072)", self.disc("line.npy", shape=(48 * 64,)))
        frames = self.write_bytes("frames.npy", npy_bytes((2, 3, 4, 5), list(range(120)), "<f4"))
        self.refused("the image has 2 frames; segment takes one: save one frame, or segment all of them with "
                     "csrbf track", frames)

    def test_the_last_channel_of_a_volume_is_no_transparency(self):
        inside = [math.dist((x, y, z), (8, 8, 4)) < 4 for z in range(8) for y in range(16) for x in range(16)]
        head = "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 16 16 8\nkinds: vector domain domain domain\nencoding: raw\n\n"
        stack = self.write_bytes("stack.nrrd", head.encode() + bytes(v for i in inside for v in (9, 200 if i else 10)))
        labels, report = self.labels(stack)
        self.assertEqual(len(report["warnings"]), 1)
        self.assertIn("the last of 2 components is used like the others", report["warnings"][0])
        self.assertEqual(sum(labels), sum(inside))

    def test_colours_and_their_channels(self):
        inside = [math.hypot(x - 30, y - 20) < 12 for y in range(48) for x in range(64)]
        noise = [7 * i * i % 41 for i in range(len(inside))]
        pixels = bytes(v for i, n in zip(inside, noise) for v in ((150 if i else 60) + n, (60 if i else 150) + n, 2 * n))
        image = self.write_bytes("color.ppm", b"P6\n64 48\n255\n" + pixels)
        labels, report = self.labels(image)
        self.assertLess(sum(bool(a) != b for a, b in zip(labels, inside)), 12)
        red, green, blue = report["result"]["channels"]
        self.assertLess(red * green, -0.4)
        self.assertLess(abs(blue), 0.1)
        outside, region = (region["channel_means"] for region in report["result"]["regions"])
        for mean, expected in zip(outside + region, (80, 170, 40, 170, 80, 40)):
            self.assertAlmostEqual(mean, expected, delta=6)
        run = self.succeed("segment", image, "-o", self.path("again.npy"))
        self.assertRegex(run.stdout, r"label 1: .* area \d+, means of the channels 1[67]\d[.\d]*, [78]\d[.\d]*, ")
        labels, report = self.labels(image, "--channels", "2")
        self.assertNotIn("channels", report["result"])
        self.assertNotIn("channel_means", report["result"]["regions"][0])
        self.assertLess(sum(bool(a) != b for a, b in zip(labels, inside)), 40)
        self.refused("--channels 4: expected numbers from 1 to 3, the components of the image", image, "--channels", "4")

    def test_damaged_files_and_unknown_types(self):
        header = bytearray(348)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, 10, 10, 10, 1, 1, 1, 1)
        struct.pack_into("<hh", header, 70, 4, 16)
        struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
        struct.pack_into("<f", header, 108, 352)
        header[344:348] = b"n+1\0"
        truncated = self.write_bytes("truncated.nii", bytes(header) + bytes(4 + 500))
        self.refused("truncated.nii: ", truncated)
        struct.pack_into("<hh", header, 70, 32, 64)  # complex numbers
        self.refused("complex.nii: ", self.write_bytes("complex.nii", bytes(header) + bytes(4 + 8000)))

    def test_results_of_unknown_formats(self):
        image = self.disc()
        self.refused("contours in the plane are .svg .csv .ply .vtp", image, "--contour", self.path("c.stl"))
        self.refused("contours are .svg .csv .ply .vtp in the plane", image, "--contour", self.path("c.txt"))
        self.refused("models are .csrbf", image, "--model", self.path("m.ply"))
        self.refused("pictures are .png", image, "--preview", self.path("p.jpg"))
        self.fail_with(2, "label images are", "segment", image, "-o", self.path("out.jpg"))


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
