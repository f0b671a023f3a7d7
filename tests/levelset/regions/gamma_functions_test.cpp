#include "csrbf/levelset/regions/gamma_functions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace csrbf::gamma_functions_test {
namespace {

constexpr double rounding = 1e-14;

TEST(Digamma, HasItsKnownValues) {
  EXPECT_NEAR(digamma(1), -std::numbers::egamma, rounding);
  EXPECT_NEAR(digamma(.5), -std::numbers::egamma - 2 * std::numbers::ln2, rounding);
  EXPECT_NEAR(digamma(2), 1 - std::numbers::egamma, rounding);
}

TEST(Digamma, IsTheDerivativeOfLogGamma) {
  for (const double x : {.05, .3, 1.0, 2.7, 9.99, 10.01, 400.0}) {
    const double h = 1e-5 * x;
    EXPECT_NEAR(digamma(x), (std::lgamma(x + h) - std::lgamma(x - h)) / (2 * h), 1e-8 * (1 / x + x)) << x;
  }
}

TEST(GammaShares, OfShapeOneAreExponential) {
  for (const double z : {1e-3, .5, 1.9, 2.1, 30.0}) {
    EXPECT_NEAR(gamma_shares(1, z).above / std::exp(-z), 1, rounding) << z;
    EXPECT_NEAR(gamma_shares(1, z).below / -std::expm1(-z), 1, rounding) << z;
  }
}

TEST(GammaShares, OfShapeOneHalfAreErrorFunctions) {
  for (const double z : {1e-3, .5, 1.4, 1.6, 30.0}) {
    EXPECT_NEAR(gamma_shares(.5, z).below / std::erf(std::sqrt(z)), 1, rounding) << z;
    EXPECT_NEAR(gamma_shares(.5, z).above / std::erfc(std::sqrt(z)), 1, rounding) << z;
  }
}

TEST(GammaShares, ObeyTheirRecurrence) {
  // P(s, z) = P(s + 1, z) + z^s exp(-z) / Gamma(s + 1)
  for (const double s : {.05, .4, 3.0, 60.0}) {
    for (const double z : {.3 * s, .99 * s + .99, s + 1.01, 2 * s + 3}) {
      const double step = std::exp(s * std::log(z) - z - std::lgamma(s + 1));
      EXPECT_NEAR(gamma_shares(s, z).below, gamma_shares(s + 1, z).below + step, 10 * rounding) << s << " " << z;
    }
  }
}

TEST(GammaShares, EndAtZero) {
  EXPECT_EQ(gamma_shares(2, 0).below, 0);
  EXPECT_EQ(gamma_shares(2, -1).above, 1);
  EXPECT_NEAR(gamma_shares(2, 700).below, 1, rounding);
}

}  // namespace
}  // namespace csrbf::gamma_functions_test
