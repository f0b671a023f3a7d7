#include "csrbf/levelset/track.hpp"

#include "levelset/track_testing.hpp"

namespace csrbf::track_test {
namespace {

using namespace track_testing;

TEST(Track, GivesTheSegmentationOfASingleFrame) {
  const Volume<float> image = disc_sequence({{2, 1, 25}}, 20);
  SegmentOptions options;
  options.seed = disc_labels({0, 0, 10});
  const Segmentation<2> expected = segment<2>(image, options);
  const Tracking<2> tracking = track<2>(image, {.segment = options});
  ASSERT_EQ(tracking.frames.size(), 1U);
  EXPECT_EQ(tracking.frames[0].segmentation.labels, expected.labels);
  EXPECT_EQ(tracking.frames[0].segmentation.report.energy, expected.report.energy);
  EXPECT_EQ(tracking.frames[0].regions[0].voxels, expected.report.regions[1].voxels);
}

// Clear frames are followed as they are, with or without a prior: the area of the level set is that of the disc to far
// less than the pixels of its border would say (a tenth of a pixel all along it: .8 % of the area).
TEST(Track, MeasuresTheAreaOfAPulsingDiscWithinATenthOfAPixelOfItsRadius) {
  constexpr double tenth = 0.1;
  const std::vector<Disc> discs = beat(10);
  const Volume<float> sequence = disc_sequence(discs, 0);
  for (const double persistence : {0.0, TrackOptions().persistence}) {
    const Tracking<2> tracking = track<2>(sequence, {.persistence = persistence});
    for (std::size_t t = 0; t < discs.size(); ++t) {
      const RegionMeasure& region = tracking.frames[t].regions[0];
      EXPECT_EQ(region.label, 1);
      const double radius = std::sqrt(region.volume / pi);
      EXPECT_NEAR(radius, discs[t].radius, tenth) << "frame " << t << ", persistence " << persistence;
      EXPECT_NEAR(region.area / (2 * pi * radius), 1, 0.01);  // a circle is the shortest line around its area
      EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.99);
      EXPECT_NEAR(region.mean, 207, 3);
    }
  }
}

// Of exactly two values, with sharp edges, deviations would hold the contour where it was.
TEST(Track, FollowsADiscOfTwoValues) {
  const std::vector<Disc> discs{{-15, 0, 10}, {-12, 0, 10}, {-9, 0, 10}, {-6, 0, 10}};
  Volume<float> sequence = disc_sequence(discs, 0);
  for (float& value : sequence.values) value = value > 125 ? 210.0F : 40.0F;
  const Tracking<2> tracking = track<2>(sequence, {});
  for (std::size_t t = 0; t < discs.size(); ++t)
    EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.99) << "frame " << t;
}

// A cavity with a wall around it, whose intensity lies between that of the cavity and that of the outside.
TEST(Track, FollowsACavityWithinAWall) {
  constexpr double wall = 7;
  constexpr float between = 0.4F;  // of the contrast
  const std::vector<Disc> discs = beat(4);
  std::vector<Disc> outlines = discs;
  for (Disc& disc : outlines) disc.radius += wall;
  const Volume<float> cavity = disc_sequence(discs, 0), whole = disc_sequence(outlines, 0);
  Volume<float> sequence = disc_sequence(discs, 15);
  for (std::size_t i = 0; i < sequence.values.size(); ++i)
    sequence.values[i] += between * (whole.values[i] - cavity.values[i]);
  TrackOptions options;
  options.segment.mode = SegmentMode::local;
  options.segment.seed = disc_labels({0, 2, 8});
  const Tracking<2> tracking = track<2>(sequence, options);
  for (std::size_t t = 0; t < discs.size(); ++t) {
    EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.97) << t;
    const double area = pi * discs[t].radius * discs[t].radius;
    EXPECT_NEAR(tracking.frames[t].regions[0].volume, area, 0.04 * area) << t;
  }
}

// The first frame alone asks for centres as fine as its voxels.
TEST(Track, KeepsNoSpacingOfTheFirstFrame) {
  const std::vector<Disc> discs = beat(6);
  const Volume<float> sequence = disc_sequence(discs, 20);
  const Tracking<2> tracking = track<2>(sequence, {});
  for (std::size_t t = 0; t < discs.size(); ++t)
    EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.98) << t;
}

