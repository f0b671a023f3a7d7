#include "csrbf/approx/samples/deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace csrbf::deviation_test {
namespace {

TEST(WeightedRms, CountsEachRowByItsWeight) {
  Eigen::MatrixXd errors(3, 2);
  errors << 1, -1, 2, 2, 100, 100;
  EXPECT_DOUBLE_EQ(weighted_rms(errors, Eigen::Vector3d(3, 1, 0)), std::sqrt(14. / 8));
}

TEST(WeightedDeviation, IsThatFromTheWeightedMeanOfEachColumn) {
  Eigen::MatrixXd values(3, 2);
  values << 1, -5, 5, -1, 1000, 1000;
  EXPECT_DOUBLE_EQ(weighted_deviation(values, Eigen::Vector3d(1, 1, 0)), 2);
  EXPECT_DOUBLE_EQ(weighted_deviation(values, Eigen::Vector3d(3, 1, 0)), std::sqrt(3.));
}

}  // namespace
}  // namespace csrbf::deviation_test
