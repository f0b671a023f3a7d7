#include "csrbf/surface/prepare/slice_stack.hpp"

#include "csrbf/surface/prepare/flat_ends.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/surface_testing.hpp"

#include <algorithm>
#include <numbers>
#include <random>

namespace csrbf::slice_stack_test {
namespace {

constexpr double apart = 0.2;

// A cylinder of radius 1 on slices from 0 to 2, across a slanting axis; `shrink`: of the radius, from one end on.
OrientedPoints cylinder(double shrink) {
  const Point<3> axis = Point<3>(1, 2, 3).normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  constexpr Index slices = 11, around = 300;
  OrientedPoints result;
  result.points.resize(3, slices * around);
  result.normals.resize(3, slices * around);
  for (Index s = 0; s < slices; ++s)
    for (Index k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * (static_cast<double>(k) + 0.3 * static_cast<double>(s)) / around;
      const Point<3> outward = std::cos(angle) * u + std::sin(angle) * v;
      const double height = apart * static_cast<double>(s);
      result.points.col(s * around + k) = (1 - shrink * height) * outward + height * axis;
      result.normals.col(s * around + k) = (outward + shrink * axis).normalized();
    }
  return result;
}

NeighborTable neighbors_of(const Points<3>& points) {
  return make_neighbor_table(points, KdTree<3>(points), 9);
}

TEST(SliceStack, NormalIsThatOfThePlanesOfRows) {
  const OrientedPoints cloud = cylinder(0);
  const std::optional<Point<3>> normal = normal_of_slices(cloud.points, neighbors_of(cloud.points));
  ASSERT_TRUE(normal);
  EXPECT_NEAR(std::abs(normal->dot(Point<3>(1, 2, 3).normalized())), 1, 1e-9);
}

// Many nearest neighbours are in other slices then, and none fits its plane exactly.
TEST(SliceStack, NormalIsFoundForSparseAndRoughContours) {
  const Points<3> all = cylinder(0).points;
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, 0.02 * apart);
  Points<3> points(3, 600);
  for (Index i = 0; i < points.cols(); ++i) {
    points.col(i) = all.col(static_cast<Index>(random() % static_cast<unsigned>(all.cols())));
    for (Index c = 0; c < 3; ++c) points(c, i) += error(random);
  }
  const std::optional<Point<3>> normal = normal_of_slices(points, neighbors_of(points));
  ASSERT_TRUE(normal);
  EXPECT_GT(std::abs(normal->dot(Point<3>(1, 2, 3).normalized())), std::cos(2e-3));
}

TEST(SliceStack, HasThreeSlicesAtLeast) {
  const Points<3> all = cylinder(0).points;
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  EXPECT_FALSE(find_slices(all.leftCols(300), axis));
  EXPECT_FALSE(find_slices(all.leftCols(600), axis));
  EXPECT_TRUE(find_slices(all.leftCols(900), axis));
}

TEST(SliceStack, PointsAllOverASurfaceHaveNoSlices) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1, 1);
  Points<3> cube(3, 2000);
  for (Index i = 0; i < cube.cols(); ++i) {
    cube.col(i) << any(random), any(random), any(random);
    cube(i % 3, i) = i % 2 == 0 ? 1 : -1;
  }
  EXPECT_FALSE(normal_of_slices(cube, neighbors_of(cube)));
}

TEST(SliceStack, EndsAreFlatWhereWallsGoOn) {
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  const OrientedPoints ends = flat_ends(cylinder(0), axis, Points<3>(3, 0));
  ASSERT_GT(ends.size(), 400);
  for (Index i = 0; i < ends.size(); ++i) {
    const double height = axis.dot(ends.points.col(i));
    EXPECT_NEAR(std::abs(height - 1), 1 + apart / 2, 1e-9);
    EXPECT_NEAR(ends.normals.col(i).dot(axis), height > 1 ? 1 : -1, 1e-9);
    EXPECT_LT((ends.points.col(i) - height * axis).norm(), 1);
  }
}

