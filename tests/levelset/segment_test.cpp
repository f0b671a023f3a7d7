#include "csrbf/levelset/segment.hpp"
#include "csrbf/levelset/seed.hpp"

#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"
#include "levelset/speckle_testing.hpp"

namespace csrbf::segment_test {
namespace {

constexpr Index n = 201;

// Without noise and with sharp edges the best two regions are those of the threshold between their means.
TEST(Segment, FindsTheTwoLevelsOfAnImage) {
  const Phantom phantom = make_phantom(n, islands, 0.05, 0);
  SegmentOptions options;
  options.center_spacing = 1;
  const Segmentation<2> result = segment<2>(phantom.image, options);
  Index wrong = 0;
  const double threshold = 0.5 * (result.report.regions[0].mean + result.report.regions[1].mean);
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    const double above = static_cast<double>(phantom.image.values[i]) - threshold;
    if (std::abs(above) < 1) continue;  // the contour passes through some voxels in the middle
    wrong += result.labels[i] != (above > 0 ? 1 : 0) ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  expect_falling_energy(result);
}

TEST(Segment, FindsIslandsAndHolesInNoise) {
  struct Case {
    double noise, least;
  };
  // Signal to noise of 30, 20 and 10 dB; a contour of about 600 pixels half a pixel off costs .008.
  for (const Case& test : {Case{2.4, 0.9965}, Case{7.5, 0.9965}, Case{24, 0.992}})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Phantom phantom = make_phantom(n, islands, 2, test.noise, seed);
      const Segmentation<2> result = segment<2>(phantom.image);
      EXPECT_GT(dice(result.labels, phantom.truth), test.least) << test.noise;
      EXPECT_EQ(result.report.components, 2);
      EXPECT_TRUE(result.report.converged);
      expect_falling_energy(result);
    }
}

TEST(Segment, FindsEverythingFromAnySeedAndNeverInvertsIt) {
  const Phantom phantom = make_phantom(n, islands, 1.5, 3);
  std::vector<std::uint8_t> checkerboard(phantom.truth.size());
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) checkerboard[x + n * y] = (x / 10 + y / 10) % 2 == 0 ? 1 : 0;
  for (const std::vector<std::uint8_t>& seed :
       {disc_seed(n, 30, 0, 20), disc_seed(n, 40, 5, 2.5), disc_seed(n, 80, -80, 8), checkerboard}) {
    SegmentOptions options;
    options.seed = seed;
    EXPECT_GT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.997);
  }
  SegmentOptions outside;
  outside.seed = disc_seed(n, -80, 80, 10);
  const Segmentation<2> inverted = segment<2>(phantom.image, outside);
  std::vector<std::uint8_t> background = phantom.truth;
  for (std::uint8_t& label : background) label = label == 0 ? 1 : 0;
  EXPECT_GT(dice(inverted.labels, background), 0.997);
  const Point<2> corner(20, 180);
  EXPECT_GT((*inverted.fields[0])(corner), 0);
}

TEST(Segment, DoesNotDependOnTheScaleOfIntensities) {
  const Phantom phantom = make_phantom(n, islands, 2, 15);
  const Segmentation<2> plain = segment<2>(phantom.image);
  Phantom scaled = phantom;
  for (float& value : scaled.image.values) value = -0.25F * value + 1000;
  const Segmentation<2> other = segment<2>(scaled.image);
  // The bins of the histogram are mirrored: a voxel in ten thousand may differ.
  EXPECT_GT(dice(plain.labels, other.labels), 0.9995);
}

TEST(Segment, TurnsWithTheImage) {
  const Phantom phantom = make_phantom(n, islands, 2, 15);
  Phantom turned = phantom;
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) turned.image.values[n - 1 - y + n * x] = phantom.image.values[x + n * y];
  const Segmentation<2> plain = segment<2>(phantom.image), other = segment<2>(turned.image);
  Index differ = 0;
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) differ += plain.labels[x + n * y] != other.labels[n - 1 - y + n * x] ? 1 : 0;
  EXPECT_LE(differ, 20);  // forward differences: lengths of corners depend on where they point
}

