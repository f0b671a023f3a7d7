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
    EXPECT_TRUE(tells_levels(three)) << noise;
    EXPECT_NE(three.report.warnings[0].find("give 3"), std::string::npos) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(rings(210, 210, noise).image))) << noise;
    EXPECT_FALSE(tells_levels(segment<2>(rings(140, 240, noise).image, {.regions = 3}))) << noise;
  }
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
