#include "levelset/segment_testing.hpp"

namespace csrbf::segment_local_test {
namespace {

constexpr Index n = 128;

double disc(double x, double y) {
  return 20 - std::hypot(x + 4, y);
}

Segmentation<2> start_from(const Phantom& phantom, double radius) {
  SegmentOptions options;
  options.mode = SegmentMode::local;
  options.seed = disc_seed(n, -4, 0, radius);
  return segment<2>(phantom.image, options);
}

TEST(SegmentLocally, StaysAtTheTruthAndComesBackFromAStartThatIsTooLarge) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    const Phantom phantom = make_phantom(n, disc, 0.3, 34, seed);
    for (const double radius : {10.0, 20.0, 26.0})
      EXPECT_GT(dice(start_from(phantom, radius).labels, phantom.truth), 0.985) << radius << " " << seed;
  }
}

TEST(SegmentLocally, FindsADiscFromOneVoxel) {
  for (unsigned seed = 1; seed < 7; ++seed) {
    const Phantom phantom = make_phantom(n, disc, 0.3, 60, seed);
    SegmentOptions options;
    options.mode = SegmentMode::local;
    options.seeds.assign(static_cast<std::size_t>(n * n), 0);
    options.seeds[60 + n * 64] = 2;
    EXPECT_GT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.95) << seed;
  }
}

// Centres as far apart as the noise asks for would be too coarse.
TEST(SegmentLocally, FindsSmallDiscs) {
  const auto small = [](double x, double y) { return 6 - std::hypot(x + 4, y); };
  for (unsigned seed = 1; seed < 4; ++seed) {
    const Phantom phantom = make_phantom(n, small, 0.3, 34, seed);
    for (const double radius : {3.0, 6.0, 8.0})
      EXPECT_GT(dice(start_from(phantom, radius).labels, phantom.truth), 0.95) << radius << " " << seed;
  }
}

// Through which nothing else would lead to the other half of the disc.
TEST(SegmentLocally, StaysOnItsSideOfAMask) {
  for (const double noise : {17.0, 68.0}) {
    const Phantom phantom = make_phantom(n, disc, 0.3, noise);
    for (const Index wall : {3, 6, 12}) {
      SegmentOptions options;
      options.mode = SegmentMode::local;
      options.mask.assign(static_cast<std::size_t>(n * n), 1);
      std::vector<std::uint8_t> left = phantom.truth;
      for (Index i = 0; i < n * n; ++i) {
        if (i % n >= 62 && i % n < 62 + wall) options.mask[i] = 0;
        if (i % n >= 62) left[i] = 0;
      }
      options.seed = disc_seed(n, -12, 0, 4);
      EXPECT_GT(dice(segment<2>(phantom.image, options).labels, left), 0.95) << noise << " " << wall;
      options.seed = {};
      options.seeds.assign(static_cast<std::size_t>(n * n), 0);
      options.seeds[60 + n * 64] = 2;
      EXPECT_GT(dice(segment<2>(phantom.image, options).labels, left), 0.95) << noise << " " << wall;
    }
  }
}

}  // namespace
}  // namespace csrbf::segment_local_test
