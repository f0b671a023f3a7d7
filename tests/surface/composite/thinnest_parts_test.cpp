#include "csrbf/surface/composite/thinnest_parts.hpp"

#include "surface/oriented_shapes.hpp"

namespace csrbf::thinnest_parts_test {
namespace {

double thinnest(const Shape& shape, double least = 0) {
  const OrientedPoints cloud{shape.points, shape.normals, Eigen::VectorXd::Constant(shape.size(), shape.spacing())};
  return thinnest_parts(cloud, KdTree<3>(cloud.points), least);
}

TEST(ThinnestParts, AreAsThinAsAWall) {
  for (const double thickness : {0.3, 1.0}) {
    const Shape bowl = random_bowl(10'000, thickness, 1);
    const double wall = thickness * bowl.spacing();
    EXPECT_NEAR(thinnest(bowl), wall, 0.15 * wall) << thickness;  // thinner at the edge, where normals are wide apart
    EXPECT_EQ(thinnest(bowl, 2 * wall), std::numeric_limits<double>::infinity());
  }
}

TEST(ThinnestParts, AreNoGapsBetweenBoxes) {
  constexpr double spacing = 0.05, gap = 0.6 * spacing;
  Shape lower = random_box({0.5, 0.5, 0.5}, spacing, 2), upper = random_box({0.5, 0.5, 0.5}, spacing, 3);
  upper.points.row(2).array() += 1 + gap;
  EXPECT_EQ(thinnest(join(lower, upper)), std::numeric_limits<double>::infinity());
}

TEST(ThinnestParts, OfSolidBodiesAreInfinite) {
  EXPECT_EQ(thinnest(random_torus(5000, 4)), std::numeric_limits<double>::infinity());
  EXPECT_EQ(thinnest(random_box({0.5, 0.5, 0.5}, 0.05, 5)), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace csrbf::thinnest_parts_test
