#include "csrbf/levelset/regions/speckle_model.hpp"

#include "csrbf/levelset/regions/region_cores.hpp"
#include "levelset/speckle_testing.hpp"

namespace csrbf::speckle_model_test {
namespace {

constexpr Index n = 200;
constexpr std::array<double, 3> grain{1.6, 1.1, 0};

TEST(FindSpeckle, FindsHowItWasMade) {
  for (const double exponent : {0.0, 0.5, 1.0})
    for (const double dark : {0.02, 0.1}) {
      const Phantom phantom = make_speckle(n, cavity, dark, exponent, grain);
      const auto found = find_speckle<2>(phantom.image.values, phantom.image.grid, phantom.truth);
      ASSERT_TRUE(found);
      // Some 700 grains in the cavity: its mean power is known to 4 %, deviations to about 3 %.
      EXPECT_NEAR(found->exponent, exponent, 0.1);
      EXPECT_NEAR(found->power[1] / found->power[0], dark, 0.2 * dark);
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(found->grain[axis], grain[axis], 0.1 * grain[axis]);
      EXPECT_NEAR(found->voxels_per_grain(), 2 * std::numbers::pi * grain[0] * grain[1], 2);
    }
}

TEST(FindSpeckle, FindsNoneInOtherNoise) {
  Phantom phantom = make_phantom(n, cavity, 1, 20);
  EXPECT_FALSE(find_speckle<2>(phantom.image.values, phantom.image.grid, phantom.truth));
  // As coarse as speckle, but symmetric.
  for (const unsigned seed : {1U, 2U, 3U}) {
    phantom = make_phantom(n, cavity, 1, 120, seed);
    gaussian_blur(phantom.image.values, phantom.image.grid.size, grain);
    EXPECT_FALSE(find_speckle<2>(phantom.image.values, phantom.image.grid, phantom.truth));
  }
}

TEST(FindSpeckle, NeedsTwoRegionsOfSomeSize) {
  const Phantom phantom = make_speckle(n, cavity, 0.05, 0, grain);
  std::vector<std::uint8_t> labels(phantom.truth.size(), 0);
  EXPECT_FALSE(find_speckle<2>(phantom.image.values, phantom.image.grid, labels));
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = phantom.truth[i] != 0 ? 1 : no_region;
  EXPECT_FALSE(find_speckle<2>(phantom.image.values, phantom.image.grid, labels));
}

}  // namespace
}  // namespace csrbf::speckle_model_test
