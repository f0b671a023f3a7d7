#include "csrbf/implicit/render/light_pattern.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

// Point i of Sobol's sequence in the unit square: the reflected binary digits, and the same through Pascal's triangle.
Point<2> sobol_point(std::uint32_t i) {
  std::uint32_t x = 0, y = 0, column = 1U << 31;
  for (std::uint32_t bit = 1U << 31; i != 0; i >>= 1, bit >>= 1, column ^= column >> 1) {
    if ((i & 1U) == 0) continue;
    x ^= bit;
    y ^= column;
  }
  return {x * 0x1p-32, y * 0x1p-32};
}

// Area-preserving map of the unit square to the unit disk by concentric rings (Shirley, Chiu 1997).
Point<2> disk_point(const Point<2>& square) {
  const Point<2> s = 2 * square - Point<2>::Ones();
  if (s.isZero()) return Point<2>::Zero();
  const bool wide = std::abs(s[0]) > std::abs(s[1]);
  const double radius = wide ? s[0] : s[1];
  constexpr double quarter = std::numbers::pi / 4;
  const double angle = wide ? quarter * (s[1] / s[0]) : 2 * quarter - quarter * (s[0] / s[1]);
  return radius * Point<2>(std::cos(angle), std::sin(angle));
}

}  // namespace

LightPattern::LightPattern(int rays_per_sample) : rays_per_sample_(rays_per_sample) {
  const Point<2> shift(1.0 / 256, 1.0 / 256);  // off the corner where the sequence starts
  const int count = classes * rays_per_sample;
  sky_.reserve(count);
  for (int i = 0; i < count; ++i) {
    const Point<2> p = disk_point(sobol_point(static_cast<std::uint32_t>(i)) + shift);
    const double z = std::sqrt(std::max(0.0, 1 - p.squaredNorm()));
    const double golden = std::fmod(i * (std::numbers::phi - 1), 1.0);
    sky_.push_back({Point<3>(p[0], p[1], z), 0.25 + 0.75 * golden});
  }
  for (std::size_t i = 0; i < classes; ++i) lamp_[i] = disk_point(sobol_point(static_cast<std::uint32_t>(i)) + shift);
}

}  // namespace csrbf
