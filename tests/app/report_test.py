"""Reads the reports in HTML that the real program writes: form, contents, and that nothing is loaded from elsewhere.

usage: report_test.py PROGRAM [unittest options]
"""

import base64
import json
import math
import os
import re
import struct
import sys
import unittest
import xml.etree.ElementTree as xml
from html.parser import HTMLParser

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from command_line_test import CommandLine, OCTAHEDRON, ply, sphere, xyz
from fit_test import csv, npy_bytes, rows_of, wave

EMPTY = {"meta", "img", "br", "input", "link", "rect", "path", "image"}  # elements without an end tag
LARGEST_PAGE = 10e6  # bytes


class Document(HTMLParser):
    """Checks that elements are closed in order, and keeps what the tests look at."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.elements, self.ids, self.text, self.scripts = [], [], [], [], []
        self.feed(text.replace("<wbr>", ""))  # where lines may break; belongs to no word
        self.close()
        assert not self.open, "not closed: %s" % self.open

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.elements.append((tag, attributes))
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "script":
            self.scripts.append([attributes, ""])
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, "</%s> closes %s" % (tag, self.open[-1:])
        self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1] == "script":
            self.scripts[-1][1] += data
        elif not (self.open and self.open[-1] == "style"):
            self.text.append(data)

    def words(self):
        return " ".join(" ".join(self.text).split())

    def script(self, **attributes):
        """The text of the only script with these attributes, None when there is none."""
        found = [body for given, body in self.scripts if all(given.get(k) == v for k, v in attributes.items())]
        assert len(found) < 2
        return found[0] if found else None


def numbers(text, code):
    data = base64.b64decode(text, validate=True)
    return struct.unpack("<%d%s" % (len(data) // struct.calcsize(code), code), data)


class Reports(CommandLine):
    def write_bytes(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def page(self, *arguments):
        """Runs the program with both reports; the page, and what it holds."""
        self.succeed(*arguments, "--report", self.path("report.json"), "--report", self.path("report.html"))
        with open(self.path("report.html"), encoding="utf-8") as file:
            text = file.read()
        document = Document(text)
        self.check_page(text, document, self.report())
        return text, document

    def check_page(self, text, document, report):
        self.assertLess(len(text), LARGEST_PAGE)
        self.assertEqual(len(document.ids), len(set(document.ids)))
        self.assertEqual(json.loads(document.script(id="report")), report)
        for name in ("options", "time-and-memory", "command"):
            if report["options"] or name != "options":
                self.assertIn(name, document.ids)
        for option in report["options"]:
            self.assertIn(option.replace("_", " "), document.words())
        for warning in report["warnings"]:
            self.assertIn(" ".join(warning.split()), document.words())
        for svg in re.findall(r"<svg.*?</svg>", text, re.S):
            xml.fromstring(svg)
        self.check_nothing_is_loaded(text, document)

    def check_nothing_is_loaded(self, text, document):
        policies = [a["content"] for tag, a in document.elements if a.get("http-equiv") == "Content-Security-Policy"]
        self.assertEqual(len(policies), 1)
        self.assertIn("default-src 'none'", policies[0])
        self.assertNotIn("http", policies[0])
        for tag, attributes in document.elements:
            self.assertNotIn(tag, ("link", "iframe", "object", "embed", "base", "form"))
            for name in ("src", "href", "xlink:href", "srcset", "data", "action", "poster"):
                if name in attributes:
                    self.assertTrue(attributes[name].startswith("data:image/png;base64,"), attributes[name][:80])
        style = re.search(r"<style>(.*?)</style>", text, re.S).group(1)
        self.assertNotRegex(style, r"@import|url\(|http")

    def surface(self, document):
        """The data of the view: vertices, triangles and the rest; None when the program has no view."""
        body = document.script(**{"class": "surface-data"})
        if body is None:
            self.assertIn("built without three.js", document.words())
            return None
        data = json.loads(body)
        places = numbers(data["positions"], "H")
        sides = [high - low for low, high in zip(data["low"], data["high"])]
        vertices = [tuple(data["low"][a] + sides[a] * places[i + a] / 65535 for a in range(3))
                    for i in range(0, len(places), 3)]
        corners = numbers(data["triangles"], "H")
        self.assertEqual(len(corners) % 3, 0)
        self.assertLess(max(corners), len(vertices))
        self.assertEqual(len(numbers(data["normals"], "b")), 3 * len(vertices))
        for scale in data["scales"]:
            self.assertEqual(len(numbers(scale["values"], "B")), len(vertices))
            if "point_values" in scale:
                self.assertEqual(3 * len(numbers(scale["point_values"], "B")),
                                 len(numbers(data["points"]["positions"], "H")))
        return {**data, "vertices": vertices, "corners": corners}


class Commands(Reports):
    def test_reconstruct_shows_the_surface_and_the_distances(self):
        cloud = self.write("cloud.xyz", xyz(sphere(600)))
        text, document = self.page("reconstruct", cloud, "-o", self.path("mesh.ply"), "--resolution", "40")
        report = self.report()
        self.assertIn("600", document.words())
        self.assertIn("Distance of the points to the surface", document.words())
        self.assertIn("The function on three planes", document.words())
        self.assertGreaterEqual(text.count("<svg"), 4)
        data = self.surface(document)
        if data:
            self.assertEqual(len(data["vertices"]), report["result"]["vertices"])
            self.assertEqual(len(data["corners"]), 3 * report["result"]["triangles"])
            for vertex in data["vertices"]:
                self.assertAlmostEqual(math.hypot(*vertex), 1, delta=0.01)
            normals = numbers(data["normals"], "b")
            for i, vertex in enumerate(data["vertices"]):
                outward = sum(a * b for a, b in zip(vertex, normals[3 * i:3 * i + 3]))
                self.assertGreater(outward, 120)
            self.assertEqual([scale["name"] for scale in data["scales"]], ["distance of the points", "mean curvature"])
            curvature = data["scales"][1]  # times the diagonal: 2 sqrt(3) everywhere
            values = sorted(curvature["lo"] + (curvature["hi"] - curvature["lo"]) * byte / 254
                            for byte in numbers(curvature["values"], "B"))
            for share in (0.1, 0.5, 0.9):
                self.assertAlmostEqual(values[int(share * len(values))], 2 * math.sqrt(3), delta=0.15)
            self.assertEqual(len(numbers(data["points"]["positions"], "H")), 3 * 600)

    def test_large_surfaces_are_shown_with_fewer_triangles(self):
        cloud = self.write("cloud.ply", ply(sphere(600)))
        text, document = self.page("reconstruct", cloud, "-o", self.path("mesh.ply"), "--resolution", "170")
        self.assertGreater(self.report()["result"]["vertices"], 65536)
        data = self.surface(document)
        if data:
            self.assertLessEqual(len(data["vertices"]), 65536)
            self.assertGreater(len(data["vertices"]), 40000)
            self.assertIn("Shown with", document.words())

    def test_fit_in_one_dimension_shows_the_curve(self):
        rows = [(i / 50, math.sin(i / 8)) for i in range(50)]
        samples = self.write("samples.csv", csv(rows, "t,height"))
        text, document = self.page("fit", samples, "-o", self.path("f.csrbf"))
        self.assertIn("height by t", text)
        self.assertIn("Errors at the samples", document.words())

    def test_fit_in_the_plane_shows_a_map_and_a_landscape(self):
        samples = self.write("samples.csv", csv(rows_of(wave, 300), "east,north,depth"))
        text, document = self.page("fit", samples, "-o", self.path("f.csrbf"))
        self.assertIn("depth by east and north", text)
        self.assertIn("expect this error between the samples", document.words())
        data = self.surface(document)
        if data:
            self.assertEqual([scale["name"] for scale in data["scales"]],
                             ["depth", "error at the samples", "standard deviation"])
            self.assertEqual(len(numbers(data["points"]["positions"], "H")), 3 * 300)

    def test_colours_of_a_fit_end_near_the_values_of_the_samples(self):
        places = [(x, y) for x in (i / 14 for i in range(15)) for y in (i / 14 for i in range(15)) if min(x, y) < 0.45]
        rows = [(x, y, 10 + (8 * x * y) ** 2) for x, y in places]  # at most 23; 74 in the corner without samples
        text, document = self.page("fit", self.write("corner.csv", csv(rows, "x,y,depth")), "-o", self.path("f.csrbf"))
        self.assertIn("depth (colours end near those of the samples)", text)
        data = self.surface(document)
        if data:
            self.assertLess(data["scales"][0]["hi"], 26)
        rows = [(x, y, x + y) for x, y in places]
        text, _ = self.page("fit", self.write("plane.csv", csv(rows + [(1, 1, 2)])), "-o", self.path("g.csrbf"))
        self.assertNotIn("colours end", text)

    def test_maps_across_the_date_line_show_every_sample(self):
        rows = [(x if x < 180 else x - 360, y, x % 7 + y % 3 + x * y % 5) for x in range(171, 190) for y in range(6)]
        samples = self.write("samples.csv", csv(rows, "lon,lat,depth"))
        text, _ = self.page("fit", samples, "-o", self.path("f.csrbf"), "--sphere", "lon,lat", "--smoothing", "1")
        plots = [plot for plot in re.findall(r"<svg[^>]*data-plot.*?</svg>", text, re.S) if "by lon and lat" in plot]
        self.assertEqual(len(plots), 2)
        for plot in plots:
            left, _, width = map(float, re.search(r'viewBox="([-\d.]+) ([-\d.]+) ([-\d.]+)', plot).groups())
            dots = re.findall(r'<path class="dots[^>]* d="([^"]*)"', plot)
            places = [float(x) for d in dots for x in re.findall(r"M([-\d.]+)", d)]
            self.assertGreaterEqual(len(places), len(rows))
            self.assertTrue(all(left < x < left + width for x in places))

    def test_long_numbers_at_an_axis_are_within_the_drawing(self):
        rows = [(500000 + 1000 * x, 5200000 + 1000 * y, v) for x, y, v in rows_of(wave, 40)]
        text, _ = self.page("fit", self.write("utm.csv", csv(rows, "easting,northing,depth")), "-o", self.path("f.csrbf"))
        shown = 0
        for plot in re.findall(r"<svg[^>]*data-plot.*?</svg>", text, re.S):
            begin = float(re.search(r'viewBox="([-\d.]+) ', plot).group(1))
            for x, number in re.findall(r'<text class="tick end" x="([\d.]+)"[^>]*>([^<]*)<', plot):
                self.assertGreaterEqual(float(x) - 8 * len(number), begin, number)
                shown += "×" in number
        self.assertGreater(shown, 1)

    def test_numbers_below_an_axis_do_not_meet(self):
        rows = [(i / 50, 6e-4 * math.sin(7919 * i) + i / 50) for i in range(50)]
        text, _ = self.page("fit", self.write("line.csv", csv(rows)), "-o", self.path("f.csrbf"), "--smoothing", "10")
        for plot in re.findall(r"<svg[^>]*data-plot.*?</svg>", text, re.S):
            ticks = re.findall(r'<text class="tick middle" x="([\d.]+)" y="([\d.]+)">([^<]*)<', plot)
            for (x, y, left), (x2, y2, right) in zip(ticks, ticks[1:]):
                if y == y2:
                    self.assertGreater(float(x2) - float(x), 4 * (len(left) + len(right)), (left, right))

    def test_fit_shows_errors_and_left_out_samples_of_any_number(self):
        inner = "in the middle was left out"
        for n, dots, left_out in ((300, True, "Every fifth sample was left out"), (1500, True, inner), (4000, False, inner)):
            with self.subTest(n=n):
                rows = [(x, y, v + 0.05 * math.sin(7919 * i)) for i, (x, y, v) in enumerate(rows_of(wave, n))]
                text, document = self.page("fit", self.write("noisy.csv", csv(rows)), "-o", self.path("f.csrbf"))
                self.assertIn("Where the errors are", document.words())
                outlined = re.search(r'<path class="dots outline"[^>]* d="([^"]*)"', text)
                self.assertEqual(bool(outlined), dots)
                if dots:
                    self.assertEqual(outlined.group(1).count("M"), n)
                self.assertIn(left_out, document.words())

    def test_evaluate_says_how_many_values_there_are_and_which(self):
        samples = self.write("samples.csv", csv([(x, y, 20000 * x) for x in range(5) for y in range(5)]))
        self.page("fit", samples, "-o", self.path("f.csrbf"))
        text, document = self.page("evaluate", self.path("f.csrbf"), "-o", self.path("grid.npy"), "--grid", "9")
        self.assertRegex(document.words(), r"81 places \S+ smallest value 80,?000 largest value")
        self.assertIn(">40,000<", text)  # on an axis

    def test_fit_in_space_shows_planes(self):
        rows = [(x, y, z, x + y * z) for x in range(5) for y in range(5) for z in range(5)]
        samples = self.write("samples.csv", csv(rows))
        text, document = self.page("fit", samples, "-o", self.path("f.csrbf"))
        for name in ("x and y", "x and z", "y and z"):
            self.assertIn("value by " + name, text)

    def test_segment_in_the_plane_shows_contour_intensities_and_energy(self):
        values = [10.0 + (x * y) % 3 if (x - 30) ** 2 + (y - 20) ** 2 < 144 else 1.0 + x % 2
                  for y in range(48) for x in range(64)]
        image = self.write_bytes("disc.npy", npy_bytes((48, 64), values, "<f4"))
        text, document = self.page("segment", image, "-o", self.path("labels.png"), "--mode", "local", "--init",
                                   "sphere:28,20,8")
        report = self.report()["result"]
        for region in report["regions"]:
            self.assertIn("label %d" % region["label"], document.words())
            self.assertIn("{:,}".format(region["voxels"]), document.words())
        self.assertIn("The contour on the image", document.words())
        self.assertGreater(len(report["energy"]), 1)
        curve = re.search(r'<path class="curve" d="([^"]*)"', text).group(1)
        self.assertEqual(len(re.findall("[ML]", curve)), len(report["energy"]))

    def test_segment_of_colours_shows_the_sum_of_channels_that_it_segmented(self):
        inside = [(x - 30) ** 2 + (y - 20) ** 2 < 144 for y in range(48) for x in range(64)]
        noise = [(7 * i) % 13 for i in range(len(inside))]
        pixels = bytes(v for disc, n in zip(inside, noise) for v in ((60 + n, 20 + n, 90 + n) if disc else (200 + n, 180 + n, 210 + n)))
        mask = self.write_bytes("mask.pgm", b"P5\n64 48\n255\n" + bytes(255 if x < 50 else 0 for y in range(48) for x in range(64)))
        image = self.write_bytes("color.ppm", b"P6\n64 48\n255\n" + pixels)
        text, document = self.page("segment", image, "-o", self.path("labels.png"), "--mask", mask)
        self.assertIn("weighted sum of the channels", document.words())
        values = {}
        axes = json.loads(re.search(r'<svg data-plot="([^"]*)"[^>]*aria-label="Histograms', text).group(1).replace("&quot;", '"'))
        for series, path in re.findall(r'<path class="area series(\d)" d="([^"]*)"', text):
            steps = [tuple(map(float, place.split())) for place in path.strip("MZ").split("L")]
            low, high, top, height = axes["y"][:4]
            values[series] = [(low + (top + height - y) / height * (high - low), x) for x, y in steps[1:-1:2]]
        for region in self.report()["result"]["regions"]:
            counted = sum(count for count, _ in values[str(region["label"])])
            self.assertAlmostEqual(counted, region["voxels"], delta=0.02 * region["voxels"])
        used = [{x for count, x in values[series] if count > 0.5} for series in "01"]
        self.assertEqual(used[0] & used[1], set())

    def test_segment_in_space_shows_slices_and_the_surface(self):
        n = 20
        values = [100.0 if math.dist((x, y, z), (10, 9, 10)) < 6 else 20.0
                  for z in range(n) for y in range(n) for x in range(n)]
        image = self.write_bytes("ball.npy", npy_bytes((n, n, n), values, "<f4"))
        text, document = self.page("segment", image, "-o", self.path("labels.npy"))
        self.assertEqual(sum(tag == "img" and "Slice across" in a.get("alt", "") for tag, a in document.elements), 3)
        data = self.surface(document)
        if data:
            for vertex in data["vertices"]:
                self.assertAlmostEqual(math.dist(vertex, (10, 9, 10)), 6, delta=0.8)

    def test_every_other_command_writes_a_page(self):
        cloud = self.write("cloud.ply", ply(sphere(400)))
        mesh = self.write("mesh.off", OCTAHEDRON)
        model = self.path("model.csrbf")
        self.page("reconstruct", cloud, "-o", self.path("out.ply"), "--model", model, "--resolution", "24")
        self.page("estimate-normals", cloud, "-o", self.path("oriented.ply"))
        self.page("polygonize", model, "-o", self.path("fine.ply"), "--resolution", "24")
        self.page("render", mesh, "-o", self.path("mesh.png"), "--size", "40x30")
        _, document = self.page("curvature", model, "-o", self.path("curved.ply"), "--resolution", "24")
        self.surface(document)
        _, document = self.page("combine", "union", model, model, "-o", self.path("both.csrbf"))
        self.surface(document)
        _, document = self.page("compare", mesh, mesh)
        data = self.surface(document)  # the file has no normals, the picture has
        if data:
            for vertex, at in zip(data["vertices"], range(0, 18, 3)):
                normal = numbers(data["normals"], "b")[at:at + 3]
                self.assertGreater(sum(a * b for a, b in zip(vertex, normal)), 120)
        self.assertIn("chamfer mean", document.words())
        self.page("info", cloud)
        samples = self.write("samples.csv", csv(rows_of(wave, 100)))
        self.page("fit", samples, "-o", self.path("f.csrbf"))
        self.page("evaluate", self.path("f.csrbf"), "-o", self.path("grid.npy"), "--grid", "5")
        holes = [math.nan if 3 < x < 6 and 3 < y < 6 else x + y for y in range(12) for x in range(12)]
        image = self.write_bytes("holes.npy", npy_bytes((12, 12), holes, "<f4"))
        self.page("inpaint", image, "-o", self.path("filled.npy"))
        frames = [10.0 if math.dist((x, y), (10 + t, 10)) < 5 else 1.0
                  for t in range(2) for y in range(20) for x in range(24)]
        movie = self.write_bytes("movie.npy", npy_bytes((2, 20, 24), frames, "<f4"))
        text, document = self.page("track", movie, "-o", self.path("movie"), "--slices-are-frames")
        self.assertEqual([a["data-frame"] for tag, a in document.elements if "data-frame" in a], ["0", "1"])

    def test_what_was_not_chosen_is_folded(self):
        cloud = self.write("cloud.xyz", xyz(sphere(100)))
        text, _ = self.page("reconstruct", cloud, "-o", self.path("mesh.ply"), "--resolution", "16")
        shown, folded = text.split('<details class="folded">')[:2]
        folded = folded.split("</details>")[0]
        self.assertNotIn('<tr class="default">', shown)
        self.assertIn('<tr class="default">', folded)
        self.assertNotIn('<tr class="given">', folded)


class Contents(Reports):
    def test_options_say_who_decided_and_why(self):
        cloud = self.write("cloud.xyz", xyz(sphere(300)))
        text, _ = self.page("reconstruct", cloud, "-o", self.path("mesh.ply"), "--resolution", "24")
        rows = dict(re.findall(r'<tr class="(\w+)"><th scope="row">resolution</th>.*?<td>([^<]*)</td>', text))
        self.assertEqual(list(rows), ["given"])
        rows = re.findall(r'<tr class="(\w+)"><th scope="row">normals</th><td>(\w+)</td><td>([^<]*)</td>', text)
        self.assertEqual([row[:2] for row in rows], [("chosen", "estimated")])
        self.assertIn("the file has none", rows[0][2])
        rows = re.findall(r'<tr class="(\w+)"><th scope="row">trim</th>', text)
        self.assertEqual(rows, ["default"])

    def test_names_cannot_become_markup(self):
        name = "a<script>alert(1)</script>&'\"b.xyz".replace("/", "_")
        cloud = self.write(name, xyz(sphere(50)))
        text, document = self.page("info", cloud)
        self.assertIn(name, document.words())
        self.assertNotIn("<script>alert", text)
        self.assertEqual(json.loads(document.script(id="report"))["input"]["file"], cloud)

    def test_warnings_are_shown(self):
        cloud = self.write("cloud.xyz", xyz(sphere(50)) + "nan 0 0\n")
        _, document = self.page("info", cloud)
        self.assertEqual(len(self.report()["warnings"]), 1)
        self.assertIn("warnings", document.ids)

    def test_the_licence_of_three_js_stays_with_it(self):
        cloud = self.write("cloud.xyz", xyz(sphere(100)))
        text, document = self.page("reconstruct", cloud, "-o", self.path("mesh.ply"), "--resolution", "16")
        self.assertIn("Permission is hereby granted, free of charge", document.words())
        self.assertEqual("three.js authors" in document.words(),
                         document.script(**{"class": "surface-data"}) is not None)

    def test_reports_have_two_forms(self):
        cloud = self.write("cloud.xyz", xyz(sphere(50)))
        self.fail_with(2, 'report.pdf: unknown extension ".pdf"; reports are .json or .html', "info", cloud, "--report",
                       self.path("report.pdf"))
        self.fail_with(1, "No such file or directory", "info", cloud, "--report", self.path("no/report.html"))
        self.assertIn('"command": "info"', self.succeed("info", cloud, "-q", "--report", "/dev/stdout").stdout)


if __name__ == "__main__":
    command_line_test.PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
