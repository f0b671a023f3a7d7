#include "csrbf/kernels/wendland.hpp"

#include "csrbf/kernels/kernel.hpp"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <functional>
#include <random>
#include <tuple>
#include <vector>

namespace csrbf::wendland_test {
namespace {

struct Wendland : Kernel {
  Wendland(int d, int k) : Kernel("wendland-c" + std::to_string(2 * k), d) {}
  [[nodiscard]] double second(double r) const { return g(r) + q(r); }
};

constexpr double rounding = 1e-13;  // some tens of roundings of numbers of order 1 to 100

// One row of the table of closed forms, with a = 1 - r.
struct Reference {
  int d;
  int k;
  double quarter;  // phi(1/4)
  double half;     // phi(1/2)
  double slope;    // max |phi'|
  double at;       // where |phi'| is largest
  double bend;     // -phi''(0)
  double (*value)(double r);
  double (*g)(double r);
  double (*q)(double r);
};

double power(double x, int n) {
  return std::pow(x, n);
}
double none(double) {
  return 0;
}

// Closed forms derived independently (Askey's function and the integral operator I f(r) = int_r^1 t f(t) dt).
const Reference references[] = {
    {1, 0, .75, .5, 1, 0, 0, [](double r) { return 1 - r; }, none, none},
    {1, 1, .73828125, .3125, 16.0 / 9, 1.0 / 3, 12, [](double r) { return power(1 - r, 3) * (3 * r + 1); },
     [](double r) { return -12 * power(1 - r, 2); }, [](double r) { return 24 * r * (1 - r); }},
    {1, 2, .652587890625, .171875, 2.2337631, .27598, 14,
     [](double r) { return power(1 - r, 5) * (8 * r * r + 5 * r + 1); },
     [](double r) { return -14 * power(1 - r, 4) * (4 * r + 1); },
     [](double r) { return 280 * r * r * power(1 - r, 3); }},
    {1, 3, .569392204284668, .0927734375, 2.5906270, .23998, 18,
     [](double r) { return power(1 - r, 7) * (21 * r * r * r + 19 * r * r + 7 * r + 1); },
     [](double r) { return -6 * power(1 - r, 6) * (35 * r * r + 18 * r + 3); },
     [](double r) { return 336 * r * r * power(1 - r, 5) * (5 * r + 1); }},
    {3, 0, .5625, .25, 2, 0, 0, [](double r) { return power(1 - r, 2); }, none, none},
    {3, 1, .6328125, .1875, 135.0 / 64, .25, 20, [](double r) { return power(1 - r, 4) * (4 * r + 1); },
     [](double r) { return -20 * power(1 - r, 3); }, [](double r) { return 60 * r * power(1 - r, 2); }},
    {3, 2, .574722290039062, .108072916666667, 2.4997889, .23557, 56.0 / 3,
     [](double r) { return power(1 - r, 6) * (35 * r * r + 18 * r + 3) / 3; },
     [](double r) { return -56.0 / 3 * power(1 - r, 5) * (5 * r + 1); },
     [](double r) { return 560 * r * r * power(1 - r, 4); }},
    {3, 3, .506821632385254, .0595703125, 2.8191010, .21529, 22,
     [](double r) { return power(1 - r, 8) * (32 * r * r * r + 25 * r * r + 8 * r + 1); },
     [](double r) { return -22 * power(1 - r, 7) * (16 * r * r + 7 * r + 1); },
     [](double r) { return 528 * r * r * power(1 - r, 6) * (6 * r + 1); }},
    {5, 0, .421875, .125, 3, 0, 0, [](double r) { return power(1 - r, 3); }, none, none},
    {5, 1, .533935546875, .109375, 2.4576, .2, 30, [](double r) { return power(1 - r, 5) * (5 * r + 1); },
     [](double r) { return -30 * power(1 - r, 4); }, [](double r) { return 120 * r * power(1 - r, 3); }},
    {5, 2, .500564575195312, .06640625, 2.7699709, .20553, 24,
     [](double r) { return power(1 - r, 7) * (16 * r * r + 7 * r + 1); },
     [](double r) { return -24 * power(1 - r, 6) * (6 * r + 1); },
     [](double r) { return 1008 * r * r * power(1 - r, 5); }},
    {5, 3, .447457802295685, .037548828125, 3.0489808, .19522, 132.0 / 5,
     [](double r) { return power(1 - r, 9) * (231 * r * r * r + 159 * r * r + 45 * r + 5) / 5; },
     [](double r) { return -132.0 / 5 * power(1 - r, 8) * (21 * r * r + 8 * r + 1); },
     [](double r) { return 792 * r * r * power(1 - r, 7) * (7 * r + 1); }},
};

// Gram matrix of random points of the unit cube, with a support that holds about 40 of them.
Eigen::VectorXd gram_eigenvalues(const std::function<double(double)>& phi, int dimension, unsigned seed) {
  constexpr int count = 300;
  constexpr int neighbours = 40;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::MatrixXd points(dimension, count);
  for (double& x : points.reshaped()) x = uniform(random);
  Eigen::MatrixXd distances(count, count);
  for (int i = 0; i < count; ++i) distances.col(i) = (points.colwise() - points.col(i)).colwise().norm().transpose();
  double support = 0;
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd sorted = distances.col(i);
    std::sort(sorted.begin(), sorted.end());
    support += sorted[neighbours] / count;
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>((distances / support).unaryExpr(phi), Eigen::EigenvaluesOnly)
      .eigenvalues();
}

class WendlandOf : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  [[nodiscard]] int d() const { return std::get<0>(GetParam()); }
  [[nodiscard]] int k() const { return std::get<1>(GetParam()); }
  [[nodiscard]] Wendland kernel() const { return {d(), k()}; }
};

TEST(Wendland, HasTheTabulatedValues) {
  for (const Reference& row : references) {
    const Wendland kernel(row.d, row.k);
    EXPECT_NEAR(kernel.value(.25), row.quarter, 1e-15) << row.d << " " << row.k;
    EXPECT_NEAR(kernel.value(.5), row.half, 1e-15) << row.d << " " << row.k;
  }
}

TEST(Wendland, AgreesWithTheClosedForms) {
  for (const Reference& row : references) {
    const Wendland kernel(row.d, row.k);
    for (double r = 0; r <= 1; r += 1.0 / 64) {
      EXPECT_NEAR(kernel.value(r), row.value(r), rounding);
      if (row.k == 0) continue;
      EXPECT_NEAR(kernel.g(r), row.g(r), rounding);
      EXPECT_NEAR(kernel.q(r), row.q(r), rounding);
      EXPECT_NEAR(kernel.second(r), row.g(r) + row.q(r), rounding);
    }
  }
}

TEST(Wendland, HasTheTabulatedBounds) {
  constexpr double printed_digits = 1e-7;  // of the table
  for (const Reference& row : references) {
    if (row.k == 0) continue;
    const Wendland kernel(row.d, row.k);
    EXPECT_NEAR(-row.at * kernel.g(row.at), row.slope, printed_digits);
    EXPECT_DOUBLE_EQ(-kernel.g(0), row.bend);
  }
}

TEST(Wendland, OfAnEvenDimensionIsTheOneOfTheNextOddDimension) {
  for (int d = 2; d <= 6; d += 2)
    for (int k = 0; k <= 3; ++k)
      for (double r = 0; r < 1; r += .1) EXPECT_EQ(Wendland(d, k).value(r), Wendland(d + 1, k).value(r));
}

TEST_P(WendlandOf, IsOneAtTheCentreAndZeroFromTheSupportOn) {
  EXPECT_EQ(kernel().value(0), 1);
  for (const double r : {1.0, std::nextafter(1.0, 2.0), 2.0, 1e200, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(kernel().value(r), 0);
    EXPECT_EQ(kernel().g(r), 0);
    EXPECT_EQ(kernel().h(r), 0);
  }
}

TEST_P(WendlandOf, KeepsItsRelativeAccuracyNearTheEndOfTheSupport) {
  // phi ~ P(1) a^(l+k) there: halving a divides phi by 2^(l+k).
  const double exponent = d() / 2 + 2 * k() + 1;
  const double a = std::ldexp(1.0, -20);
  const double ratio = kernel().value(1 - a) / kernel().value(1 - a / 2);
  EXPECT_NEAR(std::log2(ratio), exponent, 1e-5);  // the next term of the polynomial: O(a)
}

TEST_P(WendlandOf, WalksDownTwoDimensions) {
  if (k() == 0) return;
  const Wendland walked(d() + 2, k() - 1);
  for (double r = 0; r < 1; r += 1.0 / 32)
    EXPECT_NEAR(kernel().g(r), kernel().g(0) * walked.value(r), rounding * -kernel().g(0));
}

TEST_P(WendlandOf, StartsWithTheSameFirstAndSecondDerivative) {
  if (k() == 0) return;
  EXPECT_EQ(kernel().g(0), kernel().second(0));
  EXPECT_EQ(kernel().q(0), 0);
}

TEST_P(WendlandOf, HasNoGradientAtTheCentreWhenItIsOnlyContinuous) {
  if (k() > 0) return;
  EXPECT_EQ(kernel().g(0), 0);
  EXPECT_EQ(kernel().q(0), 0);
  EXPECT_EQ(kernel().h(0), 0);
}

TEST_P(WendlandOf, BendsMostAtTheCentre) {
  if (k() == 0) return;
  double bend = 0;
  for (double r = 0; r <= 1; r += 1e-4) bend = std::max({bend, std::abs(kernel().second(r)), std::abs(kernel().g(r))});
  EXPECT_NEAR(bend, -kernel().g(0), rounding * bend);
}

TEST_P(WendlandOf, HasTheDerivativesOfItsValueToSecondOrder) {
  const auto error = [&](double step) {
    double first = 0;
    double second = 0;
    for (double r = .125; r <= .75; r += .125) {
      const double difference = (kernel().value(r + step) - kernel().value(r - step)) / (2 * step);
      const double bend = (kernel().value(r + step) - 2 * kernel().value(r) + kernel().value(r - step)) / (step * step);
      first = std::max(first, std::abs(difference - r * kernel().g(r)));
      second = std::max(second, std::abs(bend - kernel().second(r)));
    }
    return std::pair(first, second);
  };
  for (double step = 1.0 / 64; step > 1.0 / 1024; step /= 2) {
    const auto [first, second] = error(step);
    const auto [first_half, second_half] = error(step / 2);
    constexpr double exact = 1e-9;  // polynomials of degree two or less are differentiated exactly
    EXPECT_TRUE(first < exact || std::log2(first / first_half) >= 1.9);
    EXPECT_TRUE(second < exact || std::log2(second / second_half) >= 1.9);
  }
}

TEST_P(WendlandOf, HasTheGradientAndHessianOfTheRadialCalculusAlsoAtTheCentre) {
  if (k() == 0) return;
  constexpr double sigma = .7;
  const auto phi = [&](const Eigen::Vector3d& x) { return kernel().value(x.norm() / sigma); };
  const Eigen::Vector3d places[] = {{0, 0, 0}, {1e-9, 0, 0}, {.1, -.2, .3}, {.3, .3, .3}};
  for (const Eigen::Vector3d& x : places) {
    const double r = x.norm() / sigma;
    const Eigen::Vector3d gradient = kernel().g(r) * x / (sigma * sigma);
    const Eigen::Matrix3d hessian =
        (kernel().g(r) * Eigen::Matrix3d::Identity() + kernel().h(r) / (sigma * sigma) * x * x.transpose()) /
        (sigma * sigma);
    constexpr double step = 1e-4;
    // Central differences: O(step^2) where the third derivative exists, O(step) of a C2 function's second ones.
    const double scale = -kernel().g(0) / (sigma * sigma);
    for (int a = 0; a < 3; ++a) {
      const Eigen::Vector3d u = step * Eigen::Vector3d::Unit(a);
      EXPECT_NEAR(gradient[a], (phi(x + u) - phi(x - u)) / (2 * step), scale * 1e-5);
      for (int b = 0; b < 3; ++b) {
        const Eigen::Vector3d v = step * Eigen::Vector3d::Unit(b);
        const double difference =
            (phi(x + u + v) - phi(x + u - v) - phi(x - u + v) + phi(x - u - v)) / (4 * step * step);
        EXPECT_NEAR(hessian(a, b), difference, scale * 5e-3);
      }
    }
  }
}

TEST_P(WendlandOf, HasTheSameValuesInBatches) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1.3);
  for (const int n : {0, 1, 3, 7, 8, 9, 15, 16, 37, 64, 100}) {
    std::vector<double> r2(n);
    for (double& x : r2) x = uniform(random) * uniform(random);
    for (std::size_t i = 0; i < r2.size(); i += 5) r2[i] = std::vector<double>{0, 1, 1e-80, 1e300}[i / 5 % 4];
    constexpr double untouched = 77;
    std::vector<double> values(r2.size() + 1, untouched);
    auto phi = values;
    auto phi2 = values;
    auto g = values;
    auto g2 = values;
    auto h = values;
    kernel().values(r2.data(), n, values.data());
    kernel().gradients(r2.data(), n, phi.data(), g.data());
    kernel().hessians(r2.data(), n, phi2.data(), g2.data(), h.data());
    for (std::size_t i = 0; i < r2.size(); ++i) {
      const double r = std::sqrt(r2[i]);
      EXPECT_NEAR(values[i], kernel().value(r), rounding);
      EXPECT_NEAR(phi[i], kernel().value(r), rounding);
      EXPECT_NEAR(phi2[i], kernel().value(r), rounding);
      EXPECT_NEAR(g[i], kernel().g(r), rounding * (1 + std::abs(kernel().g(r))));
      EXPECT_NEAR(g2[i], kernel().g(r), rounding * (1 + std::abs(kernel().g(r))));
      EXPECT_NEAR(h[i], kernel().h(r), rounding * (1e3 + std::abs(kernel().h(r))));
    }
    for (const auto* written : {&values, &phi, &phi2, &g, &g2, &h}) EXPECT_EQ(written->back(), untouched);
  }
}

