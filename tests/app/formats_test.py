"""Files of the field, through the real program: points of scanners, pictures, meshes for printers, pipes and names without
an extension; and what the program says about them.

usage: formats_test.py PROGRAM [unittest options]
"""

import ctypes
import gzip
import math
import os
import random
import re
import struct
import subprocess
import sys
import threading
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import OCTAHEDRON, CommandLine, ply, sphere, xyz
from fit_test import npy_bytes

GROUND, VEGETATION = 2, 5


def las(points, offset, scale=0.001, point_format=1):
    """A file of version 1.2: (x, y, z, class, return number, number of returns)."""
    size = {0: 20, 1: 28}[point_format]
    head = bytearray(227)
    head[:4] = b"LASF"
    head[24:26] = bytes([1, 2])
    struct.pack_into("<HII", head, 94, 227, 227, 0)
    struct.pack_into("<BHI", head, 104, point_format, size, len(points))
    struct.pack_into("<6d", head, 131, *[scale] * 3, *offset)
    records = b""
    for x, y, z, kind, number, count in points:
        place = [round((c - o) / scale) for c, o in zip((x, y, z), offset)]
        record = struct.pack("<3iHBBbBH", *place, 100, number | count << 3, kind, 0, 0, 7)
        records += record + (struct.pack("<d", 1.5) if point_format == 1 else b"")
    return bytes(head) + records


def hill(x, y):
    """Metres above the sea, on a map."""
    return 100 + 5 * math.sin((x - 500000) / 30) * math.cos((y - 4650000) / 40)


def tile(n=1500, seed=3):
    """Ground with some trees above it, as points of a scanner from the air, in UTM coordinates."""
    source = random.Random(seed)
    points = []
    for _ in range(n):
        x, y = 500000 + 200 * source.random(), 4650000 + 200 * source.random()
        z = hill(x, y)
        if source.random() < 0.3:
            points.append((x, y, z + 5 + 10 * source.random(), VEGETATION, 1, 2))
            points.append((x, y, z, GROUND, 2, 2))
        else:
            points.append((x, y, z, GROUND, 1, 1))
    return points


class Formats(CommandLine):
    def write_bytes(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)


