#include "csrbf/levelset/image/common_background.hpp"
#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf::segment_background_test {
namespace {

constexpr Index side = 192;

// Discs of radius 9, one in each square of a lattice.
double cells(double x, double y) {
  const auto off = [](double c) { return c - 40 * std::round(c / 40); };
  return 9 - std::hypot(off(x), off(y));
}

// A background that varies over about a sixth of the side, as much as the discs.
std::vector<float> background(double strength, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal(0, 1);
  std::vector<float> values(side * side);
  for (float& value : values) value = normal(generator);
  constexpr double width = 12;
  gaussian_blur(values, {side, side, 1}, {width, width, 0});
  double squares = 0;
  for (const float value : values) squares += static_cast<double>(value) * static_cast<double>(value);
  const double factor = strength / std::sqrt(squares / static_cast<double>(values.size()));
  for (float& value : values) value *= static_cast<float>(factor);
  return values;
}

TEST(SegmentBackground, AsStrongAsObjectsIsAdded) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    Phantom phantom = make_phantom(side, cells, 1.5, 12, seed);
    const std::vector<float> light = background(60, seed);
    for (std::size_t i = 0; i < light.size(); ++i) phantom.image.values[i] += light[i];
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(dice(found.labels, phantom.truth), 0.98) << seed;
    EXPECT_GE(found.report.options.shading, Shading::smooth) << seed;  // which is as short
  }
}

// Light alone is one region.
TEST(SegmentBackground, WithoutObjectsIsTold) {
  for (unsigned seed = 1; seed < 3; ++seed) {
    Phantom phantom = make_phantom(
        side, [](double, double) { return -100.0; }, 1.5, 6, seed);
    const std::vector<float> light = background(40, seed);
    for (std::size_t i = 0; i < light.size(); ++i) phantom.image.values[i] += light[i];
    const std::vector<std::string> warnings = segment<2>(phantom.image).report.warnings;
    ASSERT_EQ(warnings.size(), 1) << seed;
    EXPECT_NE(warnings[0].find("may be noise"), std::string::npos);
  }
}

TEST(SegmentBackground, IsNotWhatObjectsOfDifferentMeansLeave) {
  Phantom phantom = make_phantom(side, cells, 1.5, 0);
  for (Index y = 0; y < side; ++y)
    for (Index x = 0; x < side; ++x) {
      float& value = phantom.image.values[x + side * y];
      const Index cell = (x + 24) / 40 + 7 * ((y + 24) / 40);
      value = 40 + (value - 40) * static_cast<float>(0.4 + 0.25 * static_cast<double>(cell * cell % 7)) +
              static_cast<float>(3 * std::sin(1.7 * static_cast<double>(x * y)));
    }
  const Segmentation<2> found = segment<2>(phantom.image);
  EXPECT_GT(dice(found.labels, phantom.truth), 0.95);
  EXPECT_EQ(found.report.options.shading, Shading::objects);
}

// Balls in a volume, half of them four times as bright as the others.
TEST(SegmentBackground, IsNotWhatLeavesDimObjectsOut) {
  VolumeLayout layout;
  layout.grid.size = {48, 48, 32};
  Volume<float> image(layout);
  std::vector<std::uint8_t> truth;
  std::mt19937 generator(1);
  std::normal_distribution<double> normal(0, 1);
  const auto off = [](Index c) { return static_cast<double>(c % 16 - 8); };
  for (Index i = 0; i < image.grid.voxels(); ++i) {
    const Index x = i % 48, y = i / 48 % 48, z = i / (48 * 48), ball = x / 16 + y / 16 + z / 16;
    const double depth = 5 - std::hypot(off(x), off(y), off(z)), strength = ball % 2 == 0 ? 100 : 25;
    image.values[i] = static_cast<float>(20 + strength * (0.5 + 0.5 * std::erf(depth / 1.2)) + 5 * normal(generator));
    truth.push_back(depth > 0 ? 1 : 0);
  }
  const Segmentation<3> found = segment<3>(image);
  EXPECT_GT(dice(found.labels, truth), 0.9);
  EXPECT_EQ(found.report.options.shading, Shading::objects);
}

