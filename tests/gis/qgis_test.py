"""Runs the algorithms of the QGIS plugin by qgis_process and reads their output with GDAL.

usage: qgis_test.py BUILD/python [PROGRAM] [unittest options]

With the variable CSRBF_GIS set to a folder, the outputs are kept there. Ends with 77 (skipped) without QGIS (Debian:
qgis, qgis-providers).
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

PACKAGE, PROGRAM = None, None
# Debian's qgis_process is a script that may add options which the program behind it does not know.
QGIS = shutil.which("qgis_process.bin") or shutil.which("qgis_process")
EAST, NORTH, SIZE = 500000.0, 5600000.0, 2000.0  # UTM zone 33


def height(x, y):
    """Metres; rises to the east and the north, unlike each other."""
    u, v = (x - EAST) / SIZE, (y - NORTH) / SIZE
    return 300 + 60 * u + 25 * v + 40 * np.sin(3 * u) * np.cos(2 * v)


def write_points(path, crs="urn:ogc:def:crs:EPSG::32633", scale=1.0):
    rng = np.random.default_rng(2)
    features = []
    for i in range(400):
        x, y = EAST + SIZE * rng.random(), NORTH + SIZE * rng.random()
        z = height(x, y)
        value = {7: None, 9: -9999.0}.get(i, z)
        features.append({"type": "Feature", "properties": {"id": i, "depth": value},
                         "geometry": {"type": "Point", "coordinates": [x * scale, y * scale, z]}})
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features,
                                "crs": {"type": "name", "properties": {"name": crs}}}))


class Qgis(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory(prefix="csrbf_qgis_")
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(os.environ.get("CSRBF_GIS", holder.name))
        home = pathlib.Path(holder.name, "home")
        home.mkdir(mode=0o700)
        cls.environment = dict(os.environ, HOME=str(home), XDG_RUNTIME_DIR=str(home), QT_QPA_PLATFORM="offscreen",
                               QGIS_PLUGINPATH=str(PACKAGE / "qgis"), PYTHONPATH=str(PACKAGE), PYTHONWARNINGS="ignore")
        cls.environment.pop("DISPLAY", None)
        cls.qgis("plugins", "enable", "csrbf_qgis")
        write_points(cls.folder / "points.geojson")

    @classmethod
    def qgis(cls, *arguments, fails=False, **environment):
        run = subprocess.run([QGIS, *arguments], env={**cls.environment, **environment}, capture_output=True, text=True,
                             timeout=300)
        output = run.stdout + run.stderr
        assert (run.returncode != 0) == fails, output
        return output

    def run_algorithm(self, name, output, environment=None, fails=False, **parameters):
        given = {"INPUT": self.folder / "points.geojson", "FIELD": "depth", "MISSING": -9999, "CELL": 25,
                 "OUTPUT": self.folder / output, **parameters}
        words = [f"{key}={value}" for key, value in given.items() if value is not None]
        return self.qgis("run", f"csrbf:{name}", "--", *words, fails=fails, **(environment or {}))

    def read(self, name):
        """Values [row, column], coordinates of the centres, and the coordinate system of a raster."""
        from osgeo import gdal, osr

        raster = gdal.Open(str(self.folder / name))
        left, width, _, top, _, down = raster.GetGeoTransform()
        band = raster.GetRasterBand(1)
        values = band.ReadAsArray().astype(float)
        values[values == band.GetNoDataValue()] = np.nan
        system = osr.SpatialReference(wkt=raster.GetProjection())
        x = left + width * (np.arange(raster.RasterXSize) + 0.5)
        y = top + down * (np.arange(raster.RasterYSize) + 0.5)
        return values, x, y, system.GetAuthorityCode(None)

    def test_interpolate_writes_a_raster_where_the_points_are(self):
        log = self.run_algorithm("interpolate", "dem.tif", DEVIATION=self.folder / "sd.tif")
        self.assertIn("1 points have no value", log)
        self.assertIn("Error of new samples", log)
        values, x, y, system = self.read("dem.tif")
        self.assertEqual(system, "32633")
        self.assertEqual((round(x[1] - x[0], 6), round(y[1] - y[0], 6)), (25, -25))
        self.assertTrue(EAST < x[0] < EAST + 40 and NORTH + SIZE - 40 < y[0] < NORTH + SIZE)
        self.assertLess(np.abs(values - height(x, y[:, None]))[3:-3, 3:-3].max(), 0.5)
        deviations, *_ = self.read("sd.tif")
        self.assertEqual(deviations.shape, values.shape)
        self.assertGreaterEqual(np.nanmin(deviations), 0)

    def test_the_program_does_the_same_where_the_module_is_not_found(self):
        if PROGRAM is None:
            self.skipTest("the program was not built")
        self.run_algorithm("interpolate", "module.tif")
        self.run_algorithm("interpolate", "program.tif", {"PYTHONPATH": "", "CSRBF_PROGRAM": str(PROGRAM)})
        module, program = self.read("module.tif"), self.read("program.tif")
        np.testing.assert_allclose(module[0], program[0], rtol=1e-6)
        np.testing.assert_array_equal(module[1], program[1])
        log = self.run_algorithm("interpolate", "none.tif", {"PYTHONPATH": "", "PATH": "/nowhere"}, fails=True)
        self.assertIn("neither the Python module csrbf nor the program", log)

    def test_uncertainty_grows_away_from_the_points(self):
        extent = f"{EAST},{EAST + 2 * SIZE},{NORTH},{NORTH + SIZE} [EPSG:32633]"
        self.run_algorithm("uncertainty", "uncertainty.tif", EXTENT=extent, CELL=50)
        values, x, _, _ = self.read("uncertainty.tif")
        self.assertEqual(values.shape, (40, 80))
        near, far = (np.median(values[:, part]) for part in (x < EAST + SIZE, x > EAST + 1.5 * SIZE))
        self.assertGreater(far, 3 * near)

    def test_contours_lie_on_the_function(self):
        from osgeo import ogr

        self.run_algorithm("contour", "contours.gpkg", INTERVAL=10)
        source = ogr.Open(str(self.folder / "contours.gpkg"))
        layer = source.GetLayer(0)
        self.assertEqual(layer.GetSpatialRef().GetAuthorityCode(None), "32633")
        values, worst = set(), 0.0
        for feature in layer:
            points = np.array(feature.geometry().GetPoints())[:, :2]
            values.add(feature.GetField("value"))
            inside = ((points > [EAST + 80, NORTH + 80]) & (points < [EAST + SIZE - 80, NORTH + SIZE - 80])).all(axis=1)
            if inside.any():
                worst = max(worst, np.abs(height(*points[inside].T) - feature.GetField("value")).max())
        self.assertTrue(all(value % 10 == 0 for value in values) and len(values) > 5)
        self.assertLess(worst, 0.7)

    def test_heights_of_points_are_values_and_wrong_input_is_told(self):
        self.run_algorithm("interpolate", "heights.tif", FIELD=None, MISSING=None)
        values, x, y, _ = self.read("heights.tif")
        self.assertLess(np.abs(values - height(x, y[:, None]))[3:-3, 3:-3].max(), 0.5)
        log = self.run_algorithm("interpolate", "huge.tif", CELL=0.01, fails=True)
        self.assertIn("give a larger cell size", log)
        write_points(self.folder / "degrees.geojson", "urn:ogc:def:crs:OGC:1.3:CRS84", 1e-5)
        log = self.run_algorithm("interpolate", "degrees.tif", INPUT=self.folder / "degrees.geojson", CELL=0.001)
        self.assertIn("coordinates are degrees", log)


if __name__ == "__main__":
    if QGIS is None:
        print("skipped: QGIS is not installed (Debian: qgis, qgis-providers)")
        sys.exit(77)
    try:
        import osgeo  # noqa: F401
    except ImportError:
        print("skipped: the Python module of GDAL is not installed (Debian: python3-gdal)")
        sys.exit(77)
    PACKAGE = pathlib.Path(sys.argv.pop(1)).resolve()
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-") and pathlib.Path(sys.argv[1]).exists():
        PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
