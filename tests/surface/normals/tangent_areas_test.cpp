#include "csrbf/surface/normals/tangent_areas.hpp"

#include "surface/surface_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::tangent_areas_test {
namespace {

Eigen::VectorXd areas_of(const PointCloud& cloud, double reach) {
  return tangent_areas(cloud.points, cloud.normals, Eigen::VectorXd::Constant(cloud.size(), reach));
}

TEST(TangentAreas, OfAGridAreItsCellsAndReachBeyondItsRim) {
  PointCloud grid{Points<3>(3, 49), Points<3>(3, 49), {}};
  for (Index i = 0; i < 49; ++i) grid.points.col(i) << static_cast<double>(i % 7), static_cast<double>(i / 7), 0;
  grid.normals.colwise() = Point<3>(0, 0, 1);
  const Eigen::VectorXd areas = areas_of(grid, 2);
  EXPECT_NEAR(areas[24], 1, 1e-12);
  EXPECT_GT(areas[3], 2);  // to the end of its reach, in axes that need not be those of the grid
}

TEST(TangentAreas, AddUpToTheAreaOfASphereHoweverUnevenTheSamples) {
  constexpr double tolerance = 0.02;  // tangent planes are outside the sphere: 1 + O(spacing^2)
  EXPECT_NEAR(areas_of(sphere_cloud(2000), 1).sum() / (4 * pi), 1, tolerance);

  // Samples on 24 meridians only, each carrying the stripe to the next ones.
  PointCloud lines{Points<3>(3, 24 * 60), Points<3>(3, 24 * 60), {}};
  for (Index i = 0; i < lines.size(); ++i) {
    const double u = 2 * pi * static_cast<double>(i % 24) / 24, v = pi * (static_cast<double>(i / 24) + 0.5) / 60;
    lines.normals.col(i) << std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v);
  }
  lines.points = lines.normals;
  EXPECT_NEAR(areas_of(lines, 1).sum() / (4 * pi), 1, tolerance);
}

TEST(TangentAreas, DoNotDependOnTheOtherSheetOfAThinPlate) {
  PointCloud top = sphere_cloud(500);
  const Eigen::VectorXd alone = areas_of(top, 1);
  PointCloud inner = top;
  inner.points *= 0.98;
  inner.normals *= -1;
  const Eigen::VectorXd both = areas_of(joined(top, inner), 1);
  EXPECT_LT((both.head(500) - alone).cwiseAbs().maxCoeff(), 0.05 * alone.mean());
}

}  // namespace
}  // namespace csrbf::tangent_areas_test
