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

TEST(DrawnOver, IsLeftOutWithAWarning) {
  for (const float value : {255.0F, 0.0F}) {
    Phantom phantom = discs_in_noise();
    if (value == 0)
      for (float& each : phantom.image.values) each = 255 - each;
    draw(phantom, value);
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(dice(found.labels, phantom.truth), 0.95) << value;
    ASSERT_EQ(found.report.warnings.size(), 1) << value;
    EXPECT_NE(found.report.warnings[0].find("drawn over"), std::string::npos);
  }
}

TEST(DrawnOver, StaysIfMissingIsGiven) {
  Phantom phantom = discs_in_noise();
  draw(phantom, 255);
  EXPECT_TRUE(segment<2>(phantom.image, {.missing = std::numeric_limits<double>::quiet_NaN()}).report.warnings.empty());
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

// Hot voxels and text alone: what is left has no regions, and the text is what is found.
TEST(DrawnOver, IsTheImageWhereNothingElseIs) {
  Phantom phantom = make_phantom(
      drawn_side, [](double, double) { return -1.0; }, 1, 5);
  for (float& value : phantom.image.values) value = std::round(value);
  draw(phantom, 255);
  const Segmentation<2> found = segment<2>(phantom.image);
  EXPECT_TRUE(found.report.warnings.empty());
  EXPECT_EQ(found.labels[90 + drawn_side * 112], 1);
}

}  // namespace
}  // namespace csrbf