TEST(Segment, GivesTheSameBitsForEveryThreadCount) {
  const Phantom phantom = make_phantom(n, islands, 2, 24);
  set_thread_count(1);
  const Segmentation<2> one = segment<2>(phantom.image);
  set_thread_count(3);
  const Segmentation<2> three = segment<2>(phantom.image);
  set_thread_count(0);
  EXPECT_EQ(one.labels, three.labels);
  EXPECT_EQ(one.report.energy, three.report.energy);
}

TEST(Segment, SeesLongVoxelsAsTheyAre) {
  // The same ball in voxels of half the height: twice as many, the same volume.
  const auto ball = [](double height) {
    VolumeLayout layout;
    layout.grid.size = {40, 40, static_cast<Index>(40 / height)};
    layout.grid.spacing = Point<3>(1, 1, height);
    Volume<float> image(layout);
    std::size_t i = 0;
    for (Index z = 0; z < layout.grid.size[2]; ++z)
      for (Index y = 0; y < 40; ++y)
        for (Index x = 0; x < 40; ++x, ++i) {
          const Point<3> p(static_cast<double>(x) - 19.5, static_cast<double>(y) - 19.5,
                           (static_cast<double>(z) + 0.5) * height - 20);
          image.values[i] = static_cast<float>(100 * (0.5 + 0.5 * std::erf(12 - p.norm())));
        }
    return image;
  };
  const double volume = 4 * std::numbers::pi / 3 * 12 * 12 * 12;
  for (const double height : {1.0, 0.5, 2.5}) {
    const Segmentation<3> result = segment<3>(ball(height));
    // The mean of the two means lies lower than half the height of the edge: their ball is up to 2.3 % larger.
    EXPECT_NEAR(result.report.regions[1].volume, volume, 0.025 * volume) << height;
    EXPECT_EQ(result.report.components, 1);
  }
}

TEST(Segment, GivesAFieldWithTheLabelsAndAboutTheDistance) {
  Phantom phantom = make_phantom(
      n, [](double x, double y) { return 50 - std::hypot(x, y); }, 2, 5);
  phantom.image.grid.spacing = Point<3>(0.5, 0.5, 1);
  phantom.image.grid.origin = Point<3>(10, -20, 3);
  const Segmentation<2> result = segment<2>(phantom.image);
  const Points<2> centers = phantom.image.grid.centers<2>();
  const Jet<2> jet = result.fields[0]->evaluate(centers, Derivatives::gradient);
  Index differ = 0;
  for (Index i = 0; i < centers.cols(); ++i) differ += (jet.value[i] > 0) != (result.labels[i] != 0) ? 1 : 0;
  EXPECT_LE(differ, 2);  // values of the size of the rounding of floats
  // Along the x axis through the middle of the disc, of radius 25 in physical units.
  const Point<2> middle(10 + 50, -20 + 50);
  for (const double offset : {-1.0, 0.0, 1.0})
    EXPECT_NEAR((*result.fields[0])(middle + Point<2>(25 - offset, 0)), offset, 0.35) << offset;
}

TEST(Segment, KeepsOutOfWhatTheMaskLeavesOut) {
  Phantom phantom = make_phantom(n, islands, 1.5, 3);
  SegmentOptions options;
  options.mask.assign(phantom.truth.size(), 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x)
      if (x > 150) {
        const auto i = static_cast<std::size_t>(x + n * y);
        options.mask[i] = 0;
        phantom.truth[i] = 0;
        phantom.image.values[i] = x % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e6F;
      }
  const Segmentation<2> result = segment<2>(phantom.image, options);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.997);
  EXPECT_EQ(result.report.components, 1);
}

