#include "csrbf/implicit/render/color_map.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Linear sRGB from Oklab (Ottosson 2020), a perceptually uniform space: lightness, and chroma at a hue in radians.
LinearRgb from_oklab(float lightness, float chroma, float hue) {
  Eigen::Matrix3f to_cone_roots, to_rgb;
  to_cone_roots << 1.0F, 0.3963377774F, 0.2158037573F,  //
      1.0F, -0.1055613458F, -0.0638541728F,             //
      1.0F, -0.0894841775F, -1.2914855480F;
  to_rgb << 4.0767416621F, -3.3077115913F, 0.2309699292F,  //
      -1.2684380046F, 2.6097574011F, -0.3413193965F,       //
      -0.0041960863F, -0.7034186147F, 1.7076147010F;
  const LinearRgb lab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
  const LinearRgb cones = (to_cone_roots * lab).array().cube();
  return (to_rgb * cones).cwiseMax(0.0F).cwiseMin(1.0F);
}

constexpr float to_radians(float degrees) {
  return degrees * 0.017453292F;
}

}  // namespace

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

// Lightness, chroma and hue of both colour maps were chosen by hand within the sRGB gamut.
LinearRgb sequential_color(double t) {
  const auto s = static_cast<float>(std::clamp(t, 0.0, 1.0));
  const float chroma = 0.11F + 0.05F * s;  // as much as the gamut allows at the dark end and the green middle
  return from_oklab(0.30F + 0.62F * s, chroma, to_radians(275.0F - 170.0F * s));
}

LinearRgb diverging_color(double t) {
  const auto s = static_cast<float>(std::clamp(t, -1.0, 1.0));
  const float strength = std::abs(s);
  const float hue = s < 0 ? to_radians(255) : to_radians(33);
  return from_oklab(0.95F - 0.43F * strength, 0.15F * std::pow(strength, 0.8F), hue);
}

}  // namespace csrbf
