"""Masked arrays, tables of pandas and arrays of xarray as arguments, and what comes back."""

import pickle
import subprocess
import sys
import unittest
import warnings

import numpy as np

import csrbf

try:
    import pandas
except ImportError:
    pandas = None
try:
    import xarray
except ImportError:
    xarray = None


def soundings(n=150):
    x = np.random.default_rng(3).uniform(-1, 1, (n, 2))
    return x, np.cos(2 * x[:, 0]) * x[:, 1]


def disc(nx=64, ny=48):
    y, x = np.mgrid[:ny, :nx]
    return np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0) + np.random.default_rng(0).normal(size=(ny, nx))


class Imports(unittest.TestCase):
    def test_of_optional_packages_happen_only_when_they_are_used(self):
        program = (
            "import sys, numpy, csrbf\n"
            "f = csrbf.fit(numpy.random.rand(50, 2), numpy.arange(50.0))\n"
            "f([[0.5, 0.5]]), repr(f), csrbf.segment(numpy.eye(12) > 0)\n"
            "print([m for m in ('pandas', 'xarray', 'matplotlib', 'IPython', 'sklearn') if m in sys.modules])"
        )
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertEqual(run.stdout, "[]\n", run.stderr)


class Masks(unittest.TestCase):
    def test_masked_samples_are_left_out_and_counted(self):
        x, depth = soundings()
        spoilt = depth.copy()
        spoilt[::7] = -9999
        f = csrbf.fit(x, np.ma.masked_equal(spoilt, -9999))
        kept = csrbf.fit(x[spoilt != -9999], depth[spoilt != -9999])
        np.testing.assert_array_equal(f(x), kept(x))
        self.assertEqual(f.report["missing"], (spoilt == -9999).sum())
        self.assertEqual(pickle.loads(pickle.dumps(f)).report["missing"], f.report["missing"])

    def test_masked_coordinates_weights_and_columns_leave_the_sample_out(self):
        x, depth = soundings()
        mask = np.zeros(x.shape, bool)
        mask[3, 1] = mask[9, 0] = True
        weights = np.ma.masked_array(np.ones(len(x)), np.arange(len(x)) == 20)
        values = np.ma.masked_array(np.column_stack([depth, -depth]), False)
        values[30, 1] = np.ma.masked
        f = csrbf.fit(np.ma.masked_array(x, mask), values, weights=weights)
        kept = np.delete(np.arange(len(x)), [3, 9, 20, 30])
        np.testing.assert_allclose(f(x), csrbf.fit(x[kept], np.column_stack([depth, -depth])[kept])(x), atol=1e-9)

    def test_masks_without_masked_entries_are_plain_arrays(self):
        x, depth = soundings(50)
        f = csrbf.fit(np.ma.masked_array(x), np.ma.masked_array(depth))
        self.assertIs(type(f(np.ma.masked_array(x))), np.ndarray)

    def test_results_are_masked_where_the_places_are(self):
        x, depth = soundings()
        f = csrbf.fit(x, np.column_stack([depth, depth]))
        places = np.ma.masked_greater(x[:12].reshape(3, 4, 2), 0.5)
        hidden = np.ma.getmaskarray(places).any(axis=-1)
        self.assertTrue(hidden.any() and not hidden.all())
        for call, trailing in ((f, (2,)), (f.gradient, (2, 2)), (f.hessian, (2, 2, 2))):
            found = call(places)
            self.assertEqual(found.shape, (3, 4) + trailing)
            np.testing.assert_array_equal(np.ma.getmaskarray(found).reshape(3, 4, -1).all(axis=-1), hidden)
            np.testing.assert_array_equal(found[~hidden], call(np.asarray(places)[~hidden]))
        table = csrbf.evaluate(f, places, gradient=True)
        np.testing.assert_array_equal(np.ma.getmaskarray(table).all(axis=-1), hidden)

    def test_masked_voxels_do_not_count(self):
        image = disc()
        spoilt = image.copy()
        spoilt[:, 50:] = 1e6
        seen = np.arange(64) < 50
        g = csrbf.segment(np.ma.masked_greater(spoilt, 1e5))
        np.testing.assert_array_equal(g.labels, csrbf.segment(image, mask=np.tile(seen, (48, 1))).labels)
        self.assertGreater((g.labels[:, :50] == (disc() > 5)[:, :50]).mean(), 0.98)
        filled = csrbf.inpaint(np.ma.masked_greater(spoilt, 1e5), mask=np.tile(np.arange(64) == 3, (48, 1)))
        self.assertEqual(filled.report["missing"], 48 * 15)
        self.assertLess(np.asarray(filled).max(), 100)
        t = csrbf.track([np.ma.masked_greater(spoilt, 1e5)] * 2)
        self.assertLess(t.measures[0][0]["mean"], 100)

    def test_masked_images_are_saved_with_nan_or_not_at_all(self):
        masked = csrbf.Image(np.ma.masked_less(np.arange(12.0).reshape(3, 4), 5))
        self.assertEqual(np.isnan(np.asarray(masked)).sum(), 5)
        self.assertIs((masked > 3).mask[0, 0], np.True_)
        whole = csrbf.Image(np.ma.masked_less(np.arange(12).reshape(3, 4), 5))
        with self.assertRaisesRegex(ValueError, "voxels are masked"):
            whole.save("never.nrrd")

    def test_points_that_are_masked_are_left_out_of_surfaces(self):
        x = np.random.default_rng(0).normal(size=(2000, 3))
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        spoilt = x.copy()
        spoilt[::50] *= 100
        s = csrbf.reconstruct(np.ma.masked_outside(spoilt, -2, 2), normals=x)
        self.assertEqual(s.report["points"], (np.abs(spoilt) <= 2).all(axis=1).sum())
        self.assertIs(s(np.ma.masked_outside(spoilt[:60], -2, 2))[0], np.ma.masked)

    def test_masks_are_refused_where_they_have_no_meaning(self):
        masked = np.ma.masked_less(np.eye(3), 0.5)
        calls = {
            "points": lambda: csrbf.estimate_normals(masked),
            "vertices": lambda: csrbf.Mesh(masked, [[0, 1, 2]]),
            "y": lambda: csrbf.RBFInterpolator(masked, [1.0, 2, 3]),
            "d": lambda: csrbf.RBFInterpolator(np.eye(3), masked[0]),
            "mask": lambda: csrbf.segment(np.eye(3), mask=masked),
            "values": lambda: csrbf.fit(np.eye(3), np.ma.masked_all(3)),
            "faces": lambda: csrbf.Mesh(np.eye(3), np.ma.masked_less([[0, 1, 2]], 1)),
        }
        for name, call in calls.items():
            with self.subTest(name), self.assertRaisesRegex(ValueError, f"^{name}: .*masked"):
                call()


