#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "surface/surface_testing.hpp"

#include <random>

namespace csrbf::reconstruct_gaps_test {
namespace {

// Random points on a ring of thickness .35 and radius 1 from which a piece is cut out, whose flat ends are `gap`
// spacings apart: a bent bar, without handles.
PointCloud horseshoe(Index n, double gap, std::uint64_t seed) {
  constexpr double thickness = 0.35, pi = 3.14159265358979;
  const double area = 4 * pi * pi * thickness + 2 * pi * thickness * thickness;
  const double first = gap * std::sqrt(area / static_cast<double>(n)) / 2;
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return std::uniform_real_distribution<double>(0, 1)(random); };
  const double end_share = pi * thickness * thickness / area;
  PointCloud cloud;
  cloud.points.resize(3, n);
  for (Index i = 0; i < n;) {
    const double where = uniform(), angle = 2 * pi * uniform();
    double along = first + (2 * pi - 2 * first) * uniform(), radius = thickness;
    if (where < 2 * end_share) {
      along = where < end_share ? first : 2 * pi - first;
      radius *= std::sqrt(uniform());
    } else if (uniform() > (1 + thickness * std::cos(angle)) / (1 + thickness)) {
      continue;
    }
    const double r = 1 + radius * std::cos(angle);
    cloud.points.col(i++) << r * std::cos(along), r * std::sin(along), radius * std::sin(angle);
  }
  return cloud;
}

// In gaps as narrow as that, f is nearly 0, and its sign is chance.
TEST(ReconstructGaps, NarrowerThanTheSpacingOfPointsGetFewHandles) {
  int with_all = 0, right = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Reconstruction bar = reconstruct(horseshoe(5000, 0.7, seed));
    with_all += topology(polygonize(*bar.field, {.persistence = 0.0})).euler == 2;
    const Topology t = topology(polygonize(*bar.field));
    EXPECT_TRUE(t.watertight());
    right += t.euler == 2 && t.components == 1;
  }
  EXPECT_LE(with_all, 2);
  EXPECT_GE(right, 7);
}

TEST(ReconstructGaps, NoisyPointsSupportLess) {
  PointCloud cloud = horseshoe(3000, 3, 1);
  const std::shared_ptr<const Field<3>> exact = reconstruct(cloud).field,
                                        noisy = reconstruct(with_noise(cloud, 0.01)).field;
  EXPECT_NEAR(exact->least_persistence() / exact->feature_size(), 0.2, 0.02);
  EXPECT_NEAR(noisy->least_persistence() / noisy->feature_size(), 0.3, 0.03);
}

}  // namespace
}  // namespace csrbf::reconstruct_gaps_test
