#include "csrbf/kernels/global_kernels.hpp"

#include "csrbf/kernels/vector_math.hpp"

namespace csrbf {
namespace {

struct Gaussian {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const double e = vector_exp(-r2);
    return {e, -2 * e, 4 * e};
  }
};

// exp(-r^exponent).
struct PoweredExponential {
  double exponent;

  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double safe = center ? 1 : r2;
    const double power = center ? 0 : vector_exp(.5 * exponent * vector_log(safe));
    const double phi = vector_exp(-power);
    const double g = -exponent * power * phi / safe;
    return {phi, g, g * (exponent - 2 - exponent * power) / safe};
  }
};

// nu = Half / 2.
template <int Half>
struct Matern {
  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double r = std::sqrt(r2);
    const double safe = center ? 1 : r;
    const double e = vector_exp(-r);
    if constexpr (Half == 1) return {e, center ? 0 : -e / safe, center ? 0 : e * (1 + safe) / (safe * safe * safe)};
    if constexpr (Half == 3) return {(1 + r) * e, -e, center ? 0 : e / safe};
    if constexpr (Half == 5) return {(3 + r * (3 + r)) / 3 * e, -(1 + r) / 3 * e, e / 3};
    return {(15 + r * (15 + r * (6 + r))) / 15 * e, -(3 + r * (3 + r)) / 15 * e, (1 + r) / 15 * e};
  }
};

// sign (1 + r^2)^exponent; Twice = 2 exponent, or 0 for a general exponent.
template <int Twice>
struct Multiquadric {
  double sign;
  double exponent;

  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const double w = 1 / (1 + r2);
    double phi = sign;
    if constexpr (Twice == 1) phi = sign * std::sqrt(1 + r2);
    if constexpr (Twice == -1) phi = sign * std::sqrt(w);
    if constexpr (Twice == -2) phi = sign * w;
    if constexpr (Twice == 0) phi = sign * vector_exp(exponent * vector_log(1 + r2));
    const double g = 2 * exponent * phi * w;
    return {phi, g, 2 * (exponent - 1) * g * w};
  }
};

// sign r^Exponent for odd exponents.
template <int Exponent>
struct OddPower {
  double sign;

  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double r = center ? 0 : std::sqrt(r2);
    const double safe = center ? 1 : r;
    constexpr double b = Exponent;
    double g = sign * b * (center ? 0 : 1 / safe);
    double h = g * (b - 2);
    if constexpr (Exponent == 1) h /= safe * safe;
    if constexpr (Exponent >= 3) g = sign * b * r * integer_power<(Exponent - 3) / 2>(r2);
    if constexpr (Exponent >= 5) h = sign * b * (b - 2) * r * integer_power<(Exponent - 5) / 2>(r2);
    return {sign * r * integer_power<(Exponent - 1) / 2>(r2), g, h};
  }
};

struct AnyPower {
  double sign;
  double exponent;

  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double safe = center ? 1 : r2;
    const double phi = sign * vector_exp(.5 * exponent * vector_log(safe));
    const double g = exponent * phi / safe;
    return {center ? 0 : phi, center ? 0 : g, center ? 0 : (exponent - 2) * g / safe};
  }
};

// sign r^b log r for even b: b = Exponent (2 or 4), or b = exponent when Exponent is 0.
template <int Exponent>
struct ThinPlate {
  double sign;
  double exponent;

  CSRBF_ALWAYS_INLINE Radial operator()(double r2) const {
    const bool center = r2 < center_r2;
    const double safe = center ? 1 : r2;
    const double log_r = .5 * vector_log(safe);
    const double b = Exponent > 0 ? Exponent : exponent;
    double power = sign;
    if constexpr (Exponent == 2) power = sign * safe;
    if constexpr (Exponent == 4) power = sign * safe * safe;
    if constexpr (Exponent == 0) power = sign * vector_exp(b * log_r);
    const double slope = power / safe;
    const double bend = slope / safe;
    return {center ? 0 : power * log_r, center ? 0 : slope * (b * log_r + 1),
            center ? 0 : bend * ((b - 2) * (b * log_r + 1) + b)};
  }
};

double sign_of(double power_of_minus_one) {
  return std::fmod(power_of_minus_one, 2) == 0 ? 1 : -1;
}

}  // namespace

std::shared_ptr<const RadialFunction> gaussian_function() {
  return make_radial_function(Gaussian{});
}

std::shared_ptr<const RadialFunction> powered_exponential_function(double exponent) {
  if (exponent == 1) return make_radial_function(Matern<1>{});
  if (exponent == 2) return gaussian_function();
  return make_radial_function(PoweredExponential{exponent});
}

std::shared_ptr<const RadialFunction> matern_function(double nu) {
  if (nu == .5) return make_radial_function(Matern<1>{});
  if (nu == 1.5) return make_radial_function(Matern<3>{});
  if (nu == 2.5) return make_radial_function(Matern<5>{});
  if (nu == 3.5) return make_radial_function(Matern<7>{});
  return bessel_matern_function(nu);
}

std::shared_ptr<const RadialFunction> multiquadric_function(double exponent) {
  const double sign = exponent < 0 ? 1 : sign_of(std::ceil(exponent));
  if (exponent == .5) return make_radial_function(Multiquadric<1>{sign, exponent});
  if (exponent == -.5) return make_radial_function(Multiquadric<-1>{sign, exponent});
  if (exponent == -1) return make_radial_function(Multiquadric<-2>{sign, exponent});
  return make_radial_function(Multiquadric<0>{sign, exponent});
}

std::shared_ptr<const RadialFunction> polyharmonic_function(double exponent) {
  if (std::fmod(exponent, 2) == 0) {
    const double sign = sign_of(exponent / 2 + 1);
    if (exponent == 2) return make_radial_function(ThinPlate<2>{sign, exponent});
    if (exponent == 4) return make_radial_function(ThinPlate<4>{sign, exponent});
    return make_radial_function(ThinPlate<0>{sign, exponent});
  }
  const double sign = sign_of(std::ceil(exponent / 2));
  if (exponent == 1) return make_radial_function(OddPower<1>{sign});
  if (exponent == 3) return make_radial_function(OddPower<3>{sign});
  if (exponent == 5) return make_radial_function(OddPower<5>{sign});
  if (exponent == 7) return make_radial_function(OddPower<7>{sign});
  return make_radial_function(AnyPower{sign, exponent});
}

}  // namespace csrbf
