#include "csrbf/levelset/disturbances/region_levels.hpp"

#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

bool tells_levels(const Segmentation<2>& found) {
  for (const std::string& warning : found.report.warnings)
    if (warning.find("more than two levels") != std::string::npos) return true;
  return false;
}

double disc(double x, double y, double radius) {
  return radius - std::hypot(x, y);
}

// A disc with the values `ring` and `core`, on 40.
Phantom rings(double ring, double core, double noise) {
  Phantom phantom = make_phantom(
      96, [](double x, double y) { return disc(x, y, 35); }, 1, noise);
  for (Index y = 0; y < 96; ++y)
    for (Index x = 0; x < 96; ++x) {
      const auto i = static_cast<std::size_t>(x + 96 * y);
      const double inner = disc(static_cast<double>(x) - 42, static_cast<double>(y) - 50, 18);
      if (phantom.truth[i] != 0) phantom.image.values[i] += static_cast<float>((inner > 0 ? core : ring) - 210);
    }
  return phantom;
}

TEST(RegionLevels, AreToldOfTwoRegionsThatHideThem) {
  for (const double noise : {2.0, 30.0}) {
    const Segmentation<2> three = segment<2>(rings(140, 240, noise).image);
    ASSERT_TRUE(tells_levels(three)) << noise;
    EXPECT_NE(three.report.warnings[0].find("give 3"), std::string::npos) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(rings(210, 210, noise).image))) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(rings(140, 240, noise).image, {.regions = 3}))) << noise;
  }
}

// Stripes of the levels, the first `dark` of which have label 0, in some noise.
std::string warning_of(const std::vector<double>& levels, std::size_t dark, double offset) {
  constexpr Index size = 96;
  const Grid grid{.axes = 2, .size = {size, size, 1}};
  std::vector<float> values;
  std::vector<std::uint8_t> labels;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(offset, 3);
  for (Index y = 0; y < size; ++y)
    for (Index x = 0; x < size; ++x) {
      const auto k = static_cast<std::size_t>(x) * levels.size() / size;
      values.push_back(static_cast<float>(levels[k] + noise(random)));
      labels.push_back(k < dark ? 0 : 1);
    }
  std::vector<std::string> warnings;
  warn_of_levels(values, labels, grid, {}, {contour_weight(grid, 3), 1}, warnings);
  return warnings.empty() ? "" : warnings.front();
}

TEST(RegionLevels, CountsALevelOfBothRegionsOnce) {
  const std::string both = warning_of({20, 100, 100, 180}, 2, 0);
  EXPECT_NE(both.find("label 0"), std::string::npos) << both;
  EXPECT_NE(both.find("label 1"), std::string::npos) << both;
  EXPECT_NE(both.find("give 3"), std::string::npos) << both;
  EXPECT_NE(warning_of({20, 80, 140, 200}, 2, 0).find("give 4"), std::string::npos);
  EXPECT_EQ(warning_of({20, 20, 180, 180}, 2, 0), "");
}

TEST(RegionLevels, HaveTheDigitsThatTellThemApart) {
  const std::string far = warning_of({20, 140, 240}, 1, 10000);
  EXPECT_NE(far.find("levels of 10140 and 10240"), std::string::npos) << far;
}

// Neither light nor objects of varied brightness nor blurred borders are levels.
TEST(RegionLevels, AreNoneOfWhatVaries) {
  const auto many = [](double x, double y) { return 9 - std::hypot(std::remainder(x, 30), std::remainder(y, 30)); };
  for (const double noise : {2.0, 20.0}) {
    Phantom light = make_phantom(100, many, 1, noise), varied = light;
    const Phantom blurred = make_phantom(100, many, 3, noise);
    for (Index y = 0; y < 100; ++y)
      for (Index x = 0; x < 100; ++x) {
        const auto i = static_cast<std::size_t>(x + 100 * y);
        light.image.values[i] *= static_cast<float>(0.5 + 0.01 * static_cast<double>(x));
        const double number =
            std::round((static_cast<double>(x) - 49.5) / 30) * 3 + std::round((static_cast<double>(y) - 49.5) / 30);
        if (varied.truth[i] != 0) varied.image.values[i] += static_cast<float>(10 * number);
      }
    EXPECT_FALSE(tells_levels(segment<2>(light.image))) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(varied.image))) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(blurred.image))) << noise;
  }
}

}  // namespace
}  // namespace csrbf
