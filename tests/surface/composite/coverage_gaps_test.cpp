#include "csrbf/surface/composite/coverage_gaps.hpp"

#include "csrbf/surface/prepare/prepare.hpp"
#include "surface/oriented_shapes.hpp"
#include "surface/surface_testing.hpp"

#include <cmath>
#include <functional>
#include <random>

namespace csrbf::coverage_gaps_test {
namespace {

// Where the finest patches have less weight, coarser ones take over (composite_field.cpp).
constexpr double enough = 0.04;

double weight_at(const Patches& patches, const Point<3>& x) {
  double W;
  patches.weights(x, &W);
  return W;
}

// Evenly spread samples of the unit sphere where `kept` holds.
OrientedPoints part_of_sphere(Index count, const std::function<bool(const Point<3>&)>& kept) {
  const Shape all = even_sphere(count);
  std::vector<Index> ids;
  for (Index i = 0; i < count; ++i)
    if (kept(all.points.col(i))) ids.push_back(i);
  OrientedPoints cloud{all.points(Eigen::all, ids), all.normals(Eigen::all, ids), {}};
  cloud.spacing.setConstant(cloud.size(), all.spacing());
  return cloud;
}

TEST(CoverageGaps, AreCoveredWhereTheDensityVaries) {
  // Random samples; their density falls by a factor of 150 from pole to pole.
  const Shape all = random_sphere(100000, 3);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Index> ids;
  for (Index i = 0; i < all.size(); ++i)
    if (uniform(random) < std::exp(-2.5 * (1 + all.points(2, i)))) ids.push_back(i);
  const PreparedCloud prepared =
      prepare({all.points(Eigen::all, ids), all.normals(Eigen::all, ids), {}}, Normals::file);
  CompositeOptions options;
  options.leaf_size = 6;
  const Patches patches = fit_composite(prepared.cloud, options).patches;
  const Shape probes = even_sphere(30011);
  Index bare = 0;
  for (Index i = 0; i < probes.size(); ++i)
    bare += weight_at(patches, (probes.points.col(i) - prepared.origin) / prepared.scale) < enough;
  EXPECT_LE(bare, 12);  // of 30011; 49 without further patches
}

TEST(CoverageGaps, AreLeftBeyondTheRimOfTheCloud) {
  const OrientedPoints half = part_of_sphere(10000, [](const Point<3>& x) { return x[2] < 0; });
  const Patches patches = fit_composite(half, {}).patches;
  const double spacing = std::sqrt(4 * std::numbers::pi / 10000);
  for (int i = 0; i < 100; ++i) {
    const double height = 5 * spacing, r = std::sqrt(1 - height * height);
    EXPECT_LT(weight_at(patches, {r * std::cos(i), r * std::sin(i), height}), enough);
  }
}

TEST(CoverageGaps, AreNotCoveredFromASheetToTheNext) {
  // Two half planes one above the other, facing the same way, that end where the other begins.
  OrientedPoints cloud{Points<3>(3, 2000), Point<3>::UnitZ().replicate(1, 2000), {}};
  constexpr double spacing = 1 / 31.6;
  cloud.spacing.setConstant(2000, spacing);
  for (Index i = 0; i < 2000; ++i) {
    const Point<2> at = quasi_random(i, 1);
    cloud.points.col(i) << (i < 1000 ? at[0] : -at[0] - 2 * spacing), at[1], (i < 1000 ? 0 : 4 * spacing);
  }
  const Patches patches = fit_composite(cloud, {}).patches;
  for (double y = 0.1; y < 0.9; y += 0.05) EXPECT_LT(weight_at(patches, {-spacing, y, 2 * spacing}), enough);
}

}  // namespace
}  // namespace csrbf::coverage_gaps_test
