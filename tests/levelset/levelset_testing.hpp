#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

namespace csrbf {

/// An image with the labels that it was made from.
struct TestImage {
  Grid grid;
  std::vector<float> values;
  std::vector<unsigned char> truth;
};

/// Voxels of value `in` where inside(p) > 0 (p in physical coordinates) and `out` elsewhere, and Gaussian noise.
inline TestImage two_level_image(const Grid& grid, const std::function<double(const Point<3>&)>& inside, double in,
                                 double out, double noise, unsigned seed = 1) {
  TestImage image{grid, {}, {}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const Points<3> centers = grid.centers<3>();
  for (Index i = 0; i < grid.voxels(); ++i) {
    const bool object = inside(centers.col(i)) > 0;
    image.truth.push_back(object ? 1 : 0);
    image.values.push_back(static_cast<float>((object ? in : out) + noise * normal(random)));
  }
  return image;
}

inline Grid square_grid(Index n) {
  Grid grid;
  grid.axes = 2;
  grid.size = {n, n, 1};
  return grid;
}

/// A disc with two holes in a noisy square of n^2 voxels.
inline TestImage holed_disc(Index n, double noise, unsigned seed = 1) {
  const double s = static_cast<double>(n);
  return two_level_image(
      square_grid(n),
      [s](const Point<3>& p) {
        const auto disc = [&](double x, double y, double r) { return r * s - std::hypot(p[0] - x * s, p[1] - y * s); };
        return std::min({disc(.5, .48, .35), -disc(.62, .48, .1), -disc(.38, .45, .08)});
      },
      200, 60, noise, seed);
}

/// 1 in the disc (or ball) of this radius.
inline std::vector<unsigned char> ball_labels(const Grid& grid, const Point<3>& center, double radius) {
  std::vector<unsigned char> labels;
  const Points<3> centers = grid.centers<3>();
  for (Index i = 0; i < grid.voxels(); ++i) labels.push_back((centers.col(i) - center).norm() < radius ? 1 : 0);
  return labels;
}

struct Means {
  double inside = 0, outside = 0;
};

inline Means means_of(const std::vector<float>& values, const unsigned char* labels) {
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum[labels[i]] += static_cast<double>(values[i]);
    ++count[labels[i]];
  }
  return {count[1] > 0 ? sum[1] / count[1] : 0, count[0] > 0 ? sum[0] / count[0] : 0};
}

/// sum_in (I - C1)^2 + sum_out (I - C2)^2
inline double two_means_energy(const std::vector<float>& values, const unsigned char* labels) {
  const Means C = means_of(values, labels);
  double energy = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    energy += std::pow(static_cast<double>(values[i]) - (labels[i] != 0 ? C.inside : C.outside), 2);
  return energy;
}

/// The forces of Chan and Vese, V = (I - C1)^2 - (I - C2)^2; eq. (8.31) has the opposite sign. Appends the energy of
/// the labels to `energies` unless null.
inline ForceUpdate chan_vese_force(const std::vector<float>& values, std::vector<double>* energies = nullptr) {
  return [&values, energies](const unsigned char* labels, float* force) {
    const Means C = means_of(values, labels);
    if (energies != nullptr) energies->push_back(two_means_energy(values, labels));
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto I = static_cast<double>(values[i]);
      force[i] = static_cast<float>(std::pow(I - C.inside, 2) - std::pow(I - C.outside, 2));
    }
  };
}

inline double dice(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b) {
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] != 0 && b[i] != 0 ? 1 : 0;
    sum += (a[i] != 0 ? 1 : 0) + (b[i] != 0 ? 1 : 0);
  }
  return sum > 0 ? 2 * both / sum : 1;
}

}  // namespace csrbf
