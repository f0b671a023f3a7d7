"""Runs the notebooks of examples/notebooks in Jupyter and looks at what they show.

usage: notebooks_test.py FOLDER [unittest options]

With the variable CSRBF_NOTEBOOKS set to a folder, the pages that nbconvert makes of them go there. Ends with 77
(skipped) when a package that they need is missing (Debian: jupyter-nbconvert, python3-ipykernel, python3-matplotlib,
python3-pandas, python3-xarray).
"""

import importlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

NEEDED = ("nbconvert", "ipykernel", "matplotlib", "pandas", "xarray")
CELLS = 10
FOLDER = None


class Notebooks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="csrbf_notebooks_")
        cls.addClassCleanup(cls.folder.cleanup)
        # A kernel of this very interpreter, whichever Jupyter knows.
        kernel = pathlib.Path(cls.folder.name, "kernels", "python3")
        kernel.mkdir(parents=True)
        command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        kernel.joinpath("kernel.json").write_text(json.dumps({"argv": command, "display_name": "Python 3",
                                                              "language": "python"}))

    def convert(self, notebook, output, *options):
        environment = dict(os.environ, JUPYTER_PATH=self.folder.name, JUPYTER_PREFER_ENV_PATH="0",
                           JUPYTER_DATA_DIR=self.folder.name, JUPYTER_ALLOW_INSECURE_WRITES="1",
                           IPYTHONDIR=self.folder.name, PYTHONWARNINGS="ignore")
        environment.pop("MPLBACKEND", None)  # plots appear in the notebook
        command = [sys.executable, "-m", "nbconvert", *options, "--output-dir", self.folder.name, "--output", output]
        run = subprocess.run([*command, str(notebook)], env=environment, capture_output=True, text=True, timeout=500)
        self.assertEqual(run.returncode, 0, run.stderr[-3000:])
        return pathlib.Path(self.folder.name, output)

    def check(self, name, views, plots, printed):
        source = FOLDER / f"{name}.ipynb"
        stored = json.loads(source.read_text())
        code = [cell for cell in stored["cells"] if cell["cell_type"] == "code"]
        self.assertEqual(len(code), CELLS)
        for cell in code:
            self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None), "clear the outputs")
        # A copy: notebooks write their files where they are.
        copy = pathlib.Path(self.folder.name, source.name)
        shutil.copy(source, copy)
        run = self.convert(copy, f"{name}_run.ipynb", "--to", "notebook", "--execute")
        outputs = [output for cell in json.loads(run.read_text())["cells"] for output in cell.get("outputs", [])]
        self.assertFalse([output for output in outputs if output["output_type"] == "error"])
        texts = "".join("".join(output.get("text", output.get("data", {}).get("text/plain", ""))) for output in outputs)
        for text in printed:
            self.assertRegex(texts, text)
        bundles = [output.get("data", {}) for output in outputs]
        shown = [data for data in bundles if "<iframe" in "".join(data.get("text/html", ""))]
        self.assertEqual(len(shown), views)
        for data in shown:
            self.assertIn("image/png", data)
        pictures = [data for data in bundles if "image/png" in data]
        self.assertEqual(len(pictures), views + plots)
        page = self.convert(run, f"{name}.html", "--to", "html")
        text = page.read_text()
        self.assertEqual(text.count("<iframe"), views)  # the page, and not the picture that stands for it
        if "CSRBF_NOTEBOOKS" in os.environ:
            pathlib.Path(os.environ["CSRBF_NOTEBOOKS"], page.name).write_text(text)

    def test_functions(self):
        self.check("functions", 1, 2, [r"rms error 0\.2\d\d m", r"9[3-7]\.\d% within", "'missing': 9", "True$"])

    def test_surfaces(self):
        self.check("surfaces", 5, 2, ["normals point outwards: 100%", "inside: True", "True volume"])

    def test_images(self):
        self.check("images", 4, 3, [r"(100|9\d)\.\d% of the pixels are right", "count +18", "volume 3[67]"])


if __name__ == "__main__":
    for module in NEEDED:
        try:
            importlib.import_module(module)
        except ImportError:
            print(f"skipped: {module} is not installed")
            sys.exit(77)
    FOLDER = pathlib.Path(sys.argv.pop(1))
    unittest.main()
