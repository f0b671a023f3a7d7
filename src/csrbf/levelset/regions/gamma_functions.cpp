#include "csrbf/levelset/regions/gamma_functions.hpp"

#include <cmath>
#include <limits>

namespace csrbf {

double digamma(double x) {
  double below = 0;
  for (; x < 10; ++x) below += 1 / x;  // digamma(x + 1) = digamma(x) + 1 / x
  const double r = 1 / (x * x);
  // Bernoulli numbers B_2k / 2k
  const double series =
      r * (1. / 12 - r * (1. / 120 - r * (1. / 252 - r * (1. / 240 - r * (1. / 132 - r * (691. / 32760 - r / 12))))));
  return std::log(x) - .5 / x - series - below;
}

GammaShares gamma_shares(double s, double z) {
  if (!(z > 0)) return {};
  constexpr double precision = std::numeric_limits<double>::epsilon();
  constexpr int most_terms = 100000;  // about sqrt(s) times a few are needed: never reached for s up to 1e4
  const double factor = std::exp(s * std::log(z) - z - std::lgamma(s));
  if (z < s + 1) {
    double term = 1 / s;
    double sum = term;
    for (int n = 1; n < most_terms && term > precision * sum; ++n) {
      term *= z / (s + n);
      sum += term;
    }
    const double below = std::fmin(1, factor * sum);
    return {below, 1 - below};
  }
  // Continued fraction 1 / (z + 1 - s - 1 (1 - s) / (z + 3 - s - 2 (2 - s) / ...)), its convergents by ratios.
  double b = z + 1 - s;
  double d = 1 / b;
  double c = std::numeric_limits<double>::max();
  double value = d;
  for (int n = 1; n < most_terms; ++n) {
    const double a = -n * (n - s);
    b += 2;
    d = 1 / (b + a * d);
    c = b + a / c;
    const double ratio = c * d;
    value *= ratio;
    if (std::abs(ratio - 1) < precision) break;
  }
  const double above = std::fmin(1, factor * value);
  return {1 - above, above};
}

}  // namespace csrbf
