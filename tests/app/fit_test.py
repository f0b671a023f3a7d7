"""Runs fit, evaluate and inpaint of the real program on generated files.

usage: fit_test.py PROGRAM [unittest options]
"""

import ast
import json
import math
import os
import random
import re
import struct
import sys
import unittest
import zlib

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import CommandLine


def plane(x, y):
    return 1 + 2 * x - 3 * y


def wave(x, y):
    return math.sin(3 * x) * math.cos(2 * y)


def rows_of(function, n=100, seed=1):
    """Random points of the unit square with the value of the function behind."""
    source = random.Random(seed)
    points = [(source.random(), source.random()) for _ in range(n)]
    return [(x, y, function(x, y)) for x, y in points]


def csv(rows, head=None):
    lines = [head] if head else []
    return "\n".join(lines + [",".join("%.17g" % c for c in row) for row in rows]) + "\n"


def npy_bytes(shape, values, kind="<f8"):
    code = {"<f8": "d", "<f4": "f", "|u1": "B", "<u2": "H", "<i2": "h"}[kind]
    head = repr({"descr": kind, "fortran_order": False, "shape": tuple(shape)})
    head = (head + " " * (63 - (len(head) + 10) % 64) + "\n").encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head + struct.pack("<%d%s" % (len(values), code), *values)


