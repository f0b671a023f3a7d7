#include "levelset/segment_testing.hpp"
#include "levelset/speckle_testing.hpp"

namespace csrbf {
namespace {

TEST(SegmentSpeckle, UndoesTheBlurOfSpeckle) {
  const Phantom phantom = make_speckle(200, cavity, 0.02, 0, {1.6, 1.1, 0});
  const auto found = segment<2>(phantom.image, {.energy = SegmentEnergy::generalized_gaussian});
  ASSERT_TRUE(found.report.speckle);
  // With laws of whole regions the contour moves into the darker one.
  const auto drawn = segment<2>(phantom.image, {.energy = SegmentEnergy::gaussian});
  EXPECT_FALSE(drawn.report.speckle);
  const double missed = 1 - dice(found.labels, phantom.truth);
  EXPECT_LT(missed, 0.012);
  EXPECT_LT(missed, 0.6 * (1 - dice(drawn.labels, phantom.truth)));
  for (std::size_t i = 1; i < found.report.energy.size(); ++i)
    EXPECT_LE(found.report.energy[i], found.report.energy[i - 1]);
  const auto near = segment<2>(phantom.image, {.energy = SegmentEnergy::generalized_gaussian, .center_spacing = 4.0});
  EXPECT_EQ(*near.report.options.center_spacing, 4);  // as given
  const Phantom other = make_phantom(200, cavity, 1, 30);
  EXPECT_FALSE(segment<2>(other.image, {.energy = SegmentEnergy::generalized_gaussian}).report.speckle);
}

TEST(SegmentSpeckle, SeesSpeckleWhenNoEnergyIsGiven) {
  const Phantom phantom = make_speckle(200, cavity, 0.02, 0, {1.6, 1.1, 0});
  const auto found = segment<2>(phantom.image);
  EXPECT_TRUE(found.report.speckle);
  EXPECT_GT(found.report.grain.value_or(1), 4);
  EXPECT_GT(dice(found.labels, phantom.truth), 0.985);
  EXPECT_FALSE(segment<2>(make_phantom(200, cavity, 1, 30).image).report.speckle);
}

}  // namespace
}  // namespace csrbf
