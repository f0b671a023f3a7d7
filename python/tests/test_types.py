"""Annotations of the package, and what they refuse in a script of a user, by mypy."""

import ast
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import typing
import unittest

import numpy as np

import csrbf
from csrbf import _csrbf, _options

PACKAGE = pathlib.Path(csrbf.__file__).parent
CONFIGURATION = pathlib.Path(__file__).resolve().parents[2] / "pyproject.toml"

RIGHT = """
import numpy as np
import csrbf

x = np.random.default_rng(0).random((100, 2))
f = csrbf.fit(x, x[:, 0], centers=10, smoothing="none", progress=lambda stage, fraction: None)
values: np.ndarray[object, np.dtype[np.float64]] = f(x) + f.gradient([[0.5, 0.5]])[:, 0]
method: str = f.report["method"]
s = csrbf.reconstruct(csrbf.read_points("bunny.ply"), tolerance=1e-3)
(s | ~s - s).polygonize(resolution=40).save("bunny.ply")
g = csrbf.segment(csrbf.read_image("head.nii"), voxel_size=(1, 1, 2), init=f, mask="mask.png")
contour = g.contour()
if isinstance(contour, csrbf.Mesh):
    contour.render("contour.png", size=(80, 60))
loaded = csrbf.load("f.csrbf")
if isinstance(loaded, csrbf.Function):
    loaded.hessian(x)
volumes = csrbf.track([x, x]).volumes()
"""

WRONG = {
    'csrbf.fit([[0.0]], [0.0], centers="many")': "centers",
    "csrbf.fit([[0.0]], [0.0], tolerence=1.0)": "tolerence",
    "csrbf.fit(values=[0.0])": "points",
    'csrbf.fit([[0.0]], [0.0], method="bogus")': "method",
    'csrbf.fit([[0.0]], [0.0], kernel="wendland")': "kernel",
    'csrbf.fit([[0.0]], [0.0], smoothing="much")': "smoothing",
    'csrbf.fit([[0.0]], [0.0], loss="least")': "loss",
    'csrbf.fit([[0.0]], [0.0], transform="ln")': "transform",
    'csrbf.fit([[0.0]], [0.0]).standard_deviation([[0.0]], of="mean")': "standard_deviation",
    'csrbf.RBFInterpolator([[0.0]], [0.0], kernel="thin-plate_spline")': "kernel",
    'csrbf.reconstruct([[0.0, 0, 0]], method="poisson")': "method",
    'csrbf.reconstruct([[0.0, 0, 0]]).polygonize(method="cubes")': "method",
    'csrbf.reconstruct([[0.0, 0, 0]]).render(up="w")': "up",
    'csrbf.estimate_normals([[0.0, 0, 0]], orient="out")': "orient",
    'csrbf.segment([[0.0]], energy="otsu")': "energy",
    'csrbf.segment([[0.0]], mode="both")': "mode",
    'csrbf.inpaint([[0.0]], extrapolation="mirror")': "extrapolation",
    'csrbf.combine("xor")': "combine",
    'csrbf.Image([[0.0]], space="LAS")': "space",
    "csrbf.fit([[0.0]], [0.0]).gradeint([[0.0]])": "gradeint",
    "csrbf.reconstruct([[0.0, 0, 0]]) | 3": "Unsupported operand",
    'csrbf.farthest_points([[0.0]], "3")': "farthest_points",
    "csrbf.segment([[0.0]], progress=5)": "progress",
    "csrbf.load('f.csrbf').hessian([[0.0]])": "hessian",
    "csrbf.read_image('a.png') + csrbf.red_image('a.png')": "red_image",
}


def names_in(annotation):
    """The strings of a Literal, or of the Literals of a Union."""
    if typing.get_origin(annotation) is typing.Literal:
        return set(typing.get_args(annotation))
    return set().union(*(names_in(part) for part in typing.get_args(annotation)))