TEST(Segment, TellsFourRegionsApart) {
  Phantom phantom = make_phantom(n, islands, 1, 0);
  std::mt19937 generator(4);
  std::normal_distribution<float> normal(0, 8);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const auto i = static_cast<std::size_t>(x + n * y);
      const std::uint8_t level = x < 50 ? 0 : x < 100 ? 2 : y < 100 ? 1 : 3;
      phantom.truth[i] = level;
      phantom.image.values[i] = 60.0F * static_cast<float>(level) + normal(generator);
    }
  SegmentOptions options;
  options.regions = 4;
  const Segmentation<2> result = segment<2>(phantom.image, options);
  expect_falling_energy(result);
  ASSERT_EQ(result.fields.size(), 4U);
  ASSERT_EQ(result.report.regions.size(), 4U);
  // Label 0 has most of the border; so map by the means.
  const Points<2> centers = phantom.image.grid.centers<2>();
  std::vector<Eigen::VectorXd> values;
  for (const auto& field : result.fields) values.push_back(field->evaluate(centers).value);
  Index wrong = 0, apart = 0;
  for (std::size_t i = 0; i < phantom.truth.size(); ++i) {
    const double mean = result.report.regions[result.labels[i]].mean;
    wrong += std::abs(mean - 60 * phantom.truth[i]) > 20 ? 1 : 0;
    for (std::size_t k = 0; k < 4; ++k)
      apart += (values[k][static_cast<Index>(i)] > 0) != (result.labels[i] == k) ? 1 : 0;
  }
  EXPECT_LE(apart, 4);  // values of the size of the rounding of floats
  EXPECT_LT(static_cast<double>(wrong), 0.005 * n * n);
}

TEST(Segment, SeesThroughShading) {
  Phantom phantom = make_phantom(n, islands, 1, 4);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) phantom.image.values[x + n * y] += 85.0F * static_cast<float>(x) / n;
  const Segmentation<2> result = segment<2>(phantom.image);
  EXPECT_EQ(result.report.options.shading, Shading::linear);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.997);
  SegmentOptions constant;
  constant.shading = Shading::none;
  EXPECT_LT(dice(segment<2>(phantom.image, constant).labels, phantom.truth), dice(result.labels, phantom.truth));
  EXPECT_EQ(segment<2>(make_phantom(n, islands, 2, 4).image).report.options.shading, Shading::none);
}

TEST(Segment, TellsTexturesOfEqualMeanAndVarianceApart) {
  Phantom phantom = make_phantom(
      n, [](double x, double y) { return 60 - std::hypot(x, y); }, 1, 0);
  std::mt19937 generator(8);
  std::exponential_distribution<double> exponential(1);
  std::uniform_real_distribution<double> uniform(-std::sqrt(3.0), std::sqrt(3.0));
  for (std::size_t i = 0; i < phantom.truth.size(); ++i) {
    const double laplace = (exponential(generator) - exponential(generator)) / std::numbers::sqrt2;
    phantom.image.values[i] = static_cast<float>(128 + 30 * (phantom.truth[i] != 0 ? laplace : uniform(generator)));
  }
  SegmentOptions options;
  options.energy = SegmentEnergy::generalized_gaussian;
  const Segmentation<2> result = segment<2>(phantom.image, options);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.97);
  expect_falling_energy(result);
  const Segmentation<2> chosen = segment<2>(phantom.image);
  EXPECT_EQ(chosen.report.options.energy, SegmentEnergy::generalized_gaussian);
  EXPECT_GT(dice(chosen.labels, phantom.truth), 0.98);
  options.energy = SegmentEnergy::chan_vese;
  EXPECT_LT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.7);  // two means cannot
}

// Spikes two voxels thin at their ends, on centres three voxels apart.
TEST(Segment, FollowsSpikesWithoutNoiseToTheVoxel) {
  const auto star = [](double x, double y) { return 50 + 28 * std::cos(9 * std::atan2(y, x)) - std::hypot(x, y); };
  const Phantom phantom = make_phantom(200, star, 1.5, 0);
  const auto found = segment<2>(phantom.image, {.center_spacing = 3.0});
  double wrong = 0;
  for (std::size_t i = 0; i < phantom.truth.size(); ++i) wrong += found.labels[i] != phantom.truth[i] ? 1 : 0;
  EXPECT_LE(wrong, 10);
  for (std::size_t i = 1; i < found.report.energy.size(); ++i)
    EXPECT_LE(found.report.energy[i], found.report.energy[i - 1]);
}