TEST(Track, MeasuresInTheUnitOfTheSpacing) {
  Volume<float> sequence = disc_sequence(beat(2), 0);
  const Tracking<2> pixels = track<2>(sequence, {});
  sequence.grid.spacing = Point<3>::Constant(0.5);
  sequence.grid.direction.topLeftCorner<2, 2>() << 0, -1, 1, 0;
  sequence.grid.origin = {7, -3, 0};
  const Tracking<2> halves = track<2>(sequence, {});
  constexpr double float_rounding = 1e-3;  // of a descent in float
  for (std::size_t t = 0; t < 2; ++t) {
    const RegionMeasure& a = pixels.frames[t].regions[0];
    const RegionMeasure& b = halves.frames[t].regions[0];
    EXPECT_NEAR(b.volume / a.volume, 0.25, 0.25 * float_rounding);
    EXPECT_NEAR(b.area / a.area, 0.5, 0.5 * float_rounding);
  }
}

TEST(Track, KeepsTheRegionInsideWhateverItsSizeAndContrast) {
  // It grows from 2 % of the image to two thirds of it and its border; brightness is exchanged for all frames.
  std::vector<Disc> discs;
  for (int t = 0; t < 8; ++t) discs.push_back({0, 0, 8 + 5.5 * t});
  Volume<float> sequence = disc_sequence(discs, 5);
  for (int sign : {1, -1}) {
    SegmentOptions options;
    options.seed = disc_labels({0, 0, 5});
    const Tracking<2> tracking = track<2>(sequence, {.segment = options});
    for (std::size_t t = 0; t < discs.size(); ++t)
      EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.98) << t << ", " << sign;
    for (float& value : sequence.values) value = 250 - value;
  }
}

double roughness(const Tracking<2>& tracking, const std::vector<Disc>& discs) {
  std::vector<double> errors;
  for (std::size_t t = 0; t < discs.size(); ++t)
    errors.push_back(tracking.frames[t].regions[0].volume - pi * discs[t].radius * discs[t].radius);
  double sum = 0;
  for (std::size_t t = 1; t + 1 < errors.size(); ++t) sum += std::pow(errors[t - 1] - 2 * errors[t] + errors[t + 1], 2);
  return std::sqrt(sum / static_cast<double>(errors.size() - 2));
}

TEST(Track, SmoothsTheCurveOfAreasOfNoisyFrames) {
  const std::vector<Disc> discs = beat(16);
  const Volume<float> sequence = disc_sequence(discs, 80);
  const Tracking<2> alone = track<2>(sequence, {.persistence = 0});
  const Tracking<2> remembered = track<2>(sequence, {});
  constexpr double clearly = 0.8;
  EXPECT_LT(roughness(remembered, discs), clearly * roughness(alone, discs));
  double alone_dice = 0, remembered_dice = 0;
  for (std::size_t t = 0; t < discs.size(); ++t) {
    alone_dice += dice(alone.frames[t].segmentation.labels, disc_labels(discs[t]));
    remembered_dice += dice(remembered.frames[t].segmentation.labels, disc_labels(discs[t]));
  }
  EXPECT_GT(remembered_dice, alone_dice);
}

// Forward only, the contour lags behind a disc that moves steadily, unless its motion is extrapolated.
TEST(Track, ForeseesSteadyMotion) {
  std::vector<Disc> discs;
  for (int t = 0; t < 10; ++t) discs.push_back({-18.0 + 4 * t, 0, 18});
  const Volume<float> sequence = disc_sequence(discs, 60);
  const auto mean_dice = [&](double prediction) {
    const Tracking<2> tracking = track<2>(sequence, {.prediction = prediction, .sweeps = 1});
    double sum = 0;
    for (std::size_t t = 0; t < discs.size(); ++t)
      sum += dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t]));
    return sum / static_cast<double>(discs.size());
  };
  EXPECT_GT(mean_dice(1), mean_dice(0) + 0.01);
  EXPECT_EQ(*track<2>(sequence, {.sweeps = 1}).report.options.prediction, 1);
  EXPECT_EQ(*track<2>(sequence, {}).report.options.prediction, 0);
}

