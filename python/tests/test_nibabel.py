"""Images of nibabel as arguments: the same as the files that it writes."""

import os
import sys
import tempfile
import unittest

import numpy as np

import csrbf
from csrbf._image import as_image

try:
    import nibabel
except ImportError:
    print("skipped: needs nibabel (Debian: python3-nibabel)")
    sys.exit(77)

OBLIQUE = np.array([[-1.9, 0.3, 0.1, 40], [0.3, 1.9, -0.2, -7], [-0.05, 0.1, 3, 12], [0, 0, 0, 1]])


def affine(flip=(1, 1, 1)):
    """Turned, flipped, with voxels of 2 x 1.5 x 3."""
    q, _ = np.linalg.qr(OBLIQUE[:3, :3])
    q *= np.sign(np.diag(q))
    return np.block([[q * flip * [2, 1.5, 3], np.array([[40.0], [-7], [12]])], [np.zeros((1, 3)), np.ones((1, 1))]])


class Images(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "image.nii.gz")

    def assert_as_its_file(self, image):
        nibabel.save(image, self.path)
        expected, loaded = csrbf.read_image(self.path), nibabel.load(self.path)
        for given in (loaded, image):
            found = as_image(given)
            np.testing.assert_allclose(np.asarray(found), np.asarray(expected), atol=1e-5)
            self.assertEqual((found.axes, found.space), (expected.axes, expected.space))
            for name in ("spacing", "origin", "direction", "time_step"):
                np.testing.assert_allclose(getattr(found, name), getattr(expected, name), atol=1e-5, err_msg=name)

    def test_have_values_and_place_of_their_file(self):
        values = np.random.default_rng(0).integers(0, 900, (5, 6, 4)).astype(np.int16)
        for flip in ((1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, 1, -1)):
            self.assert_as_its_file(nibabel.Nifti1Image(values, affine(flip)))
        self.assert_as_its_file(nibabel.Nifti1Image(values.astype(float), affine()))

    def test_have_frames_and_their_time(self):
        image = nibabel.Nifti1Image(np.random.default_rng(0).random((5, 6, 4, 3)).astype(np.float32), affine())
        image.header.set_zooms((2, 1.5, 3, 40))
        for unit in ("msec", "sec"):
            image.header.set_xyzt_units("mm", unit)
            self.assert_as_its_file(image)

    def test_have_components(self):
        values = np.random.default_rng(0).random((5, 6, 4, 1, 3)).astype(np.float32)
        self.assert_as_its_file(nibabel.Nifti1Image(values, affine()))

    def test_are_segmented_where_they_lie(self):
        x, y, z = np.mgrid[:20, :18, :16]
        values = ((x - 9) ** 2 + (y - 8) ** 2 + (z - 8) ** 2 < 30) + 0.2 * np.random.default_rng(1).normal(size=x.shape)
        image = nibabel.Nifti1Image(values, affine((-1, 1, 1)))
        found = csrbf.segment(image)
        self.assertGreater(np.corrcoef(np.asarray(found.labels).T.ravel(), values.ravel())[0, 1], 0.8)
        found.save(self.path)
        np.testing.assert_allclose(nibabel.load(self.path).affine, image.affine, atol=1e-5)

    def test_are_masks_starts_and_sequences(self):
        x, y, z = np.mgrid[:20, :18, :8]
        inside = (x - 9) ** 2 + (y - 8) ** 2 + (z - 4) ** 2 < 16
        values = inside + 0.2 * np.random.default_rng(1).normal(size=x.shape)
        image = nibabel.Nifti1Image(values, affine())
        marks = nibabel.Nifti1Image(np.where(inside, 1, 0).astype(np.uint8), affine())
        left = nibabel.Nifti1Image((x < 10).astype(np.uint8), affine())
        expected = csrbf.segment(as_image(image), init=inside.T, mask=(x < 10).T)
        found = csrbf.segment(image, init=marks, mask=left)
        np.testing.assert_array_equal(found.labels, expected.labels)
        elsewhere = nibabel.Nifti1Image(np.asarray(left.dataobj), affine((-1, 1, 1)))
        with self.assertRaisesRegex(ValueError, "mask: its voxels are not where"):
            csrbf.segment(image, mask=elsewhere)
        np.testing.assert_array_equal(csrbf.inpaint(image, mask=left), csrbf.inpaint(as_image(image), (x < 10).T))
        cine = nibabel.Nifti1Image(np.stack([values, values], axis=3), affine())
        self.assertEqual(len(csrbf.track(cine, init=marks)), 2)

    def test_bring_their_voxel_size(self):
        image = nibabel.Nifti1Image(np.zeros((4, 4, 4)), affine())
        with self.assertRaisesRegex(ValueError, "voxel_size: the image has one"):
            csrbf.segment(image, voxel_size=2)


if __name__ == "__main__":
    unittest.main()
