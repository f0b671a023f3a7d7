#include "csrbf/levelset/regions/force_noise.hpp"

#include "levelset/segment_testing.hpp"

namespace csrbf::force_noise_test {
namespace {

// A force of -1 in a disc and 1 outside, with noise.
struct NoisyForce {
  Phantom phantom;
  std::vector<float> force;

  explicit NoisyForce(double noise)
      : phantom(make_phantom(
            128, [](double x, double y) { return 40 - std::hypot(x, y); }, 1, 0)) {
    std::mt19937 generator(7);
    std::normal_distribution<double> normal(0, 1);
    for (const std::uint8_t label : phantom.truth)
      force.push_back(static_cast<float>((label != 0 ? -1 : 1) + noise * normal(generator)));
  }
};

TEST(ForceNoise, IsTheDeviationOverTheGap) {
  for (const double noise : {0.02, 0.1, 0.3}) {
    const NoisyForce noisy(noise);
    const ForceNoise found = force_noise(noisy.force, noisy.phantom.truth, {}, noisy.phantom.image.grid);
    EXPECT_NEAR(found.size, noise / 2, 0.03 * noise / 2);  // 16000 second differences
    EXPECT_NEAR(found.grain, 1, 0.02);
  }
}

TEST(ForceNoise, IsLargeWhereTheForceContradictsTheLabels) {
  const NoisyForce noisy(0.1);
  std::vector<std::uint8_t> inverted = noisy.phantom.truth;
  for (std::uint8_t& label : inverted) label = label != 0 ? 0 : 1;
  EXPECT_EQ(force_noise(noisy.force, inverted, {}, noisy.phantom.image.grid).size, 1);
  const std::vector<float> none(inverted.size(), 0.0F);
  EXPECT_EQ(force_noise(none, inverted, {}, noisy.phantom.image.grid).size, 0);
}

}  // namespace
}  // namespace csrbf::force_noise_test
