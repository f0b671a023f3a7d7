#include "csrbf/implicit/draw_contour.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

namespace csrbf::draw_contour_test {
namespace {

constexpr RgbColor white{255, 255, 255};

ContourLines line_of(const std::vector<Point<2>>& points, bool closed) {
  ContourLines contours;
  contours.points.resize(2, static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) contours.points.col(static_cast<Index>(i)) = points[i];
  contours.lines = {{.begin = 0, .size = contours.points.cols(), .closed = closed}};
  return contours;
}

std::uint8_t red(const RgbImage& picture, int x, int y) {
  return picture.pixels[3 * (y * picture.width + x)];
}

double sum_of_red(const RgbImage& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.pixels.size(); i += 3) sum += picture.pixels[i] / 255.0;
  return sum;
}

TEST(DrawContour, FillsTheRowOfPixelsThatALineRunsThrough) {
  RgbImage picture(8, 5);
  draw_contour(line_of({{-1, 2.5}, {9, 2.5}}, false), {white, 1}, picture);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 8; ++x) EXPECT_EQ(red(picture, x, y), y == 2 ? 255 : 0);
}

TEST(DrawContour, SharesALineBetweenRowsOfPixels) {
  RgbImage picture(8, 5);
  draw_contour(line_of({{-1, 2}, {9, 2}}, false), {{200, 100, 50}, 1}, picture);
  for (int x = 0; x < 8; ++x) {
    EXPECT_EQ(red(picture, x, 1), 100);
    EXPECT_EQ(red(picture, x, 2), 100);
    EXPECT_EQ(red(picture, x, 3), 0);
  }
  EXPECT_EQ(picture.pixels[3 * 8 + 1], 50);
  EXPECT_EQ(picture.pixels[3 * 8 + 2], 25);
}

TEST(DrawContour, CoversTheAreaOfTheLine) {
  const double r = 30, width = 3;
  std::vector<Point<2>> circle;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * std::numbers::pi * i / 400;
    circle.emplace_back(40.3 + r * std::cos(angle), 39.8 + r * std::sin(angle));
  }
  RgbImage closed(80, 80);
  draw_contour(line_of(circle, true), {white, width}, closed);
  const double area = 2 * std::numbers::pi * r * width;
  constexpr double rounding = 0.5 / 255 * 80 * 80;  // of each pixel
  EXPECT_NEAR(sum_of_red(closed), area, rounding);
  circle.resize(201);  // half of it
  RgbImage open(80, 80);
  draw_contour(line_of(circle, false), {white, width}, open);
  EXPECT_NEAR(sum_of_red(open), area / 2 + std::numbers::pi * width * width / 4, rounding) << "with round ends";
}

TEST(DrawContour, CutsOffWhatIsOutside) {
  RgbImage picture(4, 4);
  draw_contour(line_of({{-1e9, -1e9}, {-5, 1e9}, {1e9, 7}}, true), {white, 2}, picture);
  EXPECT_EQ(sum_of_red(picture), 0);
  draw_contour({}, {white, 2}, picture);
  EXPECT_EQ(sum_of_red(picture), 0);
}

TEST(DrawContour, RefusesLinesWithoutWidth) {
  RgbImage picture(4, 4);
  EXPECT_EQ(invalid_input_message([&] {
              draw_contour({}, {white, 0}, picture);
            }),
            "draw_contour: width = 0: must be a positive number of pixels");
  EXPECT_NE(invalid_input_message([&] { draw_contour({}, {white, NAN}, picture); }), "");
}

}  // namespace
}  // namespace csrbf::draw_contour_test