// Two sweeps leave the size of a disc in a clear frame as it is, and what a single frame finds otherwise.
TEST(Track, DoesNotDampTheBeatOfClearFrames) {
  const std::vector<Disc> discs = beat(10);
  const Volume<float> sequence = disc_sequence(discs, 15);
  const Tracking<2> alone = track<2>(sequence, {.persistence = 0}), remembered = track<2>(sequence, {});
  const auto amplitude = [](const Tracking<2>& tracking) {
    double least = 1e300, most = 0;
    for (const auto& frame : tracking.frames) {
      least = std::min(least, frame.regions[0].volume);
      most = std::max(most, frame.regions[0].volume);
    }
    return (most - least) / most;
  };
  constexpr double tolerance = 0.02;  // of the amplitude
  EXPECT_NEAR(amplitude(remembered), amplitude(alone), tolerance * amplitude(alone));
}

// What the first frame chooses must hold for all: means of objects or smooth ones are for the energy auto only.
TEST(Track, GoesOnFromAnyModelOfTheFirstFrame) {
  Volume<float> sequence = disc_sequence(std::vector<Disc>(3, {0, 0, 18}), 5);
  const Index voxels = sequence.grid.voxels(), nx = sequence.grid.size[0];
  for (std::size_t i = 0; i < sequence.values.size(); ++i) {
    const double x = static_cast<double>(static_cast<Index>(i) % voxels % nx),
                 y = static_cast<double>(static_cast<Index>(i) % voxels / nx);
    sequence.values[i] += static_cast<float>(60 * std::sin(0.11 * x) * std::cos(0.13 * y));
  }
  const Tracking<2> tracking = track<2>(sequence, {});
  EXPECT_EQ(tracking.frames.size(), 3);
  EXPECT_NE(tracking.report.options.segment.shading, Shading::smooth);
  EXPECT_NE(tracking.report.options.segment.shading, Shading::objects);
}

// A clean image is best described by shapes of intensities, which would hold the contour of the next frames back.
TEST(Track, FollowsADiscWhoseFirstFrameHasShapesOfItsOwn) {
  constexpr Index small = 24, frames = 5;
  VolumeLayout layout;
  layout.grid.axes = 2;
  layout.grid.size = {small, small, 1};
  Volume<float> sequence(layout);
  sequence.frames = frames;
  sequence.values.clear();
  for (Index t = 0; t < frames; ++t)
    for (Index i = 0; i < small * small; ++i) {
      const Index x = i % small, y = i / small;
      const double distance = std::hypot(static_cast<double>(x - 7 - 2 * t), static_cast<double>(y - 12));
      sequence.values.push_back(distance < 4.5 ? 100 : static_cast<float>(10 + x * y % 3));
    }
  const Tracking<2> tracking = track<2>(sequence, {});
  EXPECT_NE(tracking.report.options.segment.energy, SegmentEnergy::generalized_gaussian);
  const std::vector<std::uint8_t>& last = tracking.frames.back().segmentation.labels;
  EXPECT_EQ(last[12 * small + 15], 1);  // its middle
  EXPECT_EQ(last[12 * small + 9], 0);   // where it was two frames before
}

TEST(Track, CarriesTheContourThroughAFrameOfNoise) {
  const std::vector<Disc> discs = beat(8);
  Volume<float> sequence = disc_sequence(discs, 10);
  std::mt19937 random(5);
  std::normal_distribution<float> normal(100, 40);
  constexpr Index lost = 3;
  for (Index i = 0; i < n * n; ++i) sequence.values[lost * n * n + i] = normal(random);
  const Tracking<2> tracking = track<2>(sequence, {});
  // Noise may move it by three pixels of a radius of 20.
  for (std::size_t t = 0; t < discs.size(); ++t)
    EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), t == lost ? 0.85 : 0.97) << t;
  // Without the prior, noise is split into two halves.
  const Tracking<2> alone = track<2>(sequence, {.persistence = 0});
  EXPECT_LT(dice(alone.frames[lost].segmentation.labels, disc_labels(discs[lost])), 0.7);
}

