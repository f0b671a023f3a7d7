#include "csrbf/spatial/usual_extent.hpp"

#include "spatial/spatial_testing.hpp"

namespace csrbf::usual_extent_test {
namespace {

TEST(UsualExtent, IsThatOfAllPointsWhereNoneIsFar) {
  for (const Index n : {2, 3, 12, 500}) {
    const Points<3> x = uniform_points<3>(n, 1);
    EXPECT_EQ(usual_extent<3>(x), bounding_box<3>(x).extent()) << n;
    EXPECT_TRUE(far_points<3>(x).empty()) << n;
  }
}

TEST(UsualExtent, LeavesFarPointsOut) {
  for (const Index n : {10, 50, 500}) {
    Points<2> x = uniform_points<2>(n + 1, 1);
    x(0, n) = -30;
    EXPECT_EQ(usual_extent<2>(x), bounding_box<2>(x.leftCols(n)).extent()) << n;
    EXPECT_EQ(far_points<2>(x), std::vector<Index>{n}) << n;
  }
}

TEST(UsualExtent, KeepsWhatManyPointsHave) {
  Points<1> x = uniform_points<1>(1000, 1);
  x.rightCols(20).array() += 40;
  EXPECT_TRUE(far_points<1>(x).empty());
  x.rightCols(200).array() += 40;  // a second group
  EXPECT_EQ(usual_extent<1>(x), bounding_box<1>(x).extent());
}

TEST(UsualExtent, IsThatOfAllWhereMostAreAtOnePlace) {
  Points<2> x = Points<2>::Constant(2, 40, 5);
  x(0, 7) = 9;
  EXPECT_EQ(usual_extent<2>(x), Point<2>(4, 0));
  EXPECT_EQ(ratio_of_extents<2>(usual_extent<2>(x)), 1);
  x.row(1).setLinSpaced(0, 40);
  EXPECT_EQ(ratio_of_extents<2>(usual_extent<2>(x)), 10);
}

}  // namespace
}  // namespace csrbf::usual_extent_test
