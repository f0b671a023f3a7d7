#include "csrbf/approx/levels/pca_multiresolution.hpp"

#include "approx/approx_testing.hpp"
#include "csrbf/approx/levels/level_sum.hpp"

namespace csrbf::pca_multiresolution_test {
namespace {

TEST(PcaMultiresolution, EndsWithinTheToleranceWhereThePublishedLoopDoesNot) {
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), peaks);
  const auto fit = pca_multiresolution<2>(data, {.tolerance = .144});
  EXPECT_TRUE(fit.converged);
  EXPECT_LE(largest_error<2>(*fit.fields[0], data), .144);
  EXPECT_LT(rms_error<2>(*fit.fields[0], peaks), .1);
}

// A binary split doubles the number of centres, which fill the supports as before when these lose half their volume.
TEST(PcaMultiresolution, ShrinksTheSupportsByHalfOfTheirVolume) {
  const auto fit = pca_multiresolution<3>(sample<3>(random_points<3>(2000, 1), waves<3>), {.tolerance = .001});
  ASSERT_GE(fit.levels.size(), 4u);
  for (std::size_t level = 1; level + 1 < fit.levels.size(); ++level)
    EXPECT_NEAR(fit.levels[level].largest_support, fit.levels[level - 1].largest_support * std::cbrt(.5), 1e-12);
}

TEST(PcaMultiresolution, StartsWithClustersOfTheGivenSize) {
  const auto fit =
      pca_multiresolution<1>(sample<1>(random_points<1>(64, 1), waves<1>), {.tolerance = 100, .cluster_size = 64});
  EXPECT_EQ(fit.levels[0].centers, 1);
  EXPECT_EQ(fit.levels.size(), 1u);
}

TEST(PcaMultiresolution, CanBeCancelled) {
  const auto stop = [](std::string_view stage, double) { return stage != "levels"; };
  EXPECT_THROW(pca_multiresolution<2>(sample<2>(random_points<2>(100, 1), franke), {.progress = stop}), Cancelled);
}

TEST(PcaMultiresolution, RefusesBadOptions) {
  const Samples<2> data = sample<2>(random_points<2>(10, 1), franke);
  EXPECT_THROW(pca_multiresolution<2>(data, {.tolerance = -1}), InvalidInput);
  EXPECT_THROW(pca_multiresolution<2>(data, {.cluster_size = -1}), InvalidInput);
  EXPECT_THROW(pca_multiresolution<2>(data, {.support = .5}), InvalidInput);
  EXPECT_THROW(pca_multiresolution<2>(data, {.max_levels = 0}), InvalidInput);
}

}  // namespace
}  // namespace csrbf::pca_multiresolution_test