class Scanners(Formats):
    def test_the_ground_of_a_las_tile_becomes_a_function(self):
        path = self.write_bytes("tile.las", las(tile(), (500000, 4650000, 0)))
        run = self.succeed("fit", path, "-o", self.path("dem.csrbf"), "--class", "2", "--report", self.path("report.json"))
        self.assertIn("coordinates: x, y; value: z", run.stdout)
        self.assertEqual(self.report()["result"]["samples"], 1500)
        self.assertEqual(self.report()["options"]["class"], "2")
        places = self.write("places.csv", "x,y\n500100,4650100\n500050.5,4650020.25\n")
        self.succeed("evaluate", self.path("dem.csrbf"), "-o", self.path("values.csv"), "--points", places)
        with open(self.path("values.csv")) as file:
            rows = [[float(c) for c in line.split(",")] for line in file.read().split("\n")[1:3]]
        for x, y, z in rows:
            self.assertAlmostEqual(z, hill(x, y), delta=0.1)

    def test_last_returns_are_the_ground_too(self):
        points = tile()
        path = self.write_bytes("tile.las", las(points, (500000, 4650000, 0)))
        trees = sum(kind == VEGETATION for _, _, _, kind, _, _ in points)
        for flag, count in (("--returns=last", 1500), ("--returns=only", 1500 - trees), ("--class=5", trees)):
            self.succeed("fit", path, "-o", self.path("f.csrbf"), flag, "--report", self.path("report.json"))
            self.assertEqual(self.report()["input"]["samples"], count, flag)

    def test_classes_that_are_not_there_are_named(self):
        path = self.write_bytes("tile.las", las(tile(20), (500000, 4650000, 0)))
        self.fail_with(2, "no point has class 6; the classes are 2, 5", "reconstruct", path, "-o", self.path("a.ply"), "--class", "6")
        self.fail_with(2, "--class 2.5: classes are whole numbers", "fit", path, "-o", self.path("a.csrbf"), "--class", "2.5")
        cloud = self.write("cloud.xyz", xyz(sphere(50)))
        self.fail_with(2, "the points have no property classification", "reconstruct", cloud, "-o", self.path("a.ply"), "--class", "2")

    def test_map_coordinates_of_a_scan_keep_their_digits(self):
        """A sphere of 20 m at UTM coordinates: the mesh is as near to it as one at the origin."""
        center = (500123.25, 4650456.5, 80)
        points = [tuple(20 * p + c for p, c in zip(q, center)) + (2, 1, 1) for q in sphere(2000)]
        path = self.write_bytes("ball.las", las(points, (500000, 4650000, 0)))
        self.succeed("reconstruct", path, "-o", self.path("ball.ply"), "--resolution", "40", "--report", self.path("report.json"))
        self.assertTrue(self.report()["result"]["watertight"])
        with open(self.path("ball.ply"), "rb") as file:
            data = file.read()
        self.assertIn(b"property double x", data)
        begin = data.index(b"end_header\n") + 11
        stride = sum({"double": 8, "float": 4, "uchar": 1, "ushort": 2}[t] for t in
                     re.findall(r"property (double|float|uchar|ushort) ", data[:begin].decode()))
        for i in range(0, self.report()["result"]["vertices"], 97):
            v = struct.unpack_from("<3d", data, begin + i * stride)
            self.assertAlmostEqual(math.dist(v, center), 20, delta=0.02)

    def test_ptx_and_stl_are_points_too(self):
        rows = "".join("%.6f %.6f %.6f 0.5\n" % p for p in sphere(600))
        scan = self.write("scan.ptx", "30\n20\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n10 20 30 1\n" + rows)
        self.succeed("reconstruct", scan, "-o", self.path("a.stl"), "--resolution", "20")
        self.succeed("reconstruct", self.path("a.stl"), "-o", self.path("b.ply"), "--resolution", "20")
        run = self.succeed("info", self.path("b.ply"))
        self.assertIn("watertight", run.stdout)

    def test_what_needs_a_library_says_what_to_do(self):
        head = bytearray(las([(0, 0, 0, 2, 1, 1)], (0, 0, 0)))
        head[104] |= 0x80
        version = self.succeed("--version", "--verbose").stdout
        for name, content, library in (("a.laz", bytes(head), "laz-perf or LASzip"), ("a.e57", b"ASTM-E57", "libE57Format")):
            if "without " + library in version:
                self.fail_with(2, "convert", "reconstruct", self.write_bytes(name, content), "-o", self.path("a.ply"))
            else:
                self.fail_with(2, "cannot be read", "reconstruct", self.write_bytes(name, content), "-o", self.path("a.ply"))


class Names(Formats):
    """Files whose names do not say what they are."""

    def test_files_without_an_extension_are_known_by_their_content(self):
        cloud = self.write("cloud", ply(sphere(400)))
        run = self.succeed("reconstruct", cloud, "-o", self.path("a.ply"), "--resolution", "20")
        self.assertIn("400 points", run.stdout)
        self.assertIn("cloud:", self.succeed("info", cloud).stdout)
        table = self.write("table", "x,y,depth\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n")
        self.succeed("fit", table, "-o", self.path("a.csrbf"))
        self.assertIn("csrbf fit takes x, y", self.succeed("info", table).stdout)
        image = self.write_bytes("image", b"P5\n4 4\n255\n" + bytes(range(16)))
        self.assertIn("4 x 4", self.succeed("info", image).stdout)

    def test_pipes_are_read(self):
        pipe = self.path("pipe")
        os.mkfifo(pipe)

        def feed(content):
            with open(pipe, "wb") as file:
                file.write(content)

        for content in (ply(sphere(400)).encode(), xyz(sphere(400)).encode()):
            writer = threading.Thread(target=feed, args=(content,))
            writer.start()
            self.succeed("reconstruct", pipe, "-o", self.path("a.ply"), "--resolution", "16")
            writer.join()
        writer = threading.Thread(target=feed, args=(b"x,y,v\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n",))
        writer.start()
        self.succeed("fit", pipe, "-o", self.path("a.csrbf"))
        writer.join()

    def test_format_says_it(self):
        cloud = self.write("cloud.dat2", ply(sphere(400)))
        self.fail_with(2, 'unknown extension ".dat2"', "reconstruct", cloud, "-o", self.path("a.ply"))
        self.succeed("reconstruct", cloud, "-o", self.path("a"), "--resolution", "16", "--format", "ply")
        with open(self.path("a"), "rb") as file:
            self.assertEqual(file.read(4), b"ply\n")
        run = subprocess.run([command_line_test.PROGRAM, "info", "-", "--format", "off"], input=OCTAHEDRON, text=True,
                             capture_output=True, timeout=60)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("8 triangles", run.stdout)


