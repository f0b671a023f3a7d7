#include "csrbf/surface/prepare/slice_stack.hpp"

#include "csrbf/surface/reconstruct.hpp"
#include "surface/surface_testing.hpp"

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

TEST(SliceStack, NormalIsThatOfThePlanesOfRows) {
  const OrientedPoints cloud = cylinder(0);
  const std::optional<Point<3>> normal = normal_of_slices(cloud.points, KdTree<3>(cloud.points));
  ASSERT_TRUE(normal);
  EXPECT_NEAR(std::abs(normal->dot(Point<3>(1, 2, 3).normalized())), 1, 1e-9);
}

TEST(SliceStack, EndsAreFlatWhereWallsGoOn) {
  const Point<3> axis = Point<3>(1, 2, 3).normalized();
  const OrientedPoints ends = flat_ends(cylinder(0), axis);
  ASSERT_GT(ends.size(), 400);
  for (Index i = 0; i < ends.size(); ++i) {
    const double height = axis.dot(ends.points.col(i));
    EXPECT_NEAR(std::abs(height - 1), 1 + apart / 2, 1e-9);
    EXPECT_NEAR(ends.normals.col(i).dot(axis), height > 1 ? 1 : -1, 1e-9);
    EXPECT_LT((ends.points.col(i) - height * axis).norm(), 1);
  }
}

TEST(SliceStack, EndsThatCloseGetNothing) {
  EXPECT_EQ(flat_ends(cylinder(0.45), Point<3>(1, 2, 3).normalized()).size(), 0);
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
