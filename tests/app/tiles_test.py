"""Surfaces in tiles by the real program: the same as at once, for any number of processes, also after kills.

usage: tiles_test.py PROGRAM [unittest options]
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
from command_line_test import sphere


def two_balls(n):
    """Rows x y z nx ny nz on two balls beside each other, in no order."""
    rows = [[*p, *p] for p in sphere(n // 2)]
    rows += [[0.7 * p[0] + 2.5, 0.7 * p[1], 0.7 * p[2], *p] for p in sphere(n // 2)]
    random.Random(1).shuffle(rows)
    return rows


def balls_side_by_side(n):
    """The same of a ball with a hole and a long one beside it, whose tip is as far right as where the hole is closed."""
    rows = [[*p, *p] for p in sphere(n) if p[0] < 0.85]
    for p in sphere(len(rows)):
        normal = [p[0] / 2.025, p[1], p[2]]
        length = math.hypot(*normal)
        rows.append([2.025 * p[0] + 2.975, p[1] + 2.5, p[2], *(x / length for x in normal)])
    random.Random(1).shuffle(rows)
    return rows


def ply(rows):
    """A binary PLY file of rows of three or six floats."""
    names = ["x", "y", "z", "nx", "ny", "nz"][:len(rows[0])]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    header += [f"property float {name}" for name in names] + ["end_header", ""]
    return "\n".join(header).encode() + b"".join(struct.pack(f"<{len(names)}f", *row) for row in rows)


class Tiles(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM
        self.cloud = self.binary("cloud.ply", ply(two_balls(6000)))
        self.mesh = self.path("mesh.ply")
        self.arguments = ["reconstruct", self.cloud, "-o", self.mesh, "--tile-points", "1000"]

    def binary(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def result(self, *flags):
        report = self.path("report.json")
        self.succeed(*self.arguments, *flags, "--report", report)
        self.assertFalse(os.path.exists(self.mesh + ".tiles"))
        with open(report) as file:
            return json.load(file)

    def kept(self, name):
        """Moves the mesh away and returns its new path."""
        path = self.path(name)
        os.replace(self.mesh, path)
        return path

    def distance(self, a, b):
        report = self.path("compare.json")
        self.succeed("compare", a, b, "--report", report)
        with open(report) as file:
            return json.load(file)["result"]["hausdorff99"]

    def test_one_tile_is_the_usual_program(self):
        self.arguments[-1] = "1000000"
        self.assertEqual(self.result()["result"]["tiles"], 1)
        tiled = self.kept("tiled.ply")
        self.succeed("reconstruct", self.cloud, "-o", self.mesh)
        self.assertTrue(filecmp.cmp(tiled, self.mesh, shallow=False))

    def test_memory_says_how_large_tiles_are(self):
        self.binary("cloud.ply", ply(two_balls(16000)))
        self.arguments[-2:] = ["--memory", "80MB"]
        options = self.result()["options"]
        self.assertGreaterEqual(options["tile_points"], 10000)
        self.assertLess(options["tile_points"], 16000)
        self.arguments[-1] = "70MB"
        self.assertIn("--memory 70 MB: is too little; give at least 79 MB", self.fail_with(*self.arguments))
        self.arguments[-1] = "much"
        self.assertIn("--memory much", self.fail_with(*self.arguments))

    def test_a_folder_alone_makes_large_tiles(self):
        self.arguments[-2:] = ["--tile-folder", self.path("steps")]
        self.assertEqual(self.result()["options"]["tile_points"], 1000000)

    def test_a_launcher_says_which_share(self):
        self.assertIn("neither mpirun nor srun", self.fail_with(*self.arguments, "--tile-share", "auto"))
        self.succeed(*self.arguments)
        alone = self.kept("alone.ply")
        runs = [subprocess.Popen([PROGRAM, *self.arguments, "--tile-share", "auto", "--quiet"],
                                 env=dict(os.environ, OMPI_COMM_WORLD_RANK=rank, OMPI_COMM_WORLD_SIZE="2"))
                for rank in ("0", "1")]
        self.assertEqual([run.wait() for run in runs], [0, 0])
        self.assertTrue(filecmp.cmp(alone, self.mesh, shallow=False))
        report = self.path("report.json")
        for rank, count in (("PMI_RANK", "PMI_SIZE"), ("SLURM_PROCID", "SLURM_NTASKS")):
            arguments = ["fit", self.path("few.csv"), "-o", self.path("few.csrbf"), "--tile-folder", self.path("few"),
                         "--tile-share", "auto", "--quiet", "--report", report]
            with open(self.path("few.csv"), "w") as file:
                file.write("x,y,z\n" + "".join(f"{i % 7},{i // 7},{i * i % 11}\n" for i in range(49)))
            subprocess.run([PROGRAM, *arguments], env=dict(os.environ, **{rank: "0", count: "1"}), check=True)
            with open(report) as file:
                self.assertEqual(json.load(file)["options"]["tile_share"], "1/1")

    def test_work_that_a_launcher_starts_unshared_gives_a_warning(self):
        for count, warns in (("2", True), ("1", False)):
            done = subprocess.run([PROGRAM, *self.arguments], capture_output=True, text=True,
                                  env=dict(os.environ, OMPI_COMM_WORLD_RANK="0", OMPI_COMM_WORLD_SIZE=count))
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("each of the 2 processes does the whole work" in done.stderr, warns, done.stderr)

    def test_tiles_fit_together(self):
        for flags in ([], ["--sharp", "off"], ["--normals", "estimate"], ["--resolution", "80"]):
            with self.subTest(flags=flags):
                result = self.result(*flags)["result"]
                self.assertGreaterEqual(result["tiles"], 6)
                self.assertTrue(result["watertight"] and result["manifold"])
                self.assertEqual((result["components"], result["euler"]), (2, 4))
                self.assertEqual(result["points_used"], result["points"])
                tiled = self.kept("tiled.ply")
                self.succeed("reconstruct", self.cloud, "-o", self.mesh, *flags)
                diagonal = math.hypot(4.2, 2, 2)
                self.assertLess(self.distance(tiled, self.mesh), 2e-3 * diagonal)

    def test_a_surface_may_enter_a_tile_without_points_there(self):
        rows = balls_side_by_side(4000)
        self.arguments[1] = self.binary("balls.ply", ply(rows))
        self.arguments[-1] = str(len(rows) // 2 + 1)
        report = self.result()["result"]
        self.assertEqual(report["tiles_meshed_again"], 1)
        self.assertEqual((report["tiles"], report["components"], report["euler"]), (2, 2, 4))
        self.assertTrue(report["watertight"] and report["manifold"])
        alone = self.kept("alone.ply")
        for process in [self.start(1, 2), self.start(2, 2)]:
            process.communicate()
        self.assertTrue(filecmp.cmp(alone, self.mesh, shallow=False))

    def test_functions_of_tiles_go_when_they_are_meshed(self):
        self.binary("cloud.ply", ply(two_balls(8000)))
        self.arguments[-1] = "1500"
        folder = self.mesh + ".tiles"
        process = self.start(1, 1)
        checked = False
        while process.poll() is None:
            names = base.names_in(folder)
            meshed = max((t for t in range(6) if f"border0_{t}.tiles" in names), default=0)
            meshed_again = any(name.startswith("missing0") for name in names)
            if meshed > 0 and not meshed_again:
                checked = True
                self.assertFalse({f"inside_{t}.tiles" for t in range(meshed)} & set(names))
            time.sleep(0.0005)
        process.communicate()
        self.assertTrue(checked)

    def test_the_model_is_read_tile_by_tile(self):
        model, places = self.path("model.csrbf"), self.path("places.csv")
        self.result("--model", model, "--resolution", "64")
        mesh = self.kept("tiled.ply")
        self.succeed("polygonize", model, "-o", self.mesh, "--resolution", "64")
        self.assertLess(self.distance(mesh, self.mesh), 1e-3)
        with open(places, "w") as file:
            file.write("x,y,z\n0,0,0\n2.5,0,0\n1.5,1,1\n")
        self.succeed("evaluate", model, "--points", places, "-o", self.path("values.csv"))
        with open(self.path("values.csv")) as file:
            values = [float(line.split(",")[-1]) for line in file.read().split("\n")[1:4]]
        self.assertGreater(min(values[:2]), 0)
        self.assertLess(values[2], 0)
        self.succeed("render", model, "-o", self.path("model.png"), "--size", "80x60")
        self.assertIn("in tiles of another file", self.fail_with("combine", "union", model, model, "-o", self.path("both.csrbf")))

    def test_the_model_of_one_tile_is_the_usual_one(self):
        self.arguments[-1] = "1000000"
        self.result("--model", self.path("tiled.csrbf"))
        self.succeed("reconstruct", self.cloud, "-o", self.mesh, "--model", self.path("usual.csrbf"))
        self.assertTrue(filecmp.cmp(self.path("tiled.csrbf"), self.path("usual.csrbf"), shallow=False))

    def test_other_formats_have_the_same_mesh(self):
        self.result()
        ply_mesh = self.kept("tiled.ply")
        self.mesh = self.path("mesh.off")
        self.arguments[3] = self.mesh
        result = self.result()["result"]
        self.assertTrue(result["watertight"])
        self.assertLess(self.distance(ply_mesh, self.mesh), 1e-6)

    def test_a_folder_gets_a_file_for_each_tile_and_they_fit(self):
        self.result()
        rows, faces = base.read_ply(self.mesh)
        self.arguments[3] = self.path("tiles/")
        os.mkdir(self.path("tiles"))
        for name in ("tile_0999.ply", "notes.ply"):
            self.binary(os.path.join("tiles", name), b"of an earlier mesh")
        tiles = self.result()["result"]["tiles"]
        files = sorted(os.listdir(self.path("tiles")))
        self.assertEqual(files.pop(0), "notes.ply")
        self.assertNotIn("tile_0999.ply", files)
        self.assertFalse(os.path.exists(self.path("tiles.tiles")))
        self.assertLessEqual(len(files), tiles)
        self.assertGreater(len(files), 1)
        corners, edges, count = set(), {}, 0
        for name in files:
            path = os.path.join(self.path("tiles"), name)
            own, triangles = base.read_ply(path)
            places = [(v["x"], v["y"], v["z"]) for v in own]
            corners.update(places)
            count += triangles
            with open(path, "rb") as file:
                data = file.read()[-13 * triangles:]
            for three, a, b, c in struct.iter_unpack("<B3i", data):
                self.assertEqual(three, 3)
                for i, j in ((a, b), (b, c), (c, a)):
                    edges[places[i], places[j]] = edges.get((places[i], places[j]), 0) + 1
        self.assertEqual(corners, {(v["x"], v["y"], v["z"]) for v in rows})
        self.assertEqual(count, faces)
        self.assertTrue(all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items()))

    def test_noise_and_outliers(self):
        noise = random.Random(2)
        rows = [[x + noise.gauss(0, 0.01) for x in row[:3]] for row in two_balls(6000)]
        rows += [[noise.uniform(-1, 3.2), noise.uniform(-1, 1), noise.uniform(-1, 1)] for _ in range(200)]
        self.arguments[1] = self.binary("noisy.ply", ply(rows))
        report = self.result()
        self.assertTrue(report["result"]["watertight"])
        self.assertEqual(report["result"]["components"], 2)
        self.assertIn("tile", " ".join(report["warnings"]))

    def test_handles_of_noise_are_removed_and_counted(self):
        noise = random.Random(3)
        rows = []
        for k, p in enumerate(sphere(6000)):
            side = 1 if k % 2 else -1  # of a thin shell
            radius = 1 if side > 0 else 0.96
            rows.append([radius * x + noise.gauss(0, 0.015) for x in p] + [side * x for x in p])
        noise.shuffle(rows)
        self.arguments[1] = self.binary("shell.ply", ply(rows))
        self.arguments[-1] = "2000"
        self.assertGreater(self.result()["result"]["weak_features"], 0)
        self.arguments[-1] = "1000000"
        whole = self.result()["result"]["weak_features"]
        del self.arguments[-2:]
        self.assertEqual(self.result()["result"]["weak_features"], whole)

    def start(self, share, count):
        return subprocess.Popen([PROGRAM, *self.arguments, "--tile-share", f"{share}/{count}"],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def test_processes_share_the_work_and_one_may_be_late(self):
        self.result()
        alone = self.kept("alone.ply")
        for count in (2, 3):
            first = [self.start(share, count) for share in range(2, count + 1)]
            time.sleep(0.3)
            for process in [*first, self.start(1, count)]:
                message = process.communicate()[1]
                self.assertEqual(process.returncode, 0, message)
            self.assertTrue(filecmp.cmp(alone, self.mesh, shallow=False))

    def test_a_killed_run_goes_on(self):
        self.result()
        alone = self.kept("alone.ply")
        folder = self.mesh + ".tiles"
        kills = 0
        for wanted in ("dealt", "points_1", "fit_0", "fit_3", "border0_2"):
            process = subprocess.Popen([PROGRAM, *self.arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while process.poll() is None:
                if any(name.startswith(wanted) for name in base.names_in(folder)):
                    process.kill()
                time.sleep(0.002)
            kills += process.returncode != 0
        self.assertGreaterEqual(kills, 2)
        report = self.result()
        self.assertTrue(filecmp.cmp(alone, self.mesh, shallow=False))
        if kills == 5:
            self.assertGreater(report["result"]["tiles_continued"], 0)

    def test_a_failed_process_ends_the_others(self):
        self.arguments += ["--tile-folder", self.path("work")]
        other = self.start(2, 2)
        time.sleep(0.2)
        os.makedirs(self.path("work"), exist_ok=True)
        with open(self.path("work/process_failed.tiles"), "w") as file:
            file.write("reconstruct: the first gave up")
        message = other.communicate(timeout=60)[1]
        self.assertNotEqual(other.returncode, 0)
        self.assertIn("the first gave up", message)

    def test_steps_of_other_work_are_refused(self):
        folder = self.mesh + ".tiles"
        process = subprocess.Popen([PROGRAM, *self.arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            if os.path.exists(os.path.join(folder, "work.tiles")):
                process.kill()
            time.sleep(0.002)
        if process.returncode == 0:
            self.skipTest("the run ended before it could be killed")
        self.arguments[-1] = "5000"
        message = self.fail_with(*self.arguments)
        self.assertIn(folder, message)
        self.assertIn("other work", message)

    def fail_with(self, *arguments):
        run = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
        self.assertNotEqual(run.returncode, 0)
        return run.stderr

    def test_what_tiles_do_not_do_is_said(self):
        for flags, words in ((["--trim", "5"], "--trim"), (["--tolerance", "1e-3"], "--tolerance"),
                             (["--method", "medial-axis"], "medial-axis"), (["--tile-share", "3/2"], "3/2"),
                             (["--tile-share", "1"], "K/N")):
            message = self.fail_with(*self.arguments, *flags)
            self.assertIn(words, message)
        message = self.fail_with("reconstruct", self.cloud, "-o", self.mesh, "--tile-share", "1/2")
        self.assertIn("--tile-folder", message)
        self.assertFalse(os.path.exists(self.mesh + ".tiles"))


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
