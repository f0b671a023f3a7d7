#include "csrbf/implicit/preview.hpp"

#include "core/error_testing.hpp"
#include "implicit/analytic_fields.hpp"
#include "implicit/plane_fields.hpp"

namespace csrbf::preview_test {
namespace {

using Image = Volume<float>;

Image image_of(const std::array<Index, 3>& size, const std::function<float(Index x, Index y, Index z)>& at) {
  VolumeLayout layout;
  layout.grid.size = size;
  layout.grid.axes = size[2] > 1 ? 3 : 2;
  Image image(layout);
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x) image.values[layout.grid.index(x, y, z)] = at(x, y, z);
  return image;
}

RgbColor pixel(const RgbImage& picture, int x, int y) {
  const std::size_t i = static_cast<std::size_t>(3 * (y * picture.width + x));
  return {picture.pixels[i], picture.pixels[i + 1], picture.pixels[i + 2]};
}

RgbColor grey(int value) {
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value)};
}

RgbImage without_contour(const Image& image, PreviewOptions options = {}) {
  options.size = 1;
  return preview<3>(image, {}, options);
}

TEST(Preview, StretchesTheWindowFromBlackToWhite) {
  // Values 0, 1, ..., 100: the window from 10 % to 90 % ends at 10 and 90.
  const Image image = image_of({101, 1, 1}, [](Index x, Index, Index) { return static_cast<float>(x); });
  const RgbImage picture = without_contour(image, {.window = {0.1, 0.9}});
  ASSERT_EQ(picture.width, 101);
  ASSERT_EQ(picture.height, 1);
  for (int x = 0; x <= 100; ++x)
    EXPECT_EQ(pixel(picture, x, 0), grey(static_cast<int>(std::lround(std::clamp((x - 10) / 80.0, 0.0, 1.0) * 255))));
}

TEST(Preview, EnlargesVoxelsAndKeepsTheirProportions) {
  Image image = image_of({10, 6, 1}, [](Index x, Index y, Index) { return static_cast<float>((x + y) % 2); });
  image.grid.spacing = {2, 3, 1};
  const RgbImage picture = preview<2>(image, {}, {.size = 25});
  EXPECT_EQ(picture.width, 30) << "3 x 10 is the smallest multiple above 25";
  EXPECT_EQ(picture.height, 27) << "rows are half as high again: 4.5 x 6";
  EXPECT_EQ(pixel(picture, 0, 0), grey(0));
  EXPECT_EQ(pixel(picture, 3, 0), grey(255));
  EXPECT_EQ(pixel(picture, 2, 4), grey(255)) << "its centre is at 4.5, where the second row begins";
  EXPECT_EQ(pixel(picture, 2, 3), grey(0));
}

TEST(Preview, DrawsTheContourWhereTheFieldIsZero) {
  Image image = image_of({40, 30, 1}, [](Index, Index, Index) { return 7.0F; });
  image.grid.spacing = {0.5, 0.5, 1};
  image.grid.origin = {100, 50, 0};
  const Point<2> center(110.1, 57.2);
  const double r = 4;
  const PlaneField disc = ellipse(r, r, {}, center);
  const RgbColor color{0, 200, 0};
  const double width = 2;
  const RgbImage picture = preview<2>(image, {&disc}, {.size = 320, .line_width = width, .colors = {color}});
  const double pixels = 8 / 0.5;
  int drawn = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      // The first voxel's centre is at 4 pixels, in the middle of its 8.
      const Point<2> p(100 + (x + 0.5 - 4) / pixels, 50 + (y + 0.5 - 4) / pixels);
      const double away = std::abs((p - center).norm() - r) * pixels;
      // Chords are 4 sqrt(2) pixels long at most, and c^2 / (8 * 64 pixels) away from the arc; 8-bit rounding.
      constexpr double polygon = 32.0 / 512 + 0.01;
      if (away < width / 2 - 0.5 - polygon) {
        EXPECT_EQ(pixel(picture, x, y), color);
      }
      if (away > width / 2 + 0.5 + polygon) {
        EXPECT_EQ(pixel(picture, x, y), grey(128));
      }
      drawn += pixel(picture, x, y) == color ? 1 : 0;
    }
  EXPECT_GT(drawn, 200);
}

TEST(Preview, CutsTheImageWhereMostIsInside) {
  const auto number = [](Index x, Index y, Index z) { return static_cast<float>(100 * z + 10 * y + x); };
  Image image = image_of({9, 8, 7}, number);
  const AnalyticField solid = quadratic_ball(2.6, Point<3>(3, 4.1, 5));
  const std::vector<const Field<3>*> fields{&solid};
  EXPECT_EQ(largest_slice<3>(image.grid, fields, 2), 5);
  EXPECT_EQ(largest_slice<3>(image.grid, fields, 1), 4);
  EXPECT_EQ(largest_slice<3>(image.grid, fields, 0), 3);
  EXPECT_EQ(largest_slice<3>(image.grid, fields, 0, 1e9), 4) << "the middle one when nothing is inside";
  const PreviewOptions all{.window = {0, 1}};
  const auto value_at = [&](const PreviewOptions& options, int x, int y, double lo, double hi) {
    return lo + (hi - lo) / 255 * pixel(without_contour(image, options), x, y)[0];
  };
  PreviewOptions options = all;
  options.slice = 5;
  constexpr double step = 0.5 / 255 * 700;  // of the grey values
  EXPECT_NEAR(value_at(options, 2, 3, 500, 578), 532, step);
  options.axis = 1;
  EXPECT_NEAR(value_at(options, 2, 6, 50, 658), 52, step) << "z goes upwards";
  EXPECT_NEAR(value_at(options, 2, 0, 50, 658), 652, step);
  options.axis = 0;
  EXPECT_NEAR(value_at(options, 1, 0, 5, 675), 615, step);
  RgbImage expected = preview<3>(image, fields, {.slice = 5});
  EXPECT_EQ(preview<3>(image, fields).pixels, expected.pixels);
}

