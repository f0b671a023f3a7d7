"""segment and Segmentation on a disc and a ball."""

import os
import tempfile
import unittest
import warnings

import numpy as np

import csrbf


def disc():
    """A bright disc of radius 12 about x = 30, y = 20 on a dark ground, [y, x]."""
    y, x = np.mgrid[:48, :64]
    return np.where((x - 30) ** 2 + (y - 20) ** 2 < 144, 10.0, 1.0)


def ball():
    """A bright ball of radius 12 about (15, 16.5, 18), voxels of 1.5 x 1.5 x 2, [z, y, x]."""
    z, y, x = np.mgrid[:18, :22, :20]
    return np.where((1.5 * x - 15) ** 2 + (1.5 * y - 16.5) ** 2 + (2 * z - 18) ** 2 < 144, 100, 20)


class Plane(unittest.TestCase):
    def test_labels_field_contour_and_report(self):
        image = disc()
        g = csrbf.segment(image)
        self.assertEqual((g.labels.shape, g.labels.dtype), ((48, 64), np.uint8))
        self.assertLess((g.labels != (image > 5)).sum(), 8)
        y, x = np.mgrid[:48, :64]
        np.testing.assert_array_equal(g.field(np.stack([x, y], axis=-1)) > 0, g.labels == 1)
        self.assertTrue(g.report["converged"])
        self.assertEqual(g.report["regions"][1]["voxels"], g.labels.sum())
        self.assertEqual(g.energy, sorted(g.energy, reverse=True))
        (line,) = g.contour()
        radii = np.linalg.norm(line - (30, 20), axis=1)
        self.assertLess(np.abs(radii - 12).max(), 1)
        measures = g.measure()
        self.assertLess(abs(measures["area"] - g.labels.sum()), 0.01 * g.labels.sum())
        self.assertLess(measures["area_error"], 0.01 * measures["area"])

    def test_what_the_start_covers_is_inside(self):
        image = disc()
        inside = csrbf.segment(image, init="sphere:30,20,5")
        outside = csrbf.segment(image, init="box:55,40,62,46")
        np.testing.assert_array_equal(inside.labels, 1 - outside.labels)
        seed = np.zeros(image.shape, bool)
        seed[18:22, 28:33] = True
        np.testing.assert_array_equal(csrbf.segment(image, init=seed).labels, inside.labels)
        np.testing.assert_array_equal(csrbf.segment(image, init=inside.field).labels, inside.labels)

    def test_volumes_of_one_slice_are_images_in_the_plane(self):
        image = disc()
        g = csrbf.segment(image)
        slice_of_it = csrbf.segment(image[np.newaxis], init=g.field)
        np.testing.assert_array_equal(slice_of_it.labels, g.labels[np.newaxis])
        labels = csrbf.evaluate(g.field, like=image[np.newaxis], labels=True)
        np.testing.assert_array_equal(labels, g.labels[np.newaxis])

    def test_points_on_the_boundary_are_a_start(self):
        angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "points.csv")
            np.savetxt(path, np.column_stack([30 + 6 * np.cos(angle), 20 + 6 * np.sin(angle)]), delimiter=",")
            g = csrbf.segment(disc(), init=f"points:{path}", mode="local")
        np.testing.assert_array_equal(g.labels, csrbf.segment(disc(), init="sphere:30,20,6", mode="local").labels)

    def test_models_and_labels_are_saved(self):
        g = csrbf.segment(disc())
        with tempfile.TemporaryDirectory() as folder:
            model, labels = os.path.join(folder, "disc.csrbf"), os.path.join(folder, "labels.npy")
            g.save(model)
            g.save(labels)
            np.testing.assert_array_equal(np.load(labels), g.labels)
            x = np.random.default_rng(1).uniform(0, 60, (50, 2))
            np.testing.assert_array_equal(csrbf.load(model)(x), g.field(x))
            np.testing.assert_array_equal(csrbf.segment(labels, init=model).labels, g.labels)

    def test_a_function_may_say_what_voxels_cost(self):
        image = disc()
        calls = []

        def force(labels):
            calls.append((labels.shape, labels.dtype))
            return 5 - image

        g = csrbf.segment(image, force=force, init="sphere:30,20,5")
        self.assertEqual(set(calls), {((48, 64), np.dtype(np.uint8))})
        self.assertLess((g.labels != (image > 5)).sum(), 8)

        def broken(labels):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            csrbf.segment(image, force=broken, init="sphere:30,20,5")
        with self.assertRaisesRegex(ValueError, "size of the result of force"):
            csrbf.segment(image, force=lambda labels: np.zeros(3), init="sphere:30,20,5")

    def test_objects_and_their_table(self):
        y, x = np.mgrid[:48, :64]
        two = np.minimum(np.hypot(x - 20, y - 24), np.hypot(x - 40, y - 24)) < 11
        g = csrbf.segment(10.0 * two + 1, objects=True, min_size=20)
        self.assertEqual((g.objects[24, 20], g.objects[24, 40], g.objects[0, 0]), (1, 2, 0))
        self.assertEqual([row["label"] for row in g.table], [1, 2])
        two[5:7, 5:7] = True
        g = csrbf.segment(10.0 * two + 1, objects=True)
        self.assertEqual((len(g.table), g.report["objects_left_out"]), (2, 1))
        np.testing.assert_allclose(g.table[1]["centroid"], (40, 24), atol=0.6)
        self.assertIsNone(csrbf.segment(disc()).objects)
        for arguments in ({"min_size": 3}, {"objects": True, "regions": 3}):
            with self.assertRaises(ValueError):
                csrbf.segment(disc(), **arguments)

    def test_channels_of_a_colour_image(self):
        inside = disc() > 5
        colours = np.stack([np.where(inside, 200, 60), np.where(inside, 60, 200), 7 * np.arange(48 * 64).reshape(48, 64) % 40],
                           axis=-1).astype(np.uint8)
        image = csrbf.Image(colours, axes="yxc")
        g = csrbf.segment(image)
        self.assertTrue((g.labels == inside).all())
        np.testing.assert_allclose(np.abs(g.report["channels"]), [0.707, 0.707, 0], atol=0.02)
        self.assertTrue((csrbf.segment(image, channels=[1]).labels == inside).all())
        with self.assertRaisesRegex(ValueError, "channels"):
            csrbf.segment(image, channels=[4])

    def test_seeds_keep_their_labels(self):
        seeds = np.zeros((48, 64), int)
        seeds[20, 30], seeds[5, 5], seeds[45, 60] = 1, 2, 1
        labels = csrbf.segment(disc(), seeds=seeds).labels
        self.assertEqual((labels[20, 30], labels[5, 5], labels[45, 60], labels[20, 35]), (0, 1, 0, 0))
        with self.assertRaisesRegex(ValueError, "seeds"):
            csrbf.segment(disc(), seeds=-seeds)

    def test_what_is_like_the_image_has_its_shape_and_place(self):
        marks = np.zeros((48, 64), int)
        marks[20, 30], marks[5, 5] = 2, 1
        for name in ("seeds", "mask", "init"):
            with self.assertRaisesRegex(ValueError, rf"{name}: has shape \(64, 48\); the image has \(48, 64\)"):
                csrbf.segment(disc(), **{name: marks.T})
        with self.assertRaisesRegex(ValueError, "seed_confidence: has shape"):
            csrbf.segment(disc(), seeds=marks, seed_confidence=np.ones((64, 48)))
        body, marks = ball(), np.zeros((18, 22, 20), int)
        marks[9, 11, 10], marks[0, 0, 0] = 2, 1
        image = csrbf.Image(body, (1.5, 1.5, 2), space="RAS")
        self.assertEqual(csrbf.segment(image, seeds=csrbf.Image(marks, (1.5, 1.5, 2), space="RAS")).labels[9, 11, 10], 1)
        for name in ("seeds", "mask", "init"):
            with self.assertRaisesRegex(ValueError, f"{name}: its voxels are not where those of the image are: spacing"):
                csrbf.segment(image, **{name: csrbf.Image(marks, (1.5, 1.5, 1), space="RAS")})

    def test_what_is_left_out_as_transparency_is_told(self):
        image = csrbf.Image(np.stack([disc(), 20 - disc()], axis=-1).astype(np.uint8), axes="yxc")
        with self.assertWarnsRegex(UserWarning, "the last of 2 components is taken for transparency"):
            csrbf.segment(image)
        four = csrbf.Image(np.concatenate([image.values] * 2, axis=-1), axes="yxc")
        with self.assertWarnsRegex(UserWarning, r"the last of 4 components.*channels=\[1, 2, 3, 4\]"):
            csrbf.segment(four)
        four.values[..., 3] = 255
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            csrbf.segment(image, channels=[1, 2])
            csrbf.segment(four)  # opaque

    def test_volumes_have_no_transparency(self):
        second = np.stack([0 * disc(), disc()], axis=-1)[np.newaxis].repeat(6, axis=0)
        with self.assertWarnsRegex(UserWarning, "the last of 2 components is used like the others"):
            g = csrbf.segment(csrbf.Image(second.astype(np.uint8), axes="zyxc"))
        np.testing.assert_array_equal(g.labels[3] > 0, disc() > 5)

    def test_uncertain_seeds_yield_to_clear_intensities(self):
        seeds = np.zeros((48, 64), int)
        seeds[20, 30], seeds[5, 5], seeds[45, 60] = 2, 1, 2
        self.assertEqual(csrbf.segment(disc(), seeds=seeds).labels[45, 60], 1)
        self.assertEqual(csrbf.segment(disc(), seeds=seeds, seed_confidence=0.7).labels[45, 60], 0)
        self.assertEqual(csrbf.segment(disc(), seeds=seeds, seed_confidence=np.float32(0.7)).labels[45, 60], 0)
        confidence = np.full(seeds.shape, 0.7)
        confidence[45, 60] = 1
        self.assertEqual(csrbf.segment(disc(), seeds=seeds, seed_confidence=confidence).labels[45, 60], 1)
        for wrong in (0, 2, confidence[:9]):
            with self.assertRaisesRegex(ValueError, "seed_confidence"):
                csrbf.segment(disc(), seeds=seeds, seed_confidence=wrong)

    def test_missing_voxels_are_ignored(self):
        noisy = disc() + 0.01 * (np.arange(64) * np.arange(48)[:, None] % 29)
        want = csrbf.segment(noisy).labels
        for value, missing in ((np.nan, "auto"), (-9999, "auto"), (-9999, -9999), (4, 4)):
            image = noisy.copy()
            image[:, 50:] = value
            g = csrbf.segment(image, missing=missing)
            np.testing.assert_array_equal(g.labels, want)
            self.assertAlmostEqual(g.report["missing"], 14 / 64)
        self.assertIsNone(csrbf.segment(disc()).report["missing"])

    def test_a_contour_starts_at_seeds(self):
        seeds = np.zeros((48, 64), int)
        seeds[18:23, 28:33] = 2
        labels = csrbf.segment(disc(), seeds=seeds, mode="local").labels
        self.assertEqual((labels[20, 38], labels[5, 5]), (1, 0))

    def test_wrong_arguments_are_value_errors(self):
        image = disc()
        for message, arguments in (
            ("constant", {"image": np.ones((9, 9))}),
            ("not a number", {"image": np.where(image > 5, np.inf, image)}),
            ("covers no voxel", {"init": "sphere:900,20,5"}),
            ("expected", {"init": "disc:1,2"}),
            ("shape", {"init": np.zeros((3, 3))}),
            ("shape", {"mask": np.zeros((3, 3))}),
            ("must be one of", {"energy": "none"}),
            ("image: its axes are \\[x\\]; they must be", {"image": np.ones(9)}),
            ("voxel_size", {"voxel_size": (1, 2, 3)}),
            ("voxel_size: .* must be positive", {"voxel_size": (1, 0)}),
            ("regions = 2.5: must be a whole number", {"regions": 2.5}),
            ("iterations = '9': must be a whole number", {"iterations": "9"}),
            ("mode = 5: is of the wrong type", {"mode": 5}),
            ("force", {"force": 3}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                csrbf.segment(**{"image": image, **arguments})
        np.testing.assert_array_equal(csrbf.segment(image, energy=None).labels, csrbf.segment(image).labels)


class Space(unittest.TestCase):
    def test_voxel_sizes_are_those_of_x_y_and_z(self):
        image = ball()
        g = csrbf.segment(image, voxel_size=(1.5, 1.5, 2.0), init="sphere:15,16.5,18,5")
        self.assertLess((g.labels != (image > 50)).sum(), 0.05 * g.labels.sum())
        mesh = g.contour()
        radii = np.linalg.norm(mesh.vertices - (15, 16.5, 18), axis=1)
        self.assertLess(np.abs(radii - 12).max(), 1.5)
        self.assertAlmostEqual(g.measure()["volume"], 4 / 3 * np.pi * 12**3, delta=0.03 * 7238)
        self.assertGreater(g.field([15, 16.5, 18]), 0)
        with tempfile.TemporaryDirectory() as folder:
            g.field.save(os.path.join(folder, "ball.csrbf"))
            loaded = csrbf.load(os.path.join(folder, "ball.csrbf"))
        self.assertAlmostEqual(loaded.to_surface().polygonize(30).volume, mesh.volume, delta=0.01 * mesh.volume)
        with self.assertRaisesRegex(ValueError, "three variables with one value"):
            csrbf.segment(disc()).field.to_surface()


class Sequence(unittest.TestCase):
    @staticmethod
    def frames(noise=0.5):
        """Discs of radius 10 to 14 on a dark ground, [t, y, x], and their areas."""
        rng = np.random.default_rng(7)
        y, x = np.mgrid[:48, :64]
        radii = 12 + 2 * np.sin(np.arange(6))
        edges = [1 / (1 + np.exp(2 * (np.hypot(x - 30, y - 20) - r))) for r in radii]
        return np.array([1 + 9 * e + noise * rng.normal(size=e.shape) for e in edges]), np.pi * radii**2

    def test_volumes_follow_a_beating_disc(self):
        frames, areas = self.frames()
        t = csrbf.track(frames, init="sphere:30,20,5")
        self.assertEqual(len(t), 6)
        self.assertLess(np.abs(t.volumes() / areas - 1).max(), 0.06)  # a third of a voxel at the border
        self.assertEqual(t[2].labels.shape, (48, 64))
        self.assertGreater(t[5].field([30, 20]), 0)
        self.assertEqual(t.warnings, [])

    def test_lists_and_files_are_sequences_too(self):
        frames, _ = self.frames()
        t = csrbf.track(list(frames), persistence=0)
        self.assertTrue((t[0].labels == csrbf.segment(frames[0]).labels).all())
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "frames.npy")
            np.save(path, frames[:, np.newaxis].astype(np.float32))
            self.assertEqual(len(csrbf.track(path)), 6)

    def test_wrong_arguments_are_named(self):
        frames, _ = self.frames()
        for error, message, arguments in (
            (ValueError, "there are none", {"frames": []}),
            (ValueError, "persistence", {"persistence": -1}),
            (ValueError, "frame 1", {"frames": [frames[0], frames[1][:20]]}),
            (TypeError, "colour", {"colour": 3}),
        ):
            with self.subTest(message), self.assertRaisesRegex(error, message):
                csrbf.track(**{"frames": frames, **arguments})


if __name__ == "__main__":
    unittest.main()
