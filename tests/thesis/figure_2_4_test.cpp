#include "thesis/figure_2_4.hpp"

#include <gtest/gtest.h>

namespace csrbf::thesis::figure_2_4_test {
namespace {

TEST(Figure_2_4, BelowHalfASampleDistanceNothingIsLeftBetweenTheSamples) {
  const SupportSize size = support_sizes({0.4})[0];
  EXPECT_NEAR(size.midpoint, 0, 1e-12);
  EXPECT_NEAR(size.condition, 1, 1e-12);  // the identity
  EXPECT_NEAR(size.density, 1.0 / 41, 1e-12);
}

// Here 3 sample distances are best; wider supports change the error little and the costs much.
TEST(Figure_2_4, WiderSupportsFillTheGapsAndMakeTheMatrixDense) {
  const auto sizes = support_sizes({0.5, 0.8, 1, 2, 40});
  for (std::size_t i = 1; i < 4; ++i) EXPECT_LT(sizes[i].rmse, sizes[i - 1].rmse);
  EXPECT_LT(sizes.back().rmse, sizes.front().rmse / 10);
  EXPECT_GT(sizes.back().density, 0.99);
  EXPECT_GT(sizes.back().condition, 1e4 * sizes.front().condition);
}

// Within 3.5 sample distances there are 7 samples, less near the ends.
TEST(Figure_2_4, TheShareOfNonzerosIsThatOfTheSupport) {
  constexpr double n = 41;
  EXPECT_NEAR(support_sizes({3.5})[0].density, (7 * n - 2 * (1 + 2 + 3)) / (n * n), 1e-12);
}

}  // namespace
}  // namespace csrbf::thesis::figure_2_4_test
