#include "csrbf/levelset/seeded/seed_tissue.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf::seed_tissue_test {
namespace {

constexpr Index n = 96;

// Discs of 100 and 125 that touch, on 30.
Phantom two_discs(double noise) {
  const auto left = [](double x, double y) { return 20 - std::hypot(x + 14, y); };
  Phantom phantom = make_phantom(n, left, 0.8, 0);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(0, noise);
  for (Index i = 0; i < n * n; ++i) {
    const double x = static_cast<double>(i % n) - 47.5, y = static_cast<double>(i / n) - 47.5;
    const auto k = static_cast<std::size_t>(i);
    const double value = phantom.truth[k] != 0 ? 100 : std::hypot(x - 24, y) < 20 ? 125 : 30;
    phantom.image.values[k] = static_cast<float>(value + normal(generator));
  }
  return phantom;
}

TEST(SeedTissue, IsOneOfTwoThatDifferLittle) {
  const std::vector<std::uint8_t> seed = disc_seed(n, -14, 0, 3);
  for (const double noise : {4.0, 10.0, 20.0}) {
    const Phantom phantom = two_discs(noise);
    const std::optional<SeedTissue> tissue = find_seed_tissue(phantom.image.values, phantom.image.grid, {}, seed);
    ASSERT_TRUE(tissue) << noise;
    EXPECT_TRUE(tissue->even) << noise;
    EXPECT_GT(dice(tissue->labels, phantom.truth), 0.96) << noise;
  }
}

TEST(SeedTissue, LeavesOutWhatTheMaskDoes) {
  const Phantom phantom = two_discs(8);
  std::vector<std::uint8_t> mask(phantom.truth.size(), 1), half = phantom.truth;
  std::vector<float> values = phantom.image.values;
  for (Index i = 0; i < n * n; ++i)
    if (i % n < 30) {
      mask[static_cast<std::size_t>(i)] = half[static_cast<std::size_t>(i)] = 0;
      values[static_cast<std::size_t>(i)] = 1e6F;
    }
  const auto tissue = find_seed_tissue(values, phantom.image.grid, mask, disc_seed(n, -14, 0, 3));
  ASSERT_TRUE(tissue);
  EXPECT_GT(dice(tissue->labels, half), 0.96);
}

TEST(SeedTissue, NeedsASeedInTheMask) {
  const Phantom phantom = two_discs(8);
  const std::vector<std::uint8_t> nothing(phantom.truth.size(), 0);
  EXPECT_FALSE(find_seed_tissue(phantom.image.values, phantom.image.grid, nothing, disc_seed(n, -14, 0, 3)));
}

// Coarse scales blur it into the organ around it, or leave the seed alone.
TEST(SeedTissue, IsASmallBallInAnOrgan) {
  constexpr Index m = 36;
  Grid grid;
  grid.size = {m, m, m};
  for (unsigned each = 1; each < 7; ++each) {
    std::vector<float> values(static_cast<std::size_t>(m * m * m));
    std::vector<std::uint8_t> truth(values.size()), seed(values.size(), 0);
    std::mt19937 generator(each);
    std::normal_distribution<double> normal(0, 8);
    for (Index i = 0; i < grid.voxels(); ++i) {
      const auto x = static_cast<double>(i % m), y = static_cast<double>(i / m % m), z = static_cast<double>(i / m / m);
      const double here = std::hypot(x - 20, y - 17, z - 19);
      const auto k = static_cast<std::size_t>(i);
      truth[k] = here < 2.3 ? 1 : 0;
      seed[k] = here < 0.5 ? 1 : 0;
      values[k] = here < 2.3 ? 56 : std::hypot(x - 18, y - 18, z - 18) < 13 ? 100 : 30;
    }
    gaussian_blur(values, grid.size, {0.5, 0.5, 0.5});
    for (float& value : values) value += static_cast<float>(normal(generator));
    const std::optional<SeedTissue> tissue = find_seed_tissue(values, grid, {}, seed);
    ASSERT_TRUE(tissue) << each;
    EXPECT_GT(dice(tissue->labels, truth), 0.7) << each;
  }
}

}  // namespace
}  // namespace csrbf::seed_tissue_test
