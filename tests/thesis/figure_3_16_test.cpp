#include "thesis/figure_3_16.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_3_16_test {
namespace {

constexpr double rounding = 1 + 1e-9;

TEST(Figure_3_16, TheBoundHoldsAtEverySampleOfADrawing) {
  const SampledSlice sampled = sample_slice(drawn_slice(109, 90), 0.3, 1);
  for (const double tolerance : {0.1, 0.02, 0.001}) {
    const BoundedLevels b = bounded_levels(sampled, tolerance, 300);
    EXPECT_LE(b.largest_error, tolerance * sampled.range() * rounding);
  }
}

TEST(Figure_3_16, TheBoundOfTwoPercentHoldsAtEverySampleOfTheBrain) {
  const auto slice = brain_slice();
  if (!slice) GTEST_SKIP() << brain_file << " is not there: apt-get install mricron-data";
  const SampledSlice sampled = sample_slice(*slice, 0.3, 1);
  const BoundedLevels b = bounded_levels(sampled, 0.02, 1172);
  EXPECT_LE(b.largest_error, b.tolerance * rounding);
  EXPECT_EQ(b.above[b.above.size() - 1], 0);
  EXPECT_LE(b.levels.cols(), 7);  // published: reached at level 6, counted from 0
}

TEST(Figure_3_16, LevelsLeaveFewerAndFewerSamplesAboveTheBound) {
  const BoundedLevels b = bounded_levels(sample_slice(drawn_slice(109, 90), 0.3, 1), 0.02, 300);
  for (Index level = 1; level < b.above.size(); ++level) EXPECT_LE(b.above[level], b.above[level - 1]);
}

}  // namespace
}  // namespace csrbf::thesis::figure_3_16_test
