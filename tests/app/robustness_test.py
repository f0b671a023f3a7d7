"""Takes memory, room on the disk, permissions and time away from the real program: it says so, leaves no half-written
result, and the next run is not disturbed.

usage: robustness_test.py PROGRAM [--slow] [unittest options]

With --slow: many more kills, and valgrind on every command.
"""

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

import command_line_test as base
from command_line_test import OCTAHEDRON, ply, sphere, xyz

SLOW = False
MB = 1 << 20


def samples(n):
    """Text table of a smooth function at points of a spiral."""
    return "x,y,z\n" + "".join("%.9g,%.9g,%.9g\n" % (x, y, x * y + z) for x, y, z in sphere(n))


def square_image(n):
    """A bright square on a dark ground, as binary PGM."""
    rows = bytes(200 if n // 4 < x < n // 2 and n // 4 < y < n // 2 else 50 for y in range(n) for x in range(n))
    return b"P5\n%d %d\n255\n" % (n, n) + rows


class Robustness(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM

    def write_bytes(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def inputs(self, points):
        """Something for every command to work on."""
        self.cloud = self.write("cloud.ply", ply(sphere(points)))
        self.table = self.write("samples.csv", samples(points))
        self.image = self.write_bytes("image.pgm", square_image(64))
        self.mesh = self.write("octahedron.off", OCTAHEDRON)
        self.surface, self.function = self.path("surface.csrbf"), self.path("function.csrbf")
        self.succeed("reconstruct", self.cloud, "-o", self.path("mesh.ply"), "--model", self.surface, "-q")
        self.succeed("fit", self.table, "-o", self.function, "-q")

    def runs(self, extensive=False):
        """A run of every command that writes a file: arguments up to the output, and the output."""
        small = [] if extensive else ["--resolution", "24"]
        grid = "700,700" if extensive else "9,9"
        return [
            (["reconstruct", self.cloud] + small, "out.ply"),
            (["estimate-normals", self.cloud], "out.ply"),
            (["polygonize", self.surface, "--resolution", "256" if extensive else "24"], "out.ply"),
            (["fit", self.table], "out.csrbf"),
            (["evaluate", self.function, "--grid", grid, "--bounds", "-1:1,-1:1"], "out.npy"),
            (["segment", self.image], "out.png"),
            (["inpaint", self.image, "--missing", "200"], "out.png"),
            (["curvature", self.surface] + small, "out.ply"),
            (["combine", "union", self.surface, self.surface], "out.csrbf"),
            (["render", self.mesh, "--size", "40x30"], "out.png"),
        ]

    def run_limited(self, limit, bytes_, *arguments):
        def set_limit():
            resource.setrlimit(limit, (bytes_, bytes_))
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=600, preexec_fn=set_limit)


class MemoryLimit(Robustness):
    """As `ulimit -v` sets it."""

    LIMITS = [24, 32, 48, 56, 64, 80, 140, 240]

    def limited(self, megabytes, *arguments):
        return self.run_limited(resource.RLIMIT_AS, megabytes * MB, *arguments, "--threads", "2")

    def test_too_little_memory_gives_1_and_no_output(self):
        self.inputs(20000)
        limits = [m for m in self.LIMITS if self.limited(m, "info", self.mesh).returncode == 0]
        if not limits:
            self.skipTest("the program does not start in little memory, as with sanitizers")
        before, refused = self.files(), set()
        for arguments, output in self.runs(extensive=True):
            for megabytes in limits:
                with self.subTest(command=arguments[0], megabytes=megabytes):
                    done = self.limited(megabytes, *arguments, "-o", self.path(output))
                    if done.returncode == 0:
                        os.remove(self.path(output))
                        break
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertIn("not enough memory", done.stderr)
                    self.assertEqual("--memory SIZE" in done.stderr, arguments[0] in ("reconstruct", "fit", "inpaint"))
                    refused.add(arguments[0])
                    self.assertEqual(self.files(), before)
        self.assertLessEqual({"reconstruct", "polygonize", "fit"}, refused)


class FullDisk(Robustness):
    FORMATS = {
        "reconstruct": [".ply", ".obj", ".off", ".stl", ".vtp"],
        "estimate-normals": [".ply", ".xyz", ".npy", ".csv"],
        "evaluate": [".npy", ".csv", ".tif", ".nii", ".nii.gz", ".nrrd", ".mha", ".vti"],
        "segment": [".png", ".tif", ".pgm", ".nrrd", ".nii.gz", ".npy", ".mha"],
    }

    def outputs(self):
        for arguments, output in self.runs():
            stem, extension = os.path.splitext(output)
            for extension in self.FORMATS.get(arguments[0], [extension]):
                yield arguments, stem + extension

    def test_every_format_says_that_the_file_cannot_grow(self):
        self.inputs(300)
        before = self.files()
        for arguments, output in self.outputs():
            with self.subTest(command=arguments[0], output=output):
                done = self.run_limited(resource.RLIMIT_FSIZE, 64, *arguments, "-o", self.path(output))
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(output + ": cannot write the file: File too large", done.stderr)
                self.assertEqual(self.files(), before)

    def test_reports_and_models_do_too(self):
        self.inputs(300)
        before = self.files()
        for flag, name in (("--report", "r.json"), ("--report", "r.html")):
            done = self.run_limited(resource.RLIMIT_FSIZE, 64, "info", self.mesh, flag, self.path(name))
            self.assertEqual((done.returncode, self.files()), (1, before), done.stderr)
            self.assertIn("File too large", done.stderr)

    def test_a_disk_without_room_keeps_the_old_result(self):
        self.inputs(300)
        disk = self.path("disk")
        os.mkdir(disk)
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "csrbf-test", disk], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("only root may mount a small disk")
        try:
            old = self.write("disk/out.ply", "old")
            done = self.run_program("reconstruct", self.cloud, "-o", old)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("out.ply: cannot write the file: No space left on device", done.stderr)
            self.assertEqual(os.listdir(disk), ["out.ply"])
            self.assertEqual(self.bytes_of("disk/out.ply"), b"old")
        finally:
            subprocess.run(["umount", disk], check=True)


class ReadOnly(Robustness):
    def run_unprivileged(self, *arguments):
        """Permissions hold back everyone but root."""
        def give_up():
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
        root = os.getuid() == 0
        try:
            return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=120,
                                  preexec_fn=give_up if root else None)
        except (PermissionError, subprocess.SubprocessError):
            self.skipTest("others than root cannot run the program here")

    def fails(self, output):
        done = self.run_unprivileged("reconstruct", self.cloud, "-o", output)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(output + ": cannot write the file: Permission denied", done.stderr)

    def setUp(self):
        super().setUp()
        self.cloud = self.write("cloud.xyz", xyz(sphere(300)))
        os.chmod(self.folder.name, 0o755)

    def test_a_folder_without_permission_to_write_gives_1(self):
        os.mkdir(self.path("locked"))
        os.chmod(self.path("locked"), 0o555)
        self.fails(self.path("locked/mesh.ply"))
        self.assertEqual(os.listdir(self.path("locked")), [])

    def test_a_protected_file_is_not_replaced(self):
        os.mkdir(self.path("open"))
        os.chmod(self.path("open"), 0o777)
        old = self.write("open/mesh.ply", "old")
        os.chmod(old, 0o444)
        self.fails(old)
        self.assertEqual(self.bytes_of("open/mesh.ply"), b"old")
        self.assertEqual(os.listdir(self.path("open")), ["mesh.ply"])


