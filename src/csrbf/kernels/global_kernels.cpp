#include "csrbf/kernels/global_kernels.hpp"

#include "csrbf/kernels/bessel_matern.hpp"
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

enum class Formula {
  gaussian,
  powered_exponential,
  matern_1,
  matern_3,
  matern_5,
  matern_7,
  root,
  inverse_root,
  inverse,
  multiquadric,
  linear,
  cubic,
  quintic,
  septic,
  power,
  thin_plate_2,
  thin_plate_4,
  thin_plate
};

struct Parameters {
  double sign = 1;
  double exponent = 0;
};

template <RadialParts parts>
CSRBF_ALWAYS_INLINE void formula_loop(Formula formula, Parameters p, const double* r2, Index n, double* phi, double* g,
                                      double* h) {
  const double s = p.sign;
  const double b = p.exponent;
  switch (formula) {
    case Formula::gaussian:
      return radial_loop<parts>(Gaussian{}, r2, n, phi, g, h);
    case Formula::powered_exponential:
      return radial_loop<parts>(PoweredExponential{b}, r2, n, phi, g, h);
    case Formula::matern_1:
      return radial_loop<parts>(Matern<1>{}, r2, n, phi, g, h);
    case Formula::matern_3:
      return radial_loop<parts>(Matern<3>{}, r2, n, phi, g, h);
    case Formula::matern_5:
      return radial_loop<parts>(Matern<5>{}, r2, n, phi, g, h);
    case Formula::matern_7:
      return radial_loop<parts>(Matern<7>{}, r2, n, phi, g, h);
    case Formula::root:
      return radial_loop<parts>(Multiquadric<1>{s, b}, r2, n, phi, g, h);
    case Formula::inverse_root:
      return radial_loop<parts>(Multiquadric<-1>{s, b}, r2, n, phi, g, h);
    case Formula::inverse:
      return radial_loop<parts>(Multiquadric<-2>{s, b}, r2, n, phi, g, h);
    case Formula::multiquadric:
      return radial_loop<parts>(Multiquadric<0>{s, b}, r2, n, phi, g, h);
    case Formula::linear:
      return radial_loop<parts>(OddPower<1>{s}, r2, n, phi, g, h);
    case Formula::cubic:
      return radial_loop<parts>(OddPower<3>{s}, r2, n, phi, g, h);
    case Formula::quintic:
      return radial_loop<parts>(OddPower<5>{s}, r2, n, phi, g, h);
    case Formula::septic:
      return radial_loop<parts>(OddPower<7>{s}, r2, n, phi, g, h);
    case Formula::power:
      return radial_loop<parts>(AnyPower{s, b}, r2, n, phi, g, h);
    case Formula::thin_plate_2:
      return radial_loop<parts>(ThinPlate<2>{s, b}, r2, n, phi, g, h);
    case Formula::thin_plate_4:
      return radial_loop<parts>(ThinPlate<4>{s, b}, r2, n, phi, g, h);
    case Formula::thin_plate:
      return radial_loop<parts>(ThinPlate<0>{s, b}, r2, n, phi, g, h);
  }
}

CSRBF_SIMD_CLONES void value_loop(Formula f, Parameters p, const double* r2, Index n, double* phi) {
  formula_loop<RadialParts::value>(f, p, r2, n, phi, nullptr, nullptr);
}
CSRBF_SIMD_CLONES void gradient_loop(Formula f, Parameters p, const double* r2, Index n, double* phi, double* g) {
  formula_loop<RadialParts::gradient>(f, p, r2, n, phi, g, nullptr);
}
CSRBF_SIMD_CLONES void hessian_loop(Formula f, Parameters p, const double* r2, Index n, double* phi, double* g,
                                    double* h) {
  formula_loop<RadialParts::hessian>(f, p, r2, n, phi, g, h);
}

class FormulaFunction : public RadialFunction {
 public:
  FormulaFunction(Formula formula, Parameters parameters) : formula_(formula), parameters_(parameters) {}

  void evaluate(const double* r2, Index n, const RadialOutput& out) const override {
    const auto loop = [this](const double* s, Index count, double* phi, double* g, double* h) {
      if (g == nullptr) return value_loop(formula_, parameters_, s, count, phi);
      if (h == nullptr) return gradient_loop(formula_, parameters_, s, count, phi, g);
      hessian_loop(formula_, parameters_, s, count, phi, g, h);
    };
    in_radial_blocks(loop, r2, n, out);
  }

 private:
  Formula formula_;
  Parameters parameters_;
};

std::shared_ptr<const RadialFunction> make(Formula formula, Parameters parameters = {}) {
  return std::make_shared<FormulaFunction>(formula, parameters);
}

double sign_of(double power_of_minus_one) {
  return std::fmod(power_of_minus_one, 2) == 0 ? 1 : -1;
}

}  // namespace

std::shared_ptr<const RadialFunction> gaussian_function() {
  return make(Formula::gaussian);
}

std::shared_ptr<const RadialFunction> powered_exponential_function(double exponent) {
  if (exponent == 1) return make(Formula::matern_1);
  if (exponent == 2) return gaussian_function();
  return make(Formula::powered_exponential, {1, exponent});
}

std::shared_ptr<const RadialFunction> matern_function(double nu) {
  if (nu == .5) return make(Formula::matern_1);
  if (nu == 1.5) return make(Formula::matern_3);
  if (nu == 2.5) return make(Formula::matern_5);
  if (nu == 3.5) return make(Formula::matern_7);
  return bessel_matern_function(nu);
}

std::shared_ptr<const RadialFunction> multiquadric_function(double exponent) {
  const Parameters p{exponent < 0 ? 1 : sign_of(std::ceil(exponent)), exponent};
  if (exponent == .5) return make(Formula::root, p);
  if (exponent == -.5) return make(Formula::inverse_root, p);
  if (exponent == -1) return make(Formula::inverse, p);
  return make(Formula::multiquadric, p);
}

std::shared_ptr<const RadialFunction> polyharmonic_function(double exponent) {
  if (std::fmod(exponent, 2) == 0) {
    const Parameters p{sign_of(exponent / 2 + 1), exponent};
    if (exponent == 2) return make(Formula::thin_plate_2, p);
    if (exponent == 4) return make(Formula::thin_plate_4, p);
    return make(Formula::thin_plate, p);
  }
  const Parameters p{sign_of(std::ceil(exponent / 2)), exponent};
  if (exponent == 1) return make(Formula::linear, p);
  if (exponent == 3) return make(Formula::cubic, p);
  if (exponent == 5) return make(Formula::quintic, p);
  if (exponent == 7) return make(Formula::septic, p);
  return make(Formula::power, p);
}

}  // namespace csrbf
