"""Runs the real program on generated files: exit codes, messages, reports, what it writes and what it leaves alone.

usage: command_line_test.py PROGRAM [unittest options]
"""

import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

# Background jobs ignore Ctrl-C, and so do the programs they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

PROGRAM = ""
COMMANDS = ["reconstruct", "estimate-normals", "polygonize", "render", "curvature", "combine", "fit", "evaluate"]
COMMANDS += ["inpaint", "segment", "track", "compare", "info", "studio"]
REPORT_KEYS = ["csrbf", "command", "input", "options", "result", "time", "peak_memory_mb", "threads", "warnings"]


def sphere(n, radius=1.0):
    """Points on a sphere along a Fibonacci spiral."""
    golden = math.pi * (3 - math.sqrt(5))
    points = []
    for i in range(n):
        z = 1 - (2 * i + 1) / n
        r = math.sqrt(1 - z * z)
        points.append((radius * r * math.cos(golden * i), radius * r * math.sin(golden * i), radius * z))
    return points


def xyz(points):
    return "".join("%.9g %.9g %.9g\n" % p for p in points)


def ply(points, colored=False):
    """Text PLY with outward normals of a sphere about the origin, and red above z = 0, blue below."""
    lines = ["ply", "format ascii 1.0", "element vertex %d" % len(points)]
    lines += ["property float " + name for name in ("x", "y", "z", "nx", "ny", "nz")]
    if colored:
        lines += ["property uchar " + name for name in ("red", "green", "blue")]
    lines += ["end_header"]
    for p in points:
        length = math.sqrt(sum(c * c for c in p))
        row = ["%.9g" % c for c in p] + ["%.9g" % (c / length) for c in p]
        if colored:
            row += ["255", "0", "0"] if p[2] > 0 else ["0", "0", "255"]
        lines.append(" ".join(row))
    return "\n".join(lines) + "\n"


OCTAHEDRON = """OFF
6 8 12
1 0 0
-1 0 0
0 1 0
0 -1 0
0 0 1
0 0 -1
3 0 2 4
3 2 1 4
3 1 3 4
3 3 0 4
3 2 0 5
3 1 2 5
3 3 1 5
3 0 3 5
"""


def read_ply(path):
    """Vertex rows and number of faces of a binary little-endian PLY file."""
    with open(path, "rb") as file:
        data = file.read()
    header, body = data.split(b"end_header\n", 1)
    assert b"binary_little_endian" in header
    sizes = {"float": "f", "uchar": "B", "char": "b", "double": "d", "int": "i"}
    names, codes, count, faces, element = [], "<", 0, 0, ""
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            count, faces = (int(words[2]), faces) if element == "vertex" else (count, int(words[2]))
        if words[0] == "property" and element == "vertex":
            names.append(words[2])
            codes += sizes[words[1]]
    size = struct.calcsize(codes)
    rows = [dict(zip(names, struct.unpack_from(codes, body, i * size))) for i in range(count)]
    return rows, faces


def off_volume(path):
    """Volume inside the triangles of an OFF file."""
    with open(path) as file:
        rows = [line.split() for line in file.read().splitlines()[1:]]
    vertices = [tuple(map(float, row[:3])) for row in rows[1:1 + int(rows[0][0])]]
    volume = 0
    for row in rows[1 + len(vertices):]:
        (a, b, c), (d, e, f), (g, h, i) = (vertices[int(v)] for v in row[1:4])
        volume += (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)) / 6
    return volume


