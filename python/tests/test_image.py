"""Image, read_image and inpaint, and compare of labels."""

import os
import pickle
import struct
import tempfile
import unittest
import warnings

import numpy as np

import csrbf


def tiff(pages, description, pixels_per_unit=None):
    """A file with a page for each array of bytes, [y, x], as ImageJ and OME-TIFF describe them on the first one."""
    out, links = bytearray(b"II*\0" + bytes(4)), [4]
    for page in pages:
        data, text = page.tobytes(), description.encode() + b"\0"
        at = len(out)
        out += data + text + struct.pack("<II", *(pixels_per_unit or (1, 1)))
        height, width = page.shape
        entries = [(256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1)]
        if page is pages[0]:
            entries.append((270, 2, len(text), at + len(data)))
        entries += [(273, 4, 1, at), (277, 3, 1, 1), (278, 4, 1, height), (279, 4, 1, len(data))]
        entries += [(tag, 5, 1, at + len(data) + len(text)) for tag in (282, 283)]
        out += bytes(len(out) % 2)
        out[links[-1] : links[-1] + 4] = struct.pack("<I", len(out))
        out += struct.pack("<H", len(entries)) + b"".join(struct.pack("<HHII", *entry) for entry in entries) + bytes(4)
        links.append(len(out) - 4)
    return bytes(out)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_arrays_are_indexed_z_y_x_and_keep_their_place(self):
        values = np.arange(24, dtype=np.int16).reshape(2, 3, 4)
        turned = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        for name in ("v.nii", "v.nii.gz", "v.nrrd", "v.mha", "v.mhd"):
            with self.subTest(name):
                image = csrbf.Image(values, (0.5, 1, 2), (10, 20, 30), turned, space="LPS")
                image.save(self.path(name))
                found = csrbf.read_image(self.path(name))
                np.testing.assert_array_equal(np.asarray(found), values)
                self.assertEqual((found.dtype, found.axes), (np.int16, "zyx"))
                np.testing.assert_allclose(found.spacing, (0.5, 1, 2), rtol=1e-6)
                # The axes of space may have been named otherwise, places are the same.
                to_lps = np.diag([-1, -1, 1]) if found.space == "RAS" else np.eye(3)
                np.testing.assert_allclose(found.centers() @ to_lps, image.centers(), atol=1e-5)

    def test_numbers_keep_their_type(self):
        wide = {np.uint8, np.int16, np.uint16, np.int32, np.float32, np.float64}
        for dtype in wide:
            values = np.array([[0, 1], [2, np.finfo(dtype).eps if dtype in (np.float32, np.float64) else 3]], dtype)
            csrbf.Image(values).save(self.path("v.npy"))
            found = csrbf.read_image(self.path("v.npy"))
            self.assertEqual(found.dtype, dtype)
            np.testing.assert_array_equal(found, values)
        large = np.array([[2**31 - 2, 5]], dtype=np.int32)
        csrbf.Image(large).save(self.path("v.nrrd"))
        np.testing.assert_array_equal(csrbf.read_image(self.path("v.nrrd")), large)
        csrbf.Image(np.eye(3, dtype=bool)).save(self.path("mask.png"))
        np.testing.assert_array_equal(csrbf.read_image(self.path("mask.png")) > 0, np.eye(3) > 0)

    def test_frames_and_colours_are_axes(self):
        colours = np.arange(5 * 6 * 3, dtype=np.uint8).reshape(5, 6, 3)
        csrbf.Image(colours, axes="yxc").save(self.path("c.png"))
        found = csrbf.read_image(self.path("c.png"))
        self.assertEqual((found.axes, found.shape), ("yxc", (5, 6, 3)))
        np.testing.assert_array_equal(found, colours)
        frames = np.arange(2 * 3 * 4 * 5, dtype=np.float32).reshape(2, 3, 4, 5)
        csrbf.Image(frames, time_step=0.5).save(self.path("t.nii"))
        found = csrbf.read_image(self.path("t.nii"))
        self.assertEqual((found.axes, found.time_step), ("tzyx", 0.5))
        np.testing.assert_array_equal(found, frames)

    def test_stacks_of_microscopes_say_what_their_pages_are(self):
        values = np.arange(2 * 3 * 2 * 4 * 5, dtype=np.uint8).reshape(2, 3, 2, 4, 5)  # [t, z, c, y, x]
        pages = list(values.reshape(12, 4, 5))
        imagej = "ImageJ=1.53\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nunit=um\nspacing=2.5\n"
        ome = ('<OME><Image><Pixels DimensionOrder="XYZTC" SizeX="5" SizeY="4" SizeC="2" SizeT="2" SizeZ="3" '
               'PhysicalSizeX="0.5" PhysicalSizeY="0.25" PhysicalSizeZ="2.5"/></Image></OME>')
        by_channel = list(values.transpose(2, 0, 1, 3, 4).reshape(12, 4, 5))
        for text, planes in ((imagej, pages), (ome, by_channel)):
            with open(self.path("stack.tif"), "wb") as file:
                file.write(tiff(planes, text, (4, 2)))
            image = csrbf.read_image(self.path("stack.tif"))
            self.assertEqual(image.axes, "tzyxc")
            np.testing.assert_array_equal(image, values.transpose(0, 1, 3, 4, 2))
            np.testing.assert_allclose(image.spacing, [0.5, 0.5 if planes is pages else 0.25, 2.5])
        with open(self.path("other.tif"), "wb") as file:  # a description of another file: pages are slices
            file.write(tiff(pages[:7], imagej))
        self.assertEqual(csrbf.read_image(self.path("other.tif")).shape, (7, 4, 5))
        sequence = csrbf.Image(values[:, 0, 0], axes="tyx")
        sequence.save(self.path("frames.tif"))
        np.testing.assert_array_equal(csrbf.read_image(self.path("frames.tif")), sequence)
        self.assertEqual(csrbf.read_image(self.path("frames.tif")).axes, "tyx")

    def test_centers_are_where_segment_and_fields_take_them(self):
        y, x = np.mgrid[:40, :50]
        image = csrbf.Image(np.where((x - 25) ** 2 + (y - 20) ** 2 < 100, 9.0, 1.0), 0.5, (100, 50))
        g = csrbf.segment(image, init="sphere:112.5,60,2")
        self.assertEqual(g.labels[20, 25], 1)
        np.testing.assert_array_equal(g.field(image.centers()) > 0, g.labels == 1)
        g.save(self.path("labels.nrrd"))
        np.testing.assert_allclose(csrbf.read_image(self.path("labels.nrrd")).origin, (100, 50, 0))

    def test_images_are_arrays_to_numpy_and_are_pickled(self):
        image = csrbf.Image(np.arange(6.0).reshape(2, 3), 2.0)
        self.assertIs(np.asarray(image), image.values)
        self.assertIsNot(np.array(image), image.values)
        self.assertEqual((image > 2).sum(), 3)
        self.assertEqual(np.mean(image), 2.5)
        self.assertEqual(image[1, 2], 5)
        copy = pickle.loads(pickle.dumps(image))
        np.testing.assert_array_equal(copy, image)
        np.testing.assert_array_equal(copy.spacing, image.spacing)

    def test_wrong_arguments_are_named(self):
        for message, arguments in (
            ("axes", {"axes": "xy"}),
            ("axes", {"axes": "zyx"}),
            ("voxel_size", {"spacing": (1, 2, 3, 4)}),
            ("space", {"space": "moon"}),
        ):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                csrbf.Image(np.zeros((2, 3)), **arguments)
        with self.assertRaisesRegex(ValueError, "real"):
            csrbf.Image(np.zeros((2, 3), complex))
        with self.assertRaisesRegex(ValueError, "float16"):
            csrbf.Image(np.zeros((2, 3), np.float16)).save(self.path("v.nrrd"))
        with self.assertRaisesRegex(csrbf.IoError, "nowhere.nii"):
            csrbf.read_image(self.path("nowhere.nii"))
        with self.assertRaises(csrbf.IoError):
            csrbf.Image(np.zeros((2, 3), np.uint8)).save(self.path("v.magic"))


