"""The program as built for another system: surfaces from clouds, bad files, and what only Linux has.

usage: program_test.py SYSTEM PROGRAM BUILDS EMULATOR...

The meshes are compared with those of the program for this system, the newest one in a folder of BUILDS; without one
these tests are skipped. The kitten is that of ./quickstart: scripts/demo_data gets it.
"""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SYSTEM, PROGRAM, BUILDS, *EMULATOR = sys.argv[1:]
del sys.argv[1:]
BUILDS = pathlib.Path(BUILDS)
KITTEN = BUILDS / "quickstart-data" / "kitten.xyz"
ENVIRONMENT = dict(os.environ, WINEDEBUG="-all", LC_ALL="C.UTF-8")


def native_program():
    found = [path for path in BUILDS.glob("*/bin/csrbf") if path.is_file() and path != pathlib.Path(PROGRAM)]
    found = [path for path in found if subprocess.run([path, "--version"], capture_output=True).returncode == 0]
    return max(found, key=lambda path: path.stat().st_mtime, default=None)


def run(folder, *arguments, command=None):
    command = command or [*EMULATOR, PROGRAM]
    return subprocess.run([*map(str, command), *map(str, arguments)], capture_output=True, cwd=folder, env=ENVIRONMENT,
                          stdin=subprocess.DEVNULL, text=True, errors="replace")


def sphere(count):
    points = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        angle, r = 2.399963 * i, math.sqrt(1 - z * z)
        points.append((r * math.cos(angle), r * math.sin(angle), z))
    return points


def mesh(path):
    """Vertices and triangles of an OBJ file."""
    vertices, triangles = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            triangles.append(tuple(int(word.split("/")[0]) - 1 for word in words[1:]))
    return vertices, triangles


class Program(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def succeed(self, *arguments, command=None):
        done = run(self.folder, *arguments, command=command)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def write_sphere(self, count=2000):
        (self.folder / "sphere.xyz").write_text("".join("%.17g %.17g %.17g\n" % p for p in sphere(count)))

    def check_closed(self, triangles):
        edges = {}
        for a, b, c in triangles:
            for edge in ((a, b), (b, c), (c, a)):
                edges[edge] = edges.get(edge, 0) + 1
        for (a, b), count in edges.items():
            self.assertEqual((count, edges.get((b, a))), (1, 1))

    def check_same_surface(self, cloud, diagonal):
        """The meshes of both programs: one component, vertices as close as rounding leaves them."""
        native = native_program()
        if native is None:
            self.skipTest(f"no program for this system in {BUILDS}")
        options = ["reconstruct", cloud, "--threads", "2"]
        self.succeed(*options, "-o", "there.obj", "--report", "there.json")
        self.succeed(*options, "-o", "here.obj", command=[native])
        (v, t), (w, u) = mesh(self.folder / "there.obj"), mesh(self.folder / "here.obj")
        self.check_closed(t)
        report = json.loads((self.folder / "there.json").read_text())
        self.assertEqual(report["result"]["components"], 1)
        self.assertEqual((len(v), len(t)), (len(w), len(u)))  # diagonals of flat squares and the order are by rounding
        step = 1e-9 * diagonal
        cells = {}
        for p in w:
            cells.setdefault(tuple(math.floor(c / (10 * step)) for c in p), []).append(p)
        alone = 0
        for p in v:
            at = [math.floor(c / (10 * step)) for c in p]
            near = (q for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)
                    for q in cells.get((at[0] + x, at[1] + y, at[2] + z), ()))
            alone += not any(math.dist(p, q) < step for q in near)
        print(f"{cloud}: {len(v)} vertices; {alone} farther than 1e-9 of the diagonal from those here")
        self.assertEqual(alone, 0)

    def test_says_its_version(self):
        self.assertRegex(self.succeed("--version"), r"\d+\.\d+\.\d+")

    def test_reconstructs_a_sphere_as_here(self):
        self.write_sphere()
        self.check_same_surface("sphere.xyz", 2 * math.sqrt(3))

    def test_reconstructs_the_kitten_as_here(self):
        if not KITTEN.exists():
            self.skipTest("no kitten: scripts/demo_data gets it")
        text = KITTEN.read_text()
        (self.folder / "kitten.xyz").write_text(text)
        points = [tuple(map(float, line.split()[:3])) for line in text.splitlines() if line.strip()]
        diagonal = math.dist([min(c) for c in zip(*points)], [max(c) for c in zip(*points)])
        self.check_same_surface("kitten.xyz", diagonal)

    def test_fits_a_function_and_evaluates_its_model(self):
        rows = [(x / 20, y / 20, math.sin(x / 10) * math.cos(y / 10)) for x in range(21) for y in range(21)]
        (self.folder / "samples.csv").write_text("x,y,z\n" + "".join("%.17g,%.17g,%.17g\n" % row for row in rows))
        (self.folder / "places.csv").write_text("x,y\n0.33,0.71\n0.5,0.2\n")
        self.succeed("fit", "samples.csv", "-o", "model.csrbf")
        self.succeed("evaluate", "model.csrbf", "-o", "values.csv", "--points", "places.csv")
        values = [float(line.split(",")[-1]) for line in (self.folder / "values.csv").read_text().splitlines()[1:]]
        for value, (x, y) in zip(values, ((0.33, 0.71), (0.5, 0.2)), strict=True):
            self.assertAlmostEqual(value, math.sin(2 * x) * math.cos(2 * y), places=4)

    def test_refuses_bad_files_in_words(self):
        (self.folder / "bad.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n")
        (self.folder / "bad.xyz").write_text("0 0 0\n1 0 zero\n")
        for name, words in (("bad.ply", "bad.ply"), ("bad.xyz", "bad.xyz"), ("missing.ply", "missing.ply")):
            done = run(self.folder, "reconstruct", name, "-o", "mesh.ply")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertIn("csrbf", done.stderr)
            self.assertFalse((self.folder / "mesh.ply").exists())
            self.assertEqual([p.name for p in self.folder.iterdir() if ".tmp" in p.name or "partial" in p.name], [])

    def test_overwrites_and_keeps_non_ascii_names(self):
        self.write_sphere(500)
        for _ in range(2):
            self.succeed("reconstruct", "sphere.xyz", "-o", "Kugel-\u00e4.ply", "--resolution", "20")
        self.assertTrue((self.folder / "Kugel-\u00e4.ply").exists())

    @unittest.skipUnless(SYSTEM == "Windows", "of Windows")
    def test_what_only_linux_has_says_so(self):
        self.assertIn("not on Windows", run(self.folder, "studio").stderr)


if __name__ == "__main__":
    unittest.main()
