"""Random images: segment without options is ahead of Otsu's threshold, and never fails.

usage: random_images_test.py PROGRAM [unittest options]
"""

import os
import sys
import unittest
from pathlib import Path
from tempfile import TemporaryDirectory

sys.dont_write_bytecode = True  # leave no files in the folder of the sources
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
try:
    import random_images
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


class RandomImages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        wanted = {"contrast": {"means", "deviations"}, "size": {"small", "medium"}}
        cls.cases = random_images.run_all(500, 60, PROGRAM, wanted)

    def test_all_are_segmented(self):
        for case in self.cases:
            self.assertGreater(case["dice"], 0, random_images.describe(case))
            self.assertIn("chosen", case)

    def test_regions_are_nearer_to_the_truth_than_those_of_a_threshold(self):
        leads = [case["dice"] - case["otsu"] for case in self.cases]
        self.assertGreater(sum(leads) / len(leads), LEAD)
        self.assertLess(sum(lead < -random_images.WRONG for lead in leads) / len(leads), LOST)

    def test_counts_of_few_photons_and_much_noise_do_not_end_in_specks(self):
        hard = random_images.run_all(600, 900, PROGRAM, {"noise": {"photons", "gauss"}, "level": {"1.0"}, "light": {"even"},
                                                         "shape": {"bars", "half", "flower"}, "size": {"medium"}})
        self.assertGreaterEqual(len(hard), 5)
        for case in hard:
            self.assertGreater(case["dice"], 0.8, random_images.describe(case))

    def test_a_disc_is_found_in_few_photons_and_a_slope_of_light(self):
        with TemporaryDirectory() as work:
            case = random_images.run(random_images.draw(20136), PROGRAM, Path(work))
        self.assertGreater(case["dice"], 0.95, random_images.describe(case))

    def test_dead_and_hot_voxels_are_left_out(self):
        with TemporaryDirectory() as work:
            case = random_images.run(random_images.draw(20218), PROGRAM, Path(work))
        self.assertGreater(case["dice"], 0.95, random_images.describe(case))

    def test_light_without_noise_is_followed_exactly(self):
        with TemporaryDirectory() as work:
            case = random_images.run(random_images.draw(40003), PROGRAM, Path(work))
        self.assertGreater(case["dice"], 0.99, random_images.describe(case))


LEAD, LOST = 0.075, 0.08

if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