// The wide end of a cone is cut off, its tip is not.
TEST(SliceStack, EndsThatCloseGetNothing) {
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  const OrientedPoints ends = flat_ends(cylinder(0.45), axis, Points<3>(3, 0));
  EXPECT_GT(ends.size(), 200);
  for (Index i = 0; i < ends.size(); ++i) EXPECT_LT(axis.dot(ends.points.col(i)), 0);
}

// Walls that lean by 45 degrees do not close a wide contour before the next slice.
TEST(SliceStack, EndsOfLeaningWallsAreFlatAndNarrower) {
  OrientedPoints cone = cylinder(0.45);
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  cone.points -= 0.8 * axis * (axis.transpose() * cone.points);  // slices a fifth as far from each other
  for (Index i = 0; i < cone.size(); ++i) {
    const double height = axis.dot(cone.points.col(i));
    const Point<3> outward = (cone.points.col(i) - height * axis).normalized();
    cone.normals.col(i) = (outward + 5 * 0.45 * axis).normalized();
  }
  const OrientedPoints ends = flat_ends(cone, axis, Points<3>(3, 0));
  EXPECT_GT(((axis.transpose() * ends.points).array() < 0).count(), 400);
  const double slope = 5 * 0.45, reach = 1 - 0.5 * slope * apart / 5;
  for (Index i = 0; i < ends.size(); ++i) {
    const double height = axis.dot(ends.points.col(i));
    if (height > 0) EXPECT_LT((ends.points.col(i) - height * axis).norm(), reach);
  }
}

// One body ends in its last slice, the other one beside it is cut off there.
TEST(SliceStack, PartsOfASliceEndByThemselves) {
  const OrientedPoints cut = cylinder(0), closing = cylinder(0.45);
  const Point<3> axis = Point<3>(1, 2, 3).normalized(), aside = 4 * axis.unitOrthogonal();
  OrientedPoints both;
  both.points.resize(3, cut.size() + closing.size());
  both.normals.resize(3, cut.size() + closing.size());
  both.points << cut.points, closing.points.colwise() + aside;
  both.normals << cut.normals, closing.normals;
  const OrientedPoints ends = flat_ends(both, axis, Points<3>(3, 0));
  Index last = 0;
  for (Index i = 0; i < ends.size(); ++i) {
    const double height = axis.dot(ends.points.col(i));
    if (height < 1) continue;
    EXPECT_LT((ends.points.col(i) - height * axis).norm(), 1);
    ++last;
  }
  EXPECT_GT(last, 200);
}

// Samples in the plane of the last slice or just beyond it tell where the solid ends, in the cloud or beside it.
TEST(SliceStack, EndsAreWhereCapsHaveSamples) {
  OrientedPoints cloud = cylinder(0);
  const Point<3> axis = Point<3>(1, 2, 3).normalized(), u = axis.unitOrthogonal();
  const Point<3> beyond = 0.3 * u - 0.8 * apart * axis;
  const auto expect_ends = [&](const OrientedPoints& ends, double first, double last) {
    ASSERT_GT(ends.size(), 400);
    for (Index i = 0; i < ends.size(); ++i) {
      const double height = axis.dot(ends.points.col(i));
      EXPECT_NEAR(height, height < 1 ? first : last, 1e-9);
    }
  };
  expect_ends(flat_ends(cloud, axis, beyond), -0.8 * apart, 2 + 0.5 * apart);
  const Index n = cloud.size();
  cloud.points.conservativeResize(3, n + 2);
  cloud.normals.conservativeResize(3, n + 2);
  cloud.points.rightCols(2) << 2 * axis, 2 * axis + 0.4 * u;
  cloud.normals.rightCols(2) << axis, axis;
  expect_ends(flat_ends(cloud, axis, beyond), -0.8 * apart, 2);
}

