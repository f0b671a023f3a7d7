"""Functions in tiles by the real program: as good as at once, the same for any number of processes, also after kills.

usage: fit_tiles_test.py PROGRAM [unittest options]
"""

import filecmp
import json
import math
import os
import random
import struct
import subprocess
import sys
import time
import unittest

import command_line_test as base


def npy(rows):
    """A .npy file of rows of doubles."""
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, %d), }" % (len(rows), len(rows[0]))
    header += " " * (-(len(header) + 11) % 64) + "\n"
    start = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
    return start + b"".join(struct.pack(f"<{len(row)}d", *row) for row in rows)


def wave(x, y):
    return math.sin(5 * x) * math.cos(4 * y)


def samples(n, seed, noise=0.0, keep=lambda x, y: True, scale=(1.0, 1.0)):
    chance = random.Random(seed)
    rows = []
    while len(rows) < n:
        x, y = chance.random(), chance.random()
        if keep(x, y):
            rows.append([scale[0] * x, scale[1] * y, wave(x, y) + noise * chance.gauss(0, 1)])
    return rows


class FitTiles(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM
        self.model = self.path("model.csrbf")
        self.give(samples(4000, 1), "--method", "partition-of-unity")

    def give(self, rows, *flags, tile_points=1000):
        with open(self.path("samples.npy"), "wb") as file:
            file.write(npy(rows))
        self.arguments = ["fit", self.path("samples.npy"), "-o", self.model, *flags, "--tile-points", str(tile_points)]

    def result(self, *flags):
        report = self.path("report.json")
        self.succeed(*self.arguments, *flags, "--report", report)
        self.assertFalse(os.path.exists(self.model + ".tiles"))
        with open(report) as file:
            return json.load(file)

    def kept(self, name):
        """Moves the model away and returns its new path."""
        path = self.path(name)
        os.replace(self.model, path)
        return path

    def values(self, model, places, *flags):
        """Rows of what evaluate writes behind the coordinates."""
        table = self.path("places.csv")
        with open(table, "w") as file:
            file.write("x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in places))
        answers = self.path("answers.csv")
        self.succeed("evaluate", model, "--points", table, "-o", answers, *flags)
        with open(answers) as file:
            return [[float(word) for word in line.split(",")[2:]] for line in list(file)[1:]]

    def rms(self, model, places, scale=(1.0, 1.0)):
        found = self.values(model, [(scale[0] * x, scale[1] * y) for x, y in places])
        return math.sqrt(sum((row[0] - wave(x, y)) ** 2 for row, (x, y) in zip(found, places)) / len(places))

    def whole(self, *flags):
        path = self.path("whole.csrbf")
        self.succeed("fit", self.path("samples.npy"), "-o", path, *flags)
        return path

    def test_tiles_are_as_accurate_as_all_at_once(self):
        places = [row[:2] for row in samples(2000, 7)]
        for noise, n, tile_points in ((0.0, 12000, 2000), (0.05, 4000, 1000)):
            self.give(samples(n, 2, noise), tile_points=tile_points)
            result = self.result()["result"]
            self.assertEqual(result["tiles"], n // tile_points)
            self.assertEqual(result["samples"], n)
            whole = self.rms(self.whole(), places)
            self.assertLess(self.rms(self.model, places), 1.5 * whole)

    # A gap wider than what tiles see of each other, across their common faces.
    def test_gaps_are_filled_from_all_sides(self):
        self.give(samples(2000, 3, keep=lambda x, y: max(abs(x - 0.5), abs(y - 0.5)) > 0.15))
        self.result()
        chance = random.Random(4)
        inside = [(chance.uniform(0.4, 0.6), chance.uniform(0.4, 0.6)) for _ in range(500)]
        whole = self.rms(self.whole(), inside)
        self.assertLess(self.rms(self.model, inside), max(3 * whole, 0.02))

    def test_axes_of_different_units(self):
        scale = (1e4, 1e-3)
        self.give(samples(3000, 5, scale=scale), "--method", "partition-of-unity")
        self.result()
        places = [row[:2] for row in samples(1000, 8)]
        self.assertLess(self.rms(self.model, places, scale), 1.5 * self.rms(self.whole("--method", "partition-of-unity"), places, scale) + 1e-9)

    def test_derivatives_and_deviations(self):
        self.give(samples(3000, 2, 0.05))
        self.result()
        places = [(0.5 * k / 100 + 0.25, 0.3) for k in range(101)]
        for (value, fx, fy, deviation), (x, y) in zip(
                self.values(self.model, places, "--gradient", "--standard-deviation"), places):
            self.assertAlmostEqual(value, wave(x, y), delta=0.05)
            self.assertAlmostEqual(fx, 5 * math.cos(5 * x) * math.cos(4 * y), delta=0.8)
            self.assertAlmostEqual(fy, -4 * math.sin(5 * x) * math.sin(4 * y), delta=0.8)
            self.assertAlmostEqual(deviation, 0.05, delta=0.01)

    def test_deviations_by_every_method(self):
        self.give(samples(2500, 2, 0.05))
        self.result("--method", "multilevel", "--standard-deviation")
        others = samples(500, 9, 0.05)
        found = self.values(self.model, [row[:2] for row in others], "--standard-deviation")
        within = sum(abs(value - row[2]) < 1.96 * deviation for (value, deviation), row in zip(found, others))
        self.assertGreater(within, 0.92 * len(others))
        self.assertLess(within, 0.98 * len(others))

    def test_outside_the_box(self):
        self.result()
        edge = self.values(self.model, [(1.0, 0.4)])[0][0]
        self.assertAlmostEqual(self.values(self.model, [(1.5, 0.4)])[0][0], edge, delta=2e-3)
        linear = self.values(self.model, [(1.2, 0.4)], "--extrapolation", "linear")[0][0]
        self.assertAlmostEqual(linear, wave(1, 0.4) + 0.2 * 5 * math.cos(5) * math.cos(1.6), delta=5e-3)
        self.assertTrue(math.isnan(self.values(self.model, [(1.2, 0.4)], "--extrapolation", "nan")[0][0]))

    def test_text_and_columns(self):
        rows = samples(2500, 6)
        self.write("samples.csv", "height,north,east\n" + "".join(f"{z!r},{y!r},{x!r}\n" for x, y, z in rows) + "1,,2\n")
        self.arguments[1] = self.path("samples.csv")
        report = self.result("--coordinates", "east,north", "--values", "height")
        self.assertEqual(report["input"]["coordinates"], ["east", "north"])
        self.assertEqual(report["result"]["tiles"], 3)
        self.assertLess(self.rms(self.model, [row[:2] for row in samples(500, 9)]), 1e-3)

    def test_gross_errors_are_named_by_their_numbers(self):
        rows = samples(3000, 2, 0.01)
        wrong = range(5, 3000, 110)  # several in every tile
        for row in wrong:
            rows[row][2] += 30
        for row in (700, 2500):
            rows[row][2] = -9999.0  # missing: counted, but no sample
        rows[3][2] = rows[0][2] = math.nan  # lack a number: counted, too
        self.give(rows)
        whole = self.path("report.json")
        self.whole("--missing", "-9999", "--report", whole)
        with open(whole) as file:
            expected = json.load(file)["result"]["gross_errors"]
        self.assertEqual(expected, [row + 1 for row in wrong])  # from 1
        models = []
        for shares in (1, 3):
            runs = [self.start("--missing", "-9999", "--tile-share", f"{k}/{shares}", "--report", self.path(f"r{k}.json"))
                    for k in range(1, shares + 1)]
            for run in runs:
                message = run.communicate()[1]
                self.assertEqual(run.returncode, 0, message)
            with open(self.path("r1.json")) as file:
                report = json.load(file)
            self.assertEqual(report["result"]["gross_errors"], expected)
            named = [text for text in report["warnings"] if "far from what those around them say" in text]
            self.assertEqual(len(named), 1)
            models.append(self.kept(f"of_{shares}.csrbf"))
            self.assertIn(", ".join(str(row) for row in expected[:10]), named[0])
        self.assertTrue(filecmp.cmp(*models, shallow=False))

    def test_tables_of_text_are_warned_of_as_without_tiles(self):
        rows = ["%r,%r,%r" % (value, x, y) for x, y, value in samples(1500, 4)]
        rows[700] = ",0.5,0.5"
        table = self.path("samples.csv")
        with open(table, "w") as file:
            file.write("\n".join(["temp,lon,lat"] + rows) + "\n")
        message = self.succeed("fit", table, "-o", self.model, "--tile-points", "1000").stderr
        self.assertIn("the value is lat, which has the name of a coordinate", message)
        self.assertIn("1 row without numbers, or a value, left out", message)

    def test_missing_values_are_left_out(self):
        rows = samples(1500, 6)
        for row in rows[::10]:
            row[2] = -9999.0
        self.give(rows, "--method", "partition-of-unity")
        report = self.result("--missing", "-9999")
        self.assertEqual(report["result"]["samples"], 1350)
        self.assertEqual(report["input"]["dropped"], 150)
        self.assertLess(self.rms(self.model, [row[:2] for row in samples(500, 9)]), 1e-3)

    def test_memory_says_how_large_tiles_are(self):
        self.give(samples(150000, 4, 0.05))
        self.arguments[-2:] = ["--memory", "200MB"]
        report = self.result()
        self.assertIn(report["result"]["tiles"], (2, 3))
        self.assertEqual(report["options"]["tile_points"], -(-150000 // report["result"]["tiles"]))
        if "ASAN_OPTIONS" not in os.environ:  # that takes more than the program
            self.assertLess(report["peak_memory_mb"] * 2**20, 200e6)
            self.assertGreater(report["peak_memory_mb"] * 2**20, 100e6)  # and uses it
        self.arguments[-1] = "80MB"
        run = self.run_program(*self.arguments)
        self.assertEqual(run.returncode, 2)
        self.assertIn("is too little; give at least", run.stderr)
        self.assertFalse(os.path.exists(self.model + ".tiles"))

    def start(self, *flags):
        return subprocess.Popen([PROGRAM, *self.arguments, *flags], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                text=True)

    def test_processes_share_the_work(self):
        self.result()
        alone = self.kept("alone.csrbf")
        self.result("--threads", "1")
        self.assertTrue(filecmp.cmp(alone, self.kept("one_thread.csrbf"), shallow=False))
        for process in [self.start("--tile-share", f"{share}/3") for share in (3, 2, 1)]:
            message = process.communicate()[1]
            self.assertEqual(process.returncode, 0, message)
        self.assertTrue(filecmp.cmp(alone, self.model, shallow=False))

    def test_a_killed_run_goes_on(self):
        self.result()
        alone = self.kept("alone.csrbf")
        folder = self.model + ".tiles"
        for wanted in ("dealt", "model_0", "fit_3"):
            process = self.start()
            while process.poll() is None:
                if any(name.startswith(wanted) for name in base.names_in(folder)):
                    process.kill()
                time.sleep(0.002)
            process.communicate()
        self.result()
        self.assertTrue(filecmp.cmp(alone, self.model, shallow=False))

    def test_a_damaged_model_is_told(self):
        self.result()
        with open(self.model, "rb") as file:
            content = file.read()
        for name, damaged in (("short", content[:-1000]), ("long", content + b"x"),
                              ("bad", content[:-5000] + bytes(100) + content[-4900:])):
            path = self.path(name + ".csrbf")
            with open(path, "wb") as file:
                file.write(damaged)
            run = subprocess.run([PROGRAM, "evaluate", path, "--grid", "60", "-o", self.path("grid.csv")],
                                 capture_output=True, text=True)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(path, run.stderr)
            self.assertIn("damaged", run.stderr)

    def test_what_tiles_do_not_do_is_said(self):
        for flags in (["--centers", "100"], ["--periods", "1,0"], ["--sphere", "1,2"], ["--drift", "1"]):
            run = subprocess.run([PROGRAM, *self.arguments, *flags], capture_output=True, text=True)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(flags[0], run.stderr)
            self.assertIn("does not go with tiles", run.stderr)
        self.assertFalse(os.path.exists(self.model + ".tiles"))


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
