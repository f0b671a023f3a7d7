"""How objects show themselves: in notebooks, in the browser, by matplotlib and in a terminal."""

import base64
import html
import json
import os
import pathlib
import re
import struct
import tempfile
import unittest
from unittest import mock

import numpy as np

import csrbf

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as pyplot
except ImportError:
    matplotlib = None
try:
    from IPython.core.formatters import DisplayFormatter
except ImportError:
    DisplayFormatter = None

MOST_IN_NOTEBOOK = 1.3e6  # bytes of one output; notebooks hold many


def make_objects():
    rng = np.random.default_rng(0)
    ball = rng.normal(size=(1200, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    surface = csrbf.reconstruct(ball * [1, 0.8, 0.5])
    mesh = surface.polygonize(24)
    colours = {name: np.full(len(mesh.vertices), 40 * i, np.uint8) for i, name in enumerate(("red", "green", "blue"))}
    x = rng.uniform(-1, 1, (200, 3))
    y, column = np.mgrid[:40, :48]
    image = np.where((column - 22) ** 2 + (y - 18) ** 2 < 90, 10.0, 1.0) + rng.normal(size=y.shape)
    volume = np.zeros((9, 20, 24)) + rng.normal(size=(9, 20, 24))
    volume[2:7, 5:15, 6:18] += 20
    return {
        "surface": surface,
        "mesh": mesh,
        "coloured": csrbf.Mesh(mesh.vertices, mesh.faces, mesh.normals, colours),
        "curve": csrbf.fit(x[:60, :1], np.sin(3 * x[:60, 0])),
        "map": csrbf.fit(x[:, :2], x[:, 0] * x[:, 1]),
        "space": csrbf.fit(x, np.column_stack([x[:, 0], x[:, 2]])),
        "cloud": csrbf.PointCloud(ball),
        "lines": surface.ridges(mesh, least_turning=0.3),
        "curvature": surface.curvature(mesh.vertices),
        "image": csrbf.Image(image, 0.5, (10, 20)),
        "colours": csrbf.Image(rng.integers(0, 255, (20, 30, 3)).astype(np.uint8)),
        "volume": csrbf.Image(volume, (1, 1, 2)),
        "plane": csrbf.segment(image, objects=True),
        "regions": csrbf.segment(image, regions=3),
        "solid": csrbf.segment(csrbf.Image(volume, (1, 1, 2))),
        "sequence": csrbf.track([image, image]),
    }


OBJECTS = make_objects()
WITH_VIEW = {"surface", "mesh", "coloured", "cloud", "lines", "solid"}
NEEDS_MATPLOTLIB = {"curve", "space", "curvature"}


def page_in(frame):
    """The page that the frame of a notebook contains."""
    return html.unescape(re.fullmatch(r'<iframe [^>]*srcdoc="([^"]*)"></iframe>', frame)[1])


def size_of(png):
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", png[16:24])


class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bundles = {name: thing._repr_mimebundle_() for name, thing in OBJECTS.items()}

    def test_every_object_has_a_page_and_a_picture_of_bounded_size(self):
        for name, thing in OBJECTS.items():
            with self.subTest(name):
                bundle = self.bundles[name]
                self.assertEqual(bundle["text/plain"], repr(thing))
                page = page_in(bundle["text/html"])
                self.assertLess(len(bundle["text/html"]), MOST_IN_NOTEBOOK)
                self.assertTrue(page.startswith("<!DOCTYPE html>"))
                if name in NEEDS_MATPLOTLIB and matplotlib is None:
                    continue
                width, height = size_of(base64.b64decode(bundle["image/png"]))
                self.assertTrue(60 < width < 1200 and 60 < height < 800)
        self.assertEqual(OBJECTS["image"]._repr_html_(), self.bundles["image"]["text/html"])
        self.assertEqual(size_of(OBJECTS["image"]._repr_png_()), (360, 300))

    def test_pages_load_nothing_and_do_not_meet(self):
        for name, bundle in self.bundles.items():
            with self.subTest(name):
                frame = bundle["text/html"]
                self.assertIn('sandbox="allow-scripts"', frame)  # of another origin: scripts and ids of their own
                page = page_in(frame)
                self.assertIn("default-src 'none'", page)
                self.assertNotRegex(page, r'(src|href)="(?!data:)')
                self.assertEqual(page.count('class="surface-data"'), name in WITH_VIEW)

    def test_the_view_has_the_data_of_the_mesh(self):
        mesh = OBJECTS["coloured"]
        data = json.loads(re.search(r'surface-data">(.*?)</script>', page_in(self.bundles["coloured"]["text/html"]))[1])
        faces = np.frombuffer(base64.b64decode(data["triangles"]), "<u2").reshape(-1, 3)
        np.testing.assert_array_equal(faces, mesh.faces)
        parts = np.frombuffer(base64.b64decode(data["positions"]), "<u2").reshape(-1, 3) / 65535
        low, high = np.array(data["low"]), np.array(data["high"])
        np.testing.assert_allclose(low + parts * (high - low), mesh.vertices, atol=1e-4)
        tints = np.frombuffer(base64.b64decode(data["tints"]), "u1").reshape(-1, 3)
        self.assertEqual((data["shown"], tints[0].tolist()), ("own", [0, 40, 80]))

    def test_large_meshes_are_shown_with_fewer_triangles_and_say_so(self):
        mesh = OBJECTS["surface"].polygonize(160, method="marching-cubes")
        self.assertGreater(len(mesh.vertices), 30000)
        frame = mesh._repr_html_()
        self.assertLess(len(frame), MOST_IN_NOTEBOOK)
        told = re.search(r"Shown with ([\d,]+) of its ([\d,]+) triangles", frame)
        self.assertEqual(told[2].replace(",", ""), str(len(mesh.faces)))
        from csrbf._coarse import coarse

        coarser = coarse(mesh, 2000)
        self.assertTrue(1000 < len(coarser.vertices) <= 2000)
        self.assertLess(csrbf.compare(coarser, mesh)["hausdorff99"], 0.02)
        cloud = csrbf.PointCloud(np.random.default_rng(0).normal(size=(50000, 3)))
        self.assertIn("Shown with 16,667 of the points", cloud._repr_html_())

    @unittest.skipIf(DisplayFormatter is None, "IPython is not installed")
    def test_a_notebook_computes_and_shows_each_of_them_once(self):
        mesh = OBJECTS["mesh"]
        with mock.patch.object(csrbf.Mesh, "_page", autospec=True, side_effect=csrbf.Mesh._page) as page:
            data, _ = DisplayFormatter().format(mesh)
        self.assertEqual(page.call_count, 1)
        self.assertEqual(set(data), {"text/plain", "text/html", "image/png"})

    def test_empty_and_odd_objects_show_themselves_too(self):
        points = np.zeros((3, 3))
        for thing in (
            csrbf.Mesh(np.eye(3), np.empty((0, 3), int)), csrbf.Mesh(points, [[0, 1, 2]]),
            csrbf.PointCloud(np.empty((0, 3))), csrbf.PointCloud(points), csrbf.PointCloud(points[:1]),
            csrbf.Polylines(points[:0], np.empty((0, 2), int)), csrbf.Polylines(points, np.array([[0, 1]])),
            csrbf.Image(np.zeros(5)), csrbf.Image(np.full((4, 4), np.nan)), csrbf.Image(np.zeros((2, 6, 7, 8))),
            csrbf.Image(np.ma.masked_less(np.arange(12).reshape(3, 4), 5)), csrbf.Image(np.eye(4) > 0),
            csrbf.Curvature(np.full(2, np.nan), np.zeros(2), np.zeros((2, 3)), np.zeros((2, 3))),
            csrbf.fit([[0.0]], [1.0]), csrbf.Tracking([], [], []),
        ):
            with self.subTest(repr(thing)):
                self.assertIn("<dd>", page_in(thing._repr_html_()))
                thing._repr_png_()

    def test_the_page_opens_in_the_browser(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch("webbrowser.open") as opened:
            path = OBJECTS["map"].show(os.path.join(folder, "map.html"))
            self.assertEqual(opened.call_args[0][0], path.resolve().as_uri())
            text = path.read_text()
            self.assertTrue(text.startswith("<!DOCTYPE html>") and "landscape" in text)
            other = OBJECTS["mesh"].show()
            self.addCleanup(other.unlink)
            self.assertIn("surface-data", other.read_text())

    def test_the_view_is_there_when_the_build_has_it(self):
        folder = pathlib.Path(csrbf.__file__).parent / "page"
        self.assertTrue((folder / "report.css").exists())
        page = page_in(self.bundles["mesh"]["text/html"])
        self.assertEqual((folder / "viewer.js").exists(), 'id="packed"' in page)
        self.assertEqual((folder / "viewer.js").exists(), "A still picture" not in page)


class Terminal(unittest.TestCase):
    def test_nothing_floods_it(self):
        rng = np.random.default_rng(0)
        OBJECTS["large"] = csrbf.PointCloud(rng.normal(size=(5000, 3)))
        for name, thing in OBJECTS.items():
            with self.subTest(name):
                self.assertLess(len(repr(thing)), 160)
                self.assertRegex(repr(thing), r"^<csrbf\.\w+ .*>$")
                self.assertNotIn("\n", repr(thing))


@unittest.skipIf(matplotlib is None, "matplotlib is not installed")
class Plots(unittest.TestCase):
    def tearDown(self):
        pyplot.close("all")

    def test_every_object_draws_itself_into_given_or_new_axes(self):
        for name, thing in OBJECTS.items():
            with self.subTest(name):
                space = {"projection": "3d"} if isinstance(thing, (csrbf.PointCloud, csrbf.Polylines)) else {}
                given = pyplot.figure().add_subplot(**space)
                traced = isinstance(thing, (csrbf.Surface, csrbf.Mesh))
                options = {"size": (80, 60)} if traced else {}
                self.assertIs(thing.plot(given, **options), given)
                if not traced:
                    self.assertIsNot(thing.plot(), given)
                pyplot.close("all")
        solid = pyplot.figure().add_subplot(projection="3d")
        OBJECTS["mesh"].plot(solid)

    def test_samples_and_deviations_of_functions_are_drawn(self):
        curve = OBJECTS["curve"]
        ax = curve.plot(deviation=True)
        self.assertEqual(len(ax.lines[0].get_xdata()), 60)
        self.assertEqual(len(ax.collections), 1)
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("x", "value"))
        ax = OBJECTS["map"].plot(resolution=30)
        shown = ax.collections[0].get_array()
        nodes = [np.linspace(*OBJECTS["map"].bounds[:, a], 30) for a in (0, 1)]
        np.testing.assert_allclose(np.ravel(shown), OBJECTS["map"].evaluate_grid(*nodes).T.ravel(), atol=1e-9)
        self.assertEqual(len(ax.collections[1].get_offsets()), 200)
        self.assertEqual(len(OBJECTS["map"].plot(samples=False).collections), 1)
        space = OBJECTS["space"]
        ax = space.plot(variables=["z", "x"], component=1, at=[0, 0.5, 0])
        self.assertEqual((ax.get_xlabel(), ax.get_ylabel()), ("z", "x"))
        for wrong in ({"variables": ["w"]}, {"variables": [0, 1, 2]}, {"component": 2}, {"at": [0, 0]}):
            with self.assertRaisesRegex(ValueError, next(iter(wrong))):
                space.plot(**wrong)

    def test_contours_are_drawn_where_the_image_is(self):
        y, x = np.mgrid[:48, :64]
        image = csrbf.Image(np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0), 0.5, (100, 50))
        ax = csrbf.segment(image).plot()
        line = np.vstack([path.vertices for path in ax.collections[0].get_paths()])
        np.testing.assert_allclose(np.hypot(*(line - [115, 60]).T), 6, atol=0.3)
        left, right, bottom, top = ax.images[0].get_extent()
        self.assertEqual((left, right, bottom, top), (99.75, 131.75, 73.75, 49.75))
        solid = OBJECTS["solid"].plot(axis="x", slice=10)
        self.assertEqual((solid.get_xlabel(), solid.get_ylabel()), ("y", "z"))
        with self.assertRaisesRegex(ValueError, "slice: 99 must be from 0 to 23"):
            OBJECTS["solid"].plot(axis="x", slice=99)


if __name__ == "__main__":
    unittest.main()
