#include "csrbf/surface/contours/slices.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::slices_test {
namespace {

Points<3> square(double half, double height, const Point<3>& center = Point<3>::Zero()) {
  Points<3> corners(3, 4);
  corners << -half, half, half, -half,  //
      -half, -half, half, half,         //
      height, height, height, height;
  return corners.colwise() + center;
}

Polylines chain(Index vertices, std::vector<std::int32_t> ends) {
  Polylines lines;
  lines.vertices = Points<3>::Random(3, vertices);
  lines.edges = Eigen::Map<const Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic>>(ends.data(), 2,
                                                                                 static_cast<Index>(ends.size() / 2));
  return lines;
}

TEST(ContourLoops, FollowTheEdgesWhateverTheirOrderAndDirection) {
  std::vector<std::string> warnings;
  const auto loops = contour_loops(chain(8, {2, 1, 5, 3, 1, 7, 7, 2, 5, 6, 6, 3}), warnings);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0], (ContourLoop{1, 2, 7}));
  EXPECT_EQ(loops[1], (ContourLoop{3, 5, 6}));
  EXPECT_TRUE(warnings.empty());
}

TEST(ContourLoops, CloseChainsWithEndsAndLeaveOutShortOnes) {
  std::vector<std::string> warnings;
  const auto loops = contour_loops(chain(9, {1, 0, 0, 4, 4, 3, 5, 6, 7, 7}), warnings);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0], (ContourLoop{3, 4, 0, 1}));
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0], "1 open contour was closed by a straight segment");
  EXPECT_EQ(warnings[1], "1 contour was left out for having fewer than three points");
}

TEST(Slice, KnowsHowDeepAPlaceIsByEvenAndOdd) {
  Slice slice({0, 0, 2}, Point<3>::UnitZ(), {1, 0, 2});
  slice.add(square(3, 2));
  slice.add(square(1, 2));
  const auto depth = [&](double x, double y) { return slice.depth(slice.to_plane({x, y, 5})); };
  EXPECT_DOUBLE_EQ(depth(2.2, 0), 0.8);
  EXPECT_DOUBLE_EQ(depth(1.2, 0.1), 0.2);
  EXPECT_DOUBLE_EQ(depth(0.3, 0), -0.7);  // in the hole
  EXPECT_DOUBLE_EQ(depth(6, 7), -5);      // beyond a corner
  EXPECT_DOUBLE_EQ(slice.height({1, 1, 5}), 3);
  EXPECT_EQ(slice.to_space(slice.to_plane({0.5, -1, 2})), Point<3>(0.5, -1, 2));
}

TEST(GatherSlices, PutsContoursOfAPlaneTogether) {
  Points<3> points(3, 16);
  points << square(0.1, 0), square(0.3, 0.2), square(0.05, 0, {0.3, 0, 0}), square(0.1, 0.2);
  const std::vector<ContourLoop> loops = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}};
  const Slices slices = gather_slices(points, loops);
  ASSERT_EQ(slices.slices.size(), 2U);
  EXPECT_EQ(slices.slice_of, (std::vector<Index>{1, 0, 1, 0}));  // the largest contour comes first
  EXPECT_EQ(slices.slices[0].loops().size(), 2U);
}

TEST(GatherSlices, RefusesContoursThatAreNotFlatOrHaveNoArea) {
  Points<3> points = square(0.3, 0);
  const auto message = [&] { return invalid_input_message([&] { gather_slices(points, {{0, 1, 2, 3}}); }); };
  points(2, 1) = 0.1;
  EXPECT_NE(message().find("contour = 1: is not planar"), std::string::npos);
  points.row(1) = points.row(0);
  points.row(2).setZero();
  EXPECT_NE(message().find("its points are collinear"), std::string::npos);
}

}  // namespace
}  // namespace csrbf::slices_test