TEST(Preview, ShowsPatientsTheSameInEverySpace) {
  Image image =
      image_of({9, 8, 7}, [](Index x, Index y, Index z) { return static_cast<float>(x * x + 3 * y + 20 * z); });
  image.grid.space = Space::left_posterior_superior;
  // The same voxels from the other ends of x and y, as files in the other space have them.
  Image turned = image;
  for (Index z = 0; z < 7; ++z)
    for (Index y = 0; y < 8; ++y)
      for (Index x = 0; x < 9; ++x)
        turned.values[turned.grid.index(8 - x, 7 - y, z)] = image.values[image.grid.index(x, y, z)];
  turned.grid.direction.diagonal() << -1, -1, 1;
  turned.grid.origin = {8, 7, 0};
  turned.grid = in_space(turned.grid, Space::right_anterior_superior);
  const AnalyticField solid = quadratic_ball(2.6, Point<3>(3, 4.1, 5));
  const AnalyticField mirrored = quadratic_ball(2.6, Point<3>(-3, -4.1, 5));
  for (int axis = 0; axis < 3; ++axis) {
    const RgbImage picture = preview<3>(image, {&solid}, {.axis = axis, .size = 100});
    EXPECT_EQ(picture.pixels, preview<3>(turned, {&mirrored}, {.axis = axis, .size = 100}).pixels) << axis;
  }
  EXPECT_EQ(pixel(without_contour(image, {.slice = 3, .window = {0, 1}}), 0, 0), grey(0)) << "right, front";
  EXPECT_EQ(pixel(without_contour(image, {.slice = 3, .window = {0, 1}}), 8, 7), grey(255)) << "left, back";
}

TEST(Preview, ShowsColoursMissingValuesAndConstants) {
  Image image = image_of({3, 1, 1}, [](Index x, Index, Index) { return x == 1 ? NAN : static_cast<float>(x); });
  EXPECT_EQ(pixel(without_contour(image), 1, 0), grey(0));
  EXPECT_EQ(pixel(without_contour(image), 2, 0), grey(255));
  const Image constant = image_of({3, 2, 1}, [](Index, Index, Index) { return -3.0F; });
  EXPECT_EQ(pixel(without_contour(constant), 1, 1), grey(128));
  const Image speck = image_of({50, 50, 1}, [](Index x, Index y, Index) { return x == 7 && y == 9 ? 1.0F : 0.0F; });
  EXPECT_EQ(pixel(without_contour(speck), 7, 9), grey(255)) << "though it is less than the window leaves out";
  VolumeLayout rgb;
  rgb.grid.size = {2, 1, 1};
  rgb.components = 3;
  Image colored(rgb);
  colored.values = {0, 51, 255, 255, 0, 0};
  EXPECT_EQ(pixel(without_contour(colored, {.window = {0, 1}}), 0, 0), (RgbColor{0, 51, 255}));
}

TEST(Preview, RefusesWhatItCannotShow) {
  const Image image = image_of({9, 8, 7}, [](Index, Index, Index) { return 0.0F; });
  const auto message = [&](const PreviewOptions& options) {
    return invalid_input_message([&] { preview<3>(image, {}, options); });
  };
  EXPECT_EQ(invalid_input_message([&] { preview<2>(image, {}); }),
            "preview: axes of the image = 3: must be at most those of the field");
  EXPECT_EQ(message({.axis = 3}), "preview: axis = 3: must be 0, 1 or 2");
  EXPECT_EQ(
      message({.slice = 7}),
      "preview: slice = 7: must be one of the 7 slices, from 0 on, or -1 for the one with the largest area inside");
  EXPECT_EQ(message({.frame = 1}), "preview: frame = 1: must be one of the 1 frames, from 0 on");
  EXPECT_EQ(message({.size = 0}), "preview: size = 0: must be between 1 and 16384 pixels");
  EXPECT_EQ(message({.window = {0.5, 0.5}}),
            "preview: window = 0.500000 to 0.500000: must be two shares of the voxels, ascending, between 0 and 1");
  Image long_voxels = image;
  long_voxels.grid.spacing[1] = 1e6;
  EXPECT_NE(invalid_input_message([&] { preview<3>(long_voxels, {}); }).find("pixels along the longest side = 8e+06"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::preview_test
