#include "csrbf/implicit/render/color_map.hpp"

#include <gtest/gtest.h>

namespace csrbf::color_map_test {
namespace {

constexpr float rounding = 1e-5F;

// Relative luminance (CIE Y) of linear sRGB.
float luminance(const LinearRgb& c) {
  return c.dot(LinearRgb(0.2126F, 0.7152F, 0.0722F));
}

// Lightness L* in [0, 100], close to how bright a colour looks.
float lightness(const LinearRgb& c) {
  return 116 * std::cbrt(luminance(c)) - 16;
}

TEST(ColorMap, SrgbEncodingHasItsDefinedValuesAndInverse) {
  EXPECT_FLOAT_EQ(srgb_from_linear(0), 0);
  EXPECT_NEAR(srgb_from_linear(1), 1, rounding);
  EXPECT_NEAR(srgb_from_linear(0.214041F), 0.5F, rounding);
  for (int i = 0; i <= 255; ++i) {
    const float encoded = static_cast<float>(i) / 255;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(encoded)), encoded, rounding);
  }
}

TEST(ColorMap, SequentialColorsGetEvenlyLighter) {
  float previous = lightness(sequential_color(0));
  EXPECT_LT(previous, 25);
  EXPECT_GT(lightness(sequential_color(1)), 85);
  for (int i = 1; i <= 20; ++i) {
    const float next = lightness(sequential_color(i / 20.0));
    EXPECT_GT(next - previous, 1.5F);
    EXPECT_LT(next - previous, 5.5F);
    previous = next;
  }
}

TEST(ColorMap, DivergingColorsAreLightInTheMiddleAndEquallyDarkOnBothSides) {
  const LinearRgb middle = diverging_color(0);
  EXPECT_LT(middle.maxCoeff() - middle.minCoeff(), 0.02F);
  EXPECT_GT(lightness(middle), 90);
  for (int i = 1; i <= 10; ++i) {
    const LinearRgb negative = diverging_color(-i / 10.0), positive = diverging_color(i / 10.0);
    EXPECT_GT(negative[2], negative[0]);
    EXPECT_GT(positive[0], positive[2]);
    EXPECT_NEAR(lightness(negative), lightness(positive), 6);
    EXPECT_LT(lightness(positive), lightness(diverging_color((i - 1) / 10.0)));
  }
}

TEST(ColorMap, ValuesOutsideTheScaleGetTheColorOfItsEnds) {
  EXPECT_EQ(sequential_color(-3), sequential_color(0));
  EXPECT_EQ(sequential_color(7), sequential_color(1));
  EXPECT_EQ(diverging_color(-7), diverging_color(-1));
  EXPECT_EQ(diverging_color(7), diverging_color(1));
}

}  // namespace
}  // namespace csrbf::color_map_test
