"""Tiles shared by processes that mpirun and Dask start: the same bytes as by one, also after a kill.

usage: launchers_test.py PROGRAM [unittest options]
"""

import filecmp
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

import command_line_test as base
from tiles_test import ply, two_balls

try:
    import dask.distributed as dask
    import csrbf
except ImportError:
    dask = None


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Launchers(base.CommandLine):
    def setUp(self):
        super().setUp()
        base.PROGRAM = PROGRAM
        self.cloud, self.mesh = self.path("cloud.ply"), self.path("mesh.ply")
        with open(self.cloud, "wb") as file:
            file.write(ply(two_balls(40000)))
        self.arguments = [PROGRAM, "reconstruct", self.cloud, "-o", self.mesh, "--tile-points", "4000", "--threads", "1",
                          "--tile-folder", self.path("steps")]
        before = cpu_seconds()
        subprocess.run([*self.arguments, "--quiet"], check=True)
        self.seconds = cpu_seconds() - before
        self.alone = self.path("alone.ply")
        os.replace(self.mesh, self.alone)

    def mpirun(self, processes):
        if shutil.which("mpirun") is None:
            self.skipTest("no mpirun; install openmpi-bin")
        command = ["mpirun", "-n", str(processes), "--oversubscribe", "--quiet"]
        if os.geteuid() == 0:
            command.append("--allow-run-as-root")
        return [*command, *self.arguments, "--tile-share", "auto", "--quiet"]

    def assert_same(self):
        self.assertTrue(filecmp.cmp(self.alone, self.mesh, shallow=False))
        os.remove(self.mesh)
        self.assertFalse(os.path.exists(self.path("steps")))

    def test_mpirun_makes_the_same_mesh(self):
        for processes in (2, 3, 8):
            subprocess.run(self.mpirun(processes), check=True)
            self.assert_same()

    def test_a_run_killed_by_mpirun_goes_on(self):
        for wait in (0.3, 0.8):
            run = subprocess.Popen(self.mpirun(3), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(wait)
            run.terminate()  # mpirun ends its processes
            run.wait()
        subprocess.run(self.mpirun(3), check=True)
        self.assert_same()

    def wait_for_step(self, step):
        steps = self.path("steps")
        while not (os.path.isdir(steps) and any(name.startswith(step) for name in os.listdir(steps))):
            time.sleep(0.001)

    def test_a_killed_rank_ends_the_run_which_goes_on(self):
        run = subprocess.Popen(self.mpirun(3), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_for_step("fit_2")
        ranks = subprocess.run(["pgrep", "-P", str(run.pid)], stdout=subprocess.PIPE, text=True).stdout.split()
        self.assertEqual(len(ranks), 3)
        os.kill(int(ranks[1]), signal.SIGKILL)
        self.assertNotEqual(run.wait(), 0)
        self.assertFalse(os.path.exists(self.mesh))
        subprocess.run(self.mpirun(3), check=True)
        self.assert_same()

    def test_mpirun_reports_an_error_of_the_input(self):
        self.arguments[2] = self.path("none.ply")
        done = subprocess.run(self.mpirun(2), capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("none.ply", done.stderr)
        self.assertFalse(os.path.exists(self.mesh))

    @unittest.skipIf(dask is None, "no Dask, or no Python module; install python3-distributed")
    def test_dask_makes_the_same_mesh(self):
        with dask.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with dask.Client(cluster) as client:
                client.run(use_one_thread)
                idle = sum(client.run(lambda: sum(os.times()[:2])).values())
                reports = client.gather(client.map(share_of(self.cloud, self.mesh, self.path("steps")),
                                                   [(0, 2), (1, 2)], pure=False))
                used = sum(client.run(lambda: sum(os.times()[:2])).values()) - idle
        self.assertTrue(reports[0]["watertight"])
        self.assert_same()
        print(f"CPU seconds: {self.seconds:.2f} alone, {used:.2f} on two workers of Dask")

    @unittest.skipIf(dask is None, "no Dask, or no Python module; install python3-distributed")
    def test_a_killed_worker_of_dask_is_replaced(self):
        with dask.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            with dask.Client(cluster) as client:
                client.run(use_one_thread)
                pids = list(client.run(os.getpid).values())
                futures = client.map(share_of(self.cloud, self.mesh, self.path("steps")), [(0, 2), (1, 2)], pure=False)
                self.wait_for_step("fit_2")
                os.kill(pids[0], signal.SIGKILL)
                client.gather(futures)
                self.assertNotIn(pids[0], client.run(os.getpid).values())
        self.assert_same()


def use_one_thread():
    import csrbf

    csrbf.set_thread_count(1)


def share_of(cloud, mesh, folder):
    """What a worker does, without anything of this test."""
    import csrbf

    return lambda share: csrbf.reconstruct_tiles(cloud, mesh, 4000, folder=folder, share=share)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
