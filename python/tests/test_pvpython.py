"""Runs the filters for ParaView in ParaView itself, without a window. Exit status 77 without it."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import csrbf

PVPYTHON = shutil.which("pvpython")
PACKAGE = pathlib.Path(csrbf.__file__).parent.parent
PLUGIN = pathlib.Path(__file__).parent.parent / "plugins" / "csrbf_paraview.py"

SCRIPT = """
import inspect, json, sys
if not hasattr(inspect, "getargspec"):  # ParaView 5.11 asks for it, Python 3.11 has it no more
    inspect.getargspec = inspect.getfullargspec
try:
    import csrbf
except ImportError as error:
    print("RESULT", json.dumps({"skipped": str(error)}))
    sys.exit()
import numpy as np
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(sys.argv[1], ns=globals())
found = {}

mesh = servermanager.Fetch(csrbfReconstruct(Sphere(ThetaResolution=50, PhiResolution=50), Resolution=30, Curvature=1))
radius = np.linalg.norm(vtk_to_numpy(mesh.GetPoints().GetData()), axis=1)
found["radius"] = [float(radius.min()), float(radius.max())]
found["euler"] = mesh.GetNumberOfPoints() - mesh.GetNumberOfPolys() // 2
found["curvature"] = float(np.median(vtk_to_numpy(mesh.GetPointData().GetArray("mean_curvature"))))

samples = Calculator(PointSource(NumberOfPoints=600, Radius=1.0), Function="2*coordsX-coordsZ", ResultArrayName="u")
image = servermanager.Fetch(csrbfFit(samples, Array="u", Nodes=9))
gradient = vtk_to_numpy(image.GetPointData().GetArray("u_gradient"))
found["gradient"] = np.abs(gradient - [2, 0, -1]).max().item()

labels = csrbfSegment(Wavelet(WholeExtent=[-8, 8, -8, 8, -8, 8]))
found["labels"] = sorted(set(vtk_to_numpy(servermanager.Fetch(labels).GetPointData().GetArray("labels")).tolist()))
found["contour"] = OutputPort(labels, 1).GetDataInformation().GetNumberOfCells()
print("RESULT", json.dumps(found))
"""


class ParaView(unittest.TestCase):
    def test_filters_work_in_pvpython(self):
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder, "script.py")
            script.write_text(SCRIPT)
            environment = dict(os.environ, PYTHONPATH=str(PACKAGE), HOME=folder, QT_QPA_PLATFORM="offscreen")
            environment.pop("DISPLAY", None)
            command = [PVPYTHON, "--force-offscreen-rendering", str(script), str(PLUGIN)]
            run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
        results = [line for line in run.stdout.splitlines() if line.startswith("RESULT ")]
        self.assertTrue(results, run.stdout + run.stderr)
        found = json.loads(results[0].removeprefix("RESULT "))
        if "skipped" in found:
            self.skipTest(f"ParaView's Python cannot import the module: {found['skipped']}")
        self.assertTrue(0.48 < found["radius"][0] <= found["radius"][1] < 0.52, found)  # ParaView's sphere has 0.5
        self.assertEqual(found["euler"], 2)
        self.assertAlmostEqual(found["curvature"], 2, delta=0.2)
        self.assertLess(found["gradient"], 0.02)
        self.assertEqual(found["labels"], [0, 1])
        self.assertGreater(found["contour"], 100)


if __name__ == "__main__":
    if PVPYTHON is None:
        print("skipped: ParaView is not installed (Debian: paraview, python3-paraview)")
        sys.exit(77)
    unittest.main()
