#include "thesis/figure_3_9.hpp"

#include "thesis/signals.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_3_9_test {
namespace {

TEST(Figure_3_9, PeaksHasItsKnownExtremes) {
  EXPECT_NEAR(peaks({-0.0093, 1.5814}), 8.1062, 1e-3);
  EXPECT_NEAR(peaks({0.2283, -1.6255}), -6.5511, 1e-3);
}

TEST(Figure_3_9, TheErrorFallsAndTheBoundHolds) {
  const PeaksLevels p = peaks_levels(0.1);
  ASSERT_GE(p.rmse.size(), 3);
  EXPECT_LT(p.rmse.back(), p.rmse.front() / 10);
  for (std::size_t i = 1; i < p.rmse.size(); ++i) EXPECT_LT(p.rmse[i], 1.05 * p.rmse[i - 1]);
  EXPECT_LE(p.max_errors.back(), 0.1 * (1 + 1e-9));
}

// "Almost null": 1 % of the range of 14.6.
TEST(Figure_3_9, TheLastLevelIsAlmostRight) {
  EXPECT_LT(peaks_levels(0.1).rmse.back(), 0.146);
}

TEST(Figure_3_9, TheDefaultFitIsBetterThanTheMultiresolution) {
  EXPECT_LT(peaks_default_fit(), peaks_levels(0.1).rmse.back() / 10);
}

}  // namespace
}  // namespace csrbf::thesis::figure_3_9_test