# A fit that takes no time to choose its kernel, for tests of everything else.
QUICK = {"method": "partition-of-unity", "kernel": "wendland-c2"}


class Inpainting(unittest.TestCase):
    @staticmethod
    def waves():
        y, x = np.mgrid[:40, :50]
        return 100 + 50 * np.sin(0.2 * x) + y, (x - 25) ** 2 + (y - 20) ** 2 < 10

    def test_holes_are_filled_and_the_rest_stays(self):
        image, hole = self.waves()
        damaged = np.where(hole, -1.0, image)
        expected = csrbf.inpaint(np.where(hole, np.nan, image), **QUICK)
        for filled in (csrbf.inpaint(damaged, hole, **QUICK), csrbf.inpaint(damaged, missing=-1, **QUICK)):
            np.testing.assert_array_equal(filled, expected)
            np.testing.assert_array_equal(filled[~hole], image[~hole])
            np.testing.assert_allclose(filled[hole], image[hole], atol=1)
            self.assertEqual(filled.report["missing"], hole.sum())
            self.assertEqual(filled.report["known"], (~hole).sum())
            self.assertIn("method", filled.report["fit"])

    def test_the_type_and_the_place_are_those_of_the_image(self):
        image, hole = self.waves()
        whole = csrbf.Image(image.astype(np.uint8), (1, 2), (5, 6))
        filled = csrbf.inpaint(whole, hole, **QUICK)
        self.assertEqual(filled.dtype, np.uint8)
        np.testing.assert_array_equal(filled.spacing, whole.spacing)
        np.testing.assert_array_equal(filled.origin, whole.origin)
        error = filled[hole].astype(float) - whole[hole]
        self.assertLess(np.abs(error).max(), 10)  # of 130; rounding is noise
        for dtype in (np.float32, np.float16, np.int64):
            self.assertEqual(csrbf.inpaint(image.astype(dtype), hole, **QUICK).dtype, dtype)

    def test_colours_and_frames_are_filled_one_by_one(self):
        image, hole = self.waves()
        colours = csrbf.Image(np.stack([image, 2 * image, -image], axis=-1), axes="yxc")
        filled = csrbf.inpaint(colours, hole, **QUICK)
        np.testing.assert_allclose(filled[..., 1], 2 * filled[..., 0], rtol=1e-6)
        frames = csrbf.Image(np.stack([image, image + 7]), axes="tyx")
        masks = np.stack([hole, hole[::-1]])
        np.testing.assert_allclose(csrbf.inpaint(frames, masks, **QUICK)[masks], frames[masks], atol=1)

    def test_files_are_images_and_masks(self):
        image, hole = self.waves()
        with tempfile.TemporaryDirectory() as folder:
            path, mask = os.path.join(folder, "image.png"), os.path.join(folder, "mask.png")
            csrbf.Image(np.where(hole, 0, image).astype(np.uint8)).save(path)
            csrbf.Image(hole.astype(np.uint8)).save(mask)
            filled = csrbf.inpaint(path, mask, **QUICK)
            damaged = np.where(hole, 0, image).astype(np.uint8)
            np.testing.assert_array_equal(filled, csrbf.inpaint(damaged, hole, **QUICK))

    def test_nothing_missing_is_a_warning_and_wrong_arguments_are_errors(self):
        image, hole = self.waves()
        with self.assertWarnsRegex(UserWarning, "nothing is missing"):
            np.testing.assert_array_equal(csrbf.inpaint(image), image)
        with self.assertRaisesRegex(ValueError, "shape"):
            csrbf.inpaint(image, hole[1:])
        with self.assertRaisesRegex(ValueError, "whole numbers"):
            csrbf.inpaint(image.astype(np.uint8), hole, extrapolation="nan")
        with warnings.catch_warnings(), self.assertRaises(ValueError):
            csrbf.inpaint(image, np.ones_like(hole))