TEST(Track, CarriesTheContourThroughAnOcclusion) {
  const std::vector<Disc> discs(6, Disc{0, 0, 30});
  Volume<float> sequence = disc_sequence(discs, 10);
  constexpr Index hidden = 3;
  for (Index y = n / 2 - 8; y < n / 2 + 8; ++y)  // a dark bar across the disc: 34 % of it
    for (Index x = 0; x < n; ++x) sequence.values[hidden * n * n + y * n + x] = 40;
  const auto worst = [&](double persistence) {
    const Tracking<2> tracking = track<2>(sequence, {.persistence = persistence, .motion = 4});
    double least = 1;
    for (std::size_t t = 0; t < discs.size(); ++t)
      least = std::min(least, dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])));
    return least;
  };
  EXPECT_GT(worst(TrackOptions().persistence), 0.93);
  EXPECT_LT(worst(0), 0.85);
}

TEST(Track, NothingAppearsFarFromTheContour) {
  const std::vector<Disc> discs(4, Disc{-15, 0, 18});
  Volume<float> sequence = disc_sequence(discs, 10);
  for (Index y = 40; y < 56; ++y)  // as bright, beside it, in one frame
    for (Index x = 76; x < 92; ++x) sequence.values[2 * n * n + y * n + x] = 210;
  const Tracking<2> tracking = track<2>(sequence, {});
  for (const TrackedFrame<2>& frame : tracking.frames) EXPECT_EQ(frame.segmentation.report.components, 1);
  EXPECT_EQ(track<2>(sequence, {.persistence = 0}).frames[2].segmentation.report.components, 2);
}

// A ball that shrinks, on voxels of unequal edges.
TEST(Track, MeasuresTheVolumeOfAShrinkingBall) {
  VolumeLayout layout;
  layout.grid.size = {40, 40, 28};
  layout.grid.spacing = {1, 1, 1.5};
  layout.frames = 3;
  Volume<float> sequence(layout);
  const Points<3> centers = layout.grid.centers<3>();
  const Point<3> middle(19.5, 19.5, 20.25);
  const auto radius = [](Index t) { return 14.0 - 1.5 * static_cast<double>(t); };
  for (Index t = 0; t < 3; ++t)
    for (Index i = 0; i < layout.grid.voxels(); ++i) {
      const double d = radius(t) - (centers.col(i) - middle).norm();
      sequence.values[t * layout.grid.voxels() + i] = static_cast<float>(100 + 60 * std::erf(d));
    }
  const Tracking<3> tracking = track<3>(sequence, {});
  constexpr double part_of_a_voxel = 0.15;
  for (Index t = 0; t < 3; ++t) {
    const RegionMeasure& region = tracking.frames[t].regions[0];
    EXPECT_NEAR(std::cbrt(0.75 * region.volume / pi), radius(t), part_of_a_voxel);
    EXPECT_NEAR(std::sqrt(0.25 * region.area / pi), radius(t), 2 * part_of_a_voxel);
  }
}

TEST(Track, KeepsTheLabelsOfSeveralRegions) {
  // A ring whose brightness rises past that of the disc: labels by intensity would be exchanged.
  Volume<float> sequence = disc_sequence({{}, {}, {}}, 0);
  const auto at = [&](Index t, Index x, Index y) -> float& { return sequence.values[t * n * n + y * n + x]; };
  for (Index t = 0; t < 3; ++t)
    for (Index y = 0; y < n; ++y)
      for (Index x = 0; x < n; ++x) {
        const double r = std::hypot(static_cast<double>(x) - 47.5, static_cast<double>(y) - 47.5);
        at(t, x, y) = r < 18 ? 120.0F : r < 34 ? 80.0F + 40.0F * static_cast<float>(t) : 20.0F;
        if (t == 1 && r >= 18 && r < 34) at(t, x, y) = 150;
      }
  TrackOptions options;
  options.segment.regions = 3;
  const Tracking<2> tracking = track<2>(sequence, options);
  const std::size_t ring = 48 * n + 20, disc = 48 * n + 48;
  const std::uint8_t ring_label = tracking.frames[0].segmentation.labels[ring];
  const std::uint8_t disc_label = tracking.frames[0].segmentation.labels[disc];
  EXPECT_NE(ring_label, disc_label);
  for (const TrackedFrame<2>& frame : tracking.frames) {
    EXPECT_EQ(frame.segmentation.labels[ring], ring_label);
    EXPECT_EQ(frame.segmentation.labels[disc], disc_label);
    const Point<2> at_ring(20, 48);
    EXPECT_GT((*frame.segmentation.fields[ring_label])(at_ring), 0);
    EXPECT_EQ(frame.regions.size(), 2U);
  }
}

}  // namespace
}  // namespace csrbf::track_test
