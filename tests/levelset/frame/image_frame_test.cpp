#include "csrbf/levelset/frame/image_frame.hpp"

#include "levelset/segment_testing.hpp"

namespace csrbf {
namespace {

constexpr Index frame_side = 120;

// Three discs in noise, and that value wherever `outside` says so (coordinates from the middle).
Phantom framed(float value, const std::function<bool(double, double)>& outside) {
  const auto discs = [](double x, double y) {
    return std::max({12 - std::hypot(x + 14, y - 5), 9 - std::hypot(x - 20, y + 12), 7 - std::hypot(x - 12, y - 25)});
  };
  Phantom phantom = make_phantom(frame_side, discs, 1, 20);
  const double middle = 0.5 * static_cast<double>(frame_side - 1);
  for (Index i = 0; i < frame_side * frame_side; ++i) {
    phantom.image.values[i] = std::round(std::clamp(phantom.image.values[i], 1.0F, 254.0F));
    if (!outside(static_cast<double>(i % frame_side) - middle, static_cast<double>(i / frame_side) - middle)) continue;
    phantom.image.values[i] = value;
    phantom.truth[i] = 0;
  }
  return phantom;
}

bool is_turned(double x, double y) {
  const double u = 0.9 * x + std::sqrt(1 - 0.81) * y, v = 0.9 * y - std::sqrt(1 - 0.81) * x;
  return std::max(std::abs(u), std::abs(v)) > 45;
}

bool is_padding(double x, double y) {
  return x < -50 || y > 45;
}

bool is_missing_tile(double x, double y) {
  return x > 20 && y > 15;
}

bool is_beyond_aperture(double x, double y) {
  return std::hypot(x - 2, y + 1) > 52;
}

bool is_beyond_sector(double x, double y) {
  const double radius = std::hypot(x, y + 75);
  return std::abs(std::atan2(x, y + 75)) > 0.6 || radius < 30 || radius > 130;
}

TEST(ImageFrame, IsLeftOut) {
  for (const auto& outside : {is_turned, is_padding, is_missing_tile, is_beyond_aperture, is_beyond_sector})
    for (const float value : {0.0F, 255.0F}) {
      const Phantom phantom = framed(value, outside);
      const std::optional<ImageFrame> frame = find_image_frame(phantom.image, {});
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->value, value);
      const Segmentation<2> found = segment<2>(phantom.image);
      EXPECT_GT(dice(found.labels, phantom.truth), 0.97)
          << value << " " << frame->share << " " << found.report.warnings[0];
    }
}

TEST(ImageFrame, MayHaveRipplesAtItsEdge) {
  Phantom phantom = framed(0, is_turned);
  std::mt19937 random(5);
  const double middle = 0.5 * static_cast<double>(frame_side - 1);
  for (Index i = 0; i < frame_side * frame_side; ++i) {
    const double x = static_cast<double>(i % frame_side) - middle, y = static_cast<double>(i / frame_side) - middle;
    if (is_turned(x, y) && !is_turned(0.94 * x, 0.94 * y)) phantom.image.values[i] = static_cast<float>(random() % 12);
  }
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.97);
}

TEST(ImageFrame, IsNothingThatBends) {
  const auto bends = [](double x, double y) { return std::hypot(x, y) > 40 + 6 * std::cos(3 * std::atan2(y, x)); };
  EXPECT_FALSE(find_image_frame(framed(0, bends).image, {}));
  const auto disc_at_border = [](double x, double y) { return std::hypot(x - 50, y) < 22; };
  EXPECT_FALSE(find_image_frame(framed(255, disc_at_border).image, {}));
  EXPECT_FALSE(find_image_frame(framed(0, [](double, double) { return false; }).image, {}));
}

// Cut out, antialiased: what is left would be its edge.
TEST(ImageFrame, IsNotTheGroundOfAThingOfOneValue) {
  for (const bool round : {false, true}) {
    Phantom phantom = framed(0, is_turned);
    const double middle = 0.5 * static_cast<double>(frame_side - 1);
    for (Index i = 0; i < frame_side * frame_side; ++i) {
      const double x = static_cast<double>(i % frame_side) - middle, y = static_cast<double>(i / frame_side) - middle;
      const double u = 0.9 * x + std::sqrt(0.19) * y, v = 0.9 * y - std::sqrt(0.19) * x;
      const double distance = round ? std::hypot(x, y) - 45 : std::max(std::abs(u), std::abs(v)) - 35;
      phantom.image.values[i] = static_cast<float>(200 * std::clamp(0.5 - distance, 0.0, 1.0));
      phantom.truth[i] = distance < 0 ? 1 : 0;
    }
    EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.98) << round;
  }
}

