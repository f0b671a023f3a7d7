#pragma once

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "levelset/segment_testing.hpp"

namespace csrbf {

/// Speckle of power 1 outside and `dark` inside of what distance(x, y) > 0 says, seen through a point spread of
/// amplitudes of these deviations along x and y, shown as amplitude^exponent, exponent 0 as its logarithm.
inline Phantom make_speckle(Index n, const std::function<double(double, double)>& distance, double dark,
                            double exponent, const std::array<double, 3>& grain, unsigned seed = 1) {
  Phantom phantom = make_phantom(n, distance, 1, 0);
  std::vector<float>& values = phantom.image.values;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<float> real(values.size()), imaginary(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double amplitude = phantom.truth[i] != 0 ? std::sqrt(dark) : 1;
    real[i] = static_cast<float>(amplitude * normal(generator));
    imaginary[i] = static_cast<float>(amplitude * normal(generator));
  }
  gaussian_blur(real, phantom.image.grid.size, grain);
  gaussian_blur(imaginary, phantom.image.grid.size, grain);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double envelope = std::hypot(static_cast<double>(real[i]), static_cast<double>(imaginary[i]));
    values[i] = static_cast<float>(exponent > 0 ? 200 * std::pow(envelope, exponent) : 200 + 40 * std::log(envelope));
  }
  return phantom;
}

inline double cavity(double x, double y) {
  return 45 + 6 * std::cos(3 * std::atan2(y, x)) - std::hypot(x, y);
}

}  // namespace csrbf
