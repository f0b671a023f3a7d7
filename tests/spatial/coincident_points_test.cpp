#include "csrbf/spatial/coincident_points.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace csrbf {
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
    EXPECT_EQ(first[static_cast<std::size_t>(i)], expected);
  }
}

}  // namespace
}  // namespace csrbf
