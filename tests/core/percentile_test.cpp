#include "csrbf/core/percentile.hpp"

#include "csrbf/core/types.hpp"

#include <gtest/gtest.h>

#include <span>
#include <vector>

namespace csrbf::percentile_test {
namespace {

TEST(OrderStatistic, IsTheValueOfThatRank) {
  const std::vector<int> sorted{1, 2, 2, 3, 5, 8};
  for (std::size_t rank = 0; rank < sorted.size(); ++rank) {
    std::vector<int> values{5, 2, 8, 1, 3, 2};
    EXPECT_EQ(order_statistic(values, static_cast<std::ptrdiff_t>(rank)), sorted[rank]);
  }
}

TEST(Median, IsTheMiddleOneOrTheLargerOfTwo) {
  EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median(std::vector<double>{4, 1, 3, 2}), 3);
  EXPECT_EQ(median(std::vector<float>{7}), 7);
  Eigen::VectorXd vector = Eigen::Vector3d(30, 10, 20);
  EXPECT_EQ(median(vector), 20);
  std::vector<double> more{1, 5, 9, 9, 9};
  EXPECT_EQ(median(std::span(more.data(), 2)), 5);
}

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
}  // namespace csrbf::percentile_test
