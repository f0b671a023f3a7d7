#include "csrbf/levelset/contour/contour_energy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace csrbf::contour_energy_test {
namespace {

// A force that favours the disc of that radius about the middle, with noise.
std::vector<float> disc_force(Index n, double radius, double noise, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<float> force(n * n);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const double d = radius - std::hypot(static_cast<double>(x) - middle, static_cast<double>(y) - middle);
      force[x + n * y] = static_cast<float>(-std::clamp(d, -1.0, 1.0) + (noise > 0 ? noise * normal(generator) : 0.0));
    }
  return force;
}

TEST(ContourEnergy, HasTheDerivativesOfItsValues) {
  const Lattice<2> lattice({24, 20, 1}, Point<3>(1, 1.5, 1), {3, 2.5, "wendland-c2"});
  const std::vector<float> force = [] {
    std::vector<float> values(24 * 20);
    std::mt19937 generator(5);
    for (float& value : values) value = std::uniform_real_distribution<float>(-1.5F, 1.5F)(generator);
    return values;
  }();
  std::vector<float> weights(force.size());
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = 0.5F + 0.25F * std::abs(force[i]);
  const ContourEnergy energy{force.data(), 0.7, 0.4, 0.8, weights.data()};
  std::vector<float> a(lattice.array_size()), g(a.size()), direction(a.size());
  std::mt19937 generator(6);
  for (float& c : a) c = std::uniform_real_distribution<float>(-0.5F, 0.5F)(generator);
  for (float& c : direction) c = std::uniform_real_distribution<float>(-1, 1)(generator);
  contour_energy(lattice, energy, a.data(), g.data());
  double slope = 0;
  for (Index i = 0; i < lattice.coefficients(); ++i) slope += static_cast<double>(g[i] * direction[i]);
  constexpr float h = 1e-3F;  // between the rounding of floats and the curvature of E
  const auto moved = [&](float t) {
    std::vector<float> there = a;
    for (std::size_t i = 0; i < there.size(); ++i) there[i] += t * direction[i];
    return contour_energy(lattice, energy, there.data(), nullptr);
  };
  EXPECT_NEAR((moved(h) - moved(-h)) / (2 * static_cast<double>(h)), slope, 2e-3 * std::abs(slope));
}

// The second sum alone is the length of a circle: the coarea formula, whatever eps.
TEST(ContourEnergy, MeasuresTheLengthOfACircle) {
  constexpr Index n = 96;
  constexpr double radius = 30;
  const Lattice<2> lattice({n, n, 1}, Point<3>(1, 1, 1), {4, 4, "wendland-c4"});
  std::vector<float> force = disc_force(n, radius, 0);
  const double middle = 0.5 * (n - 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x)
      force[x + n * y] = static_cast<float>(
          -(radius - std::hypot(static_cast<double>(x) - middle, static_cast<double>(y) - middle)) / 10);
  std::vector<float> a(lattice.array_size(), 0.0F);
  fit_target(lattice, {force.data(), 0, 1, 1}, 200, a);
  const std::vector<float> none(force.size(), 0.0F);
  for (const double eps : {0.1, 0.2}) {
    const double length = contour_energy(lattice, {none.data(), 1, eps, 0}, a.data(), nullptr);
    EXPECT_NEAR(length, 2 * std::numbers::pi * radius, 2e-3 * 2 * std::numbers::pi * radius);
  }
}

TEST(FitTarget, SolvesTheLeastSquaresPart) {
  const Lattice<2> lattice({40, 40, 1}, Point<3>(1, 1, 1), {3, 2.5, "wendland-c2"});
  const std::vector<float> force = disc_force(40, 12, 0.2);
  const ContourEnergy energy{force.data(), 0, 1, 1};
  std::vector<float> a(lattice.array_size(), 0.0F), g(a.size());
  const std::vector<float> none(force.size(), 0.0F);
  fit_target(lattice, energy, 500, a);
  // The derivative of what is left of E without the force in H is that of the least squares; so take H out by eps.
  const ContourEnergy flat{force.data(), 0, 1e6, 1};
  contour_energy(lattice, flat, a.data(), g.data());
  std::vector<float> start(a.size(), 0.0F), at_start(a.size());
  contour_energy(lattice, flat, start.data(), at_start.data());
  double left = 0, before = 0;
  for (Index i = 0; i < lattice.coefficients(); ++i) {
    left = std::max(left, static_cast<double>(std::abs(g[i])));
    before = std::max(before, static_cast<double>(std::abs(at_start[i])));
  }
  EXPECT_LT(left, 4e-3 * before);  // it stops when the residual is a thousandth in the mean
}

TEST(MinimizeContourEnergy, NeverRaisesTheEnergy) {
  for (const double length : {0.0, 1.0})
    for (const double noise : {0.0, 0.5, 2.0}) {
      const Lattice<2> lattice({60, 60, 1}, Point<3>(1, 1, 1), {2, 2.5, "wendland-c2"});
      const std::vector<float> force = disc_force(60, 20, noise);
      std::vector<float> a(lattice.array_size(), 0.0F);
      std::vector<double> energies;
      minimize_contour_energy(lattice, {force.data(), length, 0.2, 1}, 60, 1e-6, a, energies);
      ASSERT_GT(energies.size(), 3U);
      for (std::size_t i = 1; i < energies.size(); ++i) ASSERT_LE(energies[i], energies[i - 1]);
      for (const float c : a) ASSERT_LE(std::abs(c), 2.0F);
    }
}

