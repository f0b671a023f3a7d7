#pragma once

#include "csrbf/core/field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

// Rays, and where they first meet a surface by brute force.
namespace csrbf {

struct Rays {
  Points<3> origins, directions;  // unit vectors

  [[nodiscard]] Index size() const { return origins.cols(); }
};

/// Rays from a sphere around the box towards random points of the box.
inline Rays random_rays(const Box<3>& box, Index n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Rays rays{Points<3>(3, n), Points<3>(3, n)};
  for (Index i = 0; i < n; ++i) {
    rays.origins.col(i) =
        box.center() + box.diagonal() * Point<3>(normal(random), normal(random), normal(random)).normalized();
    const Point<3> target =
        box.lo + box.extent().cwiseProduct(Point<3>(uniform(random), uniform(random), uniform(random)));
    rays.directions.col(i) = (target - rays.origins.col(i)).normalized();
  }
  return rays;
}

/// Number of rays whose first hit, by sampling f at `samples` places and bisection, is not `t` up to 1e-9 of the
/// diagonal of the field's bounds. A hit before that counts as right when f changes its sign there: samples may miss
/// two zeros.
inline Index disagreements(const Field<3>& field, const Rays& rays, const Eigen::VectorXd& t, Index samples) {
  const double tolerance = 1e-9 * field.bounds().diagonal(), reach = 2.2 * field.bounds().diagonal();
  Index wrong = 0;
  Points<3> x(3, samples + 1);
  for (Index i = 0; i < rays.size(); ++i) {
    const Point<3> o = rays.origins.col(i), d = rays.directions.col(i);
    const double step = reach / static_cast<double>(samples);
    for (Index k = 0; k <= samples; ++k) x.col(k) = o + step * static_cast<double>(k) * d;
    const Eigen::VectorXd f = field.evaluate(x).value;
    double expected = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < samples; ++k) {
      if ((f[k] > 0) == (f[k + 1] > 0)) continue;
      double lo = step * static_cast<double>(k), hi = lo + step;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (lo + hi);
        ((field(o + middle * d) > 0) == (f[k] > 0) ? lo : hi) = middle;
      }
      expected = 0.5 * (lo + hi);
      break;
    }
    const bool both_miss = std::isinf(t[i]) && std::isinf(expected);
    if (both_miss || std::abs(t[i] - expected) <= tolerance) continue;
    const bool earlier =
        t[i] < expected && (field(o + (t[i] - tolerance) * d) > 0) != (field(o + (t[i] + tolerance) * d) > 0);
    if (!earlier) {
      ++wrong;
      ADD_FAILURE() << "ray " << i << " meets the surface at " << expected << ", not at " << t[i];
    }
  }
  return wrong;
}

}  // namespace csrbf