class OtherArrays(unittest.TestCase):
    def test_objects_complex_numbers_and_dates_are_refused_in_words(self):
        x, depth = soundings(40)
        cases = {
            "complex": (x, depth + 1j),
            r"entry \[3\] is None": (x, np.where(np.arange(40) == 3, None, depth)),
            r"\.astype\(float\)": (x.astype(object), depth),
            "dates or times": (x, depth.astype("M8[s]")),
            "array of numbers": ([[0, 1], [2]], [1, 2]),
            "must be real numbers": (x, ["deep"] * 40),
        }
        for words, arguments in cases.items():
            with self.subTest(words), self.assertRaisesRegex(ValueError, "^(points|values): .*" + words):
                csrbf.fit(*arguments)
        f = csrbf.fit(x, depth)
        image = np.full((9, 9), None)
        for call in (
            lambda bad: f(bad), lambda bad: csrbf.segment(bad), lambda bad: csrbf.inpaint(bad),
            lambda bad: csrbf.reconstruct(bad), lambda bad: csrbf.Image(bad), lambda bad: csrbf.farthest_points(bad, 3),
            lambda bad: csrbf.compare(bad, bad), lambda bad: csrbf.segment(np.eye(9), mask=bad),
            lambda bad: csrbf.Mesh(np.eye(3), bad), lambda bad: csrbf.RBFInterpolator(bad, np.eye(9)),
        ):
            for bad in (image, np.zeros((9, 9), complex)):
                with self.assertRaisesRegex(ValueError, "real numbers"):
                    call(bad)

    def test_faces_are_whole_numbers(self):
        self.assertEqual(csrbf.Mesh(np.eye(3), [[0.0, 1.0, 2.0]]).faces.dtype, np.int32)
        for wrong in ([[0, 1, 1.5]], [[0, 1, 2**40]]):
            with self.assertRaisesRegex(ValueError, "faces: must be whole numbers"):
                csrbf.Mesh(np.eye(3), wrong)

    def test_a_last_axis_of_three_or_four_is_colour(self):
        image = disc()
        colours = np.stack([image, 0 * image, -image], axis=-1)
        found = csrbf.segment(colours)
        self.assertEqual((found.labels.shape, csrbf.Image(colours).axes), ((48, 64), "yxc"))
        np.testing.assert_array_equal(found.labels, csrbf.segment(csrbf.Image(colours, axes="yxc")).labels)
        opaque = np.concatenate([colours, np.ones((48, 64, 1))], axis=-1)
        self.assertEqual(csrbf.inpaint(np.where(opaque > 9, np.nan, opaque)).axes, "yxc")

    def test_what_may_be_colour_or_a_volume_is_refused(self):
        for shape in ((2, 50, 3), (50, 4, 4), (5, 40, 50, 3)):
            with self.subTest(shape), self.assertRaisesRegex(ValueError, "may be colours or x"):
                csrbf.segment(np.zeros(shape))
        self.assertEqual(csrbf.Image(np.zeros((2, 3, 4))).axes, "zyx")
        self.assertEqual(csrbf.Image(np.zeros((2, 50, 3)), axes="zyx").axes, "zyx")
        with self.assertRaisesRegex(ValueError, "for each of the 2 axes y, x"):
            csrbf.segment(np.zeros((20, 30, 3)), voxel_size=(1, 1, 2))


