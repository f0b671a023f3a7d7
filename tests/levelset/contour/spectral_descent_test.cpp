#include "csrbf/levelset/contour/spectral_descent.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace csrbf::spectral_descent_test {
namespace {

// sum of (1 + i) / 2 (x_i - i / 10)^2
double bowl(const float* x, float* derivatives) {
  double sum = 0;
  for (int i = 0; i < 20; ++i) {
    const double off = static_cast<double>(x[i]) - 0.1 * i;
    sum += 0.5 * (1 + i) * off * off;
    derivatives[i] = static_cast<float>((1 + i) * off);
  }
  return sum;
}

TEST(SpectralDescent, FindsTheLeastValueWithinTheLimit) {
  std::vector<float> x(20, -0.5F);
  std::vector<double> energies;
  spectral_descent(bowl, {1.2F, 0.01, 200, 0}, x, energies);
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(x[i], std::min(1.2, 0.1 * i), 1e-4);
}

TEST(SpectralDescent, GoesOnFromBeyondTheLimit) {
  std::vector<float> x(20, -0.5F);
  x[3] = 5;
  std::vector<double> energies;
  spectral_descent(bowl, {1.2F, 0.01, 200, 0}, x, energies);
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(x[i], std::min(1.2, 0.1 * i), 1e-4);
}

TEST(SpectralDescent, NeverRaisesTheFunctionAndCountsItsEvaluations) {
  for (const double rate : {1e-3, 1.0, 1e3}) {
    int evaluations = 0;
    const auto valley = [&](const float* x, float* derivatives) {  // Rosenbrock's
      ++evaluations;
      const auto a = static_cast<double>(x[0]), b = static_cast<double>(x[1]), across = b - a * a;
      derivatives[0] = static_cast<float>(2 * (a - 1) - 400 * a * across);
      derivatives[1] = static_cast<float>(200 * across);
      return (a - 1) * (a - 1) + 100 * across * across;
    };
    std::vector<float> x{-1.2F, 1};
    std::vector<double> energies;
    const int used = spectral_descent(valley, {3, rate, 50, 0}, x, energies);
    EXPECT_EQ(used, evaluations);
    EXPECT_LT(used, 50 + 10);  // the last step may try ten times
    for (std::size_t i = 1; i < energies.size(); ++i) EXPECT_LE(energies[i], energies[i - 1]);
    EXPECT_LT(energies.back(), 0.5 * energies.front());
  }
}

TEST(SpectralDescent, StopsWhereStepsLowerLittle) {
  std::vector<float> x(20, -0.5F), y = x;
  std::vector<double> energies;
  const int loose = spectral_descent(bowl, {2, 0.01, 200, 1e-1}, x, energies);
  EXPECT_LT(loose, spectral_descent(bowl, {2, 0.01, 200, 1e-6}, y, energies));
}

}  // namespace
}  // namespace csrbf::spectral_descent_test