// Lines of four voxels: a smooth contour leaves half of them out, and cost no more than twice as much.
TEST(Segment, KeepsThinObjectsThatAreWorthTheirContour) {
  const Phantom phantom = make_phantom(
      160, [](double x, double y) { return std::hypot(x, y) < 70 ? 2.2 - std::abs(std::remainder(y, 24)) : -1.0; }, 0.2,
      80);
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.93);
}

TEST(Segment, MovesTheContourLocallyAndStaysThere) {
  // Two discs of one brightness: the seed is in one of them.
  const Phantom phantom = make_phantom(
      n, [](double x, double y) { return std::max(35 - std::hypot(x + 45, y), 35 - std::hypot(x - 45, y)); }, 1.5, 8);
  SegmentOptions options;
  options.mode = SegmentMode::local;
  options.seed = disc_seed(n, -50, 3, 8);
  const Segmentation<2> result = segment<2>(phantom.image, options);
  std::vector<std::uint8_t> left = phantom.truth;
  for (Index y = 0; y < n; ++y)
    for (Index x = n / 2; x < n; ++x) left[x + n * y] = 0;
  EXPECT_GT(dice(result.labels, left), 0.985);
  EXPECT_EQ(result.report.components, 1);
  expect_falling_energy(result);
}

TEST(Segment, IsDrawnToEdges) {
  const Phantom phantom = make_phantom(
      n, [](double x, double y) { return 50 - std::hypot(x, 1.3 * y); }, 1.5, 5);
  SegmentOptions options;
  options.energy = SegmentEnergy::edge;
  options.balloon = -0.3;
  options.seed = disc_seed(n, 0, 0, 85);
  const Segmentation<2> shrunk = segment<2>(phantom.image, options);
  EXPECT_GT(dice(shrunk.labels, phantom.truth), 0.98);
  expect_falling_energy(shrunk);
  options.balloon = 0.5;
  options.seed = disc_seed(n, 0, 0, 20);
  EXPECT_GT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.98);
}

TEST(Segment, DoesWhatTheThesisDid) {
  const Phantom phantom = make_phantom(n, islands, 2, 7.5);
  SegmentOptions options;
  options.method = SegmentMethod::collocation;
  options.center_spacing = 4;
  const Segmentation<2> result = segment<2>(phantom.image, options);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.985);
  EXPECT_EQ(result.report.components, 2);
  const Points<2> centers = phantom.image.grid.centers<2>();
  const Eigen::VectorXd values = result.fields[0]->evaluate(centers).value;
  for (Index i = 0; i < centers.cols(); ++i) ASSERT_EQ(values[i] > 0, result.labels[i] != 0) << i;
  options.seed = disc_seed(n, 0, 0, 30);
  EXPECT_GT(dice(segment<2>(phantom.image, options).labels, phantom.truth), 0.985);
}

TEST(Segment, MovesFrontsOnVoxels) {
  const Phantom phantom = make_phantom(n, islands, 2, 7.5);
  SegmentOptions options;
  options.method = SegmentMethod::finite_difference;
  options.smoothness = 0.2;
  const Segmentation<2> result = segment<2>(phantom.image, options);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.98);
  EXPECT_EQ(result.report.components, 2);
}

TEST(Segment, FollowsAForceOfTheCaller) {
  const Phantom phantom = make_phantom(n, islands, 1, 0);
  SegmentOptions options;
  options.seed = disc_seed(n, 0, 0, 30);
  options.force = [&](const unsigned char* /*labels*/, float* force) {
    for (std::size_t i = 0; i < phantom.truth.size(); ++i) force[i] = phantom.truth[i] != 0 ? -3.0F : 3.0F;
  };
  const Segmentation<2> result = segment<2>(phantom.image, options);
  EXPECT_GT(dice(result.labels, phantom.truth), 0.999);
  options.force = [](const unsigned char* /*labels*/, float* force) {
    force[0] = std::numeric_limits<float>::quiet_NaN();
  };
  EXPECT_NE(invalid_input_message([&] { segment<2>(phantom.image, options); }).find("finite"), std::string::npos);
}

