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

// A neighbour of nearly the same intensity, on a dark background: two means take both for one.
TEST(SegmentLocally, StopsAtANeighbourThatDiffersLittle) {
  constexpr Index m = 40;
  VolumeLayout layout;
  layout.grid.size = {m, m, m};
  Volume<float> image(layout);
  std::vector<std::uint8_t> truth(image.values.size());
  std::mt19937 generator(7);
  std::normal_distribution<double> normal(0, 8);
  SegmentOptions options;
  options.mode = SegmentMode::local;
  options.seed.assign(truth.size(), 0);
  for (Index i = 0; i < image.grid.voxels(); ++i) {
    const auto x = static_cast<double>(i % m), y = static_cast<double>(i / m % m), z = static_cast<double>(i / m / m);
    const double here = std::hypot(x - 13, y - 20, z - 20), beside = std::hypot(x - 29, y - 20, z - 20);
    const auto k = static_cast<std::size_t>(i);
    truth[k] = here < 9 ? 1 : 0;
    options.seed[k] = here < 2 ? 1 : 0;
    image.values[k] = static_cast<float>((here < 9 ? 100 : beside < 10 ? 122 : 30) + normal(generator));
  }
  EXPECT_GT(dice(segment<3>(image, options).labels, truth), 0.95);
}

// Which of the two is wanted cannot be known.
TEST(SegmentLocally, SaysWhatWasLeftOpen) {
  const auto dumbbell = [](double x, double y) {
    return std::max(
        {20 - std::hypot(x + 30, y), 20 - std::hypot(x - 30, y), std::min(3 - std::abs(y), 30 - std::abs(x))});
  };
  const Phantom phantom = make_phantom(n, dumbbell, 1, 8);
  SegmentOptions options;
  options.mode = SegmentMode::local;
  options.seed = disc_seed(n, -30, 0, 6);
  const Segmentation<2> cut = segment<2>(phantom.image, options);
  ASSERT_EQ(cut.report.warnings.size(), 1);
  EXPECT_NE(cut.report.warnings[0].find("neck"), std::string::npos);
  EXPECT_EQ(cut.labels[94 + n * 64], 0);
  SegmentOptions beside = options;
  beside.seeds = disc_seed(n, 30, 0, 6);
  for (std::uint8_t& label : beside.seeds) label *= 2;
  EXPECT_GT(dice(segment<2>(phantom.image, beside).labels, phantom.truth), 0.97);
  // A core of 150 within a rim of 210 on 40.
  Phantom cored = make_phantom(
      n, [](double x, double y) { return 30 - std::hypot(x, y); }, 1, 4);
  for (Index i = 0; i < n * n; ++i)
    if (std::hypot(static_cast<double>(i % n) - 63.5, static_cast<double>(i / n) - 63.5) < 22)
      cored.image.values[static_cast<std::size_t>(i)] -= 60;
  options.seed = disc_seed(n, 0, 0, 6);
  const Segmentation<2> both = segment<2>(cored.image, options);
  ASSERT_EQ(both.report.warnings.size(), 1);
  EXPECT_NE(both.report.warnings[0].find("rim"), std::string::npos);
  EXPECT_GT(dice(both.labels, cored.truth), 0.97);
  options.seeds = disc_seed(n, 26, 0, 2);  // of the background
  std::vector<std::uint8_t> core(cored.truth.size(), 0);
  for (Index i = 0; i < n * n; ++i)
    core[static_cast<std::size_t>(i)] =
        std::hypot(static_cast<double>(i % n) - 63.5, static_cast<double>(i / n) - 63.5) < 22 ? 1 : 0;
  EXPECT_GT(dice(segment<2>(cored.image, options).labels, core), 0.97);
}

}  // namespace
}  // namespace csrbf::segment_local_test