TEST(MinimizeContourEnergy, FindsADiscToAFractionOfAVoxel) {
  constexpr Index n = 80;
  for (const double radius : {10.3, 20.7, 30.5}) {
    const Lattice<2> lattice({n, n, 1}, Point<3>(1, 1, 1), {3, 2.5, "wendland-c2"});
    const std::vector<float> force = disc_force(n, radius, 0);
    std::vector<float> a(lattice.array_size(), 0.0F);
    std::vector<double> energies;
    fit_target(lattice, {force.data(), 0, 1, 1}, 10, a);
    minimize_contour_energy(lattice, {force.data(), 0, 0.1, 1}, 50, 1e-6, a, energies);
    std::vector<unsigned char> labels(force.size(), 0);
    update_labels(lattice, a, labels.data());
    double area = 0;
    for (const unsigned char label : labels) area += label;
    // A ring a twentieth of a voxel wide, and the counting of voxels.
    EXPECT_NEAR(area, std::numbers::pi * radius * radius, 2 * std::numbers::pi * radius * 0.05 + 8);
  }
}

// The sides of a star with sharp corners, which a smooth fit cuts off.
TEST(SeparateVoxels, BringsThemToTheirSides) {
  constexpr Index n = 120;
  const Lattice<2> lattice({n, n, 1}, Point<3>(1, 1, 1), {2.5, 2.5, "wendland-c2"});
  std::vector<float> force(n * n);
  const double middle = 0.5 * (n - 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const double dx = static_cast<double>(x) - middle, dy = static_cast<double>(y) - middle;
      const double d = 35 + 14 * std::cos(7 * std::atan2(dy, dx)) - std::hypot(dx, dy);
      force[x + n * y] = static_cast<float>(-std::clamp(2 * d, -2.0, 2.0));
    }
  std::fill_n(force.begin(), n * 10, 0.0F);  // these voxels take no part
  std::vector<float> a(lattice.array_size(), 0.0F);
  fit_target(lattice, {force.data(), 0, 1, 1}, 6, a);
  std::vector<unsigned char> labels(force.size(), 0);
  const auto wrong = [&] {
    update_labels(lattice, a, labels.data());
    Index count = 0;
    for (std::size_t i = 0; i < labels.size(); ++i)
      count += force[i] != 0 && (labels[i] != 0) != (force[i] < 0) ? 1 : 0;
    return count;
  };
  EXPECT_GT(wrong(), 20);
  const int used = separate_voxels(lattice, force.data(), 0.05, 40, a);
  EXPECT_LE(used, 50);  // the last step may try ten times
  EXPECT_LE(wrong(), 2);
  // Where all voxels are on their sides nothing is left to do.
  const std::vector<float> nothing(force.size(), 0.0F);
  const std::vector<float> before = a;
  separate_voxels(lattice, nothing.data(), 0.05, 40, a);
  EXPECT_EQ(a, before);
}

// With a length weight L the best disc has force + L kappa = 0 at its border.
TEST(MinimizeContourEnergy, ShrinksADiscByItsCurvature) {
  constexpr Index n = 96;
  constexpr double radius = 20, weight = 4;
  const Lattice<2> lattice({n, n, 1}, Point<3>(1, 1, 1), {3, 3, "wendland-c4"});
  std::vector<float> force(n * n);
  const double middle = 0.5 * (n - 1), slope = 0.1;
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x)
      force[x + n * y] = static_cast<float>(
          -slope * (radius - std::hypot(static_cast<double>(x) - middle, static_cast<double>(y) - middle)));
  std::vector<float> a(lattice.array_size(), 0.0F);
  fit_target(lattice, {force.data(), 0, 1, 1}, 20, a);
  std::vector<double> energies;
  minimize_contour_energy(lattice, {force.data(), weight, 2 * lattice.steepest(), 0.01}, 2000, 1e-9, a, energies);
  std::vector<unsigned char> labels(force.size(), 0);
  update_labels(lattice, a, labels.data());
  double area = 0;
  for (const unsigned char label : labels) area += label;
  // slope (R - r) = weight / r
  const double r = 0.5 * (radius + std::sqrt(radius * radius - 4 * weight / slope));
  EXPECT_NEAR(std::sqrt(area / std::numbers::pi), r, 0.15);  // r is 17.75: the shift of 2.25 voxels is found to 7 %
}

TEST(UpdateLabels, CountsWhatChanged) {
  const Lattice<2> lattice({16, 16, 1}, Point<3>(1, 1, 1), {2, 2.5, "wendland-c2"});
  std::vector<float> a(lattice.array_size(), 1.0F);
  std::vector<unsigned char> labels(256, 0);
  EXPECT_EQ(update_labels(lattice, a, labels.data()), 256);
  EXPECT_EQ(update_labels(lattice, a, labels.data()), 0);
  for (float& c : a) c = -1;
  EXPECT_EQ(update_labels(lattice, a, labels.data()), 256);
}

}  // namespace
}  // namespace csrbf::contour_energy_test
