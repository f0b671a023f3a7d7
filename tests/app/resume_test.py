"""Kills runs of the real program with --resume and goes on: the same results, less work; damaged and foreign logs.

usage: resume_test.py PROGRAM [--slow] [unittest options]
"""

import fcntl
import filecmp
import json
import os
import random
import shutil
import subprocess
import sys
import time
import unittest

import command_line_test as base
from command_line_test import ply, sphere
from robustness_test import samples

SLOW = False


class Resume(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM
        self.cloud = self.write("cloud.ply", ply(sphere(20000)))
        self.mesh, self.log = self.path("mesh.ply"), self.path("mesh.ply.resume")
        self.arguments = ["reconstruct", self.cloud, "-o", self.mesh, "--resume"]

    def run_until_log(self, size, arguments, log):
        """Kills a run when its log has so many bytes; False when it ended before."""
        process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            if os.path.exists(log) and os.path.getsize(log) >= size:
                process.kill()
            time.sleep(0.002)
        return process.returncode != 0

    def begin(self, size=200000, arguments=None, result=None):
        """A run that was killed when its log held something. On a busy machine it may end before that is seen."""
        arguments, result = arguments or self.arguments, result or self.mesh
        for _ in range(10):
            if self.run_until_log(size, arguments, result + ".resume"):
                break
            os.remove(result)
        self.assertTrue(os.path.exists(result + ".resume"))

    def resumed(self, *flags):
        """The report of a run to the end, whose log is gone."""
        self.succeed(*self.arguments, *flags, "--report", self.path("report.json"))
        self.assertFalse(os.path.exists(self.log))
        with open(self.path("report.json")) as file:
            return json.load(file)["resume"]

    def whole(self):
        """The mesh of a run without a log."""
        path = self.path("whole.ply")
        self.succeed("reconstruct", self.cloud, "-o", path)
        return path

    def assert_same(self, a, b):
        self.assertTrue(filecmp.cmp(a, b, shallow=False), "the resumed run gave another result")

    def test_goes_on_where_it_was_killed(self):
        self.begin()
        self.assertFalse(os.path.exists(self.mesh))
        self.assertGreater(self.resumed("--threads", "1")["seconds_saved"], 0)
        self.assert_same(self.mesh, self.whole())

    def test_a_run_that_nothing_breaks_off_leaves_no_log(self):
        resume = self.resumed()
        self.assertEqual(resume["seconds_saved"], 0)
        self.assertEqual(sorted(set(self.files()) - {"cloud.ply", "mesh.ply", "report.json"}), [])

    def test_functions_too(self):
        table, model = self.write("samples.csv", samples(20000)), self.path("f.csrbf")
        arguments = ["fit", table, "-o", model, "--resume"]
        self.begin(100000, arguments, model)
        self.succeed(*arguments)
        self.succeed("fit", table, "-o", self.path("whole.csrbf"))
        # Models also hold the times of their fit.
        for name in ("f", "whole"):
            self.succeed("evaluate", self.path(name + ".csrbf"), "-o", self.path(name + ".npy"), "--grid", "40,40",
                         "--bounds=-1:1,-1:1", "--gradient")
        self.assert_same(self.path("f.npy"), self.path("whole.npy"))

    def test_many_kills_in_a_row_lose_nothing(self):
        kills, seed = (100, 2) if SLOW else (5, 2)
        print("kill -9: %d times, seed %d" % (kills, seed), file=sys.stderr)
        sizes = random.Random(seed)
        for _ in range(kills):
            before = os.path.getsize(self.log) if os.path.exists(self.log) else 0
            if not self.run_until_log(before + sizes.randrange(1, 3000000), self.arguments, self.log):
                break
        self.resumed()
        self.assert_same(self.mesh, self.whole())

    def test_a_damaged_end_is_dropped(self):
        self.begin()
        shutil.copy(self.log, self.path("log"))
        size, whole = os.path.getsize(self.log), self.whole()
        for seed in range(6):
            at = random.Random(seed).randrange(400, size)
            with self.subTest(at=at):
                shutil.copy(self.path("log"), self.log)
                with open(self.log, "r+b") as file:
                    if seed % 2 == 0:
                        file.truncate(at)
                    else:
                        file.seek(at)
                        byte = file.read(1)
                        file.seek(at)
                        file.write(bytes([byte[0] ^ 1]))
                self.resumed()
                self.assert_same(self.mesh, whole)

    def test_a_log_of_another_run_is_refused_and_kept(self):
        self.begin()
        size = os.path.getsize(self.log)
        self.fail_with(2, "delete the file to start over", *self.arguments, "--smoothing", "none")
        self.fail_with(2, 'this run "--smoothing none"', *self.arguments, "--smoothing", "none")
        with open(self.cloud, "a") as file:
            file.write("\n")
        self.fail_with(2, "with fingerprint", *self.arguments)
        self.assertEqual(os.path.getsize(self.log), size)

    def test_a_log_that_is_in_use_is_left_alone(self):
        self.begin()
        with open(self.log, "r+b") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.fail_with(2, "in use by another run", *self.arguments)
        self.assertGreater(self.resumed()["seconds_saved"], 0)

    def test_a_file_that_is_no_log_is_refused_and_kept(self):
        for content in ("precious", "precious " * 100):
            self.write("mesh.ply.resume", content)
            self.fail_with(2, "mesh.ply.resume: is not a resume log", *self.arguments)
            with open(self.log) as file:
                self.assertEqual(file.read(), content)

    def test_standard_streams_have_no_log(self):
        self.fail_with(2, "--resume needs an input that can be read again", "reconstruct", "-", "-o", self.mesh,
                       "--resume")


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if "--slow" in sys.argv:
        sys.argv.remove("--slow")
        SLOW = True
    unittest.main(verbosity=2)
