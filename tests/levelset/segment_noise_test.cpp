#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "levelset/segment_testing.hpp"

#include <algorithm>

namespace csrbf {
namespace {

double disc(double x, double y) {
  return 30 - std::hypot(x + 8, y - 5);
}

// A number of photons in each voxel, in any unit.
void count_photons(Phantom& phantom, double mean, double unit) {
  std::mt19937 random(5);
  for (float& value : phantom.image.values) {
    std::poisson_distribution<int> photons(mean * static_cast<double>(value) / 125);
    value = static_cast<float>(unit * photons(random));
  }
}

TEST(SegmentNoise, OfFewPhotonsIsNoPeak) {
  for (const double unit : {1.0, 455.3, 1e-6}) {
    Phantom phantom = make_phantom(120, disc, 1, 0);
    count_photons(phantom, 1.5, unit);
    EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.97) << unit;
  }
}

TEST(SegmentNoise, ThatGrowsUnderLightThatVariesSmoothly) {
  Phantom phantom = make_phantom(80, disc, 1, 0);
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0, 1);
  for (Index y = 0; y < 80; ++y)
    for (Index x = 0; x < 80; ++x) {
      float& value = phantom.image.values[x + 80 * y];
      const double light = 1.5 + std::sin(0.09 * static_cast<double>(x)) * std::cos(0.07 * static_cast<double>(y));
      value = static_cast<float>(light * static_cast<double>(value) * (1 + 0.05 * normal(random)));
    }
  EXPECT_GT(dice(segment<2>(phantom.image, {.shading = Shading::smooth}).labels, phantom.truth), 0.9);
}

TEST(SegmentNoise, ThatIsAllThereIsGivesAWarning) {
  Phantom phantom = make_phantom(
      100, [](double, double) { return -1.0; }, 1, 20);
  const auto nothing = segment<2>(phantom.image).report.warnings;
  ASSERT_EQ(nothing.size(), 1);
  EXPECT_NE(nothing[0].find("may be noise"), std::string::npos);
  EXPECT_TRUE(segment<2>(make_phantom(100, disc, 1, 150).image).report.warnings.empty());
  EXPECT_TRUE(segment<2>(make_phantom(100, disc, 1, 0).image).report.warnings.empty());  // its background is a peak
  SegmentOptions marked;
  marked.seeds.assign(10000, 0);
  marked.seeds[20] = 1;
  marked.seeds[5050] = 2;
  EXPECT_TRUE(segment<2>(phantom.image, marked).report.warnings.empty());
}

// Dots below the size of the grain: hardly anything is left of them in CSRBFs.
TEST(SegmentNoise, WithGrainAndDotsFailsInNoWay) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    Phantom phantom = make_phantom(
        90, [](double x, double y) { return 1.3 - std::hypot(std::remainder(x, 29.0), std::remainder(y, 31.0)); }, 0.3,
        0, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    std::vector<double> noise(phantom.image.values.size());
    for (double& each : noise) each = normal(random);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      double sum = 0;
      for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 4; ++x) sum += noise[(i + x + 90 * y) % noise.size()];
      phantom.image.values[i] += static_cast<float>(4 * sum + 3 * static_cast<double>(i / 90));
    }
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(*std::max_element(found.labels.begin(), found.labels.end()), 0);
    EXPECT_GT(*found.report.options.smoothness, 0);
  }
}

// Three discs in a small image.
double few_discs(double x, double y) {
  return std::max({6 - std::hypot(x + 9, y + 8), 7 - std::hypot(x - 8, y + 3), 6 - std::hypot(x - 1, y - 12)});
}

TEST(SegmentNoise, AsStrongAsTheContrastLeavesObjects) {
  for (unsigned seed = 1; seed < 13; ++seed) {
    const Phantom phantom = make_phantom(40, few_discs, 0.3, 170, seed);
    EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.6) << seed;
  }
}

