#include "csrbf/kernels/compact_kernels.hpp"

#include "csrbf/kernels/vector_math.hpp"

namespace csrbf {
namespace {

CSRBF_ALWAYS_INLINE double inside(double r2) {
  const double r = std::sqrt(r2);
  return 1 < r ? 1 : r;  // keeps NaN
}

// artanh(e) - e = e^3 sum_j artanh[j] e^(2j).
constexpr std::array<double, 21> artanh = [] {
  std::array<double, 21> series{};
  for (std::size_t j = 0; j < series.size(); ++j) series[j] = 1.0 / static_cast<double>(2 * j + 3);
  return series;
}();

// phi = e^5 sum_j missing_wendland_tail[j] e^(2j).
constexpr std::array<double, 20> missing_wendland_tail = [] {
  std::array<double, 20> series{};
  for (std::size_t j = 0; j < series.size(); ++j) series[j] = 6.0 / static_cast<double>((2 * j + 3) * (2 * j + 5));
  return series;
}();

struct MissingWendland {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    constexpr double series_below = .16;  // in e2, where the 20 terms are exact to rounding: .16^20 = 1e-16
    const double r = center ? 1e-100 : inside(r2);
    const double e2 = (1 - r) * (1 + r);
    const double e = std::sqrt(e2);
    const double series = polynomial_value<20>(artanh, e2) * e2 * e;
    const double tail = polynomial_value<19>(missing_wendland_tail, e2) * e2 * e2 * e;
    const bool close = e2 < series_below;
    // artanh(e) - e, by its series where the difference would cancel
    const double rest = close ? series : vector_log((1 + e) / r) - e;
    const double phi = close ? tail : e * e2 - 3 * r * r * rest;
    return {center ? 1 : phi, center ? 0 : -6 * rest, center ? 0 : 6 * e / (r * r)};
  }
};

struct BuhmannC1 {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double r = center ? 1 : inside(r2);
    const double s = r * r;
    const double log_r = vector_log(r);
    const double phi = 1 + s * (12 + 12 * log_r + r * (-16 + 3 * r));
    const double g = 24 * log_r + 36 + r * (-48 + 12 * r);
    return {center ? 1 : (phi < 0 ? 0 : phi), g > 0 ? 0 : g, 24 * (1 - r) * (1 - r) / s};
  }
};

struct BuhmannC2 {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double r = center ? 1 : inside(r2);
    const double s = r * r;
    const double log_r = vector_log(r);
    const double phi = 1 + s * (-12 + r * (32 + r * (-21 + 12 * log_r)));
    const double g = -24 + r * (96 + r * (-72 + 48 * log_r));
    const double h = 96 * ((1 - r) / r + log_r);
    return {center ? 1 : (phi < 0 ? 0 : phi), center ? -24 : (g > 0 ? 0 : g), h < 0 ? 0 : h};
  }
};

// In powers of sqrt(r), with the zero of order 4 at r = 1 factored out.
struct BuhmannC3 {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    constexpr std::array<double, 6> factor = {1, 4, 10, 20, 26.6, 22.4};
    const bool center = r2 < center_r2;
    const double s = std::sqrt(inside(r2));
    const double a = 1 - s;
    const double safe = center ? 1 : s;
    return {integer_power<4>(a) * polynomial_value<5>(factor, s), -16.8 * a * a * a * (1 + s * (3 + 6 * s)),
            center ? 0 : 252 * a * a / safe};
  }
};

using WuPolynomial = std::array<double, 7>;

// ((1-r)^m p)' = (1-r)^(m-1) slope.
constexpr WuPolynomial slope_factor(const WuPolynomial& p, int m) {
  WuPolynomial slope{};
  for (std::size_t j = 0; j < p.size(); ++j) {
    const auto degree = static_cast<double>(j);
    slope[j] = -(m + degree) * p[j] + (j + 1 < p.size() ? (degree + 1) * p[j + 1] : 0);
  }
  return slope;
}

// p / r for p(0) = 0.
constexpr WuPolynomial divided(const WuPolynomial& p) {
  WuPolynomial quotient{};
  for (std::size_t j = 0; j + 1 < p.size(); ++j) quotient[j] = p[j + 1];
  return quotient;
}

