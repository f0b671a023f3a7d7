#include "csrbf/approx/transform/value_transform.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {

std::string name_of(Transform transform) {
  if (transform == Transform::square_root) return "sqrt";
  return transform == Transform::logarithm ? "log" : "none";
}

double transformed(Transform transform, double value) {
  if (transform == Transform::square_root) return std::sqrt(value);
  return transform == Transform::logarithm ? std::log(value) : value;
}

double log_slope(Transform transform, double value) {
  if (transform == Transform::none) return 0;
  return transform == Transform::square_root ? -0.5 * std::log(value) : -std::log(value);
}

MeanValue mean_value(Transform transform, double z, double noise) {
  if (transform == Transform::none) return {z, 1, 0};
  if (transform == Transform::square_root) {
    const double root = std::max(z, 0.0);
    return {root * root + noise * noise, 2 * root, z > 0 ? 2.0 : 0.0};
  }
  const double value = std::exp(z + noise * noise / 2);
  return {value, value, value};
}

double squared_error(Transform transform, double z, double variance, double noise) {
  if (transform == Transform::none) return variance;
  const double mean = mean_value(transform, z, noise).value;
  if (transform == Transform::square_root)
    return 4 * z * z * variance + 2 * variance * variance + std::pow(z * z + variance - mean, 2);
  const double n2 = noise * noise;
  return mean * mean * (std::expm1(2 * variance - n2) - 2 * std::expm1((variance - n2) / 2));
}

double noise_of_value(Transform transform, double z, double noise) {
  if (transform == Transform::none) return noise;
  if (transform == Transform::square_root) return noise * std::sqrt(4 * z * z + 2 * noise * noise);
  return mean_value(transform, z, noise).value * std::sqrt(std::expm1(noise * noise));
}

}  // namespace csrbf