TEST(Segment, ALocalContourGrowsFromASmallSeedAndKeepsIt) {
  for (const double noise : {50.0, 170.0}) {  // of a contrast of 170
    const auto disc = [](double x, double y) { return 40 - std::hypot(x, y); };
    const Phantom phantom = make_phantom(n, disc, 0.5, noise);
    SegmentOptions options;
    options.mode = SegmentMode::local;
    options.seed = seed_ball<2>(phantom.image.grid, {100, 100}, noise < 100 ? 5 : 15);
    const Segmentation<2> result = segment<2>(phantom.image, options);
    EXPECT_GT(dice(result.labels, phantom.truth), 0.95) << noise;
    for (std::size_t i = 0; i < result.labels.size(); ++i) EXPECT_GE(result.labels[i], options.seed[i]) << i;
    expect_falling_energy(result);
  }
}

TEST(Segment, SaysWhatIsWrong) {
  const Phantom phantom = make_phantom(
      32, [](double x, double y) { return 10 - std::hypot(x, y); }, 1, 1);
  const auto expect_refused = [](const Volume<float>& image, const SegmentOptions& options, const char* said) {
    const std::string message = invalid_input_message([&] { segment<2>(image, options); });
    EXPECT_NE(message.find(said), std::string::npos) << message << "\nexpected " << said;
  };
  Volume<float> image = phantom.image;
  std::fill(image.values.begin(), image.values.end(), 3.0F);
  expect_refused(image, {}, "constant");
  for (std::size_t i = 0; i < image.values.size(); ++i)
    image.values[i] = static_cast<float>(0x1p30 + 400 * phantom.truth[i]);
  expect_refused(image, {}, "single precision");
  image = phantom.image;
  image.values[17] = std::numeric_limits<float>::infinity();
  expect_refused(image, {}, "voxel 17");
  image = phantom.image;
  image.grid.size = {32, 32, 2};
  image.values.resize(2 * 32 * 32);
  expect_refused(image, {}, "too many axes");
  image = phantom.image;
  image.components = 65;
  expect_refused(image, {}, "components = 65");
  image.components = 3;
  expect_refused(image, {}, "number of values = 1024");
  image = phantom.image;
  image.grid.spacing[1] = 0;
  expect_refused(image, {}, "segment: spacing = 0: must be positive");

  const auto with = [](const auto& change) {
    SegmentOptions options;
    change(options);
    return options;
  };
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.regions = 1; }), "regions = 1");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.smoothness = -1; }), "smoothness = -1");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.center_spacing = 0.2; }), "center_spacing = 0.2");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.center_spacing = 17; }),
                 "center_spacing = 17: must be at most 16 voxels for this image, half its longest side");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.mask.assign(5, 1); }), "mask size = 5");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.mask.assign(32 * 32, 0); }), "mask = empty");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.seed.assign(32 * 32, 0); }), "seed = empty");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.energy = SegmentEnergy::edge; }), "needs a seed");
  expect_refused(phantom.image, with([](SegmentOptions& o) { o.balloon = 2; }), "balloon = 2");
  expect_refused(phantom.image, with([](SegmentOptions& o) {
                   o.regions = 3;
                   o.mode = SegmentMode::local;
                 }),
                 "more than two");
  EXPECT_NE(invalid_input_message([] { segment_energy("chan"); }).find("chan-vese"), std::string::npos);
}

TEST(Segment, StopsWhenAsked) {
  const Phantom phantom = make_phantom(n, islands, 2, 5);
  SegmentOptions options;
  options.progress = [](std::string_view stage, double /*fraction*/) { return stage != "evolve"; };
  EXPECT_THROW(segment<2>(phantom.image, options), Cancelled);
}

}  // namespace
}  // namespace csrbf::segment_test