@unittest.skipIf(pandas is None, "pandas is not installed")
class Tables(unittest.TestCase):
    def setUp(self):
        x, depth = soundings()
        self.x, self.depth = x, depth
        self.table = pandas.DataFrame({"id": range(len(x)), "lon": x[:, 0], "lat": x[:, 1], "depth": depth},
                                      index=[f"s{i}" for i in range(len(x))])

    def test_without_rows_have_nothing_to_fit_and_no_answers(self):
        none = self.table[:0]
        for points, values, names in ((none, "depth", ["lon", "lat"]), (none[["lon", "lat"]], none["depth"], None)):
            with self.assertRaisesRegex(ValueError, "at least one sample is needed"):
                csrbf.fit(points, values, coordinates=names)
        f = csrbf.fit(self.table, ["depth", "id"], coordinates=["lon", "lat"])
        self.assertEqual((f(none).shape, f.hessian(none).shape), ((0, 2), (0, 6)))

    def test_columns_are_fitted_and_answers_keep_the_index(self):
        f = csrbf.fit(self.table, "depth", coordinates=["lon", "lat"])
        plain = csrbf.fit(self.x, self.depth)
        self.assertEqual((f.coordinate_names, f.value_names), (["lon", "lat"], ["depth"]))
        found = f(self.table)
        self.assertIsInstance(found, pandas.Series)
        self.assertEqual((found.name, list(found.index)), ("depth", list(self.table.index)))
        np.testing.assert_array_equal(found.to_numpy(), plain(self.x))
        turned = self.table[["lat", "depth", "lon"]]  # names count, not the order
        np.testing.assert_array_equal(f(turned).to_numpy(), plain(self.x))
        gradient = f.gradient(self.table)
        self.assertEqual(list(gradient.columns), ["depth_lon", "depth_lat"])
        np.testing.assert_array_equal(gradient.to_numpy(), plain.gradient(self.x))
        self.assertEqual(list(f.hessian(self.table).columns), ["depth_lon_lon", "depth_lon_lat", "depth_lat_lat"])
        self.assertEqual(f.standard_deviation(self.table).name, "depth_standard_deviation")
        answers = csrbf.evaluate(f, self.table, gradient=True, standard_deviation=True)
        self.assertEqual(list(answers.columns), ["depth", "depth_lon", "depth_lat", "depth_standard_deviation"])
        self.assertEqual(pickle.loads(pickle.dumps(f)).coordinate_names, ["lon", "lat"])

    def test_several_values_and_weights_are_columns_too(self):
        table = self.table.assign(minus=-self.depth, weight=1.0 + (self.x[:, 0] > 0))
        f = csrbf.fit(table, ["depth", "minus"], coordinates=["lon", "lat"], weights="weight")
        found = f(table)
        self.assertEqual(list(found.columns), ["depth", "minus"])
        np.testing.assert_allclose(found["minus"], -found["depth"], atol=1e-9)

    def test_a_table_of_coordinates_with_values_beside_it(self):
        table, x, numbers = self.table[:40], self.x[:40], self.depth[:40]
        where, depth = table[["lon", "lat"]], table["depth"]
        plain = csrbf.fit(x, numbers)(x)
        for values, name in ((depth, "depth"), (numbers, "value"), (list(numbers), "value"),
                             (depth.astype("Float64"), "depth")):
            f = csrbf.fit(where, values)
            self.assertEqual((f.coordinate_names, f.value_names), (["lon", "lat"], [name]))
            np.testing.assert_array_equal(f(where).to_numpy(), plain)
        f = csrbf.fit(where, table[["depth", "id"]])
        self.assertEqual(list(f(where).columns), ["depth", "id"])
        np.testing.assert_array_equal(csrbf.fit(table, depth, coordinates=["lon", "lat"])(x), plain)
        hidden = np.ma.masked_array(numbers, np.arange(len(x)) == 5)
        self.assertEqual(csrbf.fit(where, hidden).report["missing"], 1)
        with self.assertRaisesRegex(ValueError, "values: have another index than the table"):
            csrbf.fit(where, depth.sample(frac=1, random_state=1))
        with self.assertRaisesRegex(ValueError, r"values: has shape \(3,\)"):
            csrbf.fit(where, [1.0, 2.0, 3.0])

    def test_rows_without_a_value_are_left_out_and_counted(self):
        table = self.table.copy()
        table.loc["s5", "depth"] = np.nan
        table["depth"] = table["depth"].astype("Float64")
        f = csrbf.fit(table, "depth", coordinates=["lon", "lat"])
        self.assertEqual(f.report["missing"], 1)
        kept = np.arange(len(self.x)) != 5
        np.testing.assert_array_equal(f(self.x), csrbf.fit(self.x[kept], self.depth[kept])(self.x))

    def test_what_is_not_there_is_said(self):
        cases = {
            'coordinates: name the columns.*id, lon, lat, depth': {"values": "depth"},
            'values: there is no "dept"; the table has the columns id, lon': {"values": "dept",
                                                                              "coordinates": ["lon", "lat"]},
            'coordinates: there is no "x"': {"values": "depth", "coordinates": ["x", "lat"]},
            "values: name the column": {"coordinates": ["lon", "lat"]},
        }
        for words, arguments in cases.items():
            with self.subTest(words), self.assertRaisesRegex(ValueError, words):
                csrbf.fit(self.table, **arguments)
        with self.assertRaisesRegex(ValueError, "coordinates: are columns of a table"):
            csrbf.fit(self.x, self.depth, coordinates=["x", "y"])
        f = csrbf.fit(self.table, "depth", coordinates=["lon", "lat"])
        with self.assertRaisesRegex(ValueError, 'x: there is no "lon"'):
            f(self.table.rename(columns={"lon": "longitude"}))
        text = self.table.assign(depth="deep")
        with self.assertRaisesRegex(ValueError, 'column "depth": must be real numbers'):
            csrbf.fit(text, "depth", coordinates=["lon", "lat"])

    def test_functions_of_arrays_take_tables_of_as_many_columns(self):
        f = csrbf.fit(self.x, self.depth)
        np.testing.assert_array_equal(f(self.table[["lon", "lat"]]).to_numpy(), f(self.x))
        with self.assertRaisesRegex(ValueError, 'there is no "x"'):
            f(self.table)

    def test_surfaces_take_x_y_z_and_normals(self):
        x = np.random.default_rng(0).normal(size=(1500, 3))
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        columns = np.column_stack([np.arange(1500), x, x])
        cloud = pandas.DataFrame(columns, columns=["id", "x", "y", "z", "nx", "ny", "nz"])
        s = csrbf.reconstruct(cloud)
        self.assertNotEqual(s.report["normals"], "estimated")
        np.testing.assert_array_equal(s(cloud).to_numpy(), s(x))


