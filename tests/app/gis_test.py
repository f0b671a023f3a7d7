"""From samples on a map to a raster that a GIS puts in its place, through the real program; GDAL's own programs say where
that is, where they are installed.

usage: gis_test.py PROGRAM [unittest options]
"""

import json
import math
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import CommandLine


def height(x, y):
    return 100 + 0.01 * (x - 500000) - 0.02 * (y - 4650000) + math.sin((x - 500000) / 300)


def samples(n=400, seed=5):
    source = random.Random(seed)
    rows = []
    for _ in range(n):
        x, y = 500010 + 980 * source.random(), 4650010 + 580 * source.random()
        rows.append((x, y, height(x, y)))
    return rows


def csv(rows, head="x,y,height"):
    return head + "\n" + "".join("%.6f,%.6f,%.9f\n" % row for row in rows)


def read_tiff(path):
    """Tags and float32 samples of an uncompressed little-endian file of one page."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:4] == b"II*\0"
    (at,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, at)
    tags = {}
    for i in range(count):
        tag, kind, number = struct.unpack_from("<HHI", data, at + 2 + 12 * i)
        code = {1: "B", 2: "c", 3: "H", 4: "I", 12: "d"}[kind]
        place = at + 2 + 12 * i + 8
        if number * struct.calcsize(code) > 4:
            (place,) = struct.unpack_from("<I", data, place)
        tags[tag] = struct.unpack_from("<%d%s" % (number, code), data, place)
    pixels = b"".join(data[o:o + n] for o, n in zip(tags[273], tags[279]))
    return tags, struct.unpack("<%df" % (len(pixels) // 4), pixels)


class Gis(CommandLine):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="csrbf_test_")
        cls.addClassCleanup(folder.cleanup)
        table, cls.model = (os.path.join(folder.name, name) for name in ("samples.csv", "height.csrbf"))
        with open(table, "w") as file:
            file.write(csv(samples()))
        subprocess.run([command_line_test.PROGRAM, "fit", table, "-o", cls.model, "--quiet"], check=True)

    def test_contour_lines_are_where_the_function_has_their_levels(self):
        lines, back = self.path("lines.csv"), self.path("back.csv")
        done = self.succeed("evaluate", self.model, "-o", lines, "--levels", "every:4")
        self.assertIn("contour lines at", done.stdout)
        with open(lines) as file:
            self.assertEqual(file.readline(), "x,y,height,contour,closed\n")
            rows = [[float(cell) for cell in line.split(",")] for line in file]
        self.assertEqual({row[2] % 4 for row in rows}, {0.0})
        self.assertGreater(len({row[2] for row in rows}), 3)
        self.succeed("evaluate", self.model, "-o", back, "--points", lines)
        with open(back) as file:
            next(file)
            for row, line in zip(rows, file):
                self.assertAlmostEqual(float(line.split(",")[2]), row[2], places=5)
        report = self.path("r.json")
        self.succeed("evaluate", self.model, "-o", self.path("l.ply"), "--levels", "--report", report, "-q")
        with open(report) as file:
            self.assertTrue(4 <= len(json.load(file)["result"]["levels"]) <= 11)
        page = self.path("r.html")
        self.succeed("evaluate", self.model, "-o", self.path("l.ply"), "--levels", "--report", page, "-q")
        with open(page) as file:
            self.assertIn('<path class="contour"', file.read())
        self.succeed("evaluate", self.model, "-o", lines, "--levels=92,100", "--mask", "distance:20", "--cell", "5")
        for arguments, message in (
                (("-o", self.path("l.png"), "--levels"), "contour lines go to .csv .ply .vtp"),
                (("-o", lines, "--levels", "every:0"), "expected a positive step"),
                (("-o", lines, "--levels", "5", "--gradient"), "contour lines have no other columns"),
                (("-o", lines, "--levels", "5", "--points", back), "give --grid instead of --points"),
                (("-o", lines, "--levels", "--bounds", "0:1,0:1", "--extent", "0,0,1,1"), "exclude each other")):
            self.fail_with(2, message, "evaluate", self.model, *arguments)
        done = self.succeed("evaluate", self.model, "-o", lines, "--levels", "1e6")
        self.assertIn("no contour lines", done.stderr)

    def test_contour_lines_on_maps_have_their_level_as_a_field(self):
        if not self.has_gdal():
            self.skipTest("built without GDAL")
        lines = self.path("lines.gpkg")
        self.succeed("evaluate", self.model, "-o", lines, "--levels", "every:4", "--crs", "EPSG:32633")
        text = self.gdal("ogrinfo", "-al", lines)
        self.assertIn("Geometry: Line String", text)
        self.assertIn("height (Real) = 100", text)
        self.assertIn("WGS 84 / UTM zone 33N", text)

    def has_gdal(self):
        return "\nwith GDAL" in self.succeed("--version", "--verbose").stdout

    def gdal(self, program, *arguments):
        if shutil.which(program) is None:
            self.skipTest(program + " is not installed")
        return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60, check=True).stdout

    def check_heights(self, path, columns, rows, west, north, cell):
        tags, values = read_tiff(path)
        self.assertEqual((tags[256][0], tags[257][0]), (columns, rows))
        for row in range(0, rows, 3):
            for column in range(0, columns, 3):
                x, y = west + (column + 0.5) * cell, north - (row + 0.5) * cell
                self.assertAlmostEqual(values[row * columns + column], height(x, y), delta=0.02)

    def test_a_raster_has_cells_of_the_size_asked_for_and_the_north_on_top(self):
        dem = self.path("dem.tif")
        self.succeed("evaluate", self.model, "--grid", "--cell", "30", "--extent", "500010,4650010,500970,4650580",
                     "--crs", "EPSG:32633", "-o", dem)
        tags, _ = read_tiff(dem)
        self.assertEqual(tags[33550], (30, 30, 0))
        self.assertEqual(tags[33922], (0, 0, 0, 500010, 4650580, 0))
        self.assertEqual(tags[34735][-4:], (3072, 0, 1, 32633))
        self.assertEqual((tags[258], tags[339]), ((32,), (3,)), "float32")
        self.check_heights(dem, 32, 19, 500010, 4650580, 30)
        with open(self.path("dem.tfw")) as file:
            self.assertEqual([float(line) for line in file], [30, 0, 0, -30, 500025, 4650565])

    def test_without_an_extent_the_cells_are_whole_multiples(self):
        dem = self.path("dem.tif")
        self.succeed("evaluate", self.model, "--cell", "50", "-o", dem)
        tags, _ = read_tiff(dem)
        west, north = tags[33922][3:5]
        self.assertEqual((west % 50, north % 50), (0, 0))
        self.check_heights(dem, 20, 12, west, north, 50)

    def test_nodes_on_bounds_have_the_north_on_top_too(self):
        dem = self.path("dem.tif")
        self.succeed("evaluate", self.model, "--grid", "9,5", "--bounds", "500100:500900,4650100:4650500", "-o", dem)
        tags, _ = read_tiff(dem)
        self.assertEqual(tags[33922][3:5], (500050, 4650550))
        self.check_heights(dem, 9, 5, 500050, 4650550, 100)

    def test_like_our_own_raster_gives_the_same(self):
        first, second = self.path("a.tif"), self.path("b.tif")
        self.succeed("evaluate", self.model, "--cell", "40", "--crs", "EPSG:32633", "-o", first)
        self.succeed("evaluate", self.model, "--like", first, "-o", second)
        self.assertEqual(read_tiff(first), read_tiff(second))
        run = self.succeed("info", second)
        self.assertIn("on a map: EPSG:32633", run.stdout)

    def test_gdal_finds_the_raster_in_its_place(self):
        dem = self.path("dem.tif")
        self.succeed("evaluate", self.model, "--cell", "30", "--extent", "500010,4650010,500970,4650580", "--crs", "EPSG:32633", "-o", dem)
        os.remove(self.path("dem.tfw"))
        told = json.loads(self.gdal("gdalinfo", "-json", "-stats", dem))
        self.assertEqual(told["geoTransform"], [500010, 30, 0, 4650580, 0, -30])
        self.assertIn("UTM zone 33N", told["coordinateSystem"]["wkt"])
        self.assertEqual(told["bands"][0]["type"], "Float32")
        x, y = 500010 + 30 * 10.5, 4650580 - 30 * 4.5
        value = float(self.gdal("gdallocationinfo", "-geoloc", "-valonly", dem, str(x), str(y)))
        self.assertAlmostEqual(value, height(x, y), delta=0.02)

    def test_maps_in_other_formats(self):
        if not self.has_gdal():
            self.skipTest("built without GDAL")
        for name in ("dem.asc", "dem.nc"):
            self.succeed("evaluate", self.model, "--cell", "30", "--extent", "500010,4650010,500970,4650580", "--crs", "EPSG:32633",
                         "-o", self.path(name))
            told = json.loads(self.gdal("gdalinfo", "-json", self.path(name)))
            self.assertEqual(told["geoTransform"], [500010, 30, 0, 4650580, 0, -30], name)
            run = self.succeed("fit", self.path(name), "-o", self.path("again.csrbf"), "--report", self.path("report.json"))
            self.assertIn("on a map: EPSG:32633", run.stdout)
            self.assertEqual(self.report()["input"]["samples"], 32 * 19)

    def test_variables_of_netcdf_have_the_names_of_the_values(self):
        if not self.has_gdal():
            self.skipTest("built without GDAL")
        name = self.path("dem.nc")
        self.succeed("evaluate", self.model, "--cell", "50", "-o", name)
        with open(name, "rb") as file:
            content = file.read()
        self.assertIn(struct.pack(">I", len("height")) + b"height", content)
        self.assertNotIn(b"Band1", content)
        self.assertNotIn(b"writing", content)
        self.succeed("evaluate", self.model, "--cell", "50", "-o", name, "--gradient")
        with open(name, "rb") as file:
            content = file.read()
        for column in (b"height1", b"height_x2", b"height_y3"):
            self.assertIn(struct.pack(">I", len(column)) + column, content)
        self.succeed("evaluate", self.model, "--cell", "50", "-o", self.path("dem.asc"))
        self.assertEqual([f for f in os.listdir(self.path("")) if f.startswith("dem.asc.")], [])

    def test_points_on_maps_are_samples_and_results(self):
        if not self.has_gdal():
            self.skipTest("built without GDAL")
        places = self.write("places.csv", csv(samples(30, seed=9), "x,y,nothing"))
        model = self.path("again.csrbf")
        for name in ("p.gpkg", "p.shp", "p.fgb"):
            self.succeed("evaluate", self.model, "--points", places, "-o", self.path(name), "--crs", "EPSG:32633")
            run = self.succeed("fit", self.path(name), "-o", model)
            self.assertIn("coordinates: x, y; value: height; on a map: EPSG:32633", run.stdout)
            self.assertIn("EPSG:32633", self.succeed("info", self.path(name)).stdout)
        # The model knows where it is.
        self.succeed("evaluate", model, "--cell", "100", "-o", self.path("dem.tif"))
        self.assertEqual(read_tiff(self.path("dem.tif"))[0][34735][-1], 32633)
        self.fail_with(2, "--crs EPSG:32634: the samples are in EPSG:32633", "evaluate", model, "--cell", "100", "-o",
                       self.path("dem.tif"), "--crs", "EPSG:32634")

    def test_a_full_disk_is_an_error_in_every_format_and_leaves_no_file(self):
        if not self.has_gdal() or os.name != "posix":
            self.skipTest("built without GDAL, or without limits of files")
        places = self.write("places.csv", csv(samples(1000, seed=9), "x,y,nothing"))

        def limit():  # of the size of files: writing more fails, as on a full disk
            import resource
            import signal
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (12288, 12288))

        for name in ("a.nc", "a.asc", "a.tif", "a.geojson", "a.fgb", "a.gpkg", "a.shp", "a.csv"):
            where = ("--cell", "10") if name in ("a.nc", "a.asc", "a.tif") else ("--points", places)
            run = subprocess.run([command_line_test.PROGRAM, "evaluate", self.model, *where, "-o", self.path(name)],
                                 capture_output=True, text=True, timeout=60, preexec_fn=limit)
            self.assertEqual(run.returncode, 1, name + ": " + run.stdout + run.stderr)
            self.assertLess(len(run.stderr.splitlines()[-1]), 400, run.stderr)
            self.assertIn(name + ": ", run.stderr.splitlines()[-1])
            self.assertEqual([f for f in os.listdir(self.path("")) if f.startswith("a.")], [], name)

    def test_wrong_flags_are_named(self):
        out = self.path("dem.tif")
        for message, *flags in (("--cell 0: expected a positive size", "--cell", "0"),
                                ("--cell and numbers of --grid exclude", "--cell", "30", "--grid", "5,5"),
                                ("--bounds, of the nodes, and --extent", "--grid", "5", "--bounds", "0:1,0:1", "--extent", "0,0,1,1"),
                                ("expected 4 numbers", "--cell", "30", "--extent", "0,1"),
                                ("the lower corner, with the smaller numbers", "--cell", "30", "--extent", "0,5,10,1"),
                                ("give a larger size", "--cell", "1e-9")):
            self.fail_with(2, message, "evaluate", self.model, "-o", out, *flags)
        self.fail_with(2, "cannot hold a reference system", "evaluate", self.model, "--cell", "30", "--crs", "EPSG:32633", "-o", self.path("a.npy"))
        self.fail_with(2, 'reference system "EPSG:99999"', "evaluate", self.model, "--cell", "30", "--crs", "99999", "-o", out)
        self.fail_with(1, "not enough memory for 64,000,000,000,000 nodes, 8000000 x 8000000; give a larger --cell",
                       "evaluate", self.model, "--grid", "8000000", "-o", self.path("a.nrrd"))
        self.fail_with(2, "UTM33", "evaluate", self.model, "--cell", "30", "--crs", "UTM33", "-o", out)

    def test_a_number_is_an_epsg_code(self):
        for crs in ("32633", "epsg:32633"):
            done = self.succeed("evaluate", self.model, "--cell", "50", "--crs", crs, "-o", self.path("dem.tif"), "--report", self.path("report.json"))
            self.assertEqual(self.report()["options"]["crs"], "EPSG:32633")
            self.assertIn(32633, read_tiff(self.path("dem.tif"))[0][34735])

    def test_a_map_is_not_transposed(self):
        out = self.path("dem.tif")
        for head in ("northing,easting,height", "y,x,height"):
            turned = self.path("turned.csrbf")
            self.succeed("fit", self.write("turned.csv", csv([(y, x, z) for x, y, z in samples()], head)), "-o", turned)
            names = head.split(",")
            message = "first axis, which is %s in the model; fit with --coordinates %s,%s" % (names[0], names[1], names[0])
            self.fail_with(2, message, "evaluate", turned, "--cell", "20", "-o", out)
            self.succeed("evaluate", turned, "--grid", "5", "-o", self.path("values.npy"))
        places = [(60 * random.Random(i).random(), i, 0.1 * i) for i in range(100)]
        globe = self.write("globe.csv", csv(places, "phi,lambda,warmth"))
        self.succeed("fit", globe, "--sphere", "lambda,phi", "-o", turned)
        self.fail_with(2, "fit with --coordinates lambda,phi", "evaluate", turned, "--cell", "5", "-o", out)
        self.succeed("fit", globe, "--coordinates", "lambda,phi", "--sphere", "lambda,phi", "-o", turned)
        self.succeed("evaluate", turned, "--cell", "5", "-o", out)

    def test_degrees_in_either_order_are_told(self):
        places = [(60 * random.Random(i).random(), i, 0.1 * i) for i in range(100)]
        done = self.succeed("fit", self.write("globe.csv", csv(places, "lat,lon,warmth")), "-o", self.path("a.csrbf"))
        self.assertIn("degrees of longitude and latitude", done.stderr)

    def test_an_extent_in_the_order_of_other_programs_is_refused(self):
        out = self.path("dem.tif")
        for extent in ("500000,501000,4650000,4650600", "1,2,0,3"):
            model = self.model
            if extent.startswith("1"):
                model = self.path("small.csrbf")
                rows = [(1 + x / 10, y / 10, x * y) for x in range(10) for y in range(30)]
                self.succeed("fit", self.write("small.csv", csv(rows)), "-o", model)
            self.fail_with(2, "the order is XMIN,YMIN,XMAX,YMAX", "evaluate", model, "--cell", "1000000", "--extent", extent, "-o", out)
        self.succeed("evaluate", self.model, "--cell", "100", "--extent", "499000,4649000,502000,4652000", "-o", out)

    def test_a_map_of_the_covariate_is_evaluated_like(self):
        rows = [(x, y, z, 15 + x / 1e4 - 0.006 * z) for x, y, z in samples()]
        table = "x,y,elevation,warmth\n" + "".join("%.9g,%.9g,%.9g,%.12g\n" % row for row in rows)
        dem, out, model = self.path("dem.tif"), self.path("warmth.tif"), self.path("warmth.csrbf")
        self.succeed("evaluate", self.model, "--cell", "50", "-o", dem)
        self.succeed("fit", self.write("stations.csv", table), "--coordinates", "x,y", "--drift", "elevation", "-o", model)
        done = self.succeed("evaluate", model, "--like", dem, "-o", out)
        self.assertIn("elevation: the values of " + dem, done.stdout)
        for flags in (("--cell", "50"), ("--grid", "5"), ("--extent", "0,0,0,1,1,1")):
            self.fail_with(2, flags[0] + ": a grid does not tell the elevation of its nodes, a covariate of the model; "
                           "give --points with the columns x, y, elevation, or --like with an image of it",
                           "evaluate", model, *flags, "-o", self.path("bad.tif"))
        self.fail_with(2, "--levels: contour lines are those of one value over two variables", "evaluate", model,
                       "--levels", "15", "-o", self.path("bad.csv"))
        self.succeed("fit", self.path("stations.csv"), "--coordinates", "x", "--drift", "elevation", "-o", model)
        self.fail_with(2, "elevation is a covariate of the model", "evaluate", model, "--levels", "-o", self.path("bad.csv"))
        tags, heights = read_tiff(dem)
        west = tags[33922][3]
        for i, (height, warmth) in enumerate(zip(heights, read_tiff(out)[1])):
            x = west + 50 * (i % tags[256][0] + 0.5)
            self.assertAlmostEqual(warmth, 15 + x / 1e4 - 0.006 * height, delta=0.01)
        self.succeed("fit", self.write("stations.csv", table), "--coordinates", "x", "--values", "warmth", "--drift", "y,elevation", "-o", model)
        self.fail_with(2, "does not tell the elevation of its pixels", "evaluate", model, "--like", dem, "-o", out)
        rows = [row[:3] + (row[0] % 7,) + row[3:] for row in rows]
        table = "x,y,elevation,slope,warmth\n" + "".join("%.9g,%.9g,%.9g,%.9g,%.12g\n" % row for row in rows)
        self.succeed("fit", self.write("two.csv", table), "--coordinates", "x,y", "--drift", "elevation,slope", "-o", model)
        self.fail_with(2, "2 covariates besides the coordinates, an image tells one at most; give --points with the "
                       "columns x, y, elevation, slope", "evaluate", model, "--like", dem, "-o", out)

    def test_grid_alone_works_and_so_do_surfaces(self):
        self.succeed("evaluate", self.model, "--grid", "-o", self.path("a.npy"))
        cloud = self.write("cloud.xyz", command_line_test.xyz(command_line_test.sphere(300)))
        surface = self.path("ball.csrbf")
        self.succeed("reconstruct", cloud, "-o", self.path("ball.ply"), "--model", surface, "--resolution", "16")
        places = self.write("places.csv", "x,y,z\n0,0,0\n2,0,0\n")
        self.succeed("evaluate", surface, "-o", self.path("values.csv"), "--points", places)
        with open(self.path("values.csv")) as file:
            lines = file.read().split("\n")
        self.assertEqual(lines[0], "x,y,z,field")
        self.assertGreater(float(lines[1].split(",")[3]), 0, "inside")
        self.assertLess(float(lines[2].split(",")[3]), 0, "outside")
        self.succeed("evaluate", surface, "-o", self.path("field.nii.gz"), "--grid", "20")
        self.assertIn("20 x 20 x 20", self.succeed("info", self.path("field.nii.gz")).stdout)


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
