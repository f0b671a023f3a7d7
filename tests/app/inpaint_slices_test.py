"""Runs inpaint by blocks of slices: the real program on generated volumes.

usage: inpaint_slices_test.py PROGRAM [unittest options]
"""

import json
import math
import os
import random
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
import command_line_test
from fit_test import npy_bytes, read_npy


class InpaintSlices(command_line_test.CommandLine):
    WIDTH, HEIGHT, DEPTH = 48, 40, 120

    def setUp(self):
        super().setUp()
        command_line_test.PROGRAM = PROGRAM
        chance = random.Random(1)
        self.truth = [round(1000 + 500 * math.sin(x / 8 + z / 10) * math.cos(y / 9 - z / 14) + chance.gauss(0, 20))
                      for z in range(self.DEPTH) for y in range(self.HEIGHT) for x in range(self.WIDTH)]
        self.marks = [0] * len(self.truth)
        for k in range(12):  # two of them where blocks end, whichever slice that is
            self.hole(chance.randrange(self.WIDTH), chance.randrange(self.HEIGHT), 5 + 10 * k, 2 + k % 3)
        self.hole(20, 20, 60, 5)
        spoiled = [0 if mark else value for value, mark in zip(self.truth, self.marks)]
        self.image = self.file("image.npy", npy_bytes(self.shape(), spoiled, "<i2"))
        self.mask = self.file("mask.npy", npy_bytes(self.shape(), self.marks, "|u1"))

    def shape(self):
        return self.DEPTH, self.HEIGHT, self.WIDTH

    def hole(self, cx, cy, cz, r):
        for z in range(max(0, cz - r), min(self.DEPTH, cz + r + 1)):
            for y in range(max(0, cy - r), min(self.HEIGHT, cy + r + 1)):
                for x in range(max(0, cx - r), min(self.WIDTH, cx + r + 1)):
                    if (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2 <= r * r:
                        self.marks[x + self.WIDTH * (y + self.HEIGHT * z)] = 1

    def file(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def fill(self, name, *flags):
        report = self.path("report.json")
        self.succeed("inpaint", self.image, "-o", self.path(name), *flags, "--report", report)
        with open(report) as file:
            return json.load(file)

    def rms(self, name):
        """Of the filled values; all others are as they were."""
        shape, kind, found = read_npy(self.path(name))
        self.assertEqual((tuple(shape), kind), (self.shape(), "<i2"))
        self.assertTrue(all(f == t for f, t, mark in zip(found, self.truth, self.marks) if not mark))
        return math.sqrt(sum((f - t) ** 2 for f, t in zip(found, self.truth)) / sum(self.marks))

    def test_blocks_are_as_good_as_the_whole(self):
        whole = self.fill("whole.npy", "--mask", self.mask)
        parts = self.fill("parts.npy", "--mask", self.mask, "--memory", "60MB")
        self.assertGreater(parts["result"]["slice_blocks"], 1)
        for key in ("missing", "known"):
            self.assertEqual(parts["result"][key], whole["result"][key])
        self.assertEqual(parts["input"], whole["input"])
        self.assertLess(self.rms("whole.npy"), 1.3 * 20)
        self.assertLess(self.rms("parts.npy"), 1.05 * self.rms("whole.npy"))
        self.fill("again.npy", "--mask", self.mask, "--memory", "60MB", "--threads", "1")
        self.assertEqual(self.content("again.npy"), self.content("parts.npy"))

    def content(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_an_image_that_fits_is_one_block(self):
        self.fill("whole.npy", "--missing", "0")
        report = self.fill("parts.npy", "--missing", "0", "--memory", "1GB")
        self.assertEqual(report["result"]["slice_blocks"], 1)
        self.assertEqual(self.content("parts.npy"), self.content("whole.npy"))

    def test_compressed_images_are_filled_the_same(self):
        self.fill("parts.npy", "--mask", self.mask, "--memory", "60MB")
        self.fill("all.nii.gz", "--mask", self.mask, "--memory", "60MB")
        self.image = self.path("all.nii.gz")  # nothing is missing any more
        self.fill("copy.npy", "--missing", "-1", "--memory", "60MB")
        self.assertEqual(read_npy(self.path("copy.npy")), read_npy(self.path("parts.npy")))

    def test_what_cannot_be_done_by_slices_is_said(self):
        self.fail_with(2, "--memory 31 MB: is too little; give at least", "inpaint", self.image, "-o", self.path("o.npy"),
                       "--mask", self.mask, "--memory", "31MB")
        self.fail_with(2, "only .nii, .nii.gz and .npy files are written by slices", "inpaint", self.image, "-o",
                       self.path("o.nrrd"), "--memory", "60MB")
        small = self.file("small.npy", npy_bytes((2, 40, 48), [0] * (2 * 40 * 48), "|u1"))
        self.fail_with(2, "the mask has 48 x 40 x 2 pixels, the image 48 x 40 x 120", "inpaint", self.image, "-o",
                       self.path("o.npy"), "--mask", small, "--memory", "60MB")
        self.fail_with(2, "an image of one slice", "inpaint", self.file("one.npy", npy_bytes((9, 9), [1] * 81, "|u1")), "-o",
                       self.path("o.npy"), "--memory", "60MB")
        self.fail_with(2, "holds whole numbers, which cannot be NaN", "inpaint", self.image, "-o", self.path("o.npy"),
                       "--mask", self.mask, "--memory", "60MB", "--extrapolation", "nan")
        for name in ("o.npy", "o.nrrd"):
            self.assertFalse(os.path.exists(self.path(name)))

    # A small disk of its own, in a private mount namespace: full, then larger.
    def on_small_disk(self, kilobytes, name, memory):
        disk = self.path("disk")
        os.makedirs(disk, exist_ok=True)
        output = os.path.join(disk, name)
        command = f"{PROGRAM} inpaint {self.image} -o {output} --mask {self.mask} --memory {memory} --quiet"
        script = f"""
mount -t tmpfs -o size={kilobytes}k csrbf-test {disk} || exit 77
echo old > {output}
{command}; echo "code $?" >&2
ls -A {disk}; cat {output}
mount -o remount,size=200m {disk}
{command} && cp {output} {self.path("second-" + name)}
"""
        done = subprocess.run(["unshare", "--mount", "sh", "-c", script], capture_output=True, text=True)
        if done.returncode == 77 or "unshare failed" in done.stderr:
            self.skipTest("this user cannot mount a small disk")
        return done

    def test_a_full_disk_keeps_the_old_image(self):
        self.fill("room.npy", "--mask", self.mask, "--memory", "60MB")
        self.fill("room.nii.gz", "--mask", self.mask, "--memory", "60MB")
        for name, kilobytes in (("room.npy", 16), ("room.npy", 440), ("room.nii.gz", 16), ("room.nii.gz", 200)):
            with self.subTest(name=name, kilobytes=kilobytes):
                done = self.on_small_disk(kilobytes, name, "60MB")
                self.assertIn("code 1", done.stderr)
                self.assertIn(name + ": cannot write the file: No space left on device", done.stderr)
                self.assertEqual(done.stdout.splitlines(), [name, "old"])
                self.assertEqual(self.content("second-" + name), self.content(name))

    def test_a_small_disk_is_told_before_the_work(self):
        done = self.on_small_disk(440, "room.npy", "31MB")  # which is too little, as the survey finds out
        self.assertIn("No space left on device", done.stderr.split("code")[0])
        self.assertNotIn("is too little", done.stderr.split("code")[0])
        self.assertIn("is too little", done.stderr.split("code")[1])


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