def read_npy(path):
    """Shape, type and values."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x93NUMPY\x01\x00"
    length = struct.unpack("<H", data[8:10])[0]
    head = ast.literal_eval(data[10:10 + length].decode())
    assert not head["fortran_order"]
    code = {"<f8": "d", "<f4": "f", "|u1": "B", "<u2": "H", "<i2": "h"}[head["descr"]]
    body = data[10 + length:]
    return head["shape"], head["descr"], list(struct.unpack("<%d%s" % (len(body) // struct.calcsize(code), code), body))


def pgm(width, height, values):
    return b"P5\n%d %d\n255\n" % (width, height) + bytes(values)


def read_pgm(path):
    with open(path, "rb") as file:
        data = file.read()
    magic, width, height, most, body = data.split(None, 4)
    assert (magic, most) == (b"P5", b"255")
    return int(width), int(height), list(body)


def json_of(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Functions(CommandLine):
    def write_bytes(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def table(self, name):
        """Names and rows of numbers of a .csv file."""
        with open(self.path(name)) as file:
            names, *lines = file.read().splitlines()
        return names.split(","), [[float(c) for c in line.split(",")] for line in lines]

    def fitted(self, rows, *flags, head=None, name="model.csrbf"):
        samples = self.write("samples.csv", csv(rows, head))
        self.succeed("fit", samples, "-o", self.path(name), *flags)
        os.remove(samples)
        return self.path(name)


class Fit(Functions):
    def test_fits_logarithms_of_amounts(self):
        rows = [(x, math.exp(math.sin(9 * x) + .3 * math.sin(1e4 * x))) for x in (i / 60 for i in range(60))]
        samples = self.write("samples.csv", csv(rows, "depth,copper"))
        self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--report", self.path("report.json"), "--transform", "log")
        report = self.report()
        self.assertEqual(report["result"]["transforms"], ["log"])
        self.assertEqual(report["options"]["transform"], "log")
        rows[7] = (rows[7][0], 0.0)
        samples = self.write("samples.csv", csv(rows, "depth,copper"))
        self.fail_with(2, "sample 7 (from 0) has the value 0", "fit", samples, "-o", self.path("f.csrbf"), "--transform", "log")

    def test_a_parameter_of_the_kernel_is_for_one_system(self):
        samples = self.write("samples.csv", csv([(i, math.sin(i / 9)) for i in range(501)]))
        self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--kernel", "matern", "--kernel-parameter", "1.5",
                     "--smoothing", "none", "--loss", "squares", "--report", self.path("report.json"))
        self.assertEqual(self.report()["result"]["method"], "interpolate")
        self.fail_with(2, "--kernel-parameter 1.5: is for the method interpolate", "fit", samples, "-o", self.path("g.csrbf"),
                       "--kernel", "matern", "--kernel-parameter", "1.5", "--method", "partition-of-unity")

    def test_warns_of_a_column_of_deviations(self):
        samples = self.write("samples.csv", "x,y,depth,sigma\n" + "".join(f"{i},{i * i % 7},{i % 3},.1\n" for i in range(20)))
        done = self.succeed("fit", samples, "-o", self.path("f.csrbf"))
        self.assertIn("sigma is used as a coordinate or value", done.stderr)

    def test_reports_what_was_done(self):
        rows = rows_of(wave) + [(0.5, 0.5, 1.0), (0.5, 0.5, 3.0)]
        samples = self.write("samples.csv", csv(rows, "x,y,height"))
        done = self.succeed("fit", samples, "-o", self.path("wave.csrbf"), "--report", self.path("report.json"), "--loss",
                            "squares")
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        self.assertIn("wave.csrbf", done.stdout)
        report = self.report()
        for key in ("samples", "merged_duplicates", "centers", "levels", "rmse", "max_error", "smoothing",
                    "cross_validation_rmse"):
            self.assertIn(key, report["result"])
        self.assertEqual(report["result"]["merged_duplicates"], 1)
        self.assertEqual(report["result"]["samples"], 101)
        self.assertEqual(report["input"]["coordinates"], ["x", "y"])
        self.assertEqual(report["options"]["values"], ["height"])
        for key in ("output", "method", "kernel", "centers", "tolerance", "smoothing", "degree", "extrapolation",
                    "coordinates", "values", "weights", "periods"):
            self.assertIn(key, report["options"])
        self.assertNotEqual(report["options"]["method"], "auto")
        for stage in ("read", "fit", "write"):
            self.assertIn(stage, report["time"])

    def test_takes_columns_by_name_and_number(self):
        rows = [(plane(x, y), 7, y, x, x * y) for x, y, _ in rows_of(plane)]
        model = self.fitted(rows, "--coordinates", "x,y", "--values", "u,5", head="u,junk,y,x,v")
        queries = self.write("queries.csv", "y,x\n0.25,0.5\n")
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
        names, values = self.table("out.csv")
        self.assertEqual(names, ["x", "y", "u", "v"])
        self.assertEqual(values[0][:2], [0.5, 0.25])
        self.assertAlmostEqual(values[0][2], plane(0.5, 0.25), places=6)
        self.assertAlmostEqual(values[0][3], 0.125, places=3)

    def test_reads_standard_input_and_npy(self):
        rows = rows_of(plane)
        self.succeed("fit", "-", "-o", self.path("text.csrbf"), stdin=csv(rows))
        array = self.write_bytes("samples.npy", npy_bytes((len(rows), 3), [c for row in rows for c in row]))
        self.succeed("fit", array, "-o", self.path("array.csrbf"))
        answers = [self.succeed("evaluate", self.path(model), "-o", "-", "--points", "-", stdin="0.5 0.25\n").stdout
                   for model in ("text.csrbf", "array.csrbf")]
        self.assertEqual(answers[0], answers[1])
        names, values = [line.split(",") for line in answers[0].splitlines()]
        self.assertEqual(names, ["x", "y", "value"])
        self.assertAlmostEqual(float(values[2]), plane(0.5, 0.25), places=6)

    def test_the_same_samples_give_the_same_file(self):
        models = [self.fitted(rows_of(wave, 400), name=name) for name in ("one.csrbf", "two.csrbf")]
        with open(models[0], "rb") as one, open(models[1], "rb") as two:
            self.assertEqual(one.read(), two.read())

    def test_every_method_is_within_its_means(self):
        rows = rows_of(wave, 400)
        queries = self.write("queries.csv", csv([row[:2] for row in rows_of(wave, 50, seed=2)]))
        for method in ("interpolate", "least-squares", "partition-of-unity", "multilevel", "pca-multiresolution",
                       "fixed-budget", "error-bounded", "moving-least-squares", "along-tracks"):
            model = self.fitted(rows, "--method", method, name=method + ".csrbf")
            self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
            for x, y, value in self.table("out.csv")[1]:
                self.assertAlmostEqual(value, wave(x, y), delta=0.2, msg=method)

    def test_gross_errors_and_missing_values_are_left_out(self):
        rows = [(x, y, -9999 if i % 7 == 3 else v + 50 * (i == 20)) for i, (x, y, v) in enumerate(rows_of(wave))]
        samples = self.write("samples.csv", csv(rows))
        done = self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--loss", "squares")
        self.assertIn("-9999 is far from all other values", done.stderr)
        done = self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--missing", "-9999", "--report",
                            self.path("report.json"))
        self.assertNotIn("-9999", done.stderr)
        result = self.report()["result"]
        self.assertEqual(result["missing"], sum(1 for row in rows if row[2] == -9999))
        self.assertEqual(result["gross_errors"], [21])  # the number of the row
        self.assertIn("number 21", done.stderr)
        self.assertLess(result["max_error"], 0.1)

    def test_samples_are_named_by_their_rows_where_others_are_left_out(self):
        lines = csv([(x, y, v + 50 * (i == 150)) for i, (x, y, v) in enumerate(rows_of(wave, 200))]).splitlines()
        for i in (3, 40, 160):
            lines[i] = "0.5,0.5,"
        samples = self.write("samples.csv", "\n".join(["x,y,depth"] + lines))
        done = self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--report", self.path("report.json"))
        self.assertEqual(self.report()["result"]["gross_errors"], [151])
        self.assertIn("(number 151)", done.stderr)

    def test_the_page_shows_no_missing_values(self):
        rows = [(x, y, -9999 if i % 7 == 3 else v) for i, (x, y, v) in enumerate(rows_of(wave))]
        samples = self.write("samples.csv", csv(rows))
        self.succeed("fit", samples, "-o", self.path("f.csrbf"), "--missing", "-9999", "--report",
                     self.path("report.html"))
        with open(self.path("report.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn("Predicted against left-out values", page)
        axes = re.findall("<text[^>]*>([^<]*)</text>", page)
        self.assertFalse([text for text in axes if re.match("[-\u2212]?[0-9],?000", text)])

    def test_functions_continue_as_told(self):
        rows = [(x, y, 3 * x - y) for x, y, _ in rows_of(wave, 60)]
        queries = self.write("queries.csv", csv([(2.0, 0.5)]))
        for how, expected in (("constant", 2.5), ("linear", 5.5), ("trend", 5.5)):
            model = self.fitted(rows, "--extrapolation", how)
            self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
            self.assertAlmostEqual(self.table("out.csv")[1][0][2], expected, delta=0.1)

    def test_a_tolerance_holds_at_every_sample(self):
        rows = rows_of(wave, 600)
        model = self.fitted(rows, "--tolerance", "0.01")
        queries = self.write("queries.csv", csv([row[:2] for row in rows]))
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
        for x, y, value in self.table("out.csv")[1]:
            self.assertLessEqual(abs(value - wave(x, y)), 0.01)

    def test_smoothing_none_interpolates(self):
        source = random.Random(3)
        rows = [(x, y, v + source.gauss(0, 0.1)) for x, y, v in rows_of(wave)]
        self.fitted(rows, "--smoothing", "none", "--method", "interpolate", "--report", self.path("report.json"))
        self.assertLess(self.report()["result"]["max_error"], 1e-6)

    def test_weights_say_what_counts(self):
        rows = [(x, y, plane(x, y), 1) for x, y, _ in rows_of(plane, 200)]
        rows += [(x, y, 50, 0) for x, y, _ in rows_of(plane, 50, seed=5)]
        model = self.fitted(rows, "--weights", "w", "--method", "moving-least-squares", head="x,y,v,w")
        out = self.succeed("evaluate", model, "-o", "-", "--points", "-", stdin="0.5,0.5\n").stdout
        self.assertAlmostEqual(float(out.splitlines()[1].split(",")[2]), plane(0.5, 0.5), places=3)

    def test_periodic_axes_are_continuous_across_their_ends(self):
        source = random.Random(4)
        rows = [(x, y, math.sin(math.radians(x)) + y) for x, y in
                ((360 * source.random(), source.random()) for _ in range(1500))]
        model = self.fitted(rows, "--periods", "360,0", "--method", "partition-of-unity")
        out = self.succeed("evaluate", model, "-o", "-", "--points", "-", stdin="0,0.5\n360,0.5\n-90,0.5\n270,0.5\n")
        values = [float(line.split(",")[2]) for line in out.stdout.splitlines()[1:]]
        self.assertAlmostEqual(values[0], 0.5, places=2)
        self.assertAlmostEqual(values[0], values[1], places=9)
        self.assertAlmostEqual(values[2], values[3], places=9)

    def test_the_sphere_has_neither_poles_nor_a_date_line(self):
        def truth(lon, lat):
            lon, lat = math.radians(lon), math.radians(lat)
            return math.sin(2 * math.cos(lon) * math.cos(lat)) + math.sin(lat)

        source = random.Random(4)
        places = [(360 * source.random(), math.degrees(math.asin(2 * source.random() - 1))) for _ in range(200)]
        rows = [(lat, truth(lon, lat), lon) for lon, lat in places]
        model = self.fitted(rows, "--sphere", "lon,lat", "--coordinates", "lon,lat", "--values", "t", head="lat,t,lon")
        queries = self.write("queries.csv", "lon,lat\n0,90\n123,90\n180,10\n-180,10\n-30,-75\n330,-75\n")
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
        values = [row[2] for row in self.table("out.csv")[1]]
        for value, (lon, lat) in zip(values, [(0, 90), (123, 90), (180, 10), (-180, 10), (-30, -75), (330, -75)]):
            self.assertAlmostEqual(value, truth(lon, lat), places=4)
        for a, b in ((0, 1), (2, 3), (4, 5)):
            self.assertAlmostEqual(values[a], values[b], places=6)
        samples = self.write("s.csv", csv(rows, "lat,t,lon"))
        self.fail_with(2, "latitude", "fit", samples, "-o", self.path("m.csrbf"), "--sphere", "lat,lon", "--values", "t")

    def test_covariates_enter_linearly_and_are_needed_to_evaluate(self):
        source = random.Random(4)
        rows = [(x, y, 10 * source.random(), wave(x, y)) for x, y, _ in rows_of(wave, 150)]
        rows = [(x, y, z, v - 0.5 * z) for x, y, z, v in rows]
        samples = self.write("samples.csv", csv(rows, "x,y,height,value"))
        model = self.path("model.csrbf")
        report = self.path("report.json")
        done = self.succeed("fit", samples, "-o", model, "--drift", "height", "--report", report)
        self.assertIn("evaluate needs these columns too", done.stdout)
        drift = json_of(report)["result"]["drift"][0]
        self.assertAlmostEqual(drift["coefficient"], -0.5, places=3)
        self.assertEqual((drift["value"], drift["covariate"]), ("value", "height"))
        queries = self.write("queries.csv", csv([(0.5, 0.5, 20)], "x,y,height"))
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries, "--gradient")
        row = self.table("out.csv")[1][0]
        self.assertAlmostEqual(row[3], wave(0.5, 0.5) - 10, places=2)
        self.assertAlmostEqual(row[6], -0.5, places=3)
        short = self.write("short.csv", csv([(0.5, 0.5)], "x,y"))
        self.fail_with(2, "height", "evaluate", model, "-o", self.path("out.csv"), "--points", short)

    def test_up_to_twenty_variables(self):
        names = ["a", "b", "c", "d", "e", "f", "g", "h"]
        places = [[math.modf(math.sin(12.9898 * i + 78.233 * a) * 43758.5)[0] ** 2 for a in range(8)] for i in range(200)]
        rows = [place + [math.sin(2 * place[0]) + place[5]] for place in places]
        model = self.fitted(rows, "--report", self.path("report.json"), head=",".join(names + ["yield"]))
        report = self.report()["result"]
        self.assertEqual((report["dimension"], report["method"], len(report["axis_scales"])), (8, "interpolate", 8))
        self.assertGreater(min(report["axis_scales"][a] for a in (1, 2, 3, 4, 6, 7)), 3 * report["axis_scales"][0])
        queries = self.write("queries.csv", csv([row[:8] for row in rows[:20]], ",".join(names)))
        self.succeed("evaluate", model, "--points", queries, "-o", self.path("out.csv"), "--gradient", "--standard-deviation")
        head, found = self.table("out.csv")
        self.assertEqual(len(head), 8 + 1 + 8 + 1)
        for row, expected in zip(found, rows):
            self.assertAlmostEqual(row[8], expected[8], delta=1e-3)
            self.assertAlmostEqual(row[9], 2 * math.cos(2 * expected[0]), delta=0.2)
        samples = self.write("s.csv", csv(rows))
        self.fail_with(2, "is for fewer variables", "fit", samples, "-o", self.path("m.csrbf"), "--method", "multilevel")
        wide = self.write("wide.csv", csv([[i + c for c in range(22)] for i in range(50)]))
        self.fail_with(2, "must be 1 to 20", "fit", wide, "-o", self.path("m.csrbf"))

    def test_derivatives_are_data(self):
        rows = [(x, y, wave(x, y), 3 * math.cos(3 * x) * math.cos(2 * y), -2 * math.sin(3 * x) * math.sin(2 * y))
                for x, y, _ in rows_of(wave, 40)]
        model = self.fitted(rows, "--derivatives", "gx,gy", "--values", "v", head="x,y,v,gx,gy")
        queries = self.write("queries.csv", csv([(0.5, 0.5)]))
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
        self.assertAlmostEqual(self.table("out.csv")[1][0][2], wave(0.5, 0.5), places=4)
        samples = self.write("s.csv", csv(rows, "x,y,v,gx,gy"))
        self.fail_with(2, "columns of derivatives", "fit", samples, "-o", model, "--derivatives", "gx", "--values", "v",
                       "--coordinates", "x,y")

    def test_faults_are_not_smoothed_across(self):
        rows = [(x, y, wave(x, y) + (5 if x > 0.5 else 0)) for x, y, _ in rows_of(wave, 300)]
        faults = self.write("faults.csv", csv([(0.5, -1, 1), (0.5, 2, 1)], "x,y,line"))
        model = self.fitted(rows, "--faults", faults)
        queries = self.write("queries.csv", csv([(0.4999, 0.5), (0.5001, 0.5)]))
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
        left, right = [row[2] for row in self.table("out.csv")[1]]
        self.assertAlmostEqual(left, wave(0.5, 0.5), places=2)
        self.assertAlmostEqual(right, wave(0.5, 0.5) + 5, places=2)
        one = self.write("one.csv", csv([(0.5, -1, 1), (0.5, 2, 2)], "x,y,line"))
        turned = self.write("turned.csv", csv([(1, -1, 0.5), (1, 2, 0.5)], "LINE,Y,X"))
        self.succeed("fit", self.write("s.csv", csv(rows)), "-o", self.path("turned.csrbf"), "--faults", turned)
        places = self.write("places.csv", csv([(0.49, 0.5), (0.51, 0.5)], "x,y"))
        here, there = (self.succeed("evaluate", m, "--points", places, "-o", "-").stdout for m in (model, self.path("turned.csrbf")))
        self.assertEqual(here, there)
        named = self.write("named.csv", "x,y,line\n0.5,-1,a\n0.5,2,a\n")
        self.fail_with(2, "row 1 has no number in column 3; lines are told apart by numbers", "fit",
                       self.write("s.csv", csv(rows)), "-o", model, "--faults", named)
        self.fail_with(2, "no column is named y", "fit", self.write("s.csv", csv(rows)), "-o", model, "--faults",
                       self.write("other.csv", csv([(0.5, -1), (0.5, 2)], "x,northing")))
        beside = self.write("beside.csv", csv([(10.5, -1), (10.5, 2)], "x,y"))
        done = self.succeed("fit", self.write("s.csv", csv(rows)), "-o", model, "--faults", beside)
        self.assertIn("all faults lie outside the box of the samples", done.stderr)
        self.fail_with(2, "one vertex; two are needed; lines are told apart by column line", "fit",
                       self.write("s.csv", csv(rows)), "-o", model, "--faults", one)
        numbered = self.write("numbered.csv", csv([(1, 0.5, -1), (1, 0.5, 2)], "id,east,north"))
        self.succeed("fit", self.write("s.csv", csv(rows)), "-o", self.path("turned.csrbf"), "--faults", numbered)
        there = self.succeed("evaluate", self.path("turned.csrbf"), "--points", places, "-o", "-").stdout
        self.assertEqual(here, there)

    def test_outside_the_samples_the_function_is_constant_or_nan(self):
        queries = self.write("queries.csv", "5,0.5\n0.5,0.5\n")
        for how in ("constant", "nan"):
            model = self.fitted(rows_of(plane), "--extrapolation", how)
            done = self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries)
            outside = self.table("out.csv")[1][0][2]
            self.assertEqual(math.isnan(outside), how == "nan")
            self.assertEqual("1 point without a value" in done.stderr, how == "nan")

    def test_rows_with_missing_numbers_are_left_out_with_a_warning(self):
        text = csv(rows_of(plane)) + "0.5,,1\n0.5,NA,2\nnan,0,3\n"
        done = self.succeed("fit", self.write("s.csv", text), "-o", self.path("m.csrbf"), "--report",
                            self.path("report.json"))
        self.assertIn("3 rows", done.stderr)
        self.assertEqual(self.report()["input"]["dropped"], 3)
        self.assertTrue(any("3 rows" in warning for warning in self.report()["warnings"]))

    def test_options_without_use_are_named_in_warnings(self):
        model = self.path("model.csrbf")
        samples = self.write("samples.csv", csv(rows_of(plane)))
        for flag, value, method in (("tolerance", "0.1", "partition-of-unity"), ("centers", "9", "moving-least-squares"),
                                    ("degree", "2", "multilevel")):
            done = self.succeed("fit", samples, "-o", model, "--" + flag, value, "--method", method)
            self.assertIn("%s: not used by the method %s" % (flag, method), done.stderr)
        one = self.write("one.csv", "1,2,3\n1,2,4\n")
        self.assertIn("all samples are at one point", self.succeed("fit", one, "-o", model).stderr)

    def test_constant_values_and_a_single_point_are_functions(self):
        for rows in ([(x, y, 4) for x, y, _ in rows_of(plane, 50)], [(1, 2, 4)], [(1, 2, 4)] * 5,
                     [(i / 10, i / 5, 4) for i in range(20)]):
            model = self.fitted(rows)
            out = self.succeed("evaluate", model, "-o", "-", "--points", "-", stdin="0.3,0.7\n").stdout
            self.assertAlmostEqual(float(out.splitlines()[1].split(",")[2]), 4, places=6)

    def test_bad_input_gives_2_and_says_why(self):
        out = self.path("model.csrbf")
        good = self.write("good.csv", csv(rows_of(plane, 30)))
        self.fail_with(2, "ragged.csv:3: expected 3 columns", "fit", self.write("ragged.csv", "1,2,3\n4,5,6\n7,8\n"),
                       "-o", out)
        self.fail_with(2, "text.csv:2: \"five\" is not a number", "fit", self.write("text.csv", "1,2,3\n4,five,6\n"),
                       "-o", out)
        self.fail_with(2, "the file holds no rows", "fit", self.write("empty.csv", ""), "-o", out)
        self.fail_with(2, "missing.csv: cannot read the file", "fit", "missing.csv", "-o", out)
        self.fail_with(2, "no column is named \"z\"", "fit", good, "-o", out, "--coordinates", "z")
        self.fail_with(2, "there is no column \"9\"", "fit", good, "-o", out, "--values", "9")
        self.fail_with(2, "dimension = 21", "fit", self.write("wide.csv", ",".join("123456789" * 3)[:43] + "\n"), "-o", out)
        self.fail_with(2, "one column of coordinates", "fit", self.write("narrow.csv", "1\n2\n"), "-o", out)
        self.fail_with(2, "no row has a finite number", "fit", self.write("nan.csv", "nan,nan,nan\n"), "-o", out)
        self.fail_with(2, "weights must not be negative", "fit", self.write("w.csv", "1,2,3,-1\n4,5,6,1\n"), "-o", out,
                       "--weights", "4")
        self.fail_with(2, "array has 3 axes", "fit", self.write_bytes("cube.npy", npy_bytes((2, 2, 2), range(8))), "-o",
                       out)
        self.fail_with(2, "unknown extension \".xlsx\"", "fit", self.write("table.xlsx", ""), "-o", out)

    def test_bad_flags_give_2_and_list_what_there_is(self):
        out = self.path("model.csrbf")
        good = self.write("good.csv", csv(rows_of(plane, 30)))
        self.fail_with(2, "partition-of-unity", "fit", good, "-o", out, "--method", "magic")
        self.fail_with(2, "wendland-c2", "fit", good, "-o", out, "--kernel", "magic")
        self.fail_with(2, "models are .csrbf", "fit", good, "-o", self.path("model.bin"))
        self.fail_with(2, "models are .csrbf", "fit", good, "-o", "-")
        self.fail_with(2, "--smoothing", "fit", good, "-o", out, "--smoothing", "some")
        self.fail_with(2, "must not be negative", "fit", good, "-o", out, "--smoothing=-1")
        self.fail_with(2, "--tolerance", "fit", good, "-o", out, "--tolerance", "0")
        self.fail_with(2, "--periods 360: expected 2", "fit", good, "-o", out, "--periods", "360")
        self.fail_with(2, "--periods", "fit", good, "-o", out, "--periods", "360,east")
        self.fail_with(2, "--extrapolation", "fit", good, "-o", out, "--extrapolation", "mirror")
        self.fail_with(1, "No such file or directory", "fit", good, "-o", self.path("no/folder/model.csrbf"))


class Evaluate(Functions):
    def test_writes_values_gradients_and_hessians(self):
        rows = [(x, y, plane(x, y), x * y) for x, y, _ in rows_of(plane, 900)]
        model = self.fitted(rows, "--values", "u,v", "--method", "partition-of-unity", head="x,y,u,v")
        queries = self.write("queries.csv", "0.5,0.25\n0.75,0.5\n")
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries, "--gradient", "--hessian")
        names, values = self.table("out.csv")
        self.assertEqual(names, ["x", "y", "u", "v", "u_x", "u_y", "v_x", "v_y", "u_x_x", "u_x_y", "u_y_y", "v_x_x",
                                 "v_x_y", "v_y_y"])
        expected = [0.5, 0.25, plane(0.5, 0.25), 0.125, 2, -3, 0.25, 0.5, 0, 0, 0, 0, 1, 0]
        for name, found, wanted in zip(names, values[0], expected):
            self.assertAlmostEqual(found, wanted, delta=0.02, msg=name)

        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--points", queries)
        self.assertEqual(read_npy(self.path("out.npy"))[0], (2, 2))
        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--points", queries, "--gradient")
        shape, kind, numbers = read_npy(self.path("out.npy"))
        self.assertEqual((shape, kind), ((2, 6), "<f8"))
        self.assertEqual(numbers[:6], values[0][2:8])
        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--points", queries, "--hessian")
        self.assertEqual(read_npy(self.path("out.npy"))[0], (2, 8))

    def test_standard_deviations_come_last(self):
        rows = [(x, y, plane(x, y), x * y) for x, y, _ in rows_of(plane, 60)]
        model = self.fitted(rows, "--values", "u,v", "--method", "interpolate", "--kernel", "cubic", head="x,y,u,v")
        queries = self.write("queries.csv", csv([row[:2] for row in rows[:5]] + [(0.5, 0.5), (7, 7)]))
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries, "--standard-deviation",
                     "--gradient", "--report", self.path("report.json"))
        names, values = self.table("out.csv")
        self.assertEqual(names, ["x", "y", "u", "v", "u_x", "u_y", "v_x", "v_y", "u_standard_deviation",
                                 "v_standard_deviation"])
        self.assertTrue(self.report()["options"]["standard_deviation"])
        for row in values[:5]:
            self.assertLess(row[9], 1e-6)  # at samples
        self.assertGreater(values[5][9], 1e-6)
        self.assertGreater(values[6][9], values[5][9])  # beyond them
        model = self.fitted(rows_of(plane), "--method", "multilevel")
        self.fail_with(2, "method = multilevel: this fit has none", "evaluate", model, "-o", self.path("out.csv"),
                       "--points", queries, "--standard-deviation")
        model = self.fitted(rows_of(plane), "--method", "multilevel", "--standard-deviation")
        self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries, "--standard-deviation")
        values, deviations = zip(*(row[2:] for row in self.table("out.csv")[1]))
        for (x, y), value, deviation in zip([*[row[:2] for row in rows[:5]], (0.5, 0.5)], values, deviations):
            self.assertLess(abs(value - plane(x, y)), 2 * deviation + 1e-9)
        self.fail_with(2, "--kernel thin-plate: must have compact support", "fit",
                       self.write("samples.csv", csv(rows_of(plane))), "-o", model, "--method", "along-tracks",
                       "--kernel", "thin-plate")

    def test_a_mask_leaves_places_far_from_samples_without_value(self):
        rows = [(x, y, wave(x, y)) for x, y, _ in rows_of(wave, 200) if x + y < 1]
        model = self.fitted(rows)
        for mask, corner, middle in (("hull", True, False), ("distance:0.2", True, False), ("distance:3", False, False)):
            done = self.succeed("evaluate", model, "-o", self.path("out.npy"), "--grid", "11", "--bounds", "0:1,0:1",
                                "--mask", mask)
            values = read_npy(self.path("out.npy"))[2]
            self.assertEqual(math.isnan(values[-1]), corner)
            self.assertEqual(math.isnan(values[3 * 11 + 3]), middle)
            self.assertEqual("without a value" in done.stderr, corner)
        self.fail_with(2, "hull, or distance:D", "evaluate", model, "-o", self.path("out.npy"), "--grid", "11", "--mask",
                       "distance:x")

    def test_extrapolation_may_be_chosen_late(self):
        model = self.fitted([(x, y, 3 * x - y) for x, y, _ in rows_of(wave, 60)])
        queries = self.write("queries.csv", csv([(2.0, 0.5)]))
        for how, expected in (("constant", 2.5), ("linear", 5.5), ("nan", math.nan)):
            self.succeed("evaluate", model, "-o", self.path("out.csv"), "--points", queries, "--extrapolation", how)
            value = self.table("out.csv")[1][0][2]
            if math.isnan(expected):
                self.assertTrue(math.isnan(value))
            else:
                self.assertAlmostEqual(value, expected, delta=0.1)

    def test_one_value_and_its_gradient_have_the_promised_shapes(self):
        model = self.fitted(rows_of(plane))
        queries = self.write("queries.csv", "0.5,0.25\n0.75,0.5\n0.1,0.1\n")
        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--points", queries)
        self.assertEqual(read_npy(self.path("out.npy"))[0], (3,))
        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--points", queries, "--gradient", "--report",
                     self.path("report.json"))
        self.assertEqual(read_npy(self.path("out.npy"))[0], (3, 3))
        self.assertEqual(self.report()["result"]["points"], 3)
        self.assertIn("evaluate", self.report()["time"])

    def test_a_grid_has_nodes_at_both_ends_and_x_fastest(self):
        model = self.fitted(rows_of(plane))
        self.succeed("evaluate", model, "-o", self.path("grid.npy"), "--grid", "5,3", "--bounds", "0.2:0.6,0.5:0.9")
        shape, _, values = read_npy(self.path("grid.npy"))
        self.assertEqual(shape, (3, 5))
        for j in range(3):
            for i in range(5):
                self.assertAlmostEqual(values[5 * j + i], plane(0.2 + 0.1 * i, 0.5 + 0.2 * j), places=6)
        self.succeed("evaluate", model, "-o", self.path("grid.csv"), "--grid", "5,3", "--bounds", "0.2:0.6,0.5:0.9")
        names, rows = self.table("grid.csv")
        self.assertEqual([row[2] for row in rows], values)
        self.assertAlmostEqual(rows[1][0], 0.3)
        self.succeed("evaluate", model, "-o", self.path("grid.npy"), "--grid", "4", "--gradient", "--report",
                     self.path("report.json"))
        self.assertEqual(read_npy(self.path("grid.npy"))[0], (4, 4, 3))
        self.assertEqual(self.report()["options"]["grid"], [4, 4])

    def test_a_grid_becomes_an_image_with_its_position(self):
        model = self.fitted(rows_of(plane))
        self.succeed("evaluate", model, "-o", self.path("grid.nrrd"), "--grid", "5,3", "--bounds", "0.2:0.6,0.5:0.9")
        with open(self.path("grid.nrrd"), "rb") as file:
            head = file.read().split(b"\n\n")[0].decode()
        self.assertIn("sizes: 5 3", head)
        self.assertIn("type: double", head)
        self.assertIn("origin", head)

    def test_grids_in_single_precision_are_the_others_rounded(self):
        model = self.fitted(rows_of(plane))
        for flags in [], ["--gradient"]:
            self.succeed("evaluate", model, "-o", self.path("double.npy"), "--grid", "5,3", *flags)
            done = self.succeed("evaluate", model, "-o", self.path("single.npy"), "--grid", "5,3", "--float32", *flags)
            shape, kind, values = read_npy(self.path("single.npy"))
            double_shape, double_kind, doubles = read_npy(self.path("double.npy"))
            self.assertEqual((shape, kind, double_kind), (double_shape, "<f4", "<f8"))
            self.assertEqual(values, [struct.unpack("<f", struct.pack("<f", value))[0] for value in doubles])
        self.assertIn("warning: --float32 rounds values by up to", done.stderr)
        self.succeed("evaluate", model, "-o", self.path("grid.nrrd"), "--grid", "5,3", "--float32")
        with open(self.path("grid.nrrd"), "rb") as file:
            self.assertIn(b"type: float", file.read())
        for output, flags in (("out.npy", ["--points", "-"]), ("out.csv", ["--grid", "3,3"])):
            self.fail_with(2, "--float32 needs --grid or --like", "evaluate", model, "-o", self.path(output),
                           "--float32", *flags)
        self.fail_with(2, "--float32: labels and pictures are whole numbers", "evaluate", model, "-o",
                       self.path("out.npy"), "--grid", "3,3", "--labels", "--float32")

    def test_like_an_image_takes_its_grid(self):
        rows = [(12 * x, 8 * y, plane(x, y)) for x, y, _ in rows_of(plane)]
        model = self.fitted(rows)
        image = self.write_bytes("image.pgm", pgm(13, 9, [0] * (13 * 9)))
        self.succeed("evaluate", model, "-o", self.path("out.npy"), "--like", image)
        shape, kind, values = read_npy(self.path("out.npy"))
        self.assertEqual((shape, kind), ((9, 13), "<f8"))
        self.assertAlmostEqual(values[13 * 4 + 6], plane(0.5, 0.5), places=5)
        self.succeed("evaluate", model, "-o", self.path("out.pgm"), "--like", image)
        self.assertEqual(read_pgm(self.path("out.pgm"))[:2], (13, 9))

    def test_queries_with_missing_numbers_have_answers_without_value(self):
        model = self.fitted(rows_of(plane))
        done = self.succeed("evaluate", model, "-o", "-", "--points", "-", stdin="0.5,0.5\n,0.5\n")
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 3)
        self.assertIn("nan", lines[2])
        self.assertIn("1 point without a value", done.stderr)

    def test_bad_flags_and_input_give_2(self):
        model = self.fitted(rows_of(plane))
        queries = self.write("queries.csv", "0.5,0.5\n")
        out = self.path("out.csv")
        self.fail_with(2, "give one of --points, --grid and --like", "evaluate", model, "-o", out)
        self.fail_with(2, "give one of", "evaluate", model, "-o", out, "--points", queries, "--grid", "3,3")
        self.fail_with(2, "--bounds needs --grid", "evaluate", model, "-o", out, "--points", queries, "--bounds", "0:1,0:1")
        self.fail_with(2, "--grid 3,3,3: expected 2", "evaluate", model, "-o", out, "--grid", "3,3,3")
        self.fail_with(2, "--grid 0,3", "evaluate", model, "-o", out, "--grid", "0,3")
        self.fail_with(2, "--bounds 0:1: expected 2", "evaluate", model, "-o", out, "--grid", "3,3", "--bounds", "0:1")
        self.fail_with(2, "--bounds 0:1,0:1,0:1: expected 2 ranges LO:HI, one per axis", "evaluate", model, "-o", out,
                       "--grid", "3,3", "--bounds", "0:1,0:1,0:1")
        self.fail_with(2, "--bounds 0:1,0:x: 0:x: expected 2 numbers", "evaluate", model, "-o", out, "--grid", "3,3",
                       "--bounds", "0:1,0:x")
        self.fail_with(2, "LO must be below HI", "evaluate", model, "-o", out, "--grid", "3,3", "--bounds", "1:0,0:1")
        self.fail_with(2, "values at points go to", "evaluate", model, "-o", self.path("out.png"), "--points", queries)
        self.fail_with(2, "pictures hold whole numbers", "evaluate", model, "-o", self.path("out.png"), "--grid", "3,3")
        self.fail_with(2, "unknown extension \".xyz\"", "evaluate", model, "-o", self.path("out.xyz"), "--grid", "3,3")
        self.fail_with(2, "expected 2 coordinates", "evaluate", model, "-o", out, "--points",
                       self.write("narrow.csv", "0.5\n"))
        self.fail_with(2, "narrow.csv: not a csrbf model", "evaluate", self.path("narrow.csv"), "-o", out, "--points",
                       queries)
        cube = self.write_bytes("cube.npy", npy_bytes((5, 5, 5), [0.0] * 125))
        self.fail_with(2, "the image has 3 axes, the model 2 variables", "evaluate", model, "-o", self.path("out.npy"),
                       "--like", cube)
        with open(model, "rb") as file:
            data = file.read()
        self.fail_with(2, "the file is damaged", "evaluate",
                       self.write_bytes("bad.csrbf", data[:90] + bytes([data[90] ^ 1]) + data[91:]), "-o", out,
                       "--points", queries)
        self.fail_with(2, "the file is truncated", "evaluate", self.write_bytes("cut.csrbf", data[:-9]), "-o", out,
                       "--points", queries)
        self.fail_with(2, "written by a newer csrbf", "evaluate",
                       self.write_bytes("new.csrbf", data[:8] + b"\x63" + data[9:]), "-o", out, "--points", queries)


class Models(Functions):
    def test_info_tells_what_a_function_is(self):
        model = self.fitted(rows_of(wave), head="longitude,latitude,depth")
        done = self.succeed("info", model, "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        self.assertIn("function depth of longitude, latitude", done.stdout)
        result = self.report()["result"]
        self.assertEqual((result["kind"], result["model"], result["dimension"]), ("model", "function", 2))
        self.assertEqual(result["values"], ["depth"])

    def test_a_function_of_two_variables_is_no_surface(self):
        model = self.fitted(rows_of(wave))
        message = "this is a function of 2 variables"
        self.fail_with(2, message, "polygonize", model, "-o", self.path("mesh.ply"))
        self.fail_with(2, message, "render", model, "-o", self.path("picture.png"))

    def test_a_function_of_three_variables_can_be_polygonized_at_a_level(self):
        source = random.Random(6)
        points = [[2 * source.random() - 1 for _ in range(3)] for _ in range(3000)]
        model = self.fitted([(*p, 1 - sum(c * c for c in p)) for p in points], "--method", "partition-of-unity")
        self.succeed("polygonize", model, "-o", self.path("mesh.ply"), "--level", "0.5", "--resolution", "40")
        vertices, faces = command_line_test.read_ply(self.path("mesh.ply"))
        self.assertGreater(faces, 1000)
        for v in vertices:
            self.assertAlmostEqual(math.sqrt(v["x"] ** 2 + v["y"] ** 2 + v["z"] ** 2), math.sqrt(0.5), delta=0.01)


class Inpaint(Functions):
    WIDTH, HEIGHT = 40, 30

    def picture(self):
        return [round(128 + 100 * wave(x / 20, y / 20)) for y in range(self.HEIGHT) for x in range(self.WIDTH)]

    def mask(self, share=0.3, seed=1):
        source = random.Random(seed)
        return [255 if source.random() < share else 0 for _ in range(self.WIDTH * self.HEIGHT)]

    def test_fills_masked_pixels_and_keeps_the_others(self):
        truth, mask = self.picture(), self.mask()
        spoiled = [0 if m else v for v, m in zip(truth, mask)]
        image = self.write_bytes("image.pgm", pgm(self.WIDTH, self.HEIGHT, spoiled))
        marks = self.write_bytes("mask.pgm", pgm(self.WIDTH, self.HEIGHT, mask))
        done = self.succeed("inpaint", image, "-o", self.path("out.pgm"), "--mask", marks, "--report",
                            self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        width, height, filled = read_pgm(self.path("out.pgm"))
        self.assertEqual((width, height), (self.WIDTH, self.HEIGHT))
        for found, wanted, marked in zip(filled, truth, mask):
            self.assertLessEqual(abs(found - wanted), 3 if marked else 0)
        report = self.report()
        self.assertEqual(report["result"]["missing"], sum(1 for m in mask if m))
        self.assertEqual(report["result"]["missing"] + report["result"]["known"], len(truth))
        for key in ("samples", "method", "rmse", "cross_validation_rmse"):
            self.assertIn(key, report["result"])
        for key in ("mask", "missing", "method", "smoothing"):
            self.assertIn(key, report["options"])

    def test_fills_pixels_of_a_value_and_nan(self):
        truth, mask = self.picture(), self.mask()
        for kind, missing, flags in (("|u1", 0, ("--missing", "0")), ("<u2", 65535, ("--missing", "65535")),
                                     ("<f4", -9999.9, ("--missing=-9999.9",)), ("<f8", math.nan, ())):
            values = [missing if m else v for v, m in zip(truth, mask)]
            image = self.write_bytes("image.npy", npy_bytes((self.HEIGHT, self.WIDTH), values, kind))
            self.succeed("inpaint", image, "-o", self.path("out.npy"), *flags)
            shape, found_kind, filled = read_npy(self.path("out.npy"))
            self.assertEqual((shape, found_kind), ((self.HEIGHT, self.WIDTH), kind))
            for found, wanted in zip(filled, truth):
                self.assertLessEqual(abs(found - wanted), 3, kind)

    def test_keeps_bit_depth_spacing_and_orientation_of_volumes(self):
        nx, ny, nz = 12, 10, 8
        values = [round(10000 + 900 * wave(x / 18, y / 18) + 50 * z)
                  for z in range(nz) for y in range(ny) for x in range(nx)]
        source = random.Random(2)
        holes = [-1 if source.random() < 0.2 else v for v in values]
        head = ("NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: %d %d %d\n"
                "space directions: (0,0.5,0) (-0.5,0,0) (0,0,3)\nspace origin: (7,8,9)\nencoding: raw\n"
                "endian: little\n\n" % (nx, ny, nz)).encode()
        image = self.write_bytes("image.nrrd", head + struct.pack("<%dh" % len(holes), *holes))
        self.succeed("inpaint", image, "-o", self.path("out.nrrd"), "--missing=-1")
        with open(self.path("out.nrrd"), "rb") as file:
            text, body = file.read().split(b"\n\n", 1)
        fields = dict(line.split(": ", 1) for line in text.decode().splitlines() if ": " in line)
        self.assertIn(fields["type"], ("short", "int16", "int16_t"))
        numbers = [float(c) for c in fields["space directions"].replace("(", " ").replace(")", " ").replace(",", " ").split()]
        self.assertEqual(numbers, [0, 0.5, 0, -0.5, 0, 0, 0, 0, 3])
        if fields["encoding"] == "gzip":
            body = zlib.decompress(body, wbits=31)
        filled = struct.unpack("<%dh" % len(holes), body)
        for found, wanted, marked in zip(filled, values, holes):
            self.assertLessEqual(abs(found - wanted), 60 if marked == -1 else 0)  # of a range of 1400

    def test_warns_when_nothing_is_missing(self):
        image = self.write_bytes("image.pgm", pgm(self.WIDTH, self.HEIGHT, self.picture()))
        done = self.succeed("inpaint", image, "-o", self.path("out.pgm"))
        self.assertIn("nothing is missing", done.stderr)
        self.assertEqual(read_pgm(self.path("out.pgm"))[2], self.picture())

    def test_bad_input_gives_2_and_says_why(self):
        image = self.write_bytes("image.pgm", pgm(self.WIDTH, self.HEIGHT, self.picture()))
        out = self.path("out.pgm")
        small = self.write_bytes("small.pgm", pgm(3, 2, [0] * 6))
        self.fail_with(2, "the mask has 3 x 2 pixels, the image 40 x 30", "inpaint", image, "-o", out, "--mask", small)
        everything = self.write_bytes("all.pgm", pgm(self.WIDTH, self.HEIGHT, [1] * (self.WIDTH * self.HEIGHT)))
        self.fail_with(2, "has no known value", "inpaint", image, "-o", out, "--mask", everything)
        self.fail_with(2, "images are .png", "inpaint", image, "-o", self.path("out.gif"))
        self.fail_with(2, "missing.png: cannot read the file", "inpaint", "missing.png", "-o", out)
        floats = self.write_bytes("floats.npy", npy_bytes((2, 2), [1, 2, math.nan, 4], "<f4"))
        self.fail_with(2, "pictures hold whole numbers", "inpaint", floats, "-o", out)
        self.fail_with(2, "--missing", "inpaint", image, "-o", out, "--missing", "black")
        self.fail_with(2, "cannot be NaN", "inpaint", image, "-o", out, "--extrapolation", "nan", "--missing", "0")
        self.fail_with(2, "partition-of-unity", "inpaint", image, "-o", out, "--missing", "128", "--method", "magic")
        cut = self.write_bytes("cut.pgm", pgm(self.WIDTH, self.HEIGHT, self.picture())[:-20])
        self.fail_with(2, "cut.pgm", "inpaint", cut, "-o", out)

    def test_info_tells_what_an_image_is(self):
        image = self.write_bytes("image.pgm", pgm(self.WIDTH, self.HEIGHT, self.picture()))
        done = self.succeed("info", image, "--report", self.path("report.json"))
        self.assertIn("40 x 30 pixels", done.stdout)
        self.assertEqual(self.report()["result"]["kind"], "image")
        self.assertEqual(self.report()["result"]["type"], "uint8")


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
