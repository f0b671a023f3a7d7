#include "csrbf/levelset/textures/texture_partition.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/levelset/textures/neighbour_code.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf::texture_partition_test {
namespace {

constexpr Index n = 96;

std::vector<float> white_noise(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> noise(count);
  for (float& value : noise) value = normal(generator);
  return noise;
}

// Of the same deviation, after a Gaussian.
std::vector<float> grained_noise(const Grid& grid, unsigned seed, double sd = 1.2) {
  std::vector<float> noise = white_noise(static_cast<std::size_t>(grid.voxels()), seed);
  gaussian_blur(noise, grid.size, {sd, sd, 0});
  double squares = 0;
  for (const float value : noise) squares += static_cast<double>(value * value) / static_cast<double>(noise.size());
  for (float& value : noise) value /= static_cast<float>(std::sqrt(squares));
  return noise;
}

// Grained noise inside, white noise outside.
Phantom two_textures(const std::function<double(double, double)>& distance) {
  Phantom phantom = make_phantom(n, distance, 0.1, 0);
  const Grid& grid = phantom.image.grid;
  const std::vector<float> white = white_noise(phantom.truth.size(), 1), grained = grained_noise(grid, 2);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    phantom.image.values[i] = 5 + (phantom.truth[i] != 0 ? grained[i] : white[i]);
  return phantom;
}

double disc(double x, double y) {
  return 25 - std::hypot(x - 4, y + 7);
}
double bars(double x, double) {
  return std::cos(2 * std::numbers::pi * x / 32) - 0.2;
}

TEST(NeighbourCode, CountsNothingForPredictionsOfIndependentVoxels) {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  const auto count = static_cast<double>(n * n);
  const std::vector<float> white = white_noise(n * n, 3), grained = grained_noise(grid, 3);
  NeighbourCode of_white(white, grid, {}, 1e-3), of_grained(grained, grid, {}, 1e-3);
  EXPECT_NEAR(of_white.fit({}), 2 * std::log(count), 0.03 * count);
  EXPECT_LT(of_white.predicted(0), 0.01);
  // A Gaussian of deviation s makes neighbours alike by exp(-1 / (4 s^2)) = .84: r along both axes, r^2 across.
  const double r = std::exp(-0.25 / (1.2 * 1.2)), left = 1 - 2 * r * r / (1 + r * r);
  EXPECT_NEAR(of_grained.fit({}), 0.5 * count * std::log(left), 0.1 * count);
  EXPECT_NEAR(of_grained.predicted(0), 1 - left, 0.03);
}

TEST(NeighbourCode, LeavesOutWhatTheMaskDoes) {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  std::vector<float> values = grained_noise(grid, 3);
  std::vector<std::uint8_t> mask(values.size(), 1);
  for (std::size_t i = 0; i < 10 * n; ++i) mask[i] = 0;
  NeighbourCode before(values, grid, mask, 1e-3);
  const double price = before.fit({});
  for (std::size_t i = 0; i < 10 * n; ++i) values[i] = 1000;
  NeighbourCode after(values, grid, mask, 1e-3);
  EXPECT_EQ(after.fit({}), price);
}

TEST(Textures, OfEqualMeansAndDeviationsAreToldApart) {
  for (const auto& distance : {disc, bars}) {
    const Phantom phantom = two_textures(distance);
    const Segmentation<2> found = segment<2>(phantom.image);
    const double same = dice(found.labels, phantom.truth);
    std::vector<std::uint8_t> others = phantom.truth;
    for (std::uint8_t& label : others) label = 1 - label;
    EXPECT_GT(std::max(same, dice(found.labels, others)), 0.95);
    ASSERT_TRUE(found.report.textures);
    const std::size_t grained = same > 0.5 ? 1 : 0;
    EXPECT_GT((*found.report.textures)[grained], 0.6);
    EXPECT_LT((*found.report.textures)[1 - grained], 0.1);
    EXPECT_TRUE(found.report.warnings.empty());
    expect_falling_energy(found);
  }
}

TEST(Textures, AreNotSoughtWhereIntensitiesTell) {
  // Noise with a grain on regions of two means; sharp and blurred edges, which neighbours predict.
  Phantom phantom = make_phantom(n, disc, 3, 10);
  EXPECT_FALSE(segment<2>(phantom.image).report.textures);
  const std::vector<float> grained = grained_noise(phantom.image.grid, 4);
  for (std::size_t i = 0; i < grained.size(); ++i) phantom.image.values[i] += 40 * grained[i];
  const Segmentation<2> found = segment<2>(phantom.image);
  EXPECT_FALSE(found.report.textures);
  EXPECT_GT(dice(found.labels, phantom.truth), 0.95);
}

TEST(Textures, AreNoneInHeavyTailsAndLight) {
  // Few large values gather by chance, and light that no polynomial follows is alike for all neighbours.
  std::mt19937 generator(5);
  std::student_t_distribution<double> heavy(2.5);
  std::normal_distribution<double> normal(0, 1);
  Phantom phantom = make_phantom(
      n, [](double x, double y) { return 6 - std::hypot(x, y); }, 2, 0);
  for (float& value : phantom.image.values) value += static_cast<float>(170 * heavy(generator));
  EXPECT_FALSE(segment<2>(phantom.image).report.textures);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x)
      phantom.image.values[x + n * y] = static_cast<float>(
          100 * std::exp(-std::hypot(static_cast<double>(x) - 30, static_cast<double>(y) - 50) / 20) +
          normal(generator));
  EXPECT_FALSE(segment<2>(phantom.image).report.textures);
}

TEST(Textures, AreNoneInNoiseOfOneGrain) {
  Phantom phantom = make_phantom(n, disc, 1, 0);
  phantom.image.values = grained_noise(phantom.image.grid, 6);
  EXPECT_FALSE(segment<2>(phantom.image).report.textures);
}

}  // namespace
}  // namespace csrbf::texture_partition_test
