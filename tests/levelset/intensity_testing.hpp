#pragma once

#include "csrbf/levelset/regions/region_model.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace csrbf {

/// Those that have a likelihood.
inline constexpr IntensityLaw likelihood_laws[] = {IntensityLaw::gaussian, IntensityLaw::generalized_gaussian,
                                                   IntensityLaw::rayleigh, IntensityLaw::gamma};

/// Samples of the generalised Gaussian of this shape around 0: |x / scale|^shape has the gamma distribution of shape
/// 1 / shape.
inline std::vector<float> generalized_gaussian_samples(std::size_t n, double scale, double shape, unsigned seed) {
  std::mt19937_64 random(seed);
  std::gamma_distribution<double> power(1 / shape);
  std::vector<float> samples(n);
  for (float& sample : samples) {
    const double x = scale * std::pow(power(random), 1 / shape);
    sample = static_cast<float>(random() % 2 == 0 ? x : -x);
  }
  return samples;
}

inline std::vector<float> uniform_samples(std::size_t n, double half_width, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-half_width, half_width);
  std::vector<float> samples(n);
  for (float& sample : samples) sample = static_cast<float>(uniform(random));
  return samples;
}

/// Logarithm of the density, from its definition.
inline double log_density(const RegionModel& m, double x) {
  const double t = (x - m.location) / m.scale;
  switch (m.law) {
    case IntensityLaw::chan_vese:
      break;
    case IntensityLaw::gaussian:
      return -.5 * t * t - .5 * std::log(2 * std::numbers::pi) - std::log(m.scale);
    case IntensityLaw::generalized_gaussian:
      return std::log(m.shape / (2 * m.scale)) - std::lgamma(1 / m.shape) - std::pow(std::abs(t), m.shape);
    case IntensityLaw::rayleigh:
      return std::log(t / m.scale) - .5 * t * t;
    case IntensityLaw::gamma:
      return (m.shape - 1) * std::log(t) - t - std::lgamma(m.shape) - std::log(m.scale);
  }
  return 0;
}

}  // namespace csrbf