class Kill(Robustness):
    def killed(self, seconds, *arguments):
        process = subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        process.kill()
        return process.wait() == -signal.SIGKILL

    def test_a_killed_run_leaves_the_old_result_or_the_new_one(self):
        kills, seed = (400, 1) if SLOW else (12, 1)
        print("kill -9: %d times, seed %d" % (kills, seed), file=sys.stderr)
        moments = random.Random(seed)
        cloud = self.write("cloud.ply", ply(sphere(3000)))
        names = ["mesh.ply", "model.csrbf"]
        arguments = ["reconstruct", cloud, "-o", self.path(names[0]), "--model", self.path(names[1])]
        start = time.monotonic()
        self.succeed(*arguments)
        usual = time.monotonic() - start
        whole = {name: self.bytes_of(name) for name in names}
        hits = 0
        for _ in range(kills):
            moment = moments.uniform(0, 1.1) * usual
            for name in names:
                self.write(name, "old")
            hits += self.killed(moment, *arguments)
            for name in names:
                self.assertIn(self.bytes_of(name), (b"old", whole[name]), "%s after %.4f s" % (name, moment))
        self.assertGreater(hits, kills // 4)
        self.succeed(*arguments)
        self.assertEqual({name: self.bytes_of(name) for name in names}, whole)

    def test_what_a_killed_run_with_the_same_process_number_left_does_not_disturb(self):
        cloud = self.write("cloud.xyz", xyz(sphere(300)))

        def leave_temporaries():
            for i in range(3):
                with open(self.path(".mesh.ply.%d-%d.tmp" % (os.getpid(), i)), "w") as file:
                    file.write("left over")
        done = subprocess.run([PROGRAM, "reconstruct", cloud, "-o", self.path("mesh.ply")], capture_output=True,
                              text=True, timeout=120, preexec_fn=leave_temporaries)
        self.assertEqual(done.returncode, 0, done.stderr)


class Valgrind(Robustness):
    def test_no_command_misuses_memory(self):
        if not SLOW:
            self.skipTest("slow: run with --slow")
        if not shutil.which("valgrind"):
            self.skipTest("no valgrind")
        command = ["valgrind", "-q", "--error-exitcode=99", "--leak-check=full", "--errors-for-leak-kinds=definite", PROGRAM]
        self.inputs(150)
        self.write_bytes("image.pgm", square_image(16))
        runs = [arguments + ["-o", self.path(output)] for arguments, output in self.runs()]
        runs += [["info", self.cloud], ["compare", self.mesh, self.mesh],
                 ["track", self.image, self.image, "-o", self.path("frames")]]
        for arguments in runs:
            with self.subTest(command=arguments[0]):
                done = subprocess.run(command + arguments + ["--threads", "2"], capture_output=True, text=True,
                                      timeout=1800)
                self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if "--slow" in sys.argv:
        sys.argv.remove("--slow")
        SLOW = True
    unittest.main(verbosity=2)