// Contours cost more than they tell, in light or not: what is warned of is still of some use.
TEST(SegmentNoise, AsStrongAsTheContrastLeavesARing) {
  for (const double slope : {0.0, 8.0}) {
    int found = 0;
    for (unsigned seed = 1; seed < 13; ++seed) {
      Phantom phantom = make_phantom(
          40, [](double x, double y) { return 3 - std::abs(std::hypot(x, y) - 10); }, 0.3, slope == 0 ? 190 : 150,
          seed);
      for (std::size_t i = 0; i < phantom.image.values.size(); ++i)
        phantom.image.values[i] += static_cast<float>(slope * static_cast<double>(i % 40));
      found += dice(segment<2>(phantom.image).labels, phantom.truth) > 0.5 ? 1 : 0;
    }
    EXPECT_GE(found, slope == 0 ? 10 : 9) << slope;  // light may leave both regions as much of the border
  }
}

TEST(SegmentNoise, BlurOfASmallImageIsNoGrain) {
  const Phantom phantom = make_phantom(40, few_discs, 4, 0);
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.85);
}

// Whose single voxels say little of where the border is.
TEST(SegmentNoise, OfBlurredDiscsMovesNoBorder) {
  const auto discs = [](double x, double y) {
    const auto off = [](double t) { return t - 16 * std::round(t / 16); };
    return 6 - std::hypot(off(x), off(y));
  };
  for (unsigned seed = 1; seed < 6; ++seed) {
    const Phantom phantom = make_phantom(80, discs, 1.7, 42, seed);
    EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.96) << seed;
  }
}

// Short contours lie inside of what is convex, in space by twice as much as in the plane.
TEST(SegmentNoise, MakesNoBodyInSpaceSmaller) {
  for (unsigned seed = 5; seed < 7; ++seed) {
    VolumeLayout layout;
    layout.grid.size = {32, 32, 32};
    const TestImage body = two_level_image(
        layout.grid, [](const Point<3>& p) { return 8 - (p - Point<3>(16, 15, 16)).norm(); }, 1, 0, 0);
    Volume<float> image(layout);
    image.values = body.values;
    gaussian_blur(image.values, layout.grid.size, {0.5, 0.5, 0.5});
    std::mt19937 random(seed);
    std::normal_distribution<float> normal(0, 0.6F);
    for (float& value : image.values) value += normal(random);
    const std::vector<std::uint8_t> labels = segment<3>(image).labels;
    const auto volume = [](const std::vector<std::uint8_t>& of) {
      return static_cast<double>(std::count(of.begin(), of.end(), std::uint8_t{1}));
    };
    EXPECT_NEAR(volume(labels) / volume(body.truth), 1, 0.05) << seed;
    EXPECT_GT(dice(labels, body.truth), 0.95) << seed;
  }
}

// Some are bright, some dim: what labels of fewer of them leave looks like a coarser grain, round after round.
TEST(SegmentNoise, OfDenseObjectsIsNoGrain) {
  constexpr Index cells = 12, pitch = 11, size = cells * pitch;
  for (unsigned seed = 1; seed < 3; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(0, 1);
    std::normal_distribution<double> normal(0, 4);
    Phantom phantom = make_phantom(
        size, [](double, double) { return -1.0; }, 1, 0);
    std::vector<std::uint8_t> truth(phantom.truth.size(), 0);
    std::vector<double> light(truth.size(), 0);
    for (Index cell = 0; cell < cells * cells; ++cell) {
      const double x = static_cast<double>(cell % cells * pitch) + 2 + 7 * any(random);
      const double y = static_cast<double>(cell / cells * pitch) + 2 + 7 * any(random);
      const double brightness = 40 + 60 * any(random), radius = 4 + 1.5 * any(random);
      for (Index i = 0; i < size * size; ++i) {
        const double depth = radius - std::hypot(static_cast<double>(i % size) - x, static_cast<double>(i / size) - y);
        if (depth > 0) truth[i] = 1;
        light[i] = std::max(light[i], brightness * std::clamp(0.35 * depth + 0.5, 0.0, 1.0) *
                                          (0.75 + 0.25 * std::clamp(depth / radius, 0.0, 1.0)));
      }
    }
    for (std::size_t i = 0; i < light.size(); ++i)
      phantom.image.values[i] = static_cast<float>(20 + light[i] + normal(random));
    EXPECT_GT(dice(segment<2>(phantom.image).labels, truth), 0.85) << seed;
  }
}

}  // namespace
}  // namespace csrbf
