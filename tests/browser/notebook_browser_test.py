"""Opens outputs of a notebook in headless Chromium: several views on one page, each alive and of its own.

usage: notebook_browser_test.py [unittest options]

Ends with 77 (skipped) when Chromium, its driver, selenium or three.js (when csrbf was built) is missing.
"""

import pathlib
import sys
import time
import unittest

import numpy as np

import csrbf

PATIENCE = 60  # seconds for views to start on a busy machine

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
from chromium import LOOK, SKIPPED, missing_browser, set_window, start_browser


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
        start_browser(cls, PATIENCE)
        cls.page = pathlib.Path(cls.folder.name, "notebook.html")
        cls.page.write_text("".join(f"<h3>{i}</h3>{thing._repr_html_()}" for i, thing in enumerate(outputs())))
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
        for look in looks:
            self.assertGreater(look["share"], 0.02)
        red, green, blue = looks[1]["color"]
        self.assertTrue(red > 120 and green < 60 and blue < 60, looks)
        red, _, blue = looks[2]["color"]
        self.assertGreater(blue, red)  # points are blue
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
    lacking = missing_browser()
    if lacking:
        print("skipped: no " + lacking)
        sys.exit(SKIPPED)
    if not (pathlib.Path(csrbf.__file__).parent / "page" / "viewer.js").exists():
        print("skipped: csrbf was built without three.js (Debian: libjs-three, esbuild)")
        sys.exit(SKIPPED)
    unittest.main()