TEST_P(WendlandOf, IsZeroInBatchesForInfiniteDistancesAndKeepsNaN) {
  const double r2[] = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()};
  double phi[2];
  double g[2];
  double h[2];
  kernel().hessians(r2, 2, phi, g, h);
  EXPECT_EQ(phi[0], 0);
  EXPECT_EQ(g[0], 0);
  EXPECT_EQ(h[0], 0);
  EXPECT_TRUE(std::isnan(phi[1]));
  EXPECT_TRUE(std::isnan(g[1]));
  EXPECT_TRUE(std::isnan(h[1]));
  EXPECT_TRUE(std::isnan(kernel().value(r2[1])));
}

TEST_P(WendlandOf, GivesSymmetricPositiveDefiniteGramMatricesUpToItsDimension) {
  const int dimension = d() / 2 * 2 + 1;  // the largest one
  const Eigen::VectorXd eigenvalues = gram_eigenvalues([this](double r) { return kernel().value(r); }, dimension, 11);
  // Smooth kernels on a line come close to singular: nothing below the rounding of the largest eigenvalue.
  EXPECT_GT(eigenvalues[0], -1e-14 * eigenvalues[299]);
  EXPECT_TRUE(k() >= 2 || eigenvalues[0] > 0);
}

INSTANTIATE_TEST_SUITE_P(AllDimensionsAndSmoothness, WendlandOf,
                         testing::Combine(testing::Values(1, 2, 3, 4, 5, 6, 7, 8, 11), testing::Values(0, 1, 2, 3)));

TEST(Wendland, IsNotPositiveDefiniteAboveItsDimension) {
  const Wendland hat(1, 0);
  // About -0.3 of a diagonal of ones on sets of this kind.
  EXPECT_LT(gram_eigenvalues([&](double r) { return hat.value(r); }, 2, 11)[0], -.1);
}

TEST(Wendland, WithTheMisprintedCoefficientWouldNotBePositiveDefinite) {
  const auto printed = [](double r) { return r < 1 ? power(1 - r, 5) * (38 * r * r + 5 * r + 1) : 0; };
  EXPECT_LT(gram_eigenvalues(printed, 1, 11)[0], -1);
}

}  // namespace
}  // namespace csrbf::wendland_test
