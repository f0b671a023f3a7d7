#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/levelset/track.hpp"
#include "levelset/track_testing.hpp"

namespace csrbf::track_frames_test {
namespace {

using namespace track_testing;

TEST(Track, ReadsOneFrameAfterTheOtherAndHandsThemOverWhenFinal) {
  const std::vector<Disc> discs = beat(4);
  const Volume<float> sequence = disc_sequence(discs, 20);
  const Tracking<2> whole = track<2>(sequence, {});
  std::vector<Index> read, taken;
  const FrameSource source = [&](Index t) {
    read.push_back(t);
    VolumeLayout layout = sequence;
    layout.frames = 1;
    Volume<float> image(layout);
    std::copy_n(sequence.values.begin() + t * n * n, n * n, image.values.begin());
    return image;
  };
  track<2>(4, source, {.sweeps = 2}, [&](Index t, TrackedFrame<2>&& frame) {
    taken.push_back(t);
    EXPECT_EQ(frame.segmentation.labels, whole.frames[t].segmentation.labels);
  });
  EXPECT_EQ(read, (std::vector<Index>{0, 1, 2, 3, 3, 2, 1, 0}));
  EXPECT_EQ(taken, (std::vector<Index>{3, 2, 1, 0}));
}

TEST(Track, IsTheSameForEveryNumberOfThreads) {
  const Volume<float> sequence = disc_sequence(beat(3), 30);
  const Tracking<2> expected = track<2>(sequence, {});
  set_thread_count(1);
  const Tracking<2> single = track<2>(sequence, {});
  set_thread_count(0);
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_EQ(single.frames[t].segmentation.labels, expected.frames[t].segmentation.labels);
    EXPECT_EQ(single.frames[t].regions[0].volume, expected.frames[t].regions[0].volume);
  }
}

TEST(Track, NamesTheFrameThatCannotBeSegmented) {
  Volume<float> constant = disc_sequence(beat(4), 5);
  std::fill_n(constant.values.begin() + 2 * n * n, n * n, 7.0F);
  const std::string message = invalid_input_message([&] { track<2>(constant, {}); });
  EXPECT_NE(message.find("frame 2"), std::string::npos) << message;
  EXPECT_NE(message.find("constant"), std::string::npos) << message;

  const FrameSource unequal = [](Index t) {
    VolumeLayout layout;
    layout.grid.axes = 2;
    layout.grid.size = {8 + t, 8, 1};
    Volume<float> image(layout);
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = i % 8 < 4 ? 0.0F : 1.0F;
    return image;
  };
  EXPECT_EQ(invalid_input_message([&] { track<2>(2, unequal, {}, [](Index, TrackedFrame<2>&&) {}); }),
            "track: size of frame 1 = 9 x 8: must be that of the first frame, 8 x 8");
}

TEST(Track, RefusesOptionsOutOfTheirRanges) {
  const Volume<float> sequence = disc_sequence(beat(2), 5);
  const auto message = [&](const TrackOptions& options) {
    return invalid_input_message([&] { track<2>(sequence, options); });
  };
  EXPECT_EQ(message({.persistence = -1}), "track: persistence = -1: must be 0 to 100");
  EXPECT_NE(message({.persistence = std::numeric_limits<double>::quiet_NaN()}), "");
  EXPECT_NE(message({.motion = 0.0}).find("motion = 0"), std::string::npos);
  EXPECT_NE(message({.prediction = 2.0}).find("prediction = 2"), std::string::npos);
  EXPECT_NE(message({.sweeps = 0}).find("sweeps = 0"), std::string::npos);
  TrackOptions prior;
  prior.segment.prior.assign(n * n, 0.0F);
  EXPECT_NE(message(prior).find("prior"), std::string::npos);
  EXPECT_NE(invalid_input_message([] { track<2>(Volume<float>(), {}); }), "");
}

// Also with those that only the energy `automatic` has, which later frames do not choose again.
TEST(Track, FollowsWithEveryShading) {
  const std::vector<Disc> discs = beat(3);
  const Volume<float> sequence = disc_sequence(discs, 15);
  for (const Shading shading : {Shading::none, Shading::smooth, Shading::objects, Shading::background}) {
    TrackOptions options;
    options.segment.shading = shading;
    const Tracking<2> tracking = track<2>(sequence, options);
    for (std::size_t t = 0; t < discs.size(); ++t)
      EXPECT_GT(dice(tracking.frames[t].segmentation.labels, disc_labels(discs[t])), 0.85)
          << t << ", shading " << static_cast<int>(shading);
  }
}

TEST(Track, CanBeCancelled) {
  const Volume<float> sequence = disc_sequence(beat(4), 5);
  TrackOptions options;
  double last = 0;
  options.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
    return fraction < 0.4;
  };
  EXPECT_THROW(track<2>(sequence, options), Cancelled);
}

}  // namespace
}  // namespace csrbf::track_frames_test