// Samples of a contour at random are closer to one neighbour than to the other, and few: their mean normal is not zero.
TEST(SliceStack, SparseContoursAtRandomHaveEnds) {
  const Point<3> axis = Point<3>(1, 2, 3).normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0, 2 * std::numbers::pi);
  constexpr Index around = 24, slices = 12;
  OrientedPoints cloud;
  cloud.points.resize(3, around * slices);
  cloud.normals.resize(3, around * slices);
  for (Index i = 0; i < around * slices; ++i) {
    const double angle = any(random);
    cloud.normals.col(i) = std::cos(angle) * u + std::sin(angle) * v;
    cloud.points.col(i) = cloud.normals.col(i) + apart * static_cast<double>(i / around) * axis;
  }
  const std::optional<Point<3>> normal = normal_of_slices(cloud.points, neighbors_of(cloud.points));
  ASSERT_TRUE(normal);
  EXPECT_NEAR(std::abs(normal->dot(axis)), 1, 1e-9);
  const Eigen::VectorXd heights = flat_ends(cloud, *normal, Points<3>(3, 0)).points.transpose() * axis;
  EXPECT_GT((heights.array() < 0).count(), 200);
  EXPECT_GT((heights.array() > 11 * apart).count(), 200);
}

// However many samples: dense contours, and slices that are close for their size.
TEST(SliceStack, LargeStacksHaveEnds) {
  constexpr Index around = 5000, slices = 3;
  OrientedPoints cloud;
  cloud.points.resize(3, around * slices);
  cloud.normals.resize(3, around * slices);
  for (Index i = 0; i < around * slices; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / around;
    cloud.normals.col(i) << std::cos(angle), std::sin(angle), 0;
    cloud.points.col(i) = cloud.normals.col(i) + 1e-3 * static_cast<double>(i / around) * Point<3>::UnitZ();
  }
  const OrientedPoints ends = flat_ends(cloud, Point<3>::UnitZ(), Points<3>(3, 0));
  const double share = static_cast<double>(ends.size()) / 200'000;  // of the boxes
  EXPECT_NEAR(share, std::numbers::pi / 4, 0.02);
}

TEST(SliceStack, EndsInARegionAreToldOf) {
  PointCloud input;
  input.points = cylinder(0).points;
  ReconstructOptions options;
  options.region = bounding_box<3>(input.points);
  options.region->lo.array() -= 0.2;
  options.region->hi.array() += 0.2;
  const std::vector<std::string> warnings = reconstruct(input, options).report.warnings;
  const auto tells = [](const std::string& text) { return text.find("left as it is") != std::string::npos; };
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(), tells), 1);
}

// The layers of a lattice are slices that points fill.
TEST(SliceStack, LayersOfALatticeHaveNoEnds) {
  OrientedPoints block;
  block.points.resize(3, 20 * 20 * 5);
  for (Index i = 0; i < block.points.cols(); ++i) {
    const Index x = i % 20, y = i / 20 % 20, z = i / 400;
    block.points.col(i) << static_cast<double>(x), static_cast<double>(y), static_cast<double>(3 * z) / 10;
  }
  block.normals = block.points.colwise() - Point<3>(9.5, 9.5, 0.6);
  block.normals.row(2).setZero();
  block.normals.colwise().normalize();
  EXPECT_EQ(flat_ends(block, Point<3>::UnitZ(), Points<3>(3, 0)).size(), 0);
}

TEST(SliceStack, SurfaceOfACutSolidEndsHalfASpacingBeyond) {
  const OrientedPoints cloud = cylinder(0);
  PointCloud input;
  input.points = cloud.points;
  const Reconstruction result = reconstruct(input);
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  for (const double across : {0.0, 0.5}) {
    const Point<3> aside = across * axis.unitOrthogonal();
    Points<3> places(3, 4);
    places << aside - 0.2 * axis, aside, aside + 2 * axis, aside + 2.2 * axis;
    const Eigen::VectorXd f = result.field->evaluate(PointsRef<3>(places)).value;
    EXPECT_LT(f[0], 0) << across;
    EXPECT_GT(f[1], 0) << across;
    EXPECT_GT(f[2], 0) << across;
    EXPECT_LT(f[3], 0) << across;
  }
}

}  // namespace
}  // namespace csrbf::slice_stack_test
