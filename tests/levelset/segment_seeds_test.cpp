#include "core/error_testing.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf::segment_seeds_test {
namespace {

constexpr Index n = 101;

// Two discs joined by a bridge.
double dumbbell(double x, double y) {
  const double discs = 20 - std::hypot(std::abs(x) - 25, y);
  return std::max(discs, std::min(4 - std::abs(y), 25 - std::abs(x)));
}

std::size_t at(double x, double y) {
  const double middle = 0.5 * static_cast<double>(n - 1);
  return static_cast<std::size_t>(std::lround(x + middle) + n * std::lround(y + middle));
}

void mark(std::vector<std::uint8_t>& seeds, double x, double y, double half, std::uint8_t number) {
  for (double v = y - half; v <= y + half; ++v)
    for (double u = x - half; u <= x + half; ++u) seeds[at(u, v)] = number;
}

double share_right_of(double x0, const std::vector<std::uint8_t>& labels) {
  double inside = 0, count = 0;
  for (double x = x0; x < 45; ++x)
    for (double y = -20; y <= 20; ++y) {
      if (dumbbell(x, y) < 2) continue;
      inside += labels[at(x, y)];
      count += 1;
    }
  return inside / count;
}

SegmentOptions with_seeds(SegmentMode mode) {
  SegmentOptions options;
  options.mode = mode;
  options.seeds.assign(static_cast<std::size_t>(n * n), 0);
  return options;
}

// A contour starts at the seeds inside and stops at those outside.
TEST(SegmentSeeds, StopAContourThatMoves) {
  const Phantom phantom = make_phantom(n, dumbbell, 1, 8);
  SegmentOptions options = with_seeds(SegmentMode::local);
  mark(options.seeds, -25, 0, 4, 2);
  SegmentOptions both = options;
  both.seeds[at(25, 0)] = 2;
  EXPECT_GT(share_right_of(10, segment<2>(phantom.image, both).labels), 0.95) << "nothing stops it";
  for (double y = -6; y <= 6; ++y) mark(options.seeds, 0, y, 1, 1);
  const Segmentation<2> stopped = segment<2>(phantom.image, options);
  EXPECT_EQ(share_right_of(10, stopped.labels), 0);
  EXPECT_GT(stopped.labels[at(-35, 5)], 0);
  for (std::size_t i = 0; i < options.seeds.size(); ++i)
    EXPECT_TRUE(options.seeds[i] == 0 || stopped.labels[i] == options.seeds[i] - 1) << i;
  // The start may also be given.
  options.seed = disc_seed(n, -25, 0, 5);
  for (std::uint8_t& each : options.seeds) each = each == 2 ? 0 : each;
  EXPECT_EQ(share_right_of(10, segment<2>(phantom.image, options).labels), 0);
}

TEST(SegmentSeeds, YieldToIntensitiesWhenTheyAreUncertain) {
  const Phantom phantom = make_phantom(n, dumbbell, 1, 8);
  for (const SegmentMode mode : {SegmentMode::local, SegmentMode::global}) {
    SegmentOptions options = with_seeds(mode);
    mark(options.seeds, -25, 0, 4, 2);
    mark(options.seeds, -45, -45, 2, 1);
    mark(options.seeds, -25, 9, 2, 1);  // wrong
    const std::size_t wrong = at(-25, 9);
    EXPECT_EQ(segment<2>(phantom.image, options).labels[wrong], 0);
    options.seed_confidence = 0.6;
    EXPECT_EQ(segment<2>(phantom.image, options).labels[wrong], 1);
    options.seed_confidences.assign(options.seeds.size(), 0.6F);
    options.seed_confidences[wrong] = 1;
    EXPECT_EQ(segment<2>(phantom.image, options).labels[wrong], 0) << "those of single seeds count";
  }
}

TEST(SegmentSeeds, SayWhichRegionIsWhichToEveryEnergy) {
  const Phantom phantom = make_phantom(n, dumbbell, 1, 8);
  SegmentOptions options = with_seeds(SegmentMode::global);
  mark(options.seeds, -25, 0, 2, 1);  // the bright one is label 0
  mark(options.seeds, -45, -45, 2, 2);
  std::vector<std::uint8_t> outside = phantom.truth;
  for (std::uint8_t& label : outside) label = 1 - label;
  for (const SegmentEnergy energy : {SegmentEnergy::automatic, SegmentEnergy::chan_vese, SegmentEnergy::gaussian}) {
    options.energy = energy;
    EXPECT_GT(dice(segment<2>(phantom.image, options).labels, outside), 0.99) << name_of(energy);
  }
}

// In strong noise a contour of means leaks from its start, one of variances does not.
TEST(SegmentSeeds, AreFollowedAsWellAsByTheBestEnergy) {
  const auto disc = [](double x, double y) { return 30 - std::hypot(x, y); };
  for (const double noise : {8.0, 250.0}) {
    const Phantom phantom = make_phantom(n, disc, 1, noise);
    SegmentOptions options;
    options.mode = SegmentMode::local;
    options.seed = disc_seed(n, 0, 0, 12);
    const Segmentation<2> chosen = segment<2>(phantom.image, options);
    double best = 0;
    for (const SegmentEnergy energy : {SegmentEnergy::chan_vese, SegmentEnergy::gaussian}) {
      options.energy = energy;
      best = std::max(best, dice(segment<2>(phantom.image, options).labels, phantom.truth));
    }
    EXPECT_GT(dice(chosen.labels, phantom.truth), best - 0.01) << noise;
    EXPECT_GT(best, 0.85) << noise;
  }
}

TEST(SegmentSeeds, RefuseWhatHasNoMeaning) {
  const Phantom phantom = make_phantom(n, dumbbell, 1, 8);
  const auto error_of = [&](const SegmentOptions& options) {
    return invalid_input_message([&] { segment<2>(phantom.image, options); });
  };
  SegmentOptions options = with_seeds(SegmentMode::local);
  mark(options.seeds, -45, -45, 2, 1);
  EXPECT_NE(error_of(options).find("must mark every region"), std::string::npos) << error_of(options);
  mark(options.seeds, -25, 0, 2, 2);
  options.seed_confidence = 0;
  EXPECT_NE(error_of(options).find("seed_confidence"), std::string::npos) << error_of(options);
  options.seed_confidence = 1;
  options.seed_confidences = {1};
  EXPECT_NE(error_of(options).find("seed_confidences size"), std::string::npos) << error_of(options);
  options.seed_confidences.assign(options.seeds.size(), 2);
  EXPECT_NE(error_of(options).find("probabilities"), std::string::npos) << error_of(options);
  options.seed_confidences.clear();
  options.energy = SegmentEnergy::edge;
  options.seed = disc_seed(n, -25, 0, 5);
  EXPECT_NE(error_of(options).find("energy of intensities"), std::string::npos) << error_of(options);
  options.seeds.clear();
  options.seed_confidences.assign(phantom.truth.size(), 1);
  EXPECT_NE(error_of(options).find("need seeds"), std::string::npos) << error_of(options);
}

TEST(SegmentSeeds, DrawsNoContourOutsideTheMask) {
  const Phantom phantom = make_phantom(n, islands, 1.5, 3);
  for (const SegmentEnergy energy : {SegmentEnergy::automatic, SegmentEnergy::chan_vese, SegmentEnergy::gaussian}) {
    SegmentOptions options;
    options.energy = energy;
    options.mask.assign(phantom.truth.size(), 0);
    for (Index y = 20; y < n - 15; ++y)
      for (Index x = 15; x < n - 25; ++x) options.mask[static_cast<std::size_t>(x + n * y)] = 1;
    const Segmentation<2> result = segment<2>(phantom.image, options);
    const Eigen::VectorXd f = result.fields[0]->evaluate(phantom.image.grid.centers<2>()).value;
    Index outside = 0, differ = 0;
    for (std::size_t i = 0; i < options.mask.size(); ++i) {
      const bool is_inside = f[static_cast<Index>(i)] > 0;
      if (options.mask[i] == 0)
        outside += is_inside ? 1 : 0;
      else
        differ += is_inside != (result.labels[i] != 0) ? 1 : 0;
    }
    EXPECT_LE(outside, 20) << static_cast<int>(energy);
    EXPECT_LE(differ, 20) << static_cast<int>(energy);
  }
}

}  // namespace
}  // namespace csrbf::segment_seeds_test