@unittest.skipIf(xarray is None, "xarray is not installed")
class Grids(unittest.TestCase):
    def grid(self):
        lat, lon = np.linspace(50, 52, 21), np.linspace(4, 8, 41)
        values = np.sin(lon) * np.cos(2 * lat[:, None])
        return xarray.DataArray(values, {"lat": lat, "lon": lon}, ["lat", "lon"], name="height", attrs={"units": "m"})

    def test_a_grid_is_fitted_and_evaluated_by_its_coordinates(self):
        grid = self.grid()
        holes = grid.where(np.random.default_rng(0).random(grid.shape) > 0.2)
        f = csrbf.fit(holes)
        self.assertEqual((f.coordinate_names, f.value_names), (["lon", "lat"], ["height"]))
        self.assertEqual(f.report["missing"], int(holes.isnull().sum()))
        finer = xarray.DataArray(np.zeros((30, 25)), {"lon": np.linspace(4, 8, 30), "lat": np.linspace(50, 52, 25)},
                                 ["lon", "lat"])
        found = f(finer)
        self.assertEqual((found.dims, found.name), (("lon", "lat"), "height"))
        np.testing.assert_array_equal(found.lon, finer.lon)
        expected = np.sin(finer.lon) * np.cos(2 * finer.lat)
        np.testing.assert_allclose(found, expected.transpose("lon", "lat"), atol=0.02)
        table = csrbf.evaluate(f, like=finer, gradient=True)
        self.assertEqual(list(table.data_vars), ["height", "height_lon", "height_lat"])
        track = xarray.Dataset(coords={"lon": ("k", [5.0, 6.0]), "lat": ("k", [51.0, 51.5])})
        np.testing.assert_allclose(f(track), f([[5, 51], [6, 51.5]]), atol=1e-12)
        self.assertEqual(f(track).dims, ("k",))
        self.assertEqual(f(grid).dims, ("lat", "lon"))

    def test_variables_of_a_dataset_are_fitted(self):
        data = self.grid().to_dataset().assign(twice=2 * self.grid())
        f = csrbf.fit(data, ["height", "twice"], coordinates=["lon", "lat"])
        found = f(data)
        self.assertEqual(list(found.data_vars), ["height", "twice"])
        np.testing.assert_allclose(found.twice, 2 * found.height, atol=1e-9)

    def test_names_must_be_there(self):
        f = csrbf.fit(self.grid())
        with self.assertRaisesRegex(ValueError, 'there is no "lon"; the array has the coordinates y, x'):
            f(self.grid().rename(lon="x", lat="y"))
        with self.assertRaisesRegex(ValueError, "leave them out"):
            csrbf.fit(self.grid(), "height")
        with self.assertRaisesRegex(ValueError, "dates or times"):
            csrbf.fit(self.grid().assign_coords(lat=np.arange(21).astype("M8[D]")))

    def image(self):
        # North up, as rasters are: y falls.
        y, x = 500 - 2.0 * np.arange(48), 100 + 2.0 * np.arange(64)
        return xarray.DataArray(disc(), {"y": y, "x": x, "crs": 32633}, ["y", "x"], name="band")

    def test_labels_and_contours_are_where_the_image_is(self):
        image = self.image()
        g = csrbf.segment(image, init="sphere:160,460,10", objects=True)
        plain = csrbf.segment(image.values, init="sphere:30,20,5")
        self.assertEqual((g.labels.dims, g.labels.name), (("y", "x"), "labels"))
        self.assertEqual(int(g.labels.crs), 32633)
        np.testing.assert_array_equal(g.labels.y, image.y)
        self.assertLess((g.labels.values != plain.labels).mean(), 0.002)
        self.assertEqual(int(g.objects.sel(x=160, y=460)), 1)
        (line,) = g.contour()
        np.testing.assert_allclose(line.mean(axis=0), [160, 460], atol=1)
        turned = csrbf.segment(image.transpose("x", "y"), init="sphere:160,460,10")
        self.assertEqual(turned.labels.dims, ("x", "y"))
        np.testing.assert_array_equal(turned.labels.transpose("y", "x").values, g.labels.values)

    def test_bands_and_missing_voxels(self):
        image = self.image()
        rgb = xarray.concat([image, 0 * image, -image], "band").transpose("band", "y", "x")
        self.assertEqual(csrbf.segment(rgb).labels.dims, ("y", "x"))
        one = image.expand_dims("band")
        self.assertEqual(csrbf.segment(one).labels.dims, ("y", "x"))
        filled = csrbf.inpaint(one.where(one.x > 120))
        self.assertEqual((filled.dims, filled.name), (one.dims, one.name))
        self.assertEqual(int(filled.isnull().sum()), 0)
        known = csrbf.segment(image.where(image.x > 120))
        self.assertGreater(float((known.labels == (image > 5)).where(image.x > 120).mean()), 0.98)

    def test_masks_and_seeds_follow_the_dimensions_of_the_image(self):
        square = self.image().isel(x=slice(0, 48))  # as many columns as rows: only names tell them apart
        turned = square.transpose("x", "y")
        seen = ((square.x < 150) & (square.y < 9999)).transpose("y", "x")
        expected = csrbf.segment(square, mask=seen.values).labels
        for mask in (seen, seen.transpose("x", "y")):
            for image in (square, turned):
                np.testing.assert_array_equal(csrbf.segment(image, mask=mask).labels.transpose("y", "x"), expected)
        plain = seen.transpose("x", "y").values  # has the axes of the image it is given with
        np.testing.assert_array_equal(csrbf.segment(turned, mask=plain).labels.transpose("y", "x"), expected)
        start = (square > 5).astype(int)
        np.testing.assert_array_equal(csrbf.segment(turned, init=start).labels.transpose("y", "x"),
                                      csrbf.segment(square, init=start).labels)
        hole = (square.x > 110) & (square.x < 116) & (square.y < 9999)
        filled = csrbf.inpaint(turned, mask=hole).transpose("y", "x")
        np.testing.assert_array_equal(filled, csrbf.inpaint(square, mask=hole))
        with self.assertRaisesRegex(ValueError, 'mask: its coordinate "x" is not that of the image'):
            csrbf.segment(square, mask=seen.assign_coords(x=square.x + 1))
        with self.assertRaisesRegex(ValueError, "mask: has the dimensions x, z; the image has y, x"):
            csrbf.segment(square, mask=seen.rename(y="z").transpose("x", "z"))

    def test_frames_keep_their_time(self):
        image = self.image()
        times = np.array(["2020-01-01", "2020-02-01"], dtype="M8[ns]")
        frames = xarray.concat([image, image], xarray.DataArray(times, dims="time", name="time"))
        t = csrbf.track(frames)
        self.assertEqual([frame.labels.time.values for frame in t], list(times))
        self.assertEqual(t[0].labels.dims, ("y", "x"))

    def test_uneven_coordinates_are_refused(self):
        image = self.image().assign_coords(x=np.arange(64.0) ** 2)
        with self.assertRaisesRegex(ValueError, '"x" is not evenly spaced'):
            csrbf.segment(image)
        with self.assertRaisesRegex(ValueError, "voxel_size: follows"):
            csrbf.segment(self.image(), voxel_size=2)


if __name__ == "__main__":
    warnings.simplefilter("ignore", DeprecationWarning)
    unittest.main()