// phi = (1-r)^m p(r), p of degree m - 1; phi'/r = (1-r)^(m-1) p_g(r) and h = (1-r)^(m-2) p_h(r), over r and r^3 for
// functions of 0 derivatives, h over r for functions of 2. Compile-time constants: the loops become vector code.
struct WuCoefficients {
  WuPolynomial value{};
  WuPolynomial g{};
  WuPolynomial h{};

  // From the integer coefficients of p, before division by p(0).
  constexpr WuCoefficients(int m, int derivatives, const WuPolynomial& p) : value(p), g(slope_factor(p, m)) {
    if (derivatives == 0) {
      const WuPolynomial slope = slope_factor(g, m - 1);  // ((1-r)^(m-1) p_g / r)' / r
      for (std::size_t j = 0; j < p.size(); ++j) h[j] = (j > 0 ? slope[j - 1] + g[j - 1] : 0) - g[j];
    } else {
      g = divided(g);
      h = slope_factor(g, m - 1);
      if (derivatives > 2) h = divided(h);
    }
    for (auto* coefficients : {&value, &g, &h})
      for (double& x : *coefficients) x /= p[0];
  }
};

// psi_{K,L} of Wu: p and the number of derivatives 2 (L - K).
template <int K, int L>
constexpr WuPolynomial wu_polynomial = {};
template <>
constexpr WuPolynomial wu_polynomial<1, 1> = {2, 1};
template <>
constexpr WuPolynomial wu_polynomial<2, 2> = {8, 9, 3};
template <>
constexpr WuPolynomial wu_polynomial<3, 3> = {16, 29, 20, 5};
template <>
constexpr WuPolynomial wu_polynomial<1, 2> = {4, 16, 12, 3};
template <>
constexpr WuPolynomial wu_polynomial<2, 3> = {8, 40, 48, 25, 5};
template <>
constexpr WuPolynomial wu_polynomial<1, 3> = {6, 36, 82, 72, 30, 5};
template <>
constexpr WuPolynomial wu_polynomial<0, 3> = {5, 35, 101, 147, 101, 35, 5};

template <int K, int L>
struct Wu {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    constexpr int m = 2 * L - K + 1;
    constexpr int derivatives = 2 * (L - K);
    constexpr WuCoefficients c(m, derivatives, wu_polynomial<K, L>);
    const bool center = r2 < center_r2;
    const double r = inside(r2);
    const double a = 1 - r;
    const double common = m > 2 ? integer_power<m - 2>(a) : (r < 1 ? 1 : 0 * r);  // zero from r = 1 on
    const double phi = common * a * a * polynomial_value<m - 1>(c.value, r);
    double g = common * a * polynomial_value<m - 1>(c.g, r);
    double h = common * polynomial_value<(m < 7 ? m : 6)>(c.h, r);
    if constexpr (derivatives <= 2) {
      const double safe = center ? 1 : r;
      const double pole = derivatives == 0 ? safe * safe * safe : safe;
      if constexpr (derivatives == 0) g = center ? 0 : g / safe;
      h = center ? 0 : h / pole;
    }
    return {phi, g, h};
  }
};

}  // namespace

std::shared_ptr<const RadialFunction> missing_wendland_function() {
  return make_radial_function(MissingWendland{});
}

std::shared_ptr<const RadialFunction> wu_function(int dimension, int derivatives) {
  switch (derivatives) {
    case 0:
      if (dimension <= 3) return make_radial_function(Wu<1, 1>{});
      if (dimension <= 5) return make_radial_function(Wu<2, 2>{});
      return dimension <= 7 ? make_radial_function(Wu<3, 3>{}) : nullptr;
    case 2:
      if (dimension <= 3) return make_radial_function(Wu<1, 2>{});
      return dimension <= 5 ? make_radial_function(Wu<2, 3>{}) : nullptr;
    case 4:
      return dimension <= 3 ? make_radial_function(Wu<1, 3>{}) : nullptr;
    default:
      return dimension <= 1 ? make_radial_function(Wu<0, 3>{}) : nullptr;
  }
}

std::shared_ptr<const RadialFunction> buhmann_function(int derivatives) {
  if (derivatives == 1) return make_radial_function(BuhmannC1{});
  if (derivatives == 2) return make_radial_function(BuhmannC2{});
  return make_radial_function(BuhmannC3{});
}

}  // namespace csrbf
