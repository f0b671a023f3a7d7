#include "csrbf/surface/normals/winding_consistency.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "surface/oriented_shapes.hpp"

namespace csrbf::winding_consistency_test {
namespace {

Shape sorted(const Shape& shape) {
  const std::vector<Index> order = morton_order<3>(shape.points);
  return {shape.points(Eigen::all, order), shape.normals(Eigen::all, order), shape.area};
}

ConsistentNormals solve(const Shape& shape) {
  return consistent_normals(shape.points, KdTree<3>(shape.points));
}

TEST(WindingConsistency, OrientsASphereOutward) {
  const Shape sphere = sorted(random_sphere(4000, 1));
  const ConsistentNormals found = solve(sphere);
  EXPECT_EQ(outward_share(found.normals, sphere.normals), 1);
  EXPECT_LT(angle_error(found.normals, sphere.normals), 6);
  EXPECT_NEAR(found.mean_winding, 0.5, 0.1);
}

TEST(WindingConsistency, OrientsThinPlates) {
  constexpr double spacing = 0.03;
  const Shape plate = sorted(random_box({1, 0.7, 0.7 * spacing}, spacing, 3));
  EXPECT_GT(outward_share(solve(plate).normals, plate.normals), 0.99);
  // Fits through both sides do not tell them apart.
  EXPECT_GT(outward_share(estimate_normals(plate.points), plate.normals), 0.99);
}

TEST(WindingConsistency, OrientsNoisyTori) {
  const Shape clean = random_torus(8000, 2);
  const Shape noisy = sorted(random_torus(8000, 2, 0.5 * clean.spacing()));
  EXPECT_GT(outward_share(solve(noisy).normals, noisy.normals), 0.995);
}

TEST(WindingConsistency, SeesThatASheetHasNoInside) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Shape sheet{Points<3>(3, 3000), Points<3>::Zero(3, 3000), 4};
  for (Index i = 0; i < 3000; ++i) {
    const double x = uniform(random), y = uniform(random);
    sheet.points.col(i) << x, y, 0.1 * std::sin(3 * x) * std::cos(4 * y);
  }
  EXPECT_LT(solve(sorted(sheet)).mean_winding, 0.15);
  EXPECT_GT(estimate_normals(sheet.points).row(2).minCoeff(), 0);
}

TEST(WindingConsistency, DoesNotDependOnTheNumberOfThreads) {
  const Shape torus = sorted(random_torus(5000, 6));
  set_thread_count(1);
  const Points<3> one = solve(torus).normals;
  set_thread_count(3);
  const Points<3> three = solve(torus).normals;
  set_thread_count(0);
  EXPECT_EQ(one, three);
}

}  // namespace
}  // namespace csrbf::winding_consistency_test