// One value but beside its ground: no picture is left.
TEST(ImageFrame, IsNotTheGroundOfAThingWithAnEdge) {
  Phantom phantom = framed(0, is_turned);
  for (Index i = 0; i < frame_side * frame_side; ++i) {
    const Index x = i % frame_side, y = i / frame_side;
    phantom.truth[i] = x >= 20 && x < 100 && y >= 20 && y < 100 ? 1 : 0;
    phantom.image.values[i] = phantom.truth[i] == 0 ? 0 : x == 20 ? static_cast<float>(40 + y) : 200;
  }
  EXPECT_GT(dice(segment<2>(phantom.image).labels, phantom.truth), 0.98);
}

// A bright building is no frame though its edges are straight: it has no corner of the picture. A tile may be missing.
TEST(ImageFrame, HasACornerIfItIsBright) {
  const auto building = [](double x, double y) { return x < -10 && std::abs(y) < 25; };
  EXPECT_TRUE(find_image_frame(framed(0, building).image, {}));
  EXPECT_FALSE(find_image_frame(framed(255, building).image, {}));
}

// Where all of the picture is alike, its frame is what there is to find.
TEST(ImageFrame, IsARegionWhereThereIsNoOther) {
  Phantom phantom = make_phantom(
      frame_side, [](double, double) { return -100.0; }, 1, 5);
  const double middle = 0.5 * static_cast<double>(frame_side - 1);
  for (Index i = 0; i < frame_side * frame_side; ++i) {
    const bool out =
        is_turned(static_cast<double>(i % frame_side) - middle, static_cast<double>(i / frame_side) - middle);
    phantom.truth[i] = out ? 0 : 1;
    if (out) phantom.image.values[i] = 0;
  }
  EXPECT_EQ(segment<2>(phantom.image).labels, phantom.truth);
}

// Three bands of noise in a frame: as many regions as the picture has, or with the frame as one of them.
TEST(ImageFrame, IsARegionOfSeveralIfThePictureHasOneLess) {
  std::mt19937 random(9);
  std::normal_distribution<float> noise(0, 12);
  for (const auto& outside : {is_turned, is_padding, is_beyond_aperture}) {
    Phantom phantom = framed(0, outside);
    std::vector<std::uint8_t> band(phantom.truth.size());
    std::vector<std::uint8_t> out(phantom.truth.size());
    const double middle = 0.5 * static_cast<double>(frame_side - 1);
    for (Index i = 0; i < frame_side * frame_side; ++i) {
      const double x = static_cast<double>(i % frame_side) - middle, y = static_cast<double>(i / frame_side) - middle;
      const double place = y + 8 * std::sin(0.1 * x);
      band[i] = place < -12 ? 0 : place < 12 ? 1 : 2;
      out[i] = outside(x, y) ? 1 : 0;
      const float value = 60.0F + 50.0F * static_cast<float>(band[i]) + noise(random);
      phantom.image.values[i] = out[i] != 0 ? 0.0F : std::round(std::clamp(value, 1.0F, 254.0F));
      if (i % 97 == 0 && out[i] == 0) phantom.image.values[i] = std::numeric_limits<float>::quiet_NaN();
    }
    for (const int regions : {3, 4}) {
      const Segmentation<2> found = segment<2>(phantom.image, {.regions = regions});
      Index wrong = 0;
      for (std::size_t i = 0; i < band.size(); ++i) {
        if (std::isnan(phantom.image.values[i])) continue;
        wrong += (out[i] != 0 ? found.labels[i] != 0 : found.labels[i] != band[i] + regions - 3) ? 1 : 0;
      }
      EXPECT_LT(wrong, std::ssize(band) / 50) << regions;
    }
  }
}

}  // namespace
}  // namespace csrbf
