#include "csrbf/levelset/disturbances/drawn_over.hpp"

#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

constexpr Index drawn_side = 120;

Phantom discs_in_noise() {
  const auto discs = [](double x, double y) {
    return std::max({14 - std::hypot(x + 14, y - 5), 11 - std::hypot(x - 20, y + 12), 9 - std::hypot(x - 12, y - 25)});
  };
  Phantom phantom = make_phantom(drawn_side, discs, 1, 20);
  for (float& value : phantom.image.values) value = std::round(std::clamp(0.5F * value, 1.0F, 254.0F));
  return phantom;
}

// A bar for the scale, and letters H, whose smooth edges are half as bright.
void draw(Phantom& phantom, float value) {
  const auto set = [&](Index x, Index y, float to) { phantom.image.values[x + drawn_side * y] = to; };
  for (Index x = 80; x < 112; ++x)
    for (Index y = 110; y < 114; ++y) set(x, y, value);
  for (Index letter = 0; letter < 6; ++letter)
    for (Index y = 4; y < 14; ++y) {
      const Index x = 5 + 9 * letter;
      for (const Index stroke : {x, x + 5}) {
        set(stroke, y, value);
        set(stroke + 1, y, 0.5F * (value + (value == 0 ? 235 : 20)));
      }
      for (Index i = 1; y == 9 && i < 5; ++i) set(x + i, y, value);
    }
}

TEST(DrawnOver, IsToldWhereItIsARegion) {
  for (const float value : {255.0F, 0.0F}) {
    Phantom phantom = make_phantom(
        drawn_side, [](double, double) { return -1.0; }, 1, 10);
    for (float& each : phantom.image.values) each = std::round(value == 0 ? 255 - each : each);
    draw(phantom, value);
    const std::vector<std::string> warnings = segment<2>(phantom.image).report.warnings;
    ASSERT_EQ(warnings.size(), 1) << value;
    EXPECT_NE(warnings[0].find("drawn over the picture"), std::string::npos);
    for (const double missing : {static_cast<double>(value), std::numeric_limits<double>::quiet_NaN()})
      for (const std::string& each : segment<2>(phantom.image, {.missing = missing}).report.warnings)
        EXPECT_EQ(each.find("drawn over"), std::string::npos);
  }
}

// Small things of the largest value are what is found, whatever they may be.
TEST(DrawnOver, KeepsWhatItMayBe) {
  Phantom beads = make_phantom(
      160,
      [](double x, double y) {
        return 1.6 - std::max(std::abs(std::remainder(x + 0.3 * y, 17.0)), std::abs(std::remainder(y, 13.0)));
      },
      0.1, 8);
  for (std::size_t i = 0; i < beads.truth.size(); ++i)
    beads.image.values[i] = beads.truth[i] != 0 ? 255.0F : std::round(std::min(beads.image.values[i], 200.0F));
  EXPECT_GT(dice(segment<2>(beads.image).labels, beads.truth), 0.98);
}

TEST(DrawnOver, IsNothingThatACameraSaw) {
  Phantom phantom = discs_in_noise();
  EXPECT_FALSE(find_drawn_over(phantom.image, {}));
  for (float& value : phantom.image.values) value = std::min(255.0F, 2.5F * value);  // saturated, with soft edges
  EXPECT_FALSE(find_drawn_over(phantom.image, {}));
  Phantom lines = make_phantom(
      drawn_side, [](double x, double) { return 1.5 - std::abs(std::remainder(x, 30.0)); }, 2, 2);
  for (float& value : lines.image.values) value = std::min(180.0F, value);
  EXPECT_FALSE(find_drawn_over(lines.image, {}));
}

// Thin things brighter than the camera can tell, in noise.
TEST(DrawnOver, IsNothingThatNoiseSaturates) {
  const auto bars = [](double x, double y) {
    return std::min(1.6 - std::abs(std::remainder(y, 24.0)), 12 - std::abs(std::remainder(x, 40.0)));
  };
  for (const float bright : {230.0F, 255.0F, 275.0F}) {
    Phantom phantom = make_phantom(drawn_side, bars, 0, 20);
    for (float& value : phantom.image.values) value = std::round(std::clamp(value * bright / 140, 0.0F, 255.0F));
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_TRUE(found.report.warnings.empty()) << bright;
    EXPECT_GT(dice(found.labels, phantom.truth), 0.95) << bright;
  }
}

}  // namespace
}  // namespace csrbf