// Discs .6 to 2.5 bright on a ramp of light: the means of others follow the ramp, but leave the dim ones out.
TEST(SegmentBackground, IsARampBesideObjectsOfVariedBrightness) {
  constexpr Index n = 96, cell = 14;
  for (const unsigned seed : {1U, 12U}) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal(0, 1);
    VolumeLayout layout;
    layout.grid.axes = 2;
    layout.grid.size = {n, n, 1};
    Volume<float> image(layout);
    std::vector<std::uint8_t> truth(n * n, 0);
    for (Index i = 0; i < n * n; ++i)
      image.values[i] = static_cast<float>(0.01 * static_cast<double>(i % n) + 0.005 * static_cast<double>(i / n) +
                                           0.3 * normal(generator));
    for (Index disc = 0; disc < 49; ++disc) {
      const double x = 5 + 4 * uniform(generator) + static_cast<double>(cell * (disc % 7));
      const double y = 5 + 4 * uniform(generator) + static_cast<double>(cell * (disc / 7));
      const double radius = 3 + 2 * uniform(generator), brightness = 0.6 + 1.9 * uniform(generator);
      for (Index i = 0; i < n * n; ++i)
        if (truth[i] == 0 && std::hypot(static_cast<double>(i % n) - x, static_cast<double>(i / n) - y) < radius) {
          image.values[i] += static_cast<float>(brightness);
          truth[i] = 1;
        }
    }
    const Segmentation<2> found = segment<2>(image);
    EXPECT_GT(dice(found.labels, truth), 0.97) << seed;
    EXPECT_EQ(found.report.options.shading, Shading::objects) << seed;
  }
}

TEST(SegmentBackground, IsForTheEnergyThatIsChosen) {
  const Phantom phantom = make_phantom(side, cells, 1.5, 12);
  EXPECT_EQ(segment<2>(phantom.image, {.shading = Shading::background}).report.options.shading, Shading::background);
  EXPECT_THROW((void)segment<2>(phantom.image, {.energy = SegmentEnergy::chan_vese, .shading = Shading::background}),
               InvalidInput);
  EXPECT_THROW((void)segment<2>(phantom.image, {.regions = 3, .shading = Shading::background}), InvalidInput);
}

TEST(MeansInBackground, AreTheLevelsAndTheRestIsCommon) {
  const Phantom phantom = make_phantom(side, cells, 0.01, 0);
  const std::vector<float> light = background(60, 9);
  std::vector<float> values(light.size());
  std::vector<std::uint8_t> mask(light.size(), 1);
  for (std::size_t i = 0; i < light.size(); ++i) {
    values[i] = light[i] + (phantom.truth[i] != 0 ? 210.0F : 40.0F);
    if (i % 11 == 0) {
      mask[i] = 0;
      values[i] = 1e4F;
    }
  }
  const Grid& grid = phantom.image.grid;
  const LocalMean narrow(grid, 0.025), wide(grid, 0.05);
  EXPECT_EQ(narrow.half_width, (std::array<Index, 3>{5, 5, 0}));
  EXPECT_NEAR(narrow.parameters / wide.parameters, 4, 0.01 + 4 * 0.05);
  std::vector<double> means{60, 190};
  const auto fields = means_in_background(values, phantom.truth, mask, grid, narrow, means);
  ASSERT_EQ(fields.size(), 2);
  double worst = 0;
  for (std::size_t i = 0; i < light.size(); ++i) {
    EXPECT_NEAR(fields[1][i] - fields[0][i], means[1] - means[0], 1e-3);
    const float mean = fields[phantom.truth[i]][i];
    if (mask[i] != 0) worst = std::max(worst, static_cast<double>(std::abs(values[i] - mean)));
  }
  EXPECT_NEAR(means[1] - means[0], 170, 10);
  EXPECT_LT(worst, 60);
}

// Most of the image and of its border are discs.
TEST(SegmentBackground, LiesBetweenDiscsThatCoverMoreThanIt) {
  const auto packed = [](double x, double y) {
    const auto off = [](double c) { return c - 20 * std::round(c / 20); };
    return 8.4 - std::hypot(off(x), off(y));
  };
  for (const float sign : {1.0F, -1.0F}) {
    Phantom phantom = make_phantom(133, packed, 1, 20);
    for (float& value : phantom.image.values) value *= sign;
    EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.97) << sign;
  }
}

// A straight border is convex on neither side.
TEST(SegmentBackground, IsTheLargerOfTwoHalves) {
  for (const float sign : {1.0F, -1.0F}) {
    Phantom phantom = make_phantom(
        100, [](double x, double) { return x - 35; }, 1, 20);
    for (float& value : phantom.image.values) value *= sign;
    const std::vector<std::uint8_t> labels = segment<2>(phantom.image).labels;
    EXPECT_LT(std::count(labels.begin(), labels.end(), 1), std::ssize(labels) / 2) << sign;
  }
}

}  // namespace
}  // namespace csrbf::segment_background_test
