"""Work in tiles that is killed, finds a full disk, or starts late, by the real program: the same command goes on to the
same bytes, or there is one clear error and no broken output.

usage: tile_failures_test.py PROGRAM [unittest options]
"""

import filecmp
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

import command_line_test as base
from fit_tiles_test import npy, samples
from tiles_test import ply, two_balls

# What the steps write, in their order; some are there for a few milliseconds only.
SURFACE_STEPS = ("survey", "work", "raw0", "dealt", "points_1", "outline", "rim_0", "inside_2", "fit_0", "fit_4", "part0_0",
                 "seam0_1", "border0_2", "missing0_0", "dropped", "numbers_0", "whole", "mesh", "written_1", "left")
FUNCTION_STEPS = ("survey", "work", "raw0", "dealt", "points_2", "model_0", "fit_1", "fit_4", "left")

ALONE = {}  # what undisturbed processes make of the inputs


class TileFailures(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM
        self.steps = self.path("steps")
        cloud, table = self.path("cloud.ply"), self.path("samples.npy")
        with open(cloud, "wb") as file:
            file.write(ply(two_balls(8000)))
        with open(table, "wb") as file:
            file.write(npy(samples(12000, 1)))
        self.works = (
            (["reconstruct", cloud, "-o", self.path("mesh.ply"), "--tile-points", "1500"], SURFACE_STEPS),
            (["fit", table, "-o", self.path("model.csrbf"), "--tile-points", "2000"], FUNCTION_STEPS))

    def start(self, arguments, *flags, folder=None):
        return subprocess.Popen([PROGRAM, *arguments, "--quiet", "--tile-folder", folder or self.steps, *flags],
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def finish(self, processes):
        """Waits for processes; returns their messages."""
        return [process.communicate(timeout=120)[1] for process in processes]

    def alone(self, arguments):
        """The output of one undisturbed process, made once for all tests."""
        name = os.path.basename(arguments[1])
        if name not in ALONE:
            self.assertEqual(self.finish([self.start(arguments)]), [""])
            with open(arguments[3], "rb") as file:
                ALONE[name] = file.read()
            os.remove(arguments[3])
        with open(arguments[3] + ".alone", "wb") as file:
            file.write(ALONE[name])
        return arguments[3] + ".alone"

    def run_until(self, wanted, processes):
        """Kills all processes once a file of a step is there; returns whether they were killed."""
        while all(process.poll() is None for process in processes):
            if os.path.isdir(self.steps) and any(name.startswith(wanted) for name in os.listdir(self.steps)):
                break
            time.sleep(0.001)
        killed = any(process.poll() is None for process in processes)
        for process in processes:
            process.kill()
        self.finish(processes)
        return killed

    def assert_goes_on(self, arguments, alone, count=1):
        processes = [self.start(arguments, "--tile-share", f"{k}/{count}") for k in range(1, count + 1)]
        self.assertEqual(self.finish(processes), [""] * count)
        self.assertEqual([process.returncode for process in processes], [0] * count)
        self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))
        self.assertFalse(os.path.exists(self.steps))
        os.remove(arguments[3])

    def test_a_kill_in_any_step(self):
        for arguments, steps in self.works:
            alone = self.alone(arguments)
            kills, chains = 0, 3
            for first in range(chains):  # of every third step, one after the other
                for step in steps[first::chains]:
                    with self.subTest(command=arguments[0], step=step):
                        kills += self.run_until(step, [self.start(arguments)])
                        if os.path.exists(arguments[3]):  # complete or not there
                            self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))
                with self.subTest(command=arguments[0], first=steps[first]):
                    self.assert_goes_on(arguments, alone)
            self.assertGreater(kills, len(steps) // 2)

    def test_an_interrupted_run_tells_where_its_steps_are(self):
        for arguments, _ in self.works:
            steps = self.path(arguments[0])
            run = self.start(arguments, folder=steps)
            while not (os.path.isdir(steps) and any(name.startswith("points_1") for name in os.listdir(steps))):
                time.sleep(0.001)
            run.send_signal(signal.SIGINT)
            message, = self.finish([run])
            with self.subTest(command=arguments[0]):
                self.assertEqual(run.returncode, 130, message)
                self.assertIn(f"interrupted; the same command goes on from the steps in {steps}", message)

    def test_another_number_of_processes_goes_on(self):
        for arguments, steps in self.works:
            alone = self.alone(arguments)
            for step, before, after in (("raw0", 3, 2), ("points", 2, 3), ("fit", 3, 1), ("fit", 1, 3)):
                with self.subTest(command=arguments[0], step=step, before=before, after=after):
                    self.run_until(step, [self.start(arguments, "--tile-share", f"{k}/{before}")
                                          for k in range(1, before + 1)])
                    self.assert_goes_on(arguments, alone, after)

    def test_the_first_waits_for_a_late_one_that_had_left_before(self):
        arguments, _ = self.works[0]
        alone = self.alone(arguments)
        shares = [["--tile-share", f"{k}/2"] for k in (1, 2)]
        while not self.run_until("left_0", [self.start(arguments, *share) for share in shares]):
            os.remove(arguments[3])  # they were done before
        os.makedirs(self.steps, exist_ok=True)
        for rank in range(2):  # as a run leaves them that is killed before it cleans up
            open(os.path.join(self.steps, f"left_{rank}.tiles"), "w").close()
        first = self.start(arguments, *shares[0])
        time.sleep(2)
        self.assertEqual(self.finish([first, self.start(arguments, *shares[1])]), ["", ""])
        self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))
        self.assertFalse(os.path.exists(self.steps))

    def test_one_of_several_is_killed_and_starts_again(self):
        for arguments, steps in self.works:
            alone = self.alone(arguments)
            for step, share in (("dealt_0", 2), ("points_1", 1), ("fit_1", 2), ("fit_3", 3)):
                with self.subTest(command=arguments[0], step=step, share=share):
                    others = [self.start(arguments, "--tile-share", f"{k}/3") for k in range(1, 4) if k != share]
                    self.run_until(step, [self.start(arguments, "--tile-share", f"{share}/3")])
                    late = self.start(arguments, "--tile-share", f"{share}/3")
                    self.assertEqual(self.finish([*others, late]), [""] * 3)
                    self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))

    def test_a_failure_of_an_earlier_run_is_forgotten(self):
        arguments = self.works[0][0]
        alone = self.alone(arguments)
        os.makedirs(self.steps)
        with open(os.path.join(self.steps, "process_failed.tiles"), "w") as file:
            file.write("the last run gave up")
        time.sleep(0.05)
        late = [self.start(arguments, "--tile-share", "2/2")]
        time.sleep(0.5)
        self.assertEqual(self.finish([self.start(arguments, "--tile-share", "1/2"), *late]), ["", ""])
        self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))

    def test_processes_that_disagree_do_not_wait_for_each_other(self):
        for arguments, _ in self.works:
            points = arguments.index("--tile-points")
            other_options = arguments[:points + 1] + ["1800"] + arguments[points + 2:]
            copy = [arguments[0], self.path("copy" + os.path.splitext(arguments[1])[1]), *arguments[2:]]
            shutil.copyfile(arguments[1], copy[1])
            for pause in (0.3, -0.3):  # the leading one is first, or last
                for second, share in ((other_options, "2/2"), (copy, "2/2"), (arguments, "3/3")):
                    with self.subTest(command=arguments[0], pause=pause, share=share, other=second[1:5]):
                        starts = [(arguments, "1/2"), (second, share)]
                        runs = []
                        for start in starts if pause >= 0 else starts[::-1]:
                            runs.append(self.start(start[0], "--tile-share", start[1]))
                            time.sleep(abs(pause))
                        try:
                            messages = self.finish(runs)
                        finally:
                            for run in runs:
                                run.kill()
                        self.assertEqual([run.returncode for run in runs], [1, 1])
                        for message in messages:
                            self.assertIn("another process works here with another input, other options", message)
                        self.assertFalse(os.path.exists(arguments[3]))

    def test_nor_do_those_that_go_on(self):
        for arguments, _ in self.works:
            with self.subTest(command=arguments[0]):
                self.run_until("points_1", [self.start(arguments, "--tile-share", f"{k}/2") for k in (1, 2)])
                runs = [self.start(arguments, "--tile-share", share) for share in ("1/2", "3/3")]
                try:
                    messages = self.finish(runs)
                finally:
                    for run in runs:
                        run.kill()
                self.assertEqual([run.returncode for run in runs], [1, 1], messages)
                for message in messages:
                    self.assertIn("another process works here with another input, other options", message)
                shutil.rmtree(self.steps)

    def test_the_same_work_is_not_done_twice_at_once(self):
        for arguments, _ in self.works:
            alone = self.alone(arguments)
            first = self.start(arguments)
            while not os.path.exists(os.path.join(self.steps, "process_0.tiles")) and first.poll() is None:
                time.sleep(0.001)
            message, = self.finish([self.start(arguments)])
            self.assertIn("another process works here under the same number", message)
            self.assertEqual(self.finish([first]), [""])
            self.assertTrue(filecmp.cmp(alone, arguments[3], shallow=False))
            os.remove(arguments[3])
            self.assertFalse(os.path.exists(self.steps))

    def test_steps_of_unplanned_work_are_not_taken(self):
        surface = self.works[0][0]
        self.run_until("fit_4", [self.start(surface)])
        os.remove(os.path.join(self.steps, "work.tiles"))
        surface[1] = self.path("other.ply")
        with open(surface[1], "wb") as file:
            file.write(ply([[2 * x for x in row[:3]] + row[3:] for row in two_balls(8000)]))
        other = self.alone(surface)
        self.assertEqual(self.finish([self.start(surface, folder=self.path("fresh"))]), [""])
        self.assertTrue(filecmp.cmp(other, surface[3], shallow=False))

    # A small disk of its own, in a private mount namespace: full, then larger.
    def on_small_disk(self, kilobytes, arguments, count, flags=("--quiet",)):
        disk = self.path("disk")
        os.makedirs(disk, exist_ok=True)
        output = os.path.join(disk, os.path.basename(arguments[3]))
        command = [PROGRAM, *arguments[:3], output, *arguments[4:], *flags, "--tile-folder", os.path.join(disk, "steps")]
        script = f"""
mount -t tmpfs -o size={kilobytes}k csrbf-test {disk} || exit 77
for k in {" ".join(str(k) for k in range(1, count + 1))}; do
  (timeout 60 {" ".join(command)} --tile-share $k/{count}; echo "code $?" >&2) &
done
wait
echo ROOM >&2
[ -e {output} ] && cp {output} {self.path("first")}
mount -o remount,size=200m {disk}
for k in {" ".join(str(k) for k in range(1, count + 1))}; do
  (timeout 60 {" ".join(command)} --tile-share $k/{count}; echo "code $?" >&2) &
done
wait
cp {output} {self.path("second")}
ls -A {disk} > {self.path("left")}
"""
        done = subprocess.run(["unshare", "--mount", "sh", "-c", script], capture_output=True, text=True)
        if done.returncode == 77 or "unshare failed" in done.stderr:
            self.skipTest("this user cannot mount a small disk")
        return done.stderr.split("ROOM\n")

    def test_a_full_disk(self):
        for arguments, _ in self.works:
            alone = self.alone(arguments)
            full = 0
            for kilobytes, count in ((8, 1), (300, 1), (1000, 2), (2000, 1), (3000, 2), (5000, 1)):
                with self.subTest(command=arguments[0], kilobytes=kilobytes, count=count):
                    for name in ("first", "second"):
                        if os.path.exists(self.path(name)):
                            os.remove(self.path(name))
                    before, after = self.on_small_disk(kilobytes, arguments, count)
                    codes = [line for line in before.splitlines() if line.startswith("code")]
                    messages = [line for line in before.splitlines() if not line.startswith("code")]
                    self.assertEqual(len(codes), count)
                    self.assertNotIn("code 124", codes, before)  # one waits for ever
                    if codes != ["code 0"] * count:
                        full += 1
                        self.assertEqual(len(messages), sum(code != "code 0" for code in codes), before)
                        self.assertTrue(any("No space left on device" in message or "make room" in message
                                            for message in messages), before)
                    if os.path.exists(self.path("first")):
                        self.assertTrue(filecmp.cmp(alone, self.path("first"), shallow=False))
                    self.assertEqual(after.count("code 0"), count, after)
                    self.assertTrue(filecmp.cmp(alone, self.path("second"), shallow=False))
                    with open(self.path("left")) as file:
                        self.assertEqual(file.read().split(), [os.path.basename(arguments[3])])
            self.assertGreaterEqual(full, 4)

    def test_a_small_disk_is_told_at_the_start(self):
        for arguments, _ in self.works:
            for kilobytes, words, code in ((100, "the points alone take", "code 2"), (600, "the steps may take", None),
                                           (20000, None, "code 0")):
                with self.subTest(command=arguments[0], kilobytes=kilobytes):
                    before, after = self.on_small_disk(kilobytes, arguments, 1, flags=())
                    self.assertEqual("on this disk" in before, words is not None, before)
                    self.assertIn(words or "", before)
                    self.assertIn(code or "code", before)
                    self.assertIn("code 0", after)
                    self.assertNotIn("on this disk", after)


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