@unittest.skipIf(shutil.which("mypy") is None, "mypy is not installed")
class Types(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cache = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.cache.cleanup)

    def mypy(self, *arguments, folder="."):
        environment = dict(os.environ, MYPYPATH=str(PACKAGE.parent), MYPY_CACHE_DIR=self.cache.name)
        environment.pop("PYTHONPATH", None)  # mypy may belong to another interpreter
        command = ["mypy", "--python-executable", sys.executable, "--config-file", str(CONFIGURATION), *arguments]
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        return run.returncode, run.stdout + run.stderr

    def test_of_the_package_are_complete_and_right(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        with tempfile.TemporaryDirectory() as folder:
            public = [str(PACKAGE / name) for name in ("__init__.py", "sklearn.py")]
            code, output = self.mypy("--strict", *public, folder=folder)
        self.assertEqual(code, 0, output)

    def test_of_a_script_are_checked(self):
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder, "script.py")
            script.write_text(RIGHT)
            code, output = self.mypy(str(script), folder=folder)
            self.assertEqual(code, 0, output)
            script.write_text("import csrbf\n\n" + "\n".join(WRONG) + "\n")
            code, output = self.mypy(str(script), folder=folder)
        self.assertEqual(code, 1, output)
        for line, (statement, expected) in enumerate(WRONG.items(), start=3):
            told = [message for message in output.splitlines() if message.startswith(f"script.py:{line}: error")]
            self.assertTrue(told and expected in told[0], f"{statement}\n{output}")

    def test_names_of_options_are_those_that_the_library_takes(self):
        x, y = np.random.default_rng(0).random((60, 2)), np.arange(60.0)
        ball = x[:, :1] * 0 + np.random.default_rng(1).normal(size=(60, 3))
        taken = {
            ("FitMethod", "fit"): lambda name: csrbf.fit(x, y, method=name),
            ("Kernel", "fit"): lambda name: csrbf.fit(x[:, :1], y, kernel=name),
            ("Extrapolation", "fit"): lambda name: csrbf.fit(x, y, extrapolation=name),
            ("Loss", "fit"): lambda name: csrbf.fit(x, y, loss=name),
            ("Transform", "fit"): lambda name: csrbf.fit(x, y, transform=name),
            ("SurfaceMethod", "reconstruct"): lambda name: csrbf.reconstruct(ball, method=name),
            ("Energy", "segment"): lambda name: csrbf.segment(np.eye(9), energy=name),
            ("Mode", "segment"): lambda name: csrbf.segment(np.eye(9), mode=name),
            ("SegmentMethod", "segment"): lambda name: csrbf.segment(np.eye(9), method=name),
            ("Shading", "segment"): lambda name: csrbf.segment(np.eye(9), shading=name),
        }
        for (kind, function), call in taken.items():
            with self.subTest(kind):
                with self.assertRaises(ValueError) as refused:
                    call("bogus")
                listed = re.split(r"(?:use one of|must be one of|; use(?! one of)) ", str(refused.exception))[-1]
                known = names_in(getattr(_options, kind)) - ({"auto"} if kind == "Kernel" else set())
                self.assertEqual(set(re.split(r", | or ", listed.rstrip("."))) - {"auto"}, known - {"auto"}, listed)

    def test_of_the_compiled_module_are_those_it_has(self):
        """Every name of the stub exists, and every public name of the module is in the stub."""
        stub = ast.parse((PACKAGE / "_csrbf.pyi").read_text())
        described = set()
        for node in stub.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                described.add(node.name)
            if isinstance(node, ast.ClassDef):
                for member in node.body:
                    if isinstance(member, ast.FunctionDef):
                        self.assertTrue(hasattr(getattr(_csrbf, node.name), member.name), f"{node.name}.{member.name}")
                members = {getattr(member, "name", "") for member in node.body}
                members |= {member.target.id for member in node.body if isinstance(member, ast.AnnAssign)}
                if not issubclass(getattr(_csrbf, node.name), Exception):
                    own = {name for name in vars(getattr(_csrbf, node.name)) if not name.startswith("_")}
                    self.assertEqual(own - members, set(), node.name)
        public = {name for name in dir(_csrbf) if not name.startswith("_") and name != "version"}
        self.assertEqual(described, public)


if __name__ == "__main__":
    unittest.main()
