#include "csrbf/core/types.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace csrbf::types_test {
namespace {

TEST(BoundingBox, HoldsAllPoints) {
  EXPECT_TRUE(bounding_box<3>(Points<3>(3, 0)).empty());
  for (const Index n : {1, 10, 16384, 16385, 50000}) {
    Points<3> points(3, n);
    for (Index i = 0; i < n; ++i) points.col(i) = Point<3>::Constant(static_cast<double>(i)) + Point<3>(0, 1, -2);
    const Box<3> box = bounding_box<3>(points);
    EXPECT_EQ(box.lo, Point<3>(0, 1, -2)) << n;
    EXPECT_EQ(box.hi, Point<3>::Constant(static_cast<double>(n - 1)) + Point<3>(0, 1, -2)) << n;
  }
}

// Wherever it is among the points that one thread takes.
TEST(BoundingBox, IgnoresNan) {
  constexpr Index n = 40000;
  for (const Index at : {0, 5, 16384, 32768}) {
    Points<2> points(2, n);
    for (Index i = 0; i < n; ++i) points.col(i).setConstant(static_cast<double>(i));
    points.col(at).setConstant(std::numeric_limits<double>::quiet_NaN());
    const Box<2> box = bounding_box<2>(points);
    EXPECT_EQ(box.lo, Point<2>::Constant(at == 0 ? 1 : 0)) << at;
    EXPECT_EQ(box.hi, Point<2>::Constant(n - 1)) << at;
  }
}

}  // namespace
}  // namespace csrbf::types_test
