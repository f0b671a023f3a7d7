#include "csrbf/levelset/textures/sharp_labels.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf::sharp_labels_test {
namespace {

constexpr Index side = 128;

// Water with little noise in land with structures that are not independent of their neighbours.
Phantom water_in_land(unsigned seed) {
  Phantom phantom = make_phantom(
      side, [](double x, double y) { return 38 + 8 * std::cos(3 * std::atan2(y, x)) - std::hypot(x, y); }, 0.01, 3,
      seed);
  std::mt19937 generator(seed + 100);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> structures(side * side);
  for (float& value : structures) value = normal(generator);
  gaussian_blur(structures, {side, side, 1}, {3, 3, 0});
  double squares = 0;
  for (const float value : structures) squares += static_cast<double>(value) * static_cast<double>(value);
  const auto factor = static_cast<float>(50 / std::sqrt(squares / static_cast<double>(structures.size())));
  for (std::size_t i = 0; i < structures.size(); ++i)
    if (phantom.truth[i] == 0) phantom.image.values[i] += factor * structures[i] + 20 * normal(generator);
  return phantom;
}

TEST(SharpLabels, StructuresOfARegionAreNoBorders) {
  for (unsigned seed = 1; seed < 3; ++seed) {
    const Phantom phantom = water_in_land(seed);
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(dice(found.labels, phantom.truth), 0.97) << seed;
    const auto& prices = found.report.prices;
    EXPECT_TRUE(std::any_of(prices.begin(), prices.end(), [](const auto& each) { return each.nats == 0; }));
  }
}

// Grains of another material in noise, dimmer towards the middle: a voxel's neighbours tell little of the light.
TEST(SharpLabels, LightIsNoRegion) {
  constexpr Index n = 192;
  Phantom phantom = make_phantom(
      n, [](double, double) { return -1.0; }, 1, 0);
  std::mt19937 generator(1);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> grains(n * n);
  for (float& value : grains) value = normal(generator);
  gaussian_blur(grains, {n, n, 1}, {6, 6, 0});
  for (Index i = 0; i < n * n; ++i) {
    const double r = std::hypot(static_cast<double>(i % n) - 96, static_cast<double>(i / n) - 96) / 96;
    phantom.truth[i] = grains[i] > 0.025F ? 1 : 0;  // half a standard deviation
    phantom.image.values[i] =
        (phantom.truth[i] != 0 ? 130.0F : 100.0F) * static_cast<float>(0.65 + 0.175 * r * r) + 13 * normal(generator);
  }
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.95);
}

// A disc in light of the third degree under hardly any noise, where a quadratic leaves more than noise.
TEST(SharpLabels, CubicLightIsNoRegion) {
  constexpr Index n = 64;
  Phantom phantom = make_phantom(
      n, [](double x, double y) { return 17.3 - std::hypot(x, y); }, 1, 0);
  std::mt19937 generator(3);
  std::normal_distribution<float> normal(0, 1);
  for (Index i = 0; i < n * n; ++i) {
    const double x = static_cast<double>(i % n) / n, light = 0.5 + 2 * (x - 0.5) * (x * x + 0.3);
    phantom.image.values[i] =
        (phantom.truth[i] != 0 ? 140.0F : 100.0F) * static_cast<float>(light) + 2 * normal(generator);
  }
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.8);
}

TEST(SharpLabels, AreOfTwoRegions) {
  const Phantom phantom = make_phantom(
      side, [](double x, double) { return x; }, 0.01, 6);
  const Grid& grid = phantom.image.grid;
  PartitionPrice price(phantom.image.values, 0, 255, grid, {}, contour_weight(grid, 1.5));
  Partition found;
  for (Index i = 0; i < side * side; ++i) found.labels.push_back(static_cast<std::uint8_t>(3 * (i / side) / side));
  found.others.push_back({{}, phantom.truth});
  const std::vector<std::uint8_t> three = found.labels;
  prefer_sharp_labels(price, found);
  EXPECT_EQ(found.labels, three);
  for (std::uint8_t& label : found.labels) label = label > 0 ? 1 : 0;
  prefer_sharp_labels(price, found);
  EXPECT_EQ(found.labels, phantom.truth);
}

}  // namespace
}  // namespace csrbf::sharp_labels_test
