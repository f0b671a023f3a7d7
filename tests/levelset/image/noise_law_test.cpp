#include "csrbf/levelset/image/noise_law.hpp"

#include "csrbf/levelset/segment.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

namespace csrbf::noise_law_test {
namespace {

// A disc of 200 on 20 with noise of variance(value).
TestImage disc_with_noise(const std::function<double(double)>& variance) {
  TestImage image = two_level_image(
      square_grid(200), [](const Point<3>& p) { return 60 - std::hypot(p[0] - 100, p[1] - 90); }, 200, 20, 0);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  for (float& x : image.values) x += static_cast<float>(std::sqrt(variance(static_cast<double>(x))) * normal(random));
  return image;
}

std::optional<NoiseLaw> measured(const TestImage& image, std::span<const std::uint8_t> mask = {}) {
  return noise_law(image.values, image.grid, image.truth, mask);
}

TEST(NoiseLaw, MeasuresTheNoiseOfPhotons) {
  const TestImage image = disc_with_noise([](double x) { return 0.5 * x; });
  const std::optional<NoiseLaw> law = measured(image);
  ASSERT_TRUE(law);
  EXPECT_LT(law->lo, 20);
  EXPECT_GT(law->hi, 200);
  const double slope = (law->variance - law->dark_variance) / (law->hi - law->lo);
  EXPECT_NEAR(law->dark_variance + slope * (20 - law->lo), 10, 2);
  EXPECT_NEAR(law->dark_variance + slope * (200 - law->lo), 100, 15);
}

TEST(NoiseLaw, IsNoneWhereNoiseIsEvenOrShrinks) {
  EXPECT_FALSE(measured(disc_with_noise([](double) { return 50; })));
  EXPECT_FALSE(measured(disc_with_noise([](double x) { return 110 - 0.5 * x; })));
}

// Borders of regions and what the mask leaves out say nothing of noise.
TEST(NoiseLaw, LooksWithinRegionsAndTheMask) {
  TestImage image = disc_with_noise([](double) { return 9; });
  std::vector<std::uint8_t> mask(image.values.size(), 1);
  for (std::size_t i = 0; i < 20000; ++i) {
    mask[i] = 0;
    image.values[i] += (i % 7 == 0 ? 1.0F : 0.0F) * image.values[i];
  }
  EXPECT_TRUE(measured(image));
  EXPECT_FALSE(measured(image, mask));
  const std::vector<std::uint8_t> none(image.values.size(), 0);
  EXPECT_FALSE(measured(image, none));
}

// Most of what is in small objects is near an edge, which a camera blurs.
TEST(NoiseLaw, IsNoneWhereObjectsAreSmall) {
  for (const auto& [radius, is_large] : {std::pair{3.0, false}, {9.0, true}}) {
    TestImage image = two_level_image(
        square_grid(200),
        [r = radius](const Point<3>& p) {
          return r - std::hypot(std::remainder(p[0] - 20, 40), std::remainder(p[1] - 20, 40));
        },
        200, 20, 0);
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, 1);
    for (float& x : image.values) x += static_cast<float>(std::sqrt(0.5 * static_cast<double>(x)) * normal(random));
    EXPECT_EQ(measured(image).has_value(), is_large) << radius;
  }
}

TEST(NoiseLaw, EvensOutTwoFifthsOfTheGrowth) {
  const NoiseLaw law{10, 110, 1, 16};
  const std::vector<float> values{10, 10.1F, 109.9F, 110, 109, 120, 0};
  const std::vector<float> even = even_noise(values, law);
  EXPECT_NEAR(even[0], 10, 1e-4);
  EXPECT_NEAR(even[3], 110, 1e-4);
  EXPECT_NEAR((even[1] - even[0]) / (even[3] - even[2]), std::pow(16, 0.2), 0.02);
  EXPECT_NEAR(even[5] - even[3], 10 * (even[3] - even[4]), 0.05);
  EXPECT_LT(even[6], 0);
}

TEST(NoiseLaw, IsToldBySegmentWhereNoiseGrows) {
  const auto growth = [](const TestImage& image) {
    VolumeLayout layout;
    layout.grid = image.grid;
    Volume<float> volume(layout);
    volume.values = image.values;
    const Segmentation<2> found = segment<2>(volume);
    Index wrong = 0;
    for (std::size_t i = 0; i < image.truth.size(); ++i) wrong += found.labels[i] != image.truth[i] ? 1 : 0;
    EXPECT_LT(wrong, 20);
    EXPECT_NEAR(found.report.regions[1].mean, 200, 1);  // in the unit of the image
    return found.report.noise_growth;
  };
  EXPECT_NEAR(growth(disc_with_noise([](double x) { return 0.5 * x; })).value_or(1), std::sqrt(10), 0.6);
  EXPECT_FALSE(growth(disc_with_noise([](double) { return 50; })));
}

}  // namespace
}  // namespace csrbf::noise_law_test
