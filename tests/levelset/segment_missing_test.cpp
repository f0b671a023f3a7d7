#include "csrbf/levelset/frame/missing_voxels.hpp"
#include "levelset/segment_testing.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr Index side = 100;
constexpr float no_number = std::numeric_limits<float>::quiet_NaN();

double disc_inside(double x, double y) {
  return 25 - std::hypot(x + 15, y - 5);
}

// A disc in noise, whose right fifth has one value.
Phantom with_block(float value) {
  Phantom phantom = make_phantom(side, disc_inside, 1, 20);
  for (Index y = 0; y < side; ++y)
    for (Index x = 80; x < side; ++x) phantom.image.values[x + side * y] = value;
  return phantom;
}

bool says(const Segmentation<2>& found, const char* words) {
  for (const std::string& warning : found.report.warnings)
    if (warning.find(words) != std::string::npos) return true;
  return false;
}

TEST(SegmentMissing, BlocksOfAnExtremeValueAreLeftOut) {
  for (const float value : {-9999.0F, -1000.5F, 65535.0F, 1e30F, -3.4028235e38F}) {
    const Phantom phantom = with_block(value);
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(dice(found.labels, phantom.truth), 0.99) << value;
    EXPECT_TRUE(says(found, "20 % of the voxels")) << value;
    EXPECT_DOUBLE_EQ(found.report.missing.value_or(0), 0.2);
    EXPECT_EQ(found.report.options.missing, value);
  }
}

TEST(SegmentMissing, NegativeValuesAreLeftOutAnywhere) {
  for (const float value : {-9999.0F, -500.0F}) {
    Phantom phantom = make_phantom(side, disc_inside, 1, 20);
    std::mt19937 random(3);
    for (std::size_t i = 0; i < phantom.truth.size(); ++i) {
      phantom.image.values[i] = std::abs(phantom.image.values[i]);
      if (random() % 20 != 0) continue;
      phantom.image.values[i] = value;
      phantom.truth[i] = 0;
    }
    const Segmentation<2> found = segment<2>(phantom.image);
    EXPECT_GT(dice(found.labels, phantom.truth), 0.98) << value;
    EXPECT_NEAR(found.report.missing.value_or(0), 0.05, 0.01);
  }
  Phantom gas = make_phantom(side, disc_inside, 0.01, 20);  // holes of a value that others are near to
  for (std::size_t i = 0; i < gas.truth.size(); ++i)
    gas.image.values[i] = gas.truth[i] != 0 ? -1000.0F : gas.image.values[i] - 100;
  EXPECT_FALSE(find_missing_block(gas.image, {}));
}

TEST(SegmentMissing, BlocksAreNoRegionOfThree) {
  Phantom phantom = with_block(-9999);
  for (Index y = 0; y < side; ++y)
    for (Index x = 0; x < 15; ++x) {
      phantom.image.values[x + side * y] += 400;
      phantom.truth[x + side * y] = 2;
    }
  EXPECT_GT(dice(segment<2>(phantom.image, {.regions = 3}).labels, phantom.truth), 0.98);
}

TEST(SegmentMissing, BlocksThatMayBeThingsAreNamed) {
  const Segmentation<2> means = segment<2>(with_block(-9999).image, {.energy = SegmentEnergy::chan_vese});
  EXPECT_TRUE(says(means, "label 1 is 20 % of the voxels"));
  EXPECT_FALSE(means.report.missing);
  // A body without regions of its own, and what surrounds it.
  Phantom phantom = make_phantom(side, disc_inside, 0.01, 5);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    if (phantom.truth[i] == 0) phantom.image.values[i] = -500;
  const Segmentation<2> body = segment<2>(phantom.image);
  EXPECT_EQ(body.labels, phantom.truth);
  EXPECT_TRUE(says(body, "label 0 is "));
}

TEST(SegmentMissing, ThingsThatAreAsBrightAsCanBeAreNone) {
  Phantom phantom = make_phantom(side, disc_inside, 0.01, 2);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    if (phantom.truth[i] != 0) phantom.image.values[i] = 4095;
  EXPECT_FALSE(find_missing_block(phantom.image, {}));  // away from the border
  EXPECT_TRUE(find_missing_block(with_block(-9999).image, {}));
  EXPECT_FALSE(find_missing_block(with_block(-20).image, {}));  // near to others
  for (const float value : {0.0F, 1.0F, 255.0F}) {
    Phantom dark = with_block(value);
    for (float& each : dark.image.values)
      if (each != value) each += 5000;
    const std::optional<MissingBlock> block = find_missing_block(dark.image, {});
    ASSERT_TRUE(block);
    EXPECT_TRUE(block->may_be_dark_or_bright);
  }
  Phantom lines = make_phantom(side, disc_inside, 1, 2);
  for (Index i = 0; i < side * side; i += 7) lines.image.values[i] = 9999;
  EXPECT_FALSE(find_missing_block(lines.image, {}));  // thin
}

TEST(SegmentMissing, ValuesThatAreGivenAndNotNumbersAreLeftOut) {
  Phantom phantom = with_block(120);
  for (std::size_t i = 3; i < phantom.truth.size(); i += 50) phantom.image.values[i] = no_number;
  for (std::size_t i = 3; i < phantom.truth.size(); i += 50) phantom.truth[i] = 0;
  const Segmentation<2> found = segment<2>(phantom.image, {.missing = 120});
  EXPECT_GT(dice(found.labels, phantom.truth), 0.99);
  EXPECT_NEAR(found.report.missing.value_or(0), 0.22, 1e-9);
  const Segmentation<2> kept = segment<2>(with_block(-9999).image, {.missing = no_number});
  EXPECT_LT(dice(kept.labels, phantom.truth), 0.5);
  EXPECT_FALSE(kept.report.missing);
  EXPECT_TRUE(kept.report.warnings.empty());
  EXPECT_THROW((void)segment<2>(phantom.image, {.missing = 120, .iterations = 0}), InvalidInput);
}

TEST(SegmentMissing, ColoursAreMissingWhereAllComponentsAre) {
  const Phantom phantom = with_block(0);
  VolumeLayout layout;
  layout.grid = phantom.image.grid;
  layout.components = 3;
  Volume<float> image(layout);
  for (std::size_t i = 0; i < phantom.truth.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) image.values[3 * i + c] = std::max(0.0F, phantom.image.values[i]);
  image.values[0] = 0;
  const Segmentation<2> found = segment<2>(image, {.missing = 0});
  EXPECT_GT(dice(found.labels, phantom.truth), 0.99);
  EXPECT_NEAR(found.report.missing.value_or(0), 0.2, 0.02);
}

}  // namespace
}  // namespace csrbf
