"""Compares csrbf-mpi on four processes with csrbf on one, on generated files.

usage: ranks_test.py CSRBF CSRBF-MPI MPIEXEC [unittest options]
"""

import json
import math
import os
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

RANKS = 4
# A system solved by MUMPS and one solved here differ by rounding, which one step of iterative refinement leaves in the
# last digits of the coefficients.
SOLVER_BOUND = 1e-12

CSRBF = CSRBF_MPI = MPIEXEC = ""


def mpi_command(ranks):
    """How OpenMPI is told that there may be fewer cores than processes, and that root may run it in a container."""
    command = [MPIEXEC, "-n", str(ranks)]
    help_text = subprocess.run([MPIEXEC, "--version"], capture_output=True, text=True).stdout
    if "Open MPI" in help_text or "OpenRTE" in help_text:
        command += ["--oversubscribe", "--quiet"]
        if os.geteuid() == 0:
            command.append("--allow-run-as-root")
    return command + [CSRBF_MPI]


def torus(n, with_normals, seed=1):
    source = random.Random(seed)
    rows = []
    for _ in range(n):
        u, v = source.uniform(0, 2 * math.pi), source.uniform(0, 2 * math.pi)
        normal = (math.cos(v) * math.cos(u), math.cos(v) * math.sin(u), math.sin(v))
        r = 0.4 + source.gauss(0, 0.004)
        rows.append((math.cos(u) + r * normal[0], math.sin(u) + r * normal[1], r * normal[2])
                    + (normal if with_normals else ()))
    return "\n".join(" ".join("%.9g" % c for c in row) for row in rows) + "\n"


def samples(n, seed=2):
    source = random.Random(seed)
    rows = []
    for _ in range(n):
        x, y = source.random(), source.random()
        rows.append("%.17g,%.17g,%.17g" % (x, y, math.sin(9 * x) * math.cos(7 * y)))
    return "\n".join(rows) + "\n"


