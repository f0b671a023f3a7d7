"""Runs the real program with --memory: the same results in less memory, and clear errors where that cannot be.

usage: memory_test.py PROGRAM [--slow] [unittest options]

With --slow: 20 million points in 2 GB, against a run without a cap (some 10 GB of memory, 20 GB of disk).
"""

import filecmp
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import command_line_test as base
from command_line_test import ply, sphere

SLOW = False
MAKE_CLOUD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../benchmarks/make_cloud.py")


class Memory(base.CommandLine):
    def setUp(self):
        base.PROGRAM = PROGRAM
        # A folder of the build: the usual one for temporary files may be kept in memory.
        self.folder = tempfile.TemporaryDirectory(prefix="csrbf_test_", dir=os.path.dirname(PROGRAM))
        self.addCleanup(self.folder.cleanup)
        self.cloud = self.write("cloud.ply", ply(sphere(300)))
        done = self.run_program("info", self.cloud, "--memory", "1GB", "--scratch", self.folder.name)
        if "was built without it" in done.stderr:
            self.skipTest("a program with sanitizers has no --memory")

    def make_cloud(self, points):
        path = self.path("large.ply")
        done = subprocess.run(["/usr/bin/python3", MAKE_CLOUD, str(points), path], capture_output=True, text=True)
        if "No module named 'numpy'" in done.stderr:
            self.skipTest("no numpy")
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def reconstruct(self, cloud, name, *flags):
        report = self.path(name + ".json")
        self.succeed("reconstruct", cloud, "-o", self.path(name), "--report", report, *flags)
        with open(report) as file:
            return json.load(file)

    def compare_with_cap(self, points, cap, flag):
        """The reports of a run without and one with a cap, which write the same mesh."""
        cloud = self.make_cloud(points)
        free = self.reconstruct(cloud, "free.ply")
        capped = self.reconstruct(cloud, "capped.ply", "--memory", flag)
        self.assertTrue(filecmp.cmp(self.path("free.ply"), self.path("capped.ply"), shallow=False))
        self.assertEqual([name for name in self.files() if name.startswith(".")], [])
        self.assertEqual(capped["memory"]["cap_mb"], round(cap / (1 << 20)))
        self.assertEqual(capped["memory"]["scratch"], self.folder.name)
        self.assertGreater(capped["memory"]["peak_scratch_mb"], 0)
        self.assertNotIn("memory", free)
        return free, capped

    def test_the_cap_halves_the_memory_and_changes_no_bit(self):
        free, capped = self.compare_with_cap(300000, 110e6, "110MB")
        self.assertGreater(free["peak_memory_mb"], 160)
        # The watcher may be late on a busy machine, and libraries for all formats take 25 MB.
        self.assertLess(capped["peak_memory_mb"], 0.55 * free["peak_memory_mb"])

    def test_a_cap_that_is_no_size_gives_2(self):
        out = ["-o", self.path("mesh.ply")]
        for text in ("2", "lots", "GB", "2gb", "-2GB", "2 GB", "2GBs"):
            self.fail_with(2, "expected a size such as 2GB", "reconstruct", self.cloud, *out, "--memory=" + text)
        self.fail_with(2, "at least 64MB", "reconstruct", self.cloud, *out, "--memory", "1MB")

    def test_scratch_folders_that_cannot_work_give_2(self):
        run = ["reconstruct", self.cloud, "-o", self.path("mesh.ply"), "--memory", "1GiB", "--scratch"]
        self.fail_with(2, "--scratch /no/folder: No such file", *run, "/no/folder")
        if os.path.isdir("/dev/shm"):
            self.fail_with(2, "kept in memory", *run, "/dev/shm")

    def test_a_scratch_folder_without_room_gives_1_and_says_where(self):
        cloud = self.make_cloud(100000)
        before = self.files()
        limit = 1 << 20

        def set_limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        done = subprocess.run([PROGRAM, "reconstruct", cloud, "-o", self.path("mesh.ply"), "--memory", "64MB"],
                              capture_output=True, text=True, timeout=300, preexec_fn=set_limit)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("not enough memory: cannot keep a block of 2 MB in a file in " + self.folder.name, done.stderr)
        self.assertIn("--scratch", done.stderr)
        self.assertEqual(self.files(), before)

    def test_a_killed_run_leaves_no_file(self):
        cloud = self.make_cloud(200000)
        before = self.files()
        process = subprocess.Popen([PROGRAM, "reconstruct", cloud, "-o", self.path("mesh.ply"), "--memory", "64MB"],
                                   stderr=subprocess.DEVNULL)
        time.sleep(1)
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL)
        self.assertEqual(self.files(), before)

    def test_twenty_million_points_fit_into_2_gb(self):
        if not SLOW:
            self.skipTest("slow: run with --slow")
        self.timeout = 3000
        free, capped = self.compare_with_cap(20000000, 2e9, "2GB")
        self.assertLess(capped["peak_memory_mb"], 2e9 / (1 << 20))
        print("peak %.0f MB, with cap %.0f MB; time %.0f s, with cap %.0f s" %
              (free["peak_memory_mb"], capped["peak_memory_mb"], free["time"]["total"], capped["time"]["total"]),
              file=sys.stderr)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if "--slow" in sys.argv:
        sys.argv.remove("--slow")
        SLOW = True
    unittest.main(verbosity=2)
