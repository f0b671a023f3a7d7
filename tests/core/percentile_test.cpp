#include "csrbf/core/percentile.hpp"

#include <gtest/gtest.h>

namespace csrbf {
namespace {

TEST(Percentile, IsLinearBetweenTheOrderStatistics) {
  std::vector<double> values{30, 10, 40, 20};
  EXPECT_EQ(percentile(values, 0), 10);
  EXPECT_EQ(percentile(values, 1), 40);
  EXPECT_EQ(percentile(values, 0.5), 25);
  EXPECT_NEAR(percentile(values, 0.9), 37, 1e-12);
  std::vector<float> one{7};
  EXPECT_EQ(percentile(one, 0.3), 7);
}

}  // namespace
}  // namespace csrbf