class Told(Formats):
    """What was used, and what may be wrong with it."""

    def fit(self, text, *flags):
        return self.succeed("fit", self.write("samples.csv", text), "-o", self.path("a.csrbf"), *flags)

    def rows(self, form, n=30):
        source = random.Random(1)
        return "".join(form % {"i": i + 1, "x": source.random(), "y": source.random()} for i in range(n))

    def test_columns_that_are_used_are_always_told(self):
        run = self.fit("x,y,depth,quality\n" + self.rows("%(x)f,%(y)f,%(x)f,1\n"), "--values", "depth", "--weights", "quality")
        self.assertIn("coordinates: x, y; value: depth; weights: quality", run.stdout)
        run = self.fit(self.rows("%(x)f %(y)f %(x)f\n"))
        self.assertIn("coordinates: x, y; value: value", run.stdout)

    def test_a_column_that_numbers_the_rows_is_suspected(self):
        run = self.fit("id,x,y,depth\n" + self.rows("%(i)d,%(x)f,%(y)f,%(x)f\n"))
        self.assertIn("the column id only numbers the rows, it seems", run.stderr)
        run = self.fit("station,x,y,depth\n" + self.rows("%(i)d,%(x)f,%(y)f,%(x)f\n"))
        self.assertIn("the column station only numbers the rows", run.stderr)
        run = self.fit("x,y,depth,fid\n" + self.rows("%(x)f,%(y)f,%(x)f,%(i)d\n"))
        self.assertIn("the column fid only numbers the rows", run.stderr)
        run = self.fit("id,x,y,depth\n" + self.rows("%(i)d,%(x)f,%(y)f,%(x)f\n"), "--coordinates", "x,y")
        self.assertNotIn("numbers the rows", run.stderr)
        run = self.fit("time,depth\n" + self.rows("%(i)d,%(x)f\n"))
        self.assertNotIn("numbers the rows", run.stderr, "the only coordinate may be a number")

    def test_a_column_without_a_name_that_counts_the_rows_is_left_out(self):
        row = "%(x)f,%(y)f,%(x)f\n"
        for head, number in ((",x,y,depth\n", "%(i)d,"), ('"","x","y","depth"\n', '"%(i)d",'), ("Unnamed: 0,x,y,depth\n", "%(i)d,")):
            run = self.fit(head + self.rows(number + row))
            self.assertIn("coordinates: x, y; value: depth", run.stdout)
            self.assertIn("has no name of its own and only counts the rows: left out; --coordinates takes it", run.stderr)
        text = ",x,y,depth\n" + self.rows("%(i)d," + row)
        self.assertIn("csrbf fit takes x, y for", self.succeed("info", self.path("samples.csv")).stdout)
        run = self.fit(text, "--memory", "1GB")
        self.assertIn("coordinates: x, y; value: depth", run.stdout)
        self.assertIn('"column 1" has no name', run.stderr)
        for columns in ("1,x,y", "column 1,x,y"):
            run = self.fit(text, "--coordinates", columns)
            self.assertIn("coordinates: column 1, x, y; value: depth", run.stdout)
            self.assertNotIn("left out", run.stderr)
        run = self.fit(",depth\n" + self.rows("%(i)d,%(x)f\n"))
        self.assertIn("coordinates: column 1; value: depth", run.stdout, "the only coordinate may be a number")
        run = self.fit(",x,depth\n" + self.rows(row))
        self.assertIn("coordinates: column 1, x; value: depth", run.stdout, "it does not count")
        self.assertNotIn("column 1", run.stderr)
        run = self.fit(",x,y,depth\n" + self.rows("3%(i)d," + row))
        self.assertIn("coordinates: column 1, x, y", run.stdout)
        self.assertIn("the column column 1 only numbers the rows, it seems", run.stderr, "of selected or shuffled rows")

    def test_a_value_with_the_name_of_a_coordinate_is_told(self):
        for head in ("z,x,y", "temp,lat,lon", "temp,z,northing,easting", "lat,lon,temp", "a,b,y"):
            columns = head.split(",")
            run = self.fit(head + "\n" + self.rows(",".join(["%(x)f", "%(y)f", "%(x)f", "%(x)f"][:len(columns)]) + "\n"))
            told = "the value is %s, which has the name of a coordinate; --coordinates" % columns[-1]
            (self.assertNotIn if columns[-1] == "temp" or columns[0] == "a" else self.assertIn)(told, run.stderr)

    def test_places_have_the_names_of_the_coordinates(self):
        self.fit("easting,northing,depth\n" + self.rows("%(x)f,%(y)f,%(x)f\n"))
        model = self.path("a.csrbf")

        def values(head, row):
            run = self.succeed("evaluate", model, "--points", self.write("p.csv", head + row + "\n"), "-o", "-")
            return float(run.stdout.splitlines()[1].split(",")[-1]), run.stderr

        value, _ = values("easting,northing\n", ".25,.75")
        for head, row in (("Northing,Easting\n", ".75,.25"), (",northing,easting\n", "1,.75,.25"), ("", ".25,.75")):
            other, told = values(head, row)
            self.assertEqual(other, value, head)
            self.assertNotIn("in this order", told)
        for head, row in (("a,b\n", ".25,.75"), (",a,b\n", "1,.25,.75")):
            other, told = values(head, row)
            self.assertEqual(other, value, head)
            self.assertIn('the columns "a", "b" were taken for "easting", "northing", in this order', told)
        self.fail_with(2, 'no column is named "northing"; the coordinates are "easting", "northing", the columns are '
                       '"north", "easting"', "evaluate", model, "-o", self.path("v.csv"), "--points",
                       self.write("p.csv", "north,easting\n.75,.25\n"))

    def test_places_beyond_a_pole_are_refused(self):
        self.fit("lon,lat,t\n" + self.rows("%(x)f,%(y)f,%(x)f\n"), "--sphere", "lon,lat")
        for head, code in (("lat,lon\n", 0), ("a,b\n", 2)):
            places = self.write("p.csv", head + ".5,190\n")
            run = self.run_program("evaluate", self.path("a.csrbf"), "--points", places, "-o", "-")
            self.assertEqual(run.returncode, code, run.stderr)
        self.assertIn("the latitude 190 is beyond 90 degrees", run.stderr)

    def test_cells_of_text_say_what_to_do(self):
        for cell, hint in (("S000", "choose the columns with numbers: --coordinates, --values; leave cells without a value "
                                    "empty"),
                           ("2024-03-01", "write dates as numbers, as the days since the first one"),
                           ("1.3.2024 12:30", "write dates as numbers, as the days since the first one"),
                           ("03/01/24", "write dates as numbers, as the days since the first one")):
            text = "name;x;y;depth\n" + self.rows("a;" + cell + ";%(x)f;%(y)f\n")
            self.fail_with(2, '"%s" is not a number (column 2); %s' % (cell, hint), "fit",
                           self.write("s.csv", text), "-o", self.path("m.csrbf"), "--coordinates", "x,y")
        self.fit("x,y,depth\n" + self.rows("%(x)f,%(y)f,%(x)f\n"))
        for head, hint in (("x,y", ""), ("a,b", "; name the columns of the coordinates x, y; leave cells without a value empty")):
            self.fail_with(2, '"S1" is not a number (column 2)' + hint + "\n", "evaluate", self.path("a.csrbf"), "-o",
                           self.path("v.csv"), "--points", self.write("p.csv", head + "\n0,S1\n"))
        image = self.write_bytes("image.pgm", b"P5\n4 4\n255\n" + bytes(range(16)))
        self.fail_with(2, '"S1" is not a number (column 3)\n', "segment", image, "-o", self.path("l.pgm"), "--seeds",
                       self.write("seeds.csv", "x,y,label\n0,0,S1\n"))
        self.fail_with(2, "--grid 10x10: expected 2 whole numbers, the nodes along each axis, or one for all axes, as --grid 100,50",
                       "evaluate", self.path("a.csrbf"), "-o", self.path("v.npy"), "--grid", "10x10")

    def test_tables_of_spreadsheets_with_commas_and_units(self):
        head = "Ort;Rechtswert [m];Hochwert [m];Wasserstand [m]\n"
        text = head + self.rows("a b;%(x)f;%(y)f;%(x)f\n").replace(".", ",")
        run = self.succeed("fit", self.write("s.csv", text), "-o", self.path("a.csrbf"), "--coordinates",
                           "rechtswert,Hochwert", "--values", "Wasserstand")
        self.assertIn("coordinates: Rechtswert [m], Hochwert [m]; value: Wasserstand [m]", run.stdout)
        for places in ("Hochwert,Rechtswert\n.25,.75\n", "Hochwert [m];Rechtswert [m]\n0,25;0,75\n"):
            run = self.succeed("evaluate", self.path("a.csrbf"), "--points", self.write("p.csv", places), "-o", "-")
            names, row = run.stdout.splitlines()
            self.assertEqual(names, "Rechtswert [m],Hochwert [m],Wasserstand [m]")
            self.assertAlmostEqual(float(row.split(",")[2]), 0.75, delta=1e-4)
            self.assertNotIn("were taken for", run.stderr)

    def test_longitude_and_latitude_are_noticed(self):
        run = self.fit("lon,lat,t\n" + self.rows("%(x)f,%(y)f,%(x)f\n"))
        self.assertIn("the coordinates are degrees of longitude and latitude", run.stderr)
        if "--sphere" in self.succeed("fit", "--help").stdout:
            self.assertIn("--sphere", run.stderr)
        self.assertNotIn("longitude", self.fit("x,y,t\n" + self.rows("%(x)f,%(y)f,%(x)f\n")).stderr)

    def test_kernels_have_the_names_of_scipy(self):
        for name, ours in (("thin_plate_spline", "thin-plate"), ("thin-plate-spline", "thin-plate"),
                           ("inverse_multiquadric", "inverse-multiquadric")):
            run = self.fit("x,y,t\n" + self.rows("%(x)f,%(y)f,%(x)f\n"), "--kernel", name, "--method", "interpolate")
            self.assertIn("of " + ours, run.stdout)

    def test_messages_name_flags_and_nothing_inside(self):
        table = self.write("samples.csv", "x,y,t\n" + self.rows("%(x)f,%(y)f,%(x)f\n"))
        cloud = self.write("cloud.xyz", xyz(sphere(100)))
        model = self.path("a.csrbf")
        for message, *arguments in (
                ("csrbf reconstruct: --method bogus: unknown; use auto, composite", "reconstruct", cloud, "-o", self.path("a.ply"), "--method", "bogus"),
                ("csrbf fit: --method bogus: unknown; use one of", "fit", table, "-o", model, "--method", "bogus"),
                ("csrbf fit: --kernel bogus: unknown; use one of", "fit", table, "-o", model, "--kernel", "bogus"),
                ("csrbf fit: --kernel wu-c6: is positive definite only up to dimension 1", "fit", table, "-o", model, "--kernel", "wu-c6")):
            run = self.run_program(*arguments)
            self.assertEqual(run.returncode, 2)
            self.assertTrue(run.stderr.startswith(message), run.stderr)

    def test_every_part_of_the_build_is_told(self):
        text = self.succeed("--version", "--verbose").stdout
        self.assertRegex(text, r"^csrbf \d+\.\d+\.\d+\n")
        for library in ("libjpeg", "laz-perf or LASzip", "libE57Format", "GDCM", "GDAL"):
            self.assertRegex(text, "\n(with|without) %s" % library)

    def test_completion_offers_methods_and_kernels(self):
        text = self.succeed("--print-completion", "bash").stdout
        self.assertRegex(text, r"'fit --method'\) words='auto interpolate ")
        self.assertRegex(text, r"'fit --kernel'\) words='auto .*thin-plate")
        self.assertRegex(text, r"'reconstruct --method'\) words='auto composite .*medial-axis")


