#pragma once

#include "csrbf/levelset/segment.hpp"
#include "levelset/levelset_testing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace csrbf {

/// An image and what is inside.
struct Phantom {
  Volume<float> image;
  std::vector<std::uint8_t> truth;
};

/// A picture of n x n pixels: 40 outside and 210 inside of what distance(x, y) > 0 says (coordinates from the middle),
/// with an edge `blur` voxels wide, and noise of that standard deviation.
inline Phantom make_phantom(Index n, const std::function<double(double, double)>& distance, double blur, double noise,
                            unsigned seed = 1) {
  VolumeLayout layout;
  layout.grid.axes = 2;
  layout.grid.size = {n, n, 1};
  Phantom phantom{Volume<float>(layout), std::vector<std::uint8_t>(static_cast<std::size_t>(n * n))};
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, 1);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const double d = distance(static_cast<double>(x) - middle, static_cast<double>(y) - middle);
      const auto i = static_cast<std::size_t>(x + n * y);
      phantom.truth[i] = d > 0 ? 1 : 0;
      const double share = 0.5 + 0.5 * std::erf(d / blur);
      phantom.image.values[i] = static_cast<float>(40 + 170 * share + noise * normal(generator));
    }
  return phantom;
}

/// A body with a hole and a far island: distances are close to Euclidean.
inline double islands(double x, double y) {
  const double angle = std::atan2(y, x);
  const double body = 60 + 8 * std::cos(3 * angle) - std::hypot(x, y);
  const double hole = std::hypot(x + 15, y) - 14;
  const double island = 12 - std::hypot(x - 80, y + 80);
  return std::max(std::min(body, hole), island);
}

inline std::vector<std::uint8_t> disc_seed(Index n, double x, double y, double radius) {
  std::vector<std::uint8_t> seed(n * n, 0);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i)
      if (std::hypot(static_cast<double>(i) - middle - x, static_cast<double>(j) - middle - y) < radius)
        seed[i + n * j] = 1;
  return seed;
}

template <int Dim>
void expect_falling_energy(const Segmentation<Dim>& segmentation) {
  const std::vector<double>& energy = segmentation.report.energy;
  ASSERT_FALSE(energy.empty());
  for (std::size_t i = 1; i < energy.size(); ++i) ASSERT_LE(energy[i], energy[i - 1]) << "step " << i;
}

}  // namespace csrbf
