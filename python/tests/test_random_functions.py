"""Random functions from random samples: fits are about as good as the best of simple ones, and know how wrong they are."""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
try:
    import random_functions
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


class RandomFunctions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cases = random_functions.run_all(900, 60, [12, 30, 80], random_functions.DESIGNS, random_functions.NOISES)

    def test_errors_are_below_those_of_the_best_of_simple_fits(self):
        ratios = [case["ratio"] for case in self.cases]
        self.assertLess(random_functions.geometric_mean(ratios), 0.4)
        self.assertLess(random_functions.geometric_mean([max(1, ratio) for ratio in ratios]), 1.12)

    def test_intervals_hold_what_they_say(self):
        within = [case["within"] for case in self.cases]
        self.assertGreater(sum(within) / len(within), 0.83)


if __name__ == "__main__":
    unittest.main()