class InfoOfEverything(Formats):
    def info(self, path):
        run = self.succeed("info", path, "--report", self.path("info.json"))
        return run.stdout, self.report("info.json")["result"]

    def test_tables(self):
        text, result = self.info(self.write("soundings.csv", "x,y,depth,ship\n0,0,1,a\n1,0,,b\n0,1,3,c\n"))
        self.assertEqual(result["kind"], "table")
        self.assertEqual([c["name"] for c in result["columns"]], ["x", "y", "depth", "ship"])
        self.assertEqual(result["columns"][2], {"name": "depth", "min": 1, "max": 3, "missing": 1})
        self.assertIn("depth: from 1 to 3, 1 missing", text)
        self.assertIn("ship: no numbers", text)
        for name, content in (("a.tsv", "a\tb\n1\t2\n3\t4\n"), ("a.dat", "1 2\n3 4\n"), ("a.xyz", "1 2 3 4\n5 6 7 8\n")):
            self.assertEqual(self.info(self.write(name, content))[1]["kind"], "table", name)
        self.assertEqual(self.info(self.write("b.csv", "x,y,z,nx\n1,2,3,4\n"))[1]["kind"], "points")
        self.assertEqual(self.info(self.write("c.csv", "x,y,z,contour\n0,0,0,1\n1,0,0,1\n0,1,0,1\n"))[1]["kind"], "curves")

    def test_arrays(self):
        for shape, kind in (((400, 3), "points"), ((40, 50), "image"), ((400, 4), "table"), ((5, 6, 7), "image"), ((9,), "image")):
            count = math.prod(shape)
            self.assertEqual(self.info(self.write_bytes("a.npy", npy_bytes(shape, [1.5] * count)))[1]["kind"], kind, shape)

    def test_arrays_and_images_in_gzip(self):
        packed = gzip.compress(npy_bytes((40, 50), [1.5] * 2000))
        self.assertEqual(self.info(self.write_bytes("a.npy.gz", packed))[1]["kind"], "image")
        packed = gzip.compress(b"P5\n4 4\n255\n" + bytes(range(16)))
        self.assertEqual(self.info(self.write_bytes("a.pgm.gz", packed))[1]["size"], [4, 4, 1])

    def test_lines_of_vtk_are_curves(self):
        self.succeed("fit", self.write("s.csv", "x,y,z\n0,0,0\n1,0,1\n0,1,1\n1,1,2\n"), "-o", self.path("a.csrbf"))
        self.succeed("evaluate", self.path("a.csrbf"), "-o", self.path("lines.vtp"), "--levels", "0.5,1.5")
        text, result = self.info(self.path("lines.vtp"))
        self.assertEqual(result["kind"], "curves")
        self.assertEqual(result["points"], result["edges"] + 2)

    def test_models_of_surfaces_tell_their_box(self):
        cloud = self.write("cloud.xyz", xyz(sphere(500)))
        self.succeed("reconstruct", cloud, "-o", self.path("m.ply"), "--model", self.path("m.csrbf"), "--resolution", "9")
        text, result = self.info(self.path("m.csrbf"))
        self.assertIn("bounds:      -", text)
        self.assertNotIn("alpha", text)
        self.assertGreater(result["bounds"]["diagonal"], 3)

    def test_patient_coordinates_are_told(self):
        head = b"ObjectType = Image\nNDims = 3\nDimSize = 8 8 8\nAnatomicalOrientation = RAI\nElementType = MET_UCHAR\n"
        ball = bytes(200 if math.dist((x, y, z), (4, 4, 4)) < 2.5 else 0 for z in range(8) for y in range(8) for x in range(8))
        image = self.write_bytes("a.mha", head + b"ElementDataFile = LOCAL\n" + ball)
        text, result = self.info(image)
        self.assertEqual(result["space"], "LPS")
        self.assertRegex(text, "spacing: .*, in LPS\n")
        self.succeed("segment", image, "-o", self.path("labels.mha"), "--contour", self.path("a.ply"))
        text, result = self.info(self.path("a.ply"))
        self.assertEqual(result["space"], "LPS")
        self.assertRegex(text, "bounds: .*, in LPS\n")
        self.assertIsNone(self.info(self.write("b.xyz", "0 0 0\n1 0 0\n0 1 0\n"))[1]["space"])

    def test_a_cloud_without_points_has_no_bounds(self):
        empty = las([], (0, 0, 0))
        text, result = self.info(self.write_bytes("none.las", empty))
        self.assertIn("0 points", text)
        self.assertIsNone(result["bounds"])

    def test_points_of_scanners_and_pictures(self):
        self.assertEqual(self.info(self.write_bytes("a.las", las(tile(9), (500000, 4650000, 0))))[1]["kind"], "points")
        bmp = b"BM" + struct.pack("<IIIIiiHHIIIIII", 70, 0, 54, 40, 2, 2, 1, 24, 0, 16, 0, 0, 0, 0) + bytes(16)
        self.assertEqual(self.info(self.write_bytes("a.bmp", bmp))[1]["kind"], "image")