def npy_values(path):
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack("<H", data[8:10])[0]
    body = data[10 + length:]
    return struct.unpack("<%dd" % (len(body) // 8), body)


class Ranks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1")

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def run_program(self, command, stdin=None):
        return subprocess.run(command, cwd=self.folder.name, env=self.environment, capture_output=True, text=True,
                              timeout=300, input=stdin)

    def one(self, *arguments):
        result = self.run_program([CSRBF, *arguments, "--threads", "1"])
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def four(self, *arguments, stdin=None):
        result = self.run_program([*mpi_command(RANKS), *arguments, "--threads", "1"], stdin)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def report(self, name):
        return json.loads(self.read(name))

    def expect_same_mesh(self, *flags, shared_work=("fit", "evaluate", "partition", "polygonize")):
        self.one("reconstruct", "points.xyz", "-o", "one.ply", *flags)
        self.four("reconstruct", "points.xyz", "-o", "four.ply", "--report", "four.json", *flags)
        self.assertEqual(self.read("one.ply"), self.read("four.ply"))
        report = self.report("four.json")
        self.assertEqual(report["ranks"], RANKS)
        shared = report["shared_work"]
        for name in shared_work:
            self.assertLess(shared[name]["computed"], 0.6 * shared[name]["items"], name)
            self.assertGreater(shared[name]["received_bytes"], shared[name]["sent_bytes"], name)

    def test_a_noisy_surface_has_the_same_mesh(self):
        self.write("points.xyz", torus(20000, True))
        self.expect_same_mesh()

    def test_a_surface_with_estimated_normals_has_the_same_mesh(self):
        self.write("points.xyz", torus(10000, False))
        self.expect_same_mesh("--normals", "estimate", shared_work=("fit", "evaluate", "polygonize"))

    def test_a_surface_within_a_tolerance_has_the_same_mesh(self):
        self.write("points.xyz", torus(5000, True))
        # There are too few patches and cells for four.
        self.expect_same_mesh("--tolerance", "0.005", shared_work=("evaluate",))

    def test_ranks_that_keep_data_in_files_make_the_same_mesh(self):
        self.write("points.xyz", torus(60000, True))
        self.one("reconstruct", "points.xyz", "-o", "one.ply")
        result = self.run_program([*mpi_command(RANKS), "reconstruct", "points.xyz", "-o", "four.ply", "--threads", "1",
                                   "--memory", "64MB", "--report", "four.json"])
        if "this folder is kept in memory" in result.stderr:
            self.skipTest("--memory needs a disk, and temporary files are in memory")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.read("one.ply"), self.read("four.ply"))
        self.assertGreater(self.report("four.json")["memory"]["peak_scratch_mb"], 0)
        self.assertEqual(sorted(os.listdir(self.folder.name)), ["four.json", "four.ply", "one.ply", "points.xyz"])

    def test_a_partition_of_unity_and_its_values_are_the_same(self):
        self.write("samples.csv", samples(60000))
        self.one("fit", "samples.csv", "-o", "one.csrbf", "--method", "partition-of-unity")
        self.four("fit", "samples.csv", "-o", "four.csrbf", "--method", "partition-of-unity", "--report", "four.json")
        for name, traffic in self.report("four.json")["shared_work"].items():
            self.assertLess(traffic["computed"], 0.6 * traffic["items"], name)
        places = (row.rsplit(",", 1)[0] for row in samples(5000, 3).split())
        self.write("places.csv", "\n".join(places) + "\n")
        for flags in (["--grid", "300,200"], ["--points", "places.csv", "--gradient"]):
            with self.subTest(flags=flags):
                self.one("evaluate", "one.csrbf", "-o", "one.npy", *flags)
                self.one("evaluate", "four.csrbf", "-o", "fitted_by_four.npy", *flags)
                self.four("evaluate", "one.csrbf", "-o", "evaluated_by_four.npy", *flags)
                self.assertEqual(self.read("one.npy"), self.read("fitted_by_four.npy"))
                self.assertEqual(self.read("one.npy"), self.read("evaluated_by_four.npy"))

    def test_a_global_system_has_the_same_solution_but_for_rounding(self):
        self.write("samples.csv", samples(12000))
        flags = ["--method", "least-squares", "--centers", "4000", "--smoothing", "1e-8"]
        self.one("fit", "samples.csv", "-o", "one.csrbf", *flags)
        self.four("fit", "samples.csv", "-o", "four.csrbf", *flags)
        for name in ("one", "four"):
            self.one("evaluate", name + ".csrbf", "-o", name + ".npy", "--grid", "60,50")
        one, four = npy_values(self.path("one.npy")), npy_values(self.path("four.npy"))
        largest = max(abs(a - b) for a, b in zip(one, four))
        self.assertLessEqual(largest, SOLVER_BOUND * (max(one) - min(one)))
        self.assertGreater(largest, 0, "both were solved by the same solver")

    def test_points_come_through_standard_input_and_text_goes_out_once(self):
        points = torus(3000, True)
        self.write("points.xyz", points)
        self.one("reconstruct", "points.xyz", "-o", "one.ply")
        result = self.four("reconstruct", "-", "-o", "four.ply", stdin=points)
        self.assertEqual(self.read("one.ply"), self.read("four.ply"))
        self.assertEqual(result.stdout.count("four.ply"), 1, result.stdout)
        self.assertEqual(sorted(os.listdir(self.folder.name)), ["four.ply", "one.ply", "points.xyz"])

    def test_an_error_is_told_once_and_ends_all(self):
        self.write("points.xyz", torus(2000, True))
        for arguments, code, message in (
                (["reconstruct", "missing.xyz", "-o", "mesh.ply"], 2, "missing.xyz"),
                (["reconstruct", "points.xyz", "-o", "mesh.ply", "--tolerance", "1e-9"], 1, "tolerance"),
                (["reconstruct", "points.xyz", "-o", "nowhere/mesh.ply"], 1, "nowhere/mesh.ply"),
                (["reconstruct", "points.xyz", "-o", "mesh.ply", "--resolution", "-4"], 2, "resolution"),
                (["reconstruct", "points.xyz", "-o", "mesh.ply", "--resume"], 2, "one process"),
                (["track", "points.xyz", "-o", "folder"], 2, "one process")):
            with self.subTest(arguments=arguments):
                result = self.run_program([*mpi_command(RANKS), *arguments])
                self.assertEqual(result.returncode, code, result.stderr)
                lines = [line for line in result.stderr.splitlines() if line.startswith("csrbf") and message in line]
                self.assertEqual(len(lines), 1, result.stderr)
                self.assertFalse(os.path.exists(self.path("mesh.ply")))

    def test_what_ranks_exchange_is_what_one_process_foretells(self):
        self.write("points.xyz", torus(10000, False))
        self.four("reconstruct", "points.xyz", "-o", "four.ply", "--report", "four.json")
        result = self.run_program([CSRBF_MPI, "--pretend-ranks", str(RANKS), "reconstruct", "points.xyz", "-o",
                                   "one.ply", "--report", "one.json"])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.read("one.ply"), self.read("four.ply"))
        foretold = self.report("one.json")["shared_work"]
        self.assertEqual(len(foretold), RANKS)
        counted = self.report("four.json")["shared_work"]
        for table in (counted, foretold[0]):
            for traffic in table.values():
                del traffic["seconds"]
        self.assertEqual(foretold[0], counted)
        for name, traffic in foretold[0].items():
            self.assertEqual(sum(rank[name]["computed"] for rank in foretold), traffic["items"], name)
            self.assertEqual(sum(rank[name]["sent_bytes"] for rank in foretold),
                             traffic["sent_bytes"] + traffic["received_bytes"], name)

    def children_of(self, pid):
        for _ in range(300):
            children = []
            for process in filter(str.isdigit, os.listdir("/proc")):
                try:
                    with open("/proc/%s/stat" % process) as file:
                        name, rest = file.read().split("(", 1)[1].rsplit(")", 1)
                except OSError:
                    continue  # it has just ended
                if name == "csrbf-mpi" and rest.split()[1] == str(pid):
                    children.append(int(process))
            if len(children) == RANKS:
                return children
            time.sleep(0.1)
        self.fail("the processes did not start")

    def test_a_signal_to_one_rank_stops_all(self):
        self.write("points.xyz", torus(60000, False))
        program = subprocess.Popen([*mpi_command(RANKS), "reconstruct", "points.xyz", "-o", "mesh.ply", "--threads",
                                    "1"], cwd=self.folder.name, env=self.environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        children = self.children_of(program.pid)
        time.sleep(1.0)
        self.assertIsNone(program.poll(), "it ended before the signal")
        os.kill(children[2], signal.SIGINT)
        _, errors = program.communicate(timeout=120)
        self.assertEqual(program.returncode, 130, errors)
        self.assertIn("interrupted", errors)
        self.assertEqual(os.listdir(self.folder.name), ["points.xyz"])


if __name__ == "__main__":
    CSRBF, CSRBF_MPI, MPIEXEC = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
