#include "core/error_testing.hpp"
#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

// Elsewhere the contour stays where it is.
TEST(SegmentHoles, AreFilledWithEveryEnergy) {
  const Phantom phantom = make_phantom(201, islands, 2, 7.5);
  std::vector<std::uint8_t> whole = phantom.truth;
  fill_enclosed(whole, phantom.image.grid);
  const Segmentation<2> plain = segment<2>(phantom.image);
  const double area = image_contour(*plain.fields[0], phantom.image.grid).lines.area;
  for (const SegmentEnergy energy : {SegmentEnergy::automatic, SegmentEnergy::chan_vese, SegmentEnergy::gaussian}) {
    SegmentOptions options;
    options.energy = energy;
    options.fill_holes = true;
    const Segmentation<2> filled = segment<2>(phantom.image, options);
    EXPECT_GT(dice(filled.labels, whole), 0.9965);
    const double hole = std::numbers::pi * 14 * 14;
    EXPECT_NEAR(image_contour(*filled.fields[0], phantom.image.grid).lines.area, area + hole,
                25);  // 0.3 along the hole
  }
  SegmentOptions more;
  more.fill_holes = true;
  more.regions = 3;
  EXPECT_NE(invalid_input_message([&] { segment<2>(phantom.image, more); }).find("fill_holes"), std::string::npos);
}

// A ring: its hole is a hole for all that nobody said, and background where a seed says so.
TEST(SegmentHoles, WithASeedOfTheBackgroundStay) {
  const Phantom phantom = make_phantom(
      97, [](double x, double y) { return std::min(36 - std::hypot(x, y), std::hypot(x, y) - 10); }, 2, 7.5);
  const Index n = 97, middle = n / 2;
  SegmentOptions options;
  options.fill_holes = true;
  options.seeds.assign(phantom.truth.size(), 0);
  for (Index y = middle - 2; y <= middle + 2; ++y)
    for (Index x = -2; x <= 2; ++x) {
      options.seeds[y * n + middle + x] = 1;
      options.seeds[y * n + middle - 24 + x] = 2;
    }
  for (const SegmentMode mode : {SegmentMode::global, SegmentMode::local})
    for (const SegmentEnergy energy : {SegmentEnergy::automatic, SegmentEnergy::chan_vese, SegmentEnergy::gaussian}) {
      options.mode = mode;
      options.energy = energy;
      EXPECT_GT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.97)
          << static_cast<int>(mode) << static_cast<int>(energy);
    }
}

}  // namespace
}  // namespace csrbf
