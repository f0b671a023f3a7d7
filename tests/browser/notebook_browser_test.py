"""Opens outputs of a notebook in headless Chromium: several views on one page, each alive and of its own.

usage: notebook_browser_test.py [unittest options]

Ends with 77 (skipped) when Chromium, its driver, selenium or three.js (when csrbf was built) is missing.
"""

import os
import pathlib
import shutil
import sys
import tempfile
import time
import unittest

import numpy as np

import csrbf

SKIPPED = 77
PATIENCE = 60  # seconds for views to start on a busy machine

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from page_picture import open_browser, set_window

# The share of the canvas that is covered, and the mean colour there.
LOOK = """
const view = document.querySelector("figure.surface").view;
view.draw();
const copy = document.createElement("canvas");
[copy.width, copy.height] = [view.canvas.width, view.canvas.height];
const context = copy.getContext("2d");
context.drawImage(view.canvas, 0, 0);
const data = context.getImageData(0, 0, copy.width, copy.height).data;
let covered = 0, sum = [0, 0, 0];
for (let i = 0; i < data.length; i += 4) {
  if (data[i + 3] < 128) continue;
  ++covered;
  for (let c = 0; c < 3; ++c) sum[c] += data[i + c];
}
return [4 * covered / data.length, ...sum.map((s) => s / Math.max(covered, 1))];
"""


def outputs():
    direction = np.random.default_rng(0).normal(size=(1500, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    surface = csrbf.reconstruct(direction * [1, 0.7, 0.4])
    mesh = surface.polygonize(24)
    red = {"red": np.full(len(mesh.vertices), 220, np.uint8), "green": np.zeros(len(mesh.vertices), np.uint8),
           "blue": np.zeros(len(mesh.vertices), np.uint8)}
    return [surface, csrbf.Mesh(mesh.vertices, mesh.faces, mesh.normals, red), csrbf.PointCloud(direction)]


class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="csrbf_browser_")
        cls.addClassCleanup(folder.cleanup)
        cls.page = pathlib.Path(folder.name, "notebook.html")
        cls.page.write_text("".join(f"<h3>{i}</h3>{thing._repr_html_()}" for i, thing in enumerate(outputs())))
        cls.browser = open_browser(os.path.join(folder.name, "profile"))
        cls.addClassCleanup(cls.browser.quit)
        set_window(cls.browser, 900, 2000)
        cls.browser.get(cls.page.as_uri())
        cls.frames = cls.browser.find_elements("css selector", "iframe")

    def wait_for(self, script):
        end = time.monotonic() + PATIENCE
        while not self.browser.execute_script(script):
            self.assertLess(time.monotonic(), end, script)
            time.sleep(0.1)

    def in_frame(self, number):
        self.browser.switch_to.default_content()
        self.browser.switch_to.frame(self.frames[number])
        self.wait_for('return document.querySelector("figure.surface.live") !== null')

    def test_every_view_lives_and_shows_its_own_object(self):
        self.assertEqual(len(self.frames), 3)
        looks = []
        for number in range(3):
            self.in_frame(number)
            self.assertEqual(self.browser.execute_script('return document.querySelectorAll("figure").length'), 1)
            looks.append(self.browser.execute_script(LOOK))
        for share, *_ in looks:
            self.assertGreater(share, 0.02)
        _, red, green, blue = looks[1]
        self.assertTrue(red > 120 and green < 60 and blue < 60, looks)
        self.assertGreater(looks[2][3], looks[2][1])  # points are blue
        self.assertEqual([entry for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"], [])

    def test_a_view_whose_place_is_taken_becomes_a_still_picture(self):
        self.in_frame(0)
        self.browser.execute_script(
            'document.querySelector("figure.surface").view.scene.renderer.forceContextLoss()')
        self.wait_for('return document.querySelector("figure.surface.live") === null')
        text = self.browser.execute_script('return document.querySelector(".why-still").textContent')
        self.assertIn("Reload the page", text)
        self.browser.get(self.page.as_uri())
        type(self).frames = self.browser.find_elements("css selector", "iframe")


if __name__ == "__main__":
    try:
        import selenium  # noqa: F401
    except ImportError:
        print("skipped: selenium is not installed (Debian: python3-selenium)")
        sys.exit(SKIPPED)
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        print("skipped: Chromium or its driver is not installed (Debian: chromium, chromium-driver)")
        sys.exit(SKIPPED)
    if not (pathlib.Path(csrbf.__file__).parent / "page" / "viewer.js").exists():
        print("skipped: csrbf was built without three.js (Debian: libjs-three, esbuild)")
        sys.exit(SKIPPED)
    unittest.main()
