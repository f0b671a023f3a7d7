"""SciPy's own tests of RBFInterpolator, run with csrbf.RBFInterpolator. They need pytest, and a SciPy with its tests."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

# Runs the module of SciPy's tests with the class under test exchanged.
CONFTEST = """\
import importlib.util

import csrbf

spec = importlib.util.find_spec("scipy.interpolate.tests.test_rbfinterp")
tests = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tests)
tests.RBFInterpolator = csrbf.RBFInterpolator
globals().update({name: member for name, member in vars(tests).items() if name.startswith("Test")})
"""

PRIVATE = "test_chunking"  # replaces a private method of SciPy's class


def available(name):
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


class ScipyTests(unittest.TestCase):
    @unittest.skipUnless(available("pytest"), "pytest is not installed")
    @unittest.skipUnless(available("scipy.interpolate.tests.test_rbfinterp"), "SciPy comes without its tests")
    def test_all_pass_with_their_messages(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "test_adopted.py")
            with open(path, "w") as file:
                file.write(CONFTEST)
            done = subprocess.run(
                [sys.executable, "-m", "pytest", "-q", "--tb=short", "-p", "no:cacheprovider", "-k", f"not {PRIVATE}", path],
                capture_output=True,
                text=True,
                cwd=folder,
            )
        self.assertEqual(done.returncode, 0, done.stdout[-4000:])
        self.assertIn("passed", done.stdout)


if __name__ == "__main__":
    unittest.main()
