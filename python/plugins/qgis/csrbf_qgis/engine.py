"""Fits samples and evaluates on a grid, by the Python module where QGIS can import it, else by the program.

Grids have x rising along columns and y falling along rows.
"""

import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

try:
    import csrbf
except ImportError:
    csrbf = None


class Failure(Exception):
    """No result, with a sentence for the user."""


class Canceled(Exception):
    """The user pressed Cancel."""


class Fitted:
    """The function of samples (n, 2) with values (n,)."""

    def __init__(self, points, values, options, feedback):
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.grid = Module(points, values, options, feedback) if csrbf else Program(points, values, options, feedback)
        self.report = self.grid.report

    def values(self, x, y):
        """Values [y, x] on a grid."""
        return self.grid.evaluate(x, y, False)

    def deviations(self, x, y):
        """Standard deviations [y, x] of the function on a grid."""
        return self.grid.evaluate(x, y, True)


class Module:
    """By the Python module, in this process."""

    def __init__(self, points, values, options, feedback):
        def progress(_, fraction):
            feedback.setProgress(60 * fraction)
            if feedback.isCanceled():
                raise Canceled

        try:
            self.f = csrbf.fit(points, values, progress=progress, **options)
        except (ValueError, csrbf.SolverFailure) as error:
            raise Failure(str(error)) from None
        self.report = self.f.report

    def evaluate(self, x, y, deviation):
        if not deviation:
            return self.f.evaluate_grid(x, y).T
        nodes = np.stack(np.meshgrid(x, y), axis=-1)
        try:
            return self.f.standard_deviation(nodes, of="function")
        except ValueError:
            try:
                return self.f.standard_deviation(nodes)
            except ValueError as error:
                raise Failure(str(error)) from None


class Program:
    """By the program, in a process of its own; columns and grids pass through files."""

    def __init__(self, points, values, options, feedback):
        self.program = find_program()
        self.feedback = feedback
        self.folder = tempfile.TemporaryDirectory(prefix="csrbf_qgis_")
        samples, self.model = (str(pathlib.Path(self.folder.name, name)) for name in ("samples.npy", "model.csrbf"))
        np.save(samples, np.column_stack([points, values]))
        flags = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
        report = self.run("fit", samples, "-o", self.model, *flags)
        self.report = {**report["result"], **report["options"], "warnings": report["warnings"]}

    def evaluate(self, x, y, deviation):
        path = str(pathlib.Path(self.folder.name, "grid.npy"))
        bounds = ",".join(f"{float(axis.min())!r}:{float(axis.max())!r}" for axis in (x, y))
        flags = ["--standard-deviation", "--deviation-of=function"] if deviation else []
        try:
            self.run("evaluate", self.model, "-o", path, f"--grid={len(x)},{len(y)}", f"--bounds={bounds}", *flags)
        except Failure:
            if not deviation:
                raise
            self.run("evaluate", self.model, "-o", path, f"--grid={len(x)},{len(y)}", f"--bounds={bounds}", flags[0])
        grid = np.load(path)
        return grid.reshape(len(y), len(x), -1)[::-1, :, int(deviation)]  # rows from the north

    def run(self, *arguments):
        """Runs the program and returns its report."""
        report = pathlib.Path(self.folder.name, "report.json")
        command = [self.program, *arguments, "--quiet", "--report", str(report)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while True:
            try:
                _, errors = process.communicate(timeout=0.2)
                break
            except subprocess.TimeoutExpired:
                if self.feedback.isCanceled():
                    process.terminate()
                    process.communicate()
                    raise Canceled from None
        if process.returncode != 0:
            raise Failure(errors.strip() or f"csrbf ended with status {process.returncode}")
        return json.loads(report.read_text())


def find_program():
    """The program of the variable CSRBF_PROGRAM, on the path, or of the installation that this plugin is part of."""
    installed = pathlib.Path(__file__).resolve().parents[4] / "bin"
    for candidate in (os.environ.get("CSRBF_PROGRAM"), shutil.which("csrbf"), shutil.which("csrbf", path=installed)):
        if candidate:
            return candidate
    raise Failure(
        "QGIS finds neither the Python module csrbf nor the program. Install csrbf, and add the folder of the program "
        "to PATH or set the variable CSRBF_PROGRAM (Settings > Options > System > Environment)."
    )
