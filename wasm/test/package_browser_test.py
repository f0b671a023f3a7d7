"""Imports the npm package in headless Chromium, both modules, and makes a surface with each.

usage: package_browser_test.py PACKAGE-FOLDER; exit status 77: Chromium, its driver or selenium are absent
"""

import sys

sys.dont_write_bytecode = True
from studio_test import run

SURFACE = """const [entry, done] = arguments;
import(entry).then(({load}) => load()).then((csrbf) => {
  const points = Array.from({length: 1000}, (_, i) => {
    const z = 1 - (2 * i + 1) / 1000, r = Math.sqrt(1 - z * z);
    return [r * Math.cos(2.4 * i), r * Math.sin(2.4 * i), z];
  });
  const {positions, triangles} = csrbf.reconstruct(points, {resolution: 24});
  done([positions.length / 3, triangles.length / 3]);
}).catch((error) => done(error.message));"""


def work(browser, address):
    browser.set_script_timeout(60)
    browser.get(address + "package.json")  # a page of the same origin
    counts = [browser.execute_async_script(SURFACE, address + name) for name in ("browser.js", "surfaces_browser.js")]
    vertices, triangles = counts[0]
    assert counts[1] == counts[0] and triangles == 2 * vertices - 4, counts  # a closed surface without handles


if __name__ == "__main__":
    sys.exit(run(sys.argv[1], work))
