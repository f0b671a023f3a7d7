#include "csrbf/kernels/global_kernels.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr double tiny = 1e-8;   // about sqrt(machine precision): below, r^nu K_nu equals its limit, if that is finite
constexpr double huge_r = 700;  // beyond, exp(-r) makes phi smaller than 1e-200: taken as 0

// K_nu(x) for x > 0. libc++ has none: there it is the integral of exp(-x cosh t) cosh(nu t) over t > 0 (DLMF 10.32.9)
// by the trapezoidal rule, which converges geometrically; the step resolves the Gaussian that large x make of it.
double bessel_k(double nu, double x) {
#ifdef __cpp_lib_math_special_functions
  return std::cyl_bessel_k(nu, x);
#else
  const double step = std::min(1.0 / 16, 0.7 / std::sqrt(x));
  double sum = 0.5;
  for (double t = step;; t += step) {
    const double half = std::sinh(t / 2);  // x - x cosh t = -2 x half^2
    const double term = 0.5 * std::exp(nu * t - 2 * x * half * half) * (1 + std::exp(-2 * nu * t));
    sum += term;
    if (!(term > 1e-17 * sum) && x * std::sinh(t) > nu) return step * std::exp(-x) * sum;
  }
#endif
}

// c r^nu K_nu(r), where c makes it 1 at r = 0; nu > 0.
double normalised(double nu, double r) {
  const double log_scale = (1 - nu) * std::log(2.0) - std::lgamma(nu) + nu * std::log(r);
  const double K = bessel_k(nu, r);
  return std::isfinite(K) && K > 0 ? std::exp(log_scale + std::log(K)) : 1;
}

class BesselMatern : public RadialFunction {
 public:
  explicit BesselMatern(double nu)
      : nu_(nu), log_scale_((1 - nu) * std::log(2.0) - std::lgamma(nu)), g_scale_(-.5 / (nu - 1)) {}

  void evaluate(const double* r2, Index n, const RadialOutput& out) const override {
    for (Index i = 0; i < n; ++i) {
      const double r = std::sqrt(r2[i]);
      out.phi[i] = value(r);
      if (out.g != nullptr) out.g[i] = derivative(r, 1);
      if (out.h != nullptr) out.h[i] = derivative(r, 2);
    }
  }

 private:
  [[nodiscard]] double value(double r) const {
    if (std::isnan(r)) return r;
    if (r > huge_r) return 0;
    if (r < tiny && nu_ >= 1) return 1;
    // By the leading term of 1 - phi: K_nu itself may overflow.
    if (r < tiny) return 1 - std::pow(r / 2, 2 * nu_) * std::tgamma(1 - nu_) / std::tgamma(1 + nu_);
    return normalised(nu_, r);
  }

  // The operator (1/r) d/dr applied `times` times: (-1)^times c r^(nu - times) K_(nu - times).
  [[nodiscard]] double derivative(double r, int times) const {
    if (std::isnan(r)) return r;
    if (r > huge_r) return 0;
    const double order = nu_ - times;
    if (order > 0) {
      const double scale = times == 1 ? g_scale_ : .25 / ((nu_ - 1) * order);
      return scale * (r < tiny && order >= 1 ? 1 : (r * r < center_r2 ? 1 : normalised(order, r)));
    }
    if (r * r < center_r2) return 0;
    const double sign = times == 1 ? -1 : 1;
    return sign * std::exp(log_scale_ + order * std::log(r)) * bessel_k(-order, r);
  }

  double nu_;
  double log_scale_;
  double g_scale_;
};

}  // namespace

std::shared_ptr<const RadialFunction> bessel_matern_function(double nu) {
  return std::make_shared<BesselMatern>(nu);
}

}  // namespace csrbf
