#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/oriented_shapes.hpp"

namespace csrbf::reconstruct_thin_test {
namespace {

// Share of the triangles that the largest component has.
double largest_share(const Mesh& mesh) {
  DisjointSets sets(mesh.vertices.cols());
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Index c = 1; c < 3; ++c) sets.unite(mesh.triangles(0, t), mesh.triangles(c, t));
  std::vector<Index> count(mesh.vertices.cols(), 0);
  for (Index t = 0; t < mesh.triangles.cols(); ++t) ++count[sets.find(mesh.triangles(0, t))];
  return static_cast<double>(*std::max_element(count.begin(), count.end())) /
         static_cast<double>(mesh.triangles.cols());
}

// Walls about as thin as the spacing of points, or thinner.

TEST(ReconstructThin, WallsWithExactNormalsAreClosed) {
  for (const double thickness : {0.5, 1.0}) {
    const Shape bowl = random_bowl(10'000, thickness, 1);
    const Reconstruction result = reconstruct({bowl.points, bowl.normals, {}});
    EXPECT_EQ(result.report.normals, NormalSource::file) << thickness;
    EXPECT_LT(result.report.rms_distance, 0.02 * bowl.spacing() / 3);
    EXPECT_LT(result.field->feature_size(), 0.6 * thickness * bowl.spacing());
    const Mesh mesh = polygonize(*result.field);
    EXPECT_TRUE(topology(mesh).watertight());
    EXPECT_GT(largest_share(mesh), 0.999) << thickness;  // in hundreds of pieces with cells as wide as the spacing
    // Not a solid ball: nothing is far from the wall but what closes its edge.
    const double lowest_inside = 1 - (thickness + 4) * bowl.spacing();
    Index far = 0;
    for (Index v = 0; v < mesh.vertices.cols(); ++v) far += mesh.vertices.col(v).norm() < lowest_inside ? 1 : 0;
    EXPECT_EQ(far, 0) << thickness;
  }
}

TEST(ReconstructThin, WallsTooThinForTheMeshAreTold) {
  const auto warned = [](const Reconstruction& result) {
    return std::any_of(result.report.warnings.begin(), result.report.warnings.end(),
                       [](const std::string& text) { return text.find("too thin for the mesh") != std::string::npos; });
  };
  for (const double thickness : {0.2, 0.7}) {
    const Shape bowl = random_bowl(10'000, thickness, 1);
    EXPECT_EQ(warned(reconstruct({bowl.points, bowl.normals, {}})), thickness == 0.2) << thickness;
  }
}

TEST(ReconstructThin, NormalsOfWallsAreFound) {
  for (const double thickness : {0.3, 0.7, 1.2}) {
    const Shape bowl = random_bowl(10'000, thickness, 2);
    EXPECT_GT(outward_share(estimate_normals(bowl.points), bowl.normals), 0.97) << thickness;
  }
}

// The same sheets, but facing each other across a gap.
TEST(ReconstructThin, GapsAreNoWalls) {
  constexpr double spacing = 0.05;
  const Shape lower = random_box({0.5, 0.5, 0.5}, spacing, 2);
  Shape upper = random_box({0.5, 0.5, 0.5}, spacing, 3);
  upper.points.row(2).array() += 1 + 1.2 * spacing;
  const Shape both = join(lower, upper);
  EXPECT_GT(outward_share(estimate_normals(both.points), both.normals), 0.95);
}

TEST(ReconstructThin, WallsWithoutNormalsAreNotFilled) {
  const Shape bowl = random_bowl(10'000, 0.7, 3);
  const Mesh mesh = polygonize(*reconstruct({bowl.points, Points<3>(3, 0), {}}).field);
  EXPECT_GT(mesh.vertices.colwise().norm().minCoeff(), 1 - 5 * bowl.spacing());
}

// A plate on four legs that are 1.5 spacings thick; the spacing is 1.
Shape random_table(unsigned seed) {
  constexpr double length = 10, radius = 0.75, half = 7, at = 4.5;
  const Shape plate = random_box({half, half, 2}, 1, seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point<3>> points, normals;
  const auto leg_of = [&](const Point<3>& p) {
    return Point<3>(std::copysign(at, p[0]), std::copysign(at, p[1]), -2 - length / 2);
  };
  for (Index i = 0; i < plate.size(); ++i) {
    const Point<3> p = plate.points.col(i);
    if (p[2] < -1.99 && (p - leg_of(p)).head<2>().norm() < radius) continue;
    points.push_back(p);
    normals.emplace_back(plate.normals.col(i));
  }
  for (const Point<3>& quarter : {Point<3>(1, 1, 0), Point<3>(1, -1, 0), Point<3>(-1, 1, 0), Point<3>(-1, -1, 0)}) {
    for (Index k = 0; k < static_cast<Index>(2 * std::numbers::pi * radius * length); ++k) {
      const double angle = std::numbers::pi * uniform(random);
      normals.emplace_back(std::cos(angle), std::sin(angle), 0);
      points.push_back(leg_of(quarter) + radius * normals.back() + Point<3>(0, 0, length / 2 * uniform(random)));
    }
    points.push_back(leg_of(quarter) - Point<3>(0, 0, length / 2));
    normals.emplace_back(0, 0, -1);
  }
  Shape table;
  table.points.resize(3, std::ssize(points));
  table.normals.resize(3, std::ssize(points));
  for (Index i = 0; i < table.size(); ++i) {
    table.points.col(i) = points[i];
    table.normals.col(i) = normals[i];
  }
  return table;
}

// Patches of the plate that know nothing of a leg reach into it.
TEST(ReconstructThin, LegsHoldToTheirTable) {
  Index pieces = 0;
  for (const unsigned seed : {4U, 8U, 16U, 20U, 22U}) {
    const Shape table = random_table(seed);
    pieces += topology(polygonize(*reconstruct({table.points, table.normals, {}}).field)).components;
  }
  EXPECT_LE(pieces, 11);  // 15 where coarser patches fill in
}

}  // namespace
}  // namespace csrbf::reconstruct_thin_test
