"""What the tests in headless Chromium share."""

import os
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from page_picture import open_browser, set_window  # noqa: F401

SKIPPED = 77

# What the canvas shows: the share of its pixels that are covered, their mean colour, and a number for all of it.
LOOK = """
const view = document.querySelector("figure.surface").view;
view.draw();
const copy = document.createElement("canvas");
[copy.width, copy.height] = [view.canvas.width, view.canvas.height];
const context = copy.getContext("2d");
context.drawImage(view.canvas, 0, 0);
const data = context.getImageData(0, 0, copy.width, copy.height).data;
let covered = 0, red = 0, green = 0, blue = 0, hash = 0;
for (let i = 0; i < data.length; i += 4) {
  hash = (Math.imul(hash, 31) + data[i] + 256 * data[i + 1] + 65536 * data[i + 2]) | 0;
  if (data[i + 3] < 128) continue;
  ++covered;
  red += data[i]; green += data[i + 1]; blue += data[i + 2];
}
return {share: 4 * covered / data.length, color: [red, green, blue].map((sum) => sum / Math.max(covered, 1)), hash};
"""


def start_browser(test, patience):
    """Gives the class of a test its `folder` and `browser`, until it ends; `patience`: seconds for pages and scripts."""
    test.folder = tempfile.TemporaryDirectory(prefix="csrbf_browser_")
    test.addClassCleanup(test.folder.cleanup)
    test.browser = open_browser(os.path.join(test.folder.name, "profile"))
    test.addClassCleanup(test.browser.quit)
    test.browser.set_page_load_timeout(patience)
    test.browser.set_script_timeout(patience)


def missing_browser():
    """What is not here that a browser needs."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "selenium (python3-selenium)"
    for program, package in (("chromium", "chromium"), ("chromedriver", "chromium-driver")):
        if shutil.which(program) is None:
            return f"{program} ({package})"
    return None
