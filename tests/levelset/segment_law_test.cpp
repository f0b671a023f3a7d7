#include "levelset/segment_testing.hpp"

namespace csrbf::segment_law_test {
namespace {

constexpr Index n = 80;

// Bars of a tenth of the picture; what draw(inside) says of each pixel.
Phantom bars(const std::function<double(bool)>& draw) {
  Phantom phantom = make_phantom(
      n, [](double x, double /*y*/) { return std::sin(x * 2 * std::numbers::pi / 16); }, 0.3, 0);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    phantom.image.values[i] = static_cast<float>(draw(phantom.truth[i] != 0));
  return phantom;
}

double dice_by(const Phantom& phantom, SegmentEnergy energy) {
  std::vector<std::uint8_t> labels = segment<2>(phantom.image, {.energy = energy}).labels;
  const double found = dice(labels, phantom.truth);
  for (std::uint8_t& label : labels) label = 1 - label;
  return std::max(found, dice(labels, phantom.truth));
}

TEST(SegmentByLaw, FindsGaussiansOfTheirOwnDeviations) {
  for (const double dark : {0.02, 0.15, 0.4}) {
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    const Phantom phantom =
        bars([&](bool inside) { return (inside ? 1 : 0) + (inside ? 0.15 : dark) * normal(generator); });
    for (const SegmentEnergy energy :
         {SegmentEnergy::chan_vese, SegmentEnergy::gaussian, SegmentEnergy::generalized_gaussian})
      EXPECT_GT(dice_by(phantom, energy), 0.98) << dark << " " << name_of(energy);
  }
}

TEST(SegmentByLaw, FindsEchoesInDarkAndBrightCavities) {
  for (const double ratio : {3.0, 10.0, 25.0})
    for (const bool dark : {false, true}) {
      std::mt19937 generator(4);
      std::gamma_distribution<double> powers(3);
      std::exponential_distribution<double> power;
      const auto mean = [&](bool inside) { return inside == dark ? 1 : ratio; };
      EXPECT_GT(dice_by(bars([&](bool inside) { return mean(inside) * powers(generator); }), SegmentEnergy::gamma),
                0.97)
          << ratio << dark;
      EXPECT_GT(dice_by(bars([&](bool inside) { return mean(inside) * std::sqrt(power(generator)); }),
                        SegmentEnergy::rayleigh),
                0.97)
          << ratio << dark;
    }
}

// Which are too few for regions of three.
TEST(SegmentByLaw, KeepsTheLevelSetOfAFewVoxels) {
  VolumeLayout layout;
  layout.grid.axes = 2;
  layout.grid.size = {2, 2, 1};
  Volume<float> image(layout);
  image.values = {0, 1, 2, 3};
  for (const SegmentEnergy energy : {SegmentEnergy::chan_vese, SegmentEnergy::gamma})
    EXPECT_EQ(segment<2>(image, {.energy = energy}).labels.size(), 4U);
  EXPECT_THROW(segment<2>(image), InvalidInput);
}

}  // namespace
}  // namespace csrbf::segment_law_test
