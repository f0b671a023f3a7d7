#include "csrbf/spatial/coincident_points.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace csrbf::coincident_points_test {
namespace {

TEST(CoincidentPoints, NameTheFirstPointAtTheSamePlace) {
  Points<2> points(2, 6);
  points << 0, 1, 0, 1, -0.0, 2,  //
      0, 1, 0, 2, 0.0, 2;
  EXPECT_EQ(first_coincident<2>(points), (std::vector<Index>{0, 1, 0, 3, 0, 5}));
  EXPECT_TRUE(first_coincident<2>(points.leftCols(0)).empty());
}

TEST(CoincidentPoints, LeavesNanForItself) {
  Points<1> points(1, 4);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  points << nan, nan, infinity, infinity;
  EXPECT_EQ(first_coincident<1>(points), (std::vector<Index>{0, 1, 2, 2}));
}

TEST(CoincidentPoints, AgreesWithComparingAllPairs) {
  std::mt19937_64 random(1);
  Points<3> points(3, 500);
  for (Index i = 0; i < points.size(); ++i) points(i) = static_cast<double>(random() % 6) * 0.1;  // 216 places
  const std::vector<Index> first = first_coincident<3>(points);
  for (Index i = 0; i < points.cols(); ++i) {
    Index expected = 0;
    while (points.col(expected) != points.col(i)) ++expected;
    EXPECT_EQ(first[i], expected);
  }
}

// Runs of equal points end before, at and after the ranges that threads take.
TEST(CoincidentPoints, AgreesWithATableForManyPoints) {
  for (const Index n : {16383, 16384, 16385, 50000})
    for (const unsigned places : {1U, 2U, 50U, 1000U}) {
      std::mt19937_64 random(places);
      Points<2> points(2, n);
      for (Index i = 0; i < points.size(); ++i) points(i) = static_cast<double>(random() % places) * 0.25;
      points.col(n / 3).setConstant(std::numeric_limits<double>::quiet_NaN());
      std::map<std::pair<double, double>, Index> table;
      std::vector<Index> expected;
      for (Index i = 0; i < n; ++i)
        expected.push_back(i == n / 3 ? i : table.try_emplace({points(0, i), points(1, i)}, i).first->second);
      EXPECT_EQ(first_coincident<2>(points), expected) << n << " " << places;
    }
}

}  // namespace
}  // namespace csrbf::coincident_points_test