class Labels(unittest.TestCase):
    def test_overlaps_are_those_of_the_sets(self):
        a, b = np.zeros((20, 20), int), np.zeros((20, 20), int)
        a[5:15, 5:15] = 1
        b[5:15, 7:17] = 1
        found = csrbf.compare(a, b, voxel_size=0.5)
        self.assertAlmostEqual(found["dice"], 0.8)
        self.assertAlmostEqual(found["jaccard"], 80 / 120)
        self.assertAlmostEqual(found["hausdorff95"], 1.0)
        self.assertEqual(found["labels"][0]["voxels"], 100)
        self.assertEqual(csrbf.compare(a, 5 * b)["dice"], found["dice"])
        self.assertEqual([l["label"] for l in csrbf.compare(a + 2 * (b > a), 2 * b)["labels"]], [1, 2])

    def test_segmentations_images_and_files_compare(self):
        y, x = np.mgrid[:48, :64]
        truth = (x - 30) ** 2 + (y - 20) ** 2 < 144
        g = csrbf.segment(csrbf.Image(np.where(truth, 10.0, 1.0), 2.0, (3, 4)))
        self.assertGreater(csrbf.compare(g, truth)["dice"], 0.99)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "truth.png")
            csrbf.Image(truth.astype(np.uint8)).save(path)
            self.assertEqual(csrbf.compare(g, path), csrbf.compare(g, truth))
        moved = csrbf.Image(truth.astype(np.uint8), 2.0, (30, 4))
        with self.assertRaisesRegex(ValueError, "origin"):
            csrbf.compare(g, moved)
        with self.assertRaisesRegex(ValueError, "whole numbers"):
            csrbf.compare(truth * 0.5, truth)


if __name__ == "__main__":
    unittest.main()
