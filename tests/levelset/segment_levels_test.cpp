#include "levelset/segment_testing.hpp"

namespace csrbf::segment_levels_test {
namespace {

// A body with something brighter in it, which two regions have no mean for.
TEST(SegmentLevels, OfWhatIsInABodyLeaveItWhole) {
  const auto body = [](double x, double y) { return 1 - std::hypot(x / 50, y / 38); };
  for (const double level : {0.3, 0.7, 1.0})  // of the contrast, above the body
    for (const double radius : {4.0, 6.0, 10.0}) {
      Phantom phantom = make_phantom(128, body, 0.01, 2.5);
      const std::vector<std::uint8_t> inner = disc_seed(128, 0, 21, radius);
      for (std::size_t i = 0; i < inner.size(); ++i)
        if (inner[i] != 0) phantom.image.values[i] += static_cast<float>(170 * level);
      EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.99) << level << " " << radius;
    }
}

}  // namespace
}  // namespace csrbf::segment_levels_test