class Printers(Formats):
    def test_3mf_is_a_package_with_a_closed_mesh_and_colours(self):
        cloud = self.write("cloud.ply", ply(sphere(400), colored=True))
        self.succeed("reconstruct", cloud, "-o", self.path("a.3mf"), "--resolution", "16")
        with zipfile.ZipFile(self.path("a.3mf")) as package:
            self.assertIsNone(package.testzip())
            self.assertEqual(package.namelist(), ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"])
            for name in package.namelist():
                ElementTree.fromstring(package.read(name))
            model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
        core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
        material = "{http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"
        vertices = list(model.iter(core + "vertex"))
        triangles = [[int(t.get(v)) for v in ("v1", "v2", "v3")] for t in model.iter(core + "triangle")]
        edges = {}
        for a, b, c in triangles:
            for edge in ((a, b), (b, c), (c, a)):
                edges[edge] = edges.get(edge, 0) + 1
        self.assertTrue(all(edges[a, b] == 1 and edges.get((b, a)) == 1 for a, b in edges), "closed and oriented")
        self.assertEqual(len(vertices) - len(edges) // 2 + len(triangles), 2)
        colors = [c.get("color") for c in model.iter(material + "color")]
        self.assertTrue({"#FF0000FF", "#0000FFFF"} <= set(colors))
        for triangle in model.iter(core + "triangle"):
            for corner in ("p1", "p2", "p3"):
                self.assertLess(int(triangle.get(corner)), len(colors))
        self.fail_with(2, ".3mf is only written", "compare", self.path("a.3mf"), cloud)

    def test_lib3mf_reads_it_strictly(self):
        try:
            library = ctypes.CDLL("lib3MF.so.1")
        except OSError:
            self.skipTest("lib3mf is not installed")
        cloud = self.write("cloud.ply", ply(sphere(400), colored=True))
        self.succeed("reconstruct", cloud, "-o", self.path("a.3mf"), "--resolution", "16", "--report", self.path("report.json"))

        def call(name, *arguments):
            self.assertEqual(getattr(library, "lib3mf_" + name)(*arguments), 0, name)

        model, reader, meshes, mesh = (ctypes.c_void_p() for _ in range(4))
        found, warnings, vertices, triangles = ctypes.c_int(), ctypes.c_uint32(), ctypes.c_uint32(), ctypes.c_uint32()
        call("createmodel", ctypes.byref(model))
        call("model_queryreader", model, b"3mf", ctypes.byref(reader))
        call("reader_setstrictmodeactive", reader, ctypes.c_int(1))
        call("reader_readfromfileutf8", reader, self.path("a.3mf").encode())
        call("reader_getwarningcount", reader, ctypes.byref(warnings))
        self.assertEqual(warnings.value, 0)
        call("model_getmeshobjects", model, ctypes.byref(meshes))
        call("resourceiterator_movenext", meshes, ctypes.byref(found))
        self.assertTrue(found.value)
        call("resourceiterator_getcurrent", meshes, ctypes.byref(mesh))
        call("meshobject_getvertexcount", mesh, ctypes.byref(vertices))
        call("meshobject_gettrianglecount", mesh, ctypes.byref(triangles))
        result = self.report()["result"]
        self.assertEqual((vertices.value, triangles.value), (result["vertices"], result["triangles"]))

    def test_obj_refers_to_no_other_file(self):
        cloud = self.write("cloud.ply", ply(sphere(400), colored=True))
        self.succeed("reconstruct", cloud, "-o", self.path("a.obj"), "--resolution", "16")
        with open(self.path("a.obj")) as file:
            text = file.read()
        self.assertNotIn("mtllib", text)
        self.assertNotIn("usemtl", text)


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