def read_png(path):
    """Width, height and the rows of an RGB picture."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height, depth, color = struct.unpack(">IIBB", data[16:26])
    assert (depth, color) == (8, 2)
    packed, at = b"", 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw = zlib.decompress(packed)
    assert len(raw) == height * (1 + 3 * width)
    return width, height, raw


def names_in(folder):
    """Names of files in a folder that another process makes and removes; none when it is not there."""
    try:
        return os.listdir(folder)
    except FileNotFoundError:
        return []


class CommandLine(unittest.TestCase):
    timeout = 300  # seconds that a run of the program may take

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="csrbf_test_")
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def files(self):
        return sorted(os.listdir(self.folder.name))

    def run_program(self, *arguments, stdin=None):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, input=stdin,
                              timeout=self.timeout, cwd=self.folder.name)

    def succeed(self, *arguments, stdin=None):
        done = self.run_program(*arguments, stdin=stdin)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def fail_with(self, code, message, *arguments):
        """The run ends with `code` and says `message` on standard error only, and writes no file."""
        before = self.files()
        done = self.run_program(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(message, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(self.files(), before)

    def report(self, name="report.json"):
        with open(self.path(name)) as file:
            report = json.load(file)
        self.assertEqual(list(report), REPORT_KEYS)
        self.assertIn("total", report["time"])
        self.assertGreater(report["peak_memory_mb"], 0)
        self.assertGreaterEqual(report["threads"], 1)
        return report


class Usage(CommandLine):
    def test_help_lists_the_commands(self):
        text = self.succeed("--help").stdout
        for command in COMMANDS:
            self.assertIn(command, text)

    def test_help_of_each_command_has_an_example_and_the_common_flags(self):
        for command in COMMANDS:
            text = self.succeed(command, "--help").stdout
            self.assertIn("Example:\n  csrbf " + command, text)
            for flag in ("--threads", "--report", "--progress", "--quiet", "--verbose", "--version", "--help"):
                self.assertIn(flag, text)
            self.assertIn("default: all cores", text)
            self.assertLessEqual(max(map(len, text.splitlines())), 100)
        for command, forms in (("evaluate", ("--bounds LO:HI,...", "--mask hull|distance:D", "every:STEP")),
                               ("fit", ("--degree N ", "--returns all|first|last|only\n")),
                               ("render", ("--color NAME",))):
            for form in forms:
                self.assertIn(form, self.succeed(command, "--help").stdout)

    def test_version_is_printed_everywhere(self):
        self.assertRegex(self.succeed("--version").stdout, r"^csrbf \d+\.\d+\.\d+\n$")
        self.assertRegex(self.succeed("info", "--version").stdout, r"^csrbf \d+\.\d+\.\d+\n$")

    def test_bad_usage_gives_2_and_says_why(self):
        self.fail_with(2, "a command is required")
        self.fail_with(2, "unknown command \"frobnicate\"", "frobnicate")
        self.fail_with(2, "--output is required", "reconstruct", "points.xyz")
        self.fail_with(2, "csrbf info --help", "info")
        self.fail_with(2, "unknown flag --frobnicate", "info", "a.ply", "--frobnicate")
        self.fail_with(2, "unknown flag --foo; csrbf info", "info", "a.ply", "--foo")

    def test_numbers_that_flags_do_not_take_say_which(self):
        for flag, value, kind in (("--centers", "1e3", "whole number"), ("--kernel-parameter", "many", "number")):
            self.fail_with(2, flag + " " + value + ": expected a " + kind + "\n", "fit", "a.csv", "-o", "a.csrbf", flag,
                           value)

    def test_one_result_goes_to_standard_output(self):
        samples = self.write("s.csv", "0,0,1\n1,0,2\n0,1,3\n")
        self.succeed("fit", samples, "-o", self.path("a.csrbf"), "--report", "-")
        self.fail_with(2, "-: standard output takes one result", "evaluate", self.path("a.csrbf"), "-o", "-", "--grid",
                       "2,2", "--report", "-")

    def test_flags_without_a_value_are_named(self):
        for flags, message in ((("--sphere", "--threads", "1"), "--sphere needs a value, LON,LAT; --threads follows it"),
                               (("-o", "--threads", "1"), "-o needs a value, FILE; --threads follows it"),
                               (("-o", "a.csrbf", "--values", "-q"), "--values needs a value, COLUMNS; -q follows it")):
            self.fail_with(2, message, "fit", "a.csv", *flags)

    def test_a_slip_of_the_keys_gets_a_suggestion(self):
        self.fail_with(2, "unknown command \"reconstrcut\"; did you mean reconstruct?", "reconstrcut", "a.ply")
        self.fail_with(2, "unknown flag --kernl; did you mean --kernel?", "fit", "a.csv", "--kernl", "cubic")
        with open(self.path("slip.csv"), "w", encoding="utf-8") as file:
            file.write("x,y,depth\n" + "".join(f"{i},{i * i % 7},{i % 5}\n" for i in range(20)))
        fit = ["fit", self.path("slip.csv"), "-o", self.path("slip.csrbf")]
        self.fail_with(2, "did you mean wendland-c2?", *fit, "--kernel", "wendlnd-c2")
        self.fail_with(2, "csrbf fit: --method intrpolate: unknown; did you mean interpolate?", *fit, "--method", "intrpolate")
        self.fail_with(2, "did you mean depth?", *fit, "--values", "dpeth")

    def test_help_is_a_command_too(self):
        self.assertEqual(self.succeed("help", "fit").stdout, self.succeed("fit", "--help").stdout)
        self.assertEqual(self.succeed("help").stdout, self.succeed("--help").stdout)
        self.assertEqual(self.succeed("-V").stdout, self.succeed("--version").stdout)
        self.fail_with(2, "--threads", "info", "a.ply", "--threads", "0")
        self.fail_with(2, "--progress", "info", "a.ply", "--progress", "sometimes")
        self.fail_with(2, "--resolution", "reconstruct", "a.ply", "-o", "b.ply", "--resolution", "many")
        self.fail_with(2, "--size 10: expected 2 numbers", "render", "a.ply", "-o", "b.png", "--size", "10")
        self.fail_with(2, "--view up", "render", "a.ply", "-o", "b.png", "--view", "up")
        self.fail_with(2, "--color pink", "render", "a.ply", "-o", "b.png", "--color", "pink")
        self.fail_with(2, "--trim far", "reconstruct", "a.ply", "-o", "b.ply", "--trim", "far")
        self.fail_with(2, "OP", "combine", "add", "a.csrbf", "b.csrbf", "-o", "c.csrbf")
        self.fail_with(2, "union takes at least two models", "combine", "union", "a.csrbf", "-o", "c.csrbf")
        self.fail_with(2, "complement takes one model", "combine", "complement", "a.csrbf", "b.csrbf", "-o",
                       "c.csrbf")
        self.fail_with(2, "sharp: has no radius", "combine", "blend", "a.csrbf", "b.csrbf", "-o", "c.csrbf",
                       "--blending", "sharp")
        self.fail_with(2, "--radius", "combine", "union", "a.csrbf", "b.csrbf", "-o", "c.csrbf", "--radius", "0")
        self.fail_with(2, "only .ply and .vtp store", "curvature", "a.csrbf", "-o", "c.obj")
        self.fail_with(2, "--ridges r.obj: only .ply", "curvature", "a.csrbf", "-o", "c.ply", "--ridges", "r.obj")
        self.fail_with(2, "--smoothing some", "reconstruct", "a.ply", "-o", "b.ply", "--smoothing", "some")

    def test_surface_without_data_is_told(self):
        cap = self.write("cap.xyz", xyz([p for p in sphere(2000) if p[2] > -0.5]))
        told = self.run_program("reconstruct", cap, "-o", "cap.ply", "--report", self.path("report.json"))
        self.assertRegex(told.stderr, r"warning: \d+ % of the surface is farther than 4 spacings from all points")
        self.assertGreater(self.report()["result"]["without_data"], 0.03)
        for options in ([self.write("ball.xyz", xyz(sphere(2000)))], [cap, "--trim", "4"]):
            done = self.run_program("reconstruct", *options, "-o", "mesh.ply")
            self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_numbers_that_must_be_positive_are_named(self):
        for command, flag, value in (("reconstruct", "--tolerance", "-1"), ("reconstruct", "--centers", "0"),
                                  ("fit", "--tolerance", "0"), ("fit", "--centers", "many"),
                                  ("inpaint", "--centers", "-5"), ("polygonize", "--tolerance", "nan"),
                                  ("track", "--motion", "inf")):
            done = self.run_program(command, "a", "-o", "b", flag, value)
            self.assertEqual((done.returncode, done.stderr),
                             (2, "csrbf: %s %s: must be a positive number\n" % (flag, value)))

    def test_unknown_output_formats_give_2(self):
        cloud = self.write("cloud.xyz", xyz(sphere(100)))
        self.fail_with(2, "mesh files are .ply .obj .off .stl .vtp", "reconstruct", cloud, "-o", self.path("mesh.vtk"))
        self.fail_with(2, "models are .csrbf", "reconstruct", cloud, "-o", self.path("mesh.ply"), "--model", "m.bin")
        self.fail_with(2, "pictures are .png", "render", cloud, "-o", self.path("picture.jpg"))
        self.fail_with(2, "models are .csrbf", "combine", "union", cloud, cloud, "-o", self.path("model.bin"))
        self.fail_with(2, "point files are", "estimate-normals", cloud, "-o", self.path("points.las"))


class InstalledTexts(CommandLine):
    """The man page and the completions that the program prints for the installation."""

    def long_flags(self, command):
        return set(re.findall(r"--[a-z0-9-]+", self.succeed(command, "--help").stdout.split("Example:")[0]))

    def completed(self, *words):
        """What bash offers for the last of the words."""
        script = self.write("completion", self.succeed("--print-completion", "bash").stdout)
        command = 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _csrbf; printf "%s\\n" "${COMPREPLY[@]}"'
        done = subprocess.run(["bash", "-c", command, script, *words], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_man_page_has_every_command_and_flag(self):
        page = self.succeed("--print-man").stdout.replace("\\-", "-")
        for title in ("NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "EXIT STATUS", "FORMATS", "EXAMPLES"):
            self.assertIn(".SH %s\n" % title, page)
        for command in COMMANDS:
            self.assertIn(".SS %s\n.B csrbf %s\n" % (command, command), page)
            for flag in self.long_flags(command):
                self.assertIn("\\fB%s\\fR" % flag, page)
        self.assertNotIn("--print", page + self.succeed("--help").stdout)

    def test_man_page_is_clean(self):
        if not shutil.which("groff"):
            self.skipTest("no groff")
        page = self.write("csrbf.1", self.succeed("--print-man").stdout)
        done = subprocess.run(["groff", "-man", "-ww", "-z", page], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))

    def test_completions_have_every_command_and_flag(self):
        for shell, dashes in (("bash", "--"), ("zsh", "--"), ("fish", "-l ")):
            script = self.succeed("--print-completion", shell).stdout
            for command in COMMANDS:
                self.assertIn(command, script)
                for flag in self.long_flags(command):
                    self.assertIn(dashes + flag[2:], script)

    def test_shells_accept_their_completions(self):
        for shell in filter(shutil.which, ("bash", "zsh", "fish")):
            script = self.write(shell, self.succeed("--print-completion", shell).stdout)
            done = subprocess.run([shell, "-n", script], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.fail_with(2, "tcsh", "--print-completion", "tcsh")

    def test_bash_completes_commands_flags_and_words_and_leaves_files_to_readline(self):
        self.assertEqual(self.completed("csrbf", "rec"), ["reconstruct"])
        self.assertLessEqual(set(COMMANDS), set(self.completed("csrbf", "")))
        self.assertEqual(self.completed("csrbf", "reconstruct", "--tr"), ["--trim"])
        self.assertEqual(self.completed("csrbf", "reconstruct", "a.ply", "--normals", ""), ["auto", "file", "estimate"])
        self.assertEqual(self.completed("csrbf", "reconstruct", "-o", ""), [])
        for command in COMMANDS:
            self.assertEqual(set(self.completed("csrbf", command, "--")), self.long_flags(command))


class Input(CommandLine):
    def test_unreadable_input_gives_2_and_names_the_place(self):
        out = self.path("mesh.ply")
        self.fail_with(2, "missing.ply: cannot read the file: No such file", "reconstruct", "missing.ply", "-o", out)
        ragged = self.write("ragged.xyz", "0 0 0\n1 0 0\n\n0 1\n")
        self.fail_with(2, "ragged.xyz:4: expected 3 columns as in line 1, found 2", "reconstruct", ragged, "-o", out)
        empty = self.write("empty.xyz", "")
        self.fail_with(2, "empty.xyz: the file holds no rows", "reconstruct", empty, "-o", out)
        broken = self.write("broken.ply", ply(sphere(50))[:-100])
        self.fail_with(2, "broken.ply:", "reconstruct", broken, "-o", out)
        las = self.write("cloud.las", "LASF")
        self.fail_with(2, "cloud.las: the file is truncated", "reconstruct", las, "-o", out)
        laz = self.write("cloud.laz", "LASF")
        self.fail_with(2, "cloud.laz: the file is truncated", "reconstruct", laz, "-o", out)
        model = self.write("model.csrbf", "not a model")
        self.fail_with(2, "model.csrbf: not a csrbf model", "polygonize", model, "-o", out)
        self.fail_with(2, "not a csrbf model", "render", model, "-o", self.path("a.png"))
        self.fail_with(2, "not a csrbf model", "info", model)

    def test_what_is_no_text_is_told(self):
        for name, message in (("a.xyz", "a.xyz: the file is binary, not text"), ("a.las", "not a LAS or LAZ file")):
            with open(self.path(name), "wb") as file:
                file.write(bytes((7 * i + 7) % 256 for i in range(500)))
            self.fail_with(2, message, "reconstruct", self.path(name), "-o", self.path("a.ply"))

    def test_usual_names_of_coordinates_are_known(self):
        rows = "".join("%g,%g,%g\n" % (500000 + x, 4e6 + y, z) for x, y, z in sphere(200))
        scan = self.write("scan.csv", "Easting,Northing,Height\n" + rows)
        self.succeed("reconstruct", scan, "-o", self.path("a.ply"), "--resolution", "16")
        self.fail_with(2, "longitudes and latitudes are angles", "reconstruct", self.write("degrees.csv", "lon,lat,height\n" + rows),
                       "-o", self.path("b.ply"))

    def test_points_that_are_no_surface_give_2(self):
        out = self.path("mesh.ply")
        few = self.write("few.xyz", "0 0 0\n1 0 0\n0 1 0\n")
        self.fail_with(2, "reconstruct", "reconstruct", few, "-o", out)
        line = self.write("line.xyz", "".join("%d 0 0\n" % i for i in range(100)))
        self.fail_with(2, "reconstruct", "reconstruct", line, "-o", out)
        bad = self.write("nan.xyz", "nan nan nan\n" * 20)
        self.fail_with(2, "reconstruct", "reconstruct", bad, "-o", out)

    def test_two_clouds_cannot_be_compared(self):
        cloud = self.write("cloud.xyz", xyz(sphere(10)))
        self.fail_with(2, "one must be a mesh", "compare", cloud, cloud)


class Output(CommandLine):
    def test_results_that_cannot_be_written_give_1_before_any_work(self):
        cloud = self.write("cloud.xyz", xyz(sphere(100)))
        self.fail_with(1, "No such file or directory", "reconstruct", cloud, "-o", self.path("no/folder/mesh.ply"))
        self.fail_with(1, "No such file or directory", "info", cloud, "--report", self.path("no/folder/report.json"))
        os.mkdir(self.path("folder.ply"))
        self.fail_with(1, "Is a directory", "reconstruct", cloud, "-o", self.path("folder.ply"))
        os.rmdir(self.path("folder.ply"))

    def test_a_full_disk_gives_1(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        self.fail_with(1, "No space left on device", "info", mesh, "--report", "/dev/full")

    def test_what_cannot_be_printed_gives_1(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        for arguments in (["info", mesh], ["compare", mesh, mesh], ["--help"], ["--version"],
                          ["--print-man"]):
            with self.subTest(arguments=arguments), open("/dev/full", "w") as full:
                done = subprocess.run([PROGRAM, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 1)
                self.assertIn("standard output: cannot write: No space left on device", done.stderr)
        closed = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", PROGRAM, "info", mesh], stderr=subprocess.PIPE)
        self.assertEqual((closed.returncode, closed.stderr), (0, b""))

    def test_a_failed_run_keeps_the_old_result(self):
        old = self.write("mesh.ply", "old")
        ragged = self.write("ragged.xyz", "0 0 0\n1 0\n")
        self.fail_with(2, "ragged.xyz:2", "reconstruct", ragged, "-o", old)
        with open(old) as file:
            self.assertEqual(file.read(), "old")

    def test_quiet_prints_nothing(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        done = self.succeed("info", mesh, "--quiet", "--progress", "always")
        self.assertEqual(done.stdout + done.stderr, "")


class Info(CommandLine):
    def test_tells_what_a_point_file_holds(self):
        cloud = self.write("cloud.ply", ply(sphere(50, radius=2), colored=True))
        done = self.succeed("info", cloud, "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        self.assertIn("50 points", done.stdout)
        result = self.report()["result"]
        self.assertEqual((result["kind"], result["points"], result["normals"]), ("points", 50, True))
        self.assertEqual([p["name"] for p in result["properties"]], ["red", "green", "blue"])
        self.assertAlmostEqual(result["bounds"]["hi"][2], 2 * (1 - 1 / 50), places=5)

    def test_tells_the_topology_of_a_mesh(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        self.succeed("info", mesh, "--report", self.path("report.json"))
        result = self.report()["result"]
        self.assertEqual((result["vertices"], result["triangles"], result["edges"]), (6, 8, 12))
        self.assertEqual((result["watertight"], result["manifold"], result["euler"]), (True, True, 2))

    def test_tells_places_far_from_the_origin_apart(self):
        cloud = self.write("cloud.xyz", "500000.5 5400000.25 12\n500200.75 5400150 52.55\n")
        self.assertIn("500000.5 5400000.25 12 to 500200.75 5400150 52.55, ", self.succeed("info", cloud).stdout)

    def test_capitals_name_coordinates_too(self):
        cloud = self.write("utm.csv", "X,Y,Z,R,G,B\n" + "".join(f"{i},{i % 3},{i % 5},1,2,3\n" for i in range(9)))
        self.assertIn("cloud:       9 points", self.succeed("info", cloud).stdout)

    def test_tells_curves_from_points(self):
        lines = self.write("lines.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nelement edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
                           "0 0 0\n1 0 0\n1 1 0\n0 1\n1 2\n")
        done = self.succeed("info", lines, "--report", self.path("report.json"))
        self.assertIn("curves:      3 points, 2 edges", done.stdout)
        self.assertEqual(self.report()["result"]["kind"], "curves")

    def test_tells_what_fit_does_with_text(self):
        table = self.write("stations.csv", "id,station,x,y,depth\n" + "".join(f"{i},S{i},{i % 3},{i % 5},{i % 4}\n" for i in range(9)))
        told = self.succeed("info", table).stdout
        self.assertIn("csrbf fit needs --coordinates and --values: by default it takes all columns, and station holds text", told)
        self.fail_with(2, '"S0" is not a number', "fit", table, "-o", self.path("a.csrbf"))
        self.succeed("fit", table, "-o", self.path("a.csrbf"), "--coordinates", "x,y", "--values", "depth")

    def test_formats_are_listed_once(self):
        self.fail_with(2, '.npz"; files of meshes and points are .ply .xyz .pts .txt .csv .obj .off .npy .vtp .stl .las '
                       ".laz .e57 .pcd .ptx\n", "info", self.write("p.npz", ""))
        self.fail_with(2, ".glb is only written", "info", self.write("p.glb", ""))

    def test_warns_of_points_that_are_not_finite(self):
        cloud = self.write("cloud.xyz", "0 0 0\n1 nan 0\n0 1 inf\n")
        done = self.succeed("info", cloud, "--report", self.path("report.json"))
        self.assertIn("2 points without finite coordinates", done.stderr)
        self.assertEqual(len(self.report()["warnings"]), 1)


class Compare(CommandLine):
    def test_a_mesh_equals_itself(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        done = self.succeed("compare", mesh, mesh, "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        result = self.report()["result"]
        self.assertLess(result["chamfer_mean"], 1e-12)
        self.assertLess(result["hausdorff99"], 1e-12)
        self.assertLess(result["normal_error_deg"], 1e-4)
        self.assertTrue(result["watertight"] and result["manifold"])

    def test_distances_are_fractions_of_the_diagonal(self):
        mesh = self.write("octahedron.off", OCTAHEDRON)
        # The centre of a face, one unit off along its normal; the diagonal of the points' box is 2 sqrt(3) t.
        t = 1 / 3 + 1 / math.sqrt(3)
        points = self.write("points.xyz", xyz([(t, t, t), (-t, -t, -t)]))
        self.succeed("compare", mesh, points, "--report", self.path("report.json"))
        self.assertAlmostEqual(self.report()["result"]["chamfer_mean"], 1 / (2 * math.sqrt(3) * t), places=6)


    def test_label_images_are_compared_voxel_by_voxel(self):
        def nrrd(name, labels, spacings="0.5 2"):
            return self.write(name, "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 6 2\nspacings: %s\nencoding: ascii\n\n%s\n"
                              % (spacings, labels))
        a = nrrd("a.nrrd", "1 1 1 0 2 2  1 1 1 0 2 2")
        b = nrrd("b.nrrd", "1 1 0 0 2 2  1 1 0 0 2 2")
        done = self.succeed("compare", a, b, "--report", self.path("report.json"))
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        result = self.report()["result"]
        self.assertAlmostEqual(result["dice"], 16 / 18)
        self.assertAlmostEqual(result["jaccard"], 8 / 10)
        self.assertAlmostEqual(result["hausdorff95"], 0.5)
        self.assertEqual([label["label"] for label in result["labels"]], [1, 2])
        self.assertEqual([label["voxels"] for label in result["labels"]], [6, 4])
        self.assertEqual([label["reference_voxels"] for label in result["labels"]], [4, 4])
        self.assertAlmostEqual(result["labels"][0]["dice"], 8 / 10)
        self.assertEqual(result["labels"][1]["dice"], 1)
        moved = nrrd("moved.nrrd", "1 1 0 0 2 2  1 1 0 0 2 2", "1 2")
        self.fail_with(2, "spacing (0.5, 2, 1) and (1, 2, 1)", "compare", a, moved)
        missing = nrrd("missing.nrrd", "0 0 0 0 2 2  0 0 0 0 2 2")
        self.succeed("compare", a, missing, "--report", self.path("report.json"))
        self.assertIsNone(self.report()["result"]["hausdorff95"])

    def test_pictures_take_the_place_and_the_mark_of_the_other_label_image(self):
        picture = self.write("a.pgm", "P2 3 2 255\n255 255 0 255 255 0\n")
        nrrd = self.write("b.nrrd", "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 3 2\nspacings: 0.5 2\nencoding: ascii\n\n"
                          "1 1 1 1 1 1\n")
        done = self.succeed("compare", picture, nrrd, "--report", self.path("report.json"))
        self.assertIn("a.pgm stores no position for its voxels", done.stderr)
        self.assertIn("with different values", done.stderr)
        self.assertAlmostEqual(self.report()["result"]["dice"], 0.8)
        self.assertAlmostEqual(self.report()["result"]["hausdorff95"], 0.5)
        larger = self.write("c.pgm", "P2 3 3 255\n0 0 0 0 0 0 0 0 0\n")
        self.fail_with(2, "3 x 2 and 3 x 3", "compare", picture, larger)


class Surfaces(CommandLine):
    """Everything that can be done with a sphere."""

    def test_reconstruct_writes_mesh_model_and_report(self):
        cloud = self.write("cloud.ply", ply(sphere(2000), colored=True))
        done = self.succeed("reconstruct", cloud, "-o", self.path("mesh.ply"), "--model", self.path("model.csrbf"),
                            "--report", self.path("report.json"), "--resolution", "48")
        self.assertEqual(self.files(), ["cloud.ply", "mesh.ply", "model.csrbf", "report.json"])
        self.assertLessEqual(len(done.stdout.splitlines()), 10)
        self.assertEqual(done.stderr, "")
        report = self.report()
        result = report["result"]
        self.assertEqual((result["points"], result["watertight"], result["components"], result["euler"]),
                         (2000, True, 1, 2))
        for key in ("points_used", "centers", "method", "vertices", "triangles", "rms_distance", "p99_distance"):
            self.assertIn(key, result)
        self.assertLess(result["p99_distance"], 1e-3)
        for key in ("method", "normals", "centers", "tolerance", "smoothing", "resolution", "trim"):
            self.assertIn(key, report["options"])
        for stage in ("read", "prepare", "fit", "evaluate", "polygonize", "write", "total"):
            self.assertIn(stage, report["time"])

        vertices, faces = read_ply(self.path("mesh.ply"))
        self.assertEqual((len(vertices), faces), (result["vertices"], result["triangles"]))
        for v in vertices:
            length = math.sqrt(v["x"] ** 2 + v["y"] ** 2 + v["z"] ** 2)
            self.assertAlmostEqual(length, 1, delta=0.01)
            self.assertGreater(v["x"] * v["nx"] + v["y"] * v["ny"] + v["z"] * v["nz"], 0.95)
            if abs(v["z"]) > 0.2:
                self.assertEqual((v["red"], v["blue"]), (255, 0) if v["z"] > 0 else (0, 255))

        info = self.succeed("info", self.path("model.csrbf"))
        self.assertIn("model:", info.stdout)
        self.succeed("polygonize", self.path("model.csrbf"), "-o", self.path("coarse.obj"), "--resolution", "16",
                     "--report", self.path("report.json"))
        self.assertTrue(self.report()["result"]["watertight"])
        self.assertEqual(self.report()["options"]["method"], "dual-contouring")
        triangles = {}
        for method in ("marching-tetrahedra", "dual-contouring", "adaptive"):
            self.succeed("polygonize", self.path("model.csrbf"), "-o", self.path("other.obj"), "--resolution", "24",
                         "--method", method, "--report", self.path("report.json"))
            result = self.report()["result"]
            self.assertEqual((result["watertight"], result["euler"]), (True, 2))
            triangles[method] = result["triangles"]
        self.assertLess(triangles["adaptive"], triangles["dual-contouring"])
        self.succeed("polygonize", self.path("model.csrbf"), "-o", self.path("other.obj"), "--resolution", "24",
                     "--method", "adaptive", "--tolerance", "0.02", "--report", self.path("report.json"))
        self.assertLess(self.report()["result"]["triangles"], triangles["adaptive"])
        self.assertEqual(self.report()["options"]["tolerance"], 0.02)
        self.fail_with(2, "--tolerance: dual-contouring has none", "polygonize", self.path("model.csrbf"), "-o",
                       self.path("other.obj"), "--method", "dual-contouring", "--tolerance", "0.02")
        self.fail_with(2, "--method", "polygonize", self.path("model.csrbf"), "-o", self.path("other.obj"), "--method",
                       "guesswork")
        for name in ("mesh.ply", "model.csrbf"):
            self.succeed("render", self.path(name), "-o", self.path("a.png"), "--size", "80x60", "--color", "normal")
            width, height, pixels = read_png(self.path("a.png"))
            self.assertEqual((width, height), (80, 60))
            self.assertGreater(len(set(pixels)), 50)
        self.succeed("compare", self.path("mesh.ply"), self.path("coarse.obj"))

    def test_medial_axis_keeps_its_budget_and_its_model(self):
        cloud = self.write("cloud.ply", ply(sphere(2000)))
        self.succeed("reconstruct", cloud, "-o", self.path("mesh.ply"), "--method", "medial-axis", "--centers", "250",
                     "--model", self.path("model.csrbf"), "--report", self.path("report.json"), "--resolution", "32")
        report = self.report()
        result = report["result"]
        self.assertEqual((result["method"], result["centers"], result["watertight"], result["components"]),
                         ("medial-axis", 250, True, 1))
        self.assertEqual(report["options"]["method"], "medial-axis")
        self.assertLess(result["rms_distance"], 1e-4)
        self.assertNotIn("patches", result)
        self.succeed("polygonize", self.path("model.csrbf"), "-o", self.path("again.ply"), "--resolution", "32")
        self.assertIn("placed surface", self.succeed("info", self.path("model.csrbf")).stdout)
        self.assertIn("medial-axis", self.succeed("reconstruct", "--help").stdout)

    def test_curvature_measures_an_ellipsoid_and_finds_its_ridge(self):
        cloud = self.write("cloud.xyz", xyz([(3 * x, 2 * y, z) for x, y, z in sphere(4000)]))
        self.succeed("reconstruct", cloud, "-o", self.path("mesh.ply"), "--model", self.path("model.csrbf"))
        self.succeed("curvature", self.path("model.csrbf"), "-o", self.path("curved.ply"), "--ridges",
                     self.path("ridges.ply"), "--resolution", "60", "--report", self.path("report.json"))
        result = self.report()["result"]
        vertices, faces = read_ply(self.path("curved.ply"))
        self.assertEqual((len(vertices), faces), (result["vertices"], result["triangles"]))
        self.assertEqual(result["singular"], 0)
        errors = []
        for v in vertices:
            self.assertGreaterEqual(v["k1"], v["k2"])
            self.assertAlmostEqual(v["mean_curvature"], (v["k1"] + v["k2"]) / 2, delta=1e-5 * (1 + abs(v["k1"])))
            self.assertAlmostEqual(v["d1x"] * v["nx"] + v["d1y"] * v["ny"] + v["d1z"] * v["nz"], 0, delta=1e-5)
            # Gaussian curvature h^4 / (a b c)^2, 1 / h^2 = x^2 / a^4 + y^2 / b^4 + z^2 / c^4
            h2 = 1 / (v["x"] ** 2 / 81 + v["y"] ** 2 / 16 + v["z"] ** 2)
            errors.append(abs(v["gaussian_curvature"] / (h2 * h2 / 36) - 1))
        # The samples are three times further apart along x than along z.
        self.assertLess(sorted(errors)[len(errors) // 2], 0.1)
        points, edges = read_ply(self.path("ridges.ply"))
        ridge = [p for p in points if p["kind"] == 1]
        self.assertEqual(len(ridge), result["ridge_points"])
        self.assertEqual(len(points) - len(ridge), result["valley_points"])
        self.assertGreater(edges, 50)
        # The ridge is the ellipse z = 0.
        self.assertLess(sorted(abs(p["z"]) for p in ridge)[len(ridge) // 2], 0.05)

    def test_combine_writes_models_that_can_be_meshed_and_drawn(self):
        for name, shift in (("a", 0), ("b", 1)):
            cloud = self.write(name + ".xyz", xyz([(x + shift, y, z) for x, y, z in sphere(1000)]))
            self.succeed("reconstruct", cloud, "-o", self.path("mesh.ply"), "--model", self.path(name + ".csrbf"))
        a, b = self.path("a.csrbf"), self.path("b.csrbf")
        volumes = {}
        for operation in ("union", "intersection", "difference", "blend"):
            model = self.path(operation + ".csrbf")
            self.succeed("combine", operation, a, b, "-o", model, "--report", self.path("report.json"))
            report = self.report()
            self.assertEqual(report["result"]["models"], 2)
            self.assertEqual(report["options"]["blending"], "super-elliptic" if operation == "blend" else "sharp")
            self.assertEqual(report["options"]["radius"], 0.05 if operation == "blend" else None)
            self.succeed("polygonize", model, "-o", self.path("mesh.off"), "--resolution", "40", "--report",
                         self.path("report.json"))
            self.assertTrue(self.report()["result"]["watertight"])
            volumes[operation] = off_volume(self.path("mesh.off"))
        # Unit balls whose centres are 1 apart share a lens of 5 pi / 12; sharp edges are cut off by about a cell.
        self.assertAlmostEqual(volumes["union"], (8 / 3 - 5 / 12) * math.pi, delta=0.1)
        self.assertAlmostEqual(volumes["intersection"], 5 / 12 * math.pi, delta=0.05)
        self.assertAlmostEqual(volumes["difference"], (4 / 3 - 5 / 12) * math.pi, delta=0.05)
        self.assertGreater(volumes["blend"], volumes["union"] + 0.01)
        self.succeed("combine", "complement", a, "-o", self.path("outside.csrbf"))
        self.succeed("combine", "intersection", b, self.path("outside.csrbf"), "-o", self.path("rest.csrbf"))
        self.succeed("render", self.path("rest.csrbf"), "-o", self.path("rest.png"), "--size", "60x40")
        self.succeed("info", self.path("rest.csrbf"))

    def test_methods_without_a_file_form_say_so_before_any_work(self):
        cloud = self.write("cloud.ply", ply(sphere(500)))
        self.fail_with(2, "cannot be saved", "reconstruct", cloud, "-o", self.path("mesh.ply"), "--method", "hoppe",
                       "--model", self.path("model.csrbf"))
        self.assertEqual(self.files(), ["cloud.ply"])

    def test_results_do_not_depend_on_the_number_of_threads(self):
        cloud = self.write("cloud.ply", ply(sphere(1000)))
        for threads in ("1", "2"):
            self.succeed("reconstruct", cloud, "-o", self.path(threads + ".ply"), "--threads", threads,
                         "--resolution", "32")
        with open(self.path("1.ply"), "rb") as one, open(self.path("2.ply"), "rb") as two:
            self.assertEqual(one.read(), two.read())

    def test_faces_of_a_file_tell_what_its_vertices_do_not(self):
        """A bracket whose twelve vertices lie on its two profiles, with its faces and without."""
        profile = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]
        caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
        faces = [face[::-1] for face in caps] + [tuple(i + 6 for i in face) for face in caps]
        for i in range(6):
            j = (i + 1) % 6
            faces += [(i, j, j + 6), (i, j + 6, i + 6)]
        rows = "".join(f"{x} {y} {z}\n" for z in (0, 5) for x, y in profile)
        rows += "".join("3 {} {} {}\n".format(*face) for face in faces)
        bracket = self.write("bracket.off", f"OFF\n12 {len(faces)} 0\n{rows}")
        for options in ([], ["--method", "composite"]):
            done = self.run_program("reconstruct", bracket, "-o", self.path("mesh.ply"), *options)
            self.assertEqual(done.returncode, 0)
            self.assertIn("20,000 points on its faces used in their place", done.stderr)
            self.succeed("compare", self.path("mesh.ply"), bracket, "--report", self.path("report.json"))
            self.assertLess(self.report()["result"]["hausdorff99"], 2e-3)

    def test_reconstruct_reads_and_writes_the_standard_streams(self):
        done = self.succeed("reconstruct", "-", "-o", "-", "--resolution", "24", stdin=xyz(sphere(500)))
        self.assertTrue(done.stdout.startswith("NOFF\n"))
        self.assertIn("watertight", done.stderr)
        self.assertEqual(self.files(), [])

    def test_estimate_normals_drops_points_that_are_not_finite(self):
        rows = "".join("%.9g,%.9g,%.9g,%d\n" % (*p, i) for i, p in enumerate(sphere(300)))
        cloud = self.write("gaps.csv", "x,y,z,number\n" + "nan,1,2,-1\n" + rows + "1,inf,2,-2\n")
        done = self.succeed("estimate-normals", cloud, "-o", self.path("out.ply"))
        self.assertIn("2 points with NaN or infinite coordinates dropped", done.stderr)
        self.assertEqual([row["number"] for row in read_ply(self.path("out.ply"))[0]], list(range(300)))

    def test_map_coordinates_keep_their_digits_or_a_warning_tells(self):
        place = (500000, 5300000, 300)
        cloud = self.write("map.xyz", "".join("%.4f %.4f %.4f\n" % tuple(a + b for a, b in zip(p, place))
                                              for p in sphere(500)))
        self.assertNotIn("precision", self.succeed("reconstruct", cloud, "-o", self.path("m.ply")).stderr)
        self.succeed("estimate-normals", cloud, "-o", self.path("n.ply"))
        for name in ("m.ply", "n.ply"):
            for row in read_ply(self.path(name))[0]:
                self.assertAlmostEqual(math.dist([row[c] for c in "xyz"], place), 1, delta=0.02)
        run = self.succeed("reconstruct", cloud, "-o", self.path("m.stl"))
        self.assertRegex(run.stderr, r"m\.stl: \.stl holds single precision, which moves coordinates by up to 0\.\d+ here")

    def test_estimate_normals_points_outwards(self):
        cloud = self.write("cloud.xyz", xyz(sphere(1000)))
        self.succeed("estimate-normals", cloud, "-o", self.path("oriented.ply"), "--report", self.path("report.json"))
        rows, faces = read_ply(self.path("oriented.ply"))
        self.assertEqual((len(rows), faces), (1000, 0))
        for v in rows:
            self.assertGreater(v["x"] * v["nx"] + v["y"] * v["ny"] + v["z"] * v["nz"], 0.95)
        self.assertEqual(self.report()["input"]["points"], 1000)
        self.assertEqual(self.report()["options"]["neighbors"], 16)  # chosen: there is no noise
        self.assertEqual(self.report()["result"], {"points": 1000, "duplicates": 0, "undetermined": 0})
        self.succeed("estimate-normals", cloud, "-o", self.path("inwards.ply"), "--orient", "viewpoint", "0,0,0")
        for v in read_ply(self.path("inwards.ply"))[0]:
            self.assertLess(v["x"] * v["nx"] + v["y"] * v["ny"] + v["z"] * v["nz"], -0.95)

    def test_progress_is_shown_as_lines_when_asked_for(self):
        cloud = self.write("cloud.ply", ply(sphere(500)))
        done = self.succeed("reconstruct", cloud, "-o", self.path("m.ply"), "--progress", "always", "--resolution", "24")
        self.assertRegex(done.stderr, r"(?m)^fit \d+ %")
        self.assertRegex(done.stderr, r"(?m)^polygonize \d+ %")

    def test_interruption_gives_130_and_leaves_nothing(self):
        cloud = self.write("cloud.ply", ply(sphere(60000)))
        process = subprocess.Popen([PROGRAM, "reconstruct", cloud, "-o", self.path("mesh.ply"), "--model",
                                    self.path("model.csrbf"), "--report", self.path("report.json"), "--progress",
                                    "always"], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for line in process.stderr:
            if line.startswith("prepare"):
                break
        process.send_signal(signal.SIGINT)
        output, messages = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, messages)
        self.assertEqual(output, "")
        self.assertIn("interrupted", messages)
        self.assertEqual(self.files(), ["cloud.ply"])

    def test_interruption_while_reading_gives_130(self):
        process = subprocess.Popen([PROGRAM, "reconstruct", "-", "-o", self.path("mesh.ply"), "--progress", "always"],
                                   stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertTrue(process.stderr.readline().startswith("read"))
        process.send_signal(signal.SIGINT)
        messages = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 130, messages)
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
