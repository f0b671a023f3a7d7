#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Value, gradient and, when Order is 2, Hessian of a function at one point, with the arithmetic that carries them
/// through an expression (forward-mode differentiation). The Hessian is empty when Order is 1.
template <int Dim, int Order = 2>
struct Taylor {
  static_assert(Order == 1 || Order == 2);
  using Hessian = Eigen::Matrix<double, Order == 2 ? Dim : 0, Order == 2 ? Dim : 0>;

  double value = 0;
  Point<Dim> gradient = Point<Dim>::Zero();
  Hessian hessian = Hessian::Zero();

  Taylor() = default;
  Taylor(double constant) : value(constant) {}  // NOLINT(google-explicit-constructor): constants mix with variables

  friend Taylor operator+(Taylor a, const Taylor& b) {
    a.value += b.value;
    a.gradient += b.gradient;
    a.hessian += b.hessian;
    return a;
  }
  friend Taylor operator-(const Taylor& a, const Taylor& b) { return a + (-1.0) * b; }
  friend Taylor operator*(double factor, Taylor a) {
    a.value *= factor;
    a.gradient *= factor;
    a.hessian *= factor;
    return a;
  }
  friend Taylor operator*(const Taylor& a, const Taylor& b) {
    Taylor product;
    product.value = a.value * b.value;
    product.gradient = a.value * b.gradient + b.value * a.gradient;
    if constexpr (Order == 2)
      product.hessian = a.value * b.hessian + b.value * a.hessian + a.gradient * b.gradient.transpose() +
                        b.gradient * a.gradient.transpose();
    return product;
  }
  friend Taylor operator/(const Taylor& a, const Taylor& b) {
    const double inverse = 1 / b.value;
    return a * apply(b, inverse, -inverse * inverse, 2 * inverse * inverse * inverse);
  }
  /// Chain rule for a scalar function with value f and derivatives f', f'' at a.value.
  friend Taylor apply(const Taylor& a, double f, double f1, double f2) {
    Taylor result;
    result.value = f;
    result.gradient = f1 * a.gradient;
    if constexpr (Order == 2) result.hessian = f1 * a.hessian + f2 * a.gradient * a.gradient.transpose();
    return result;
  }
};

/// Quintic step: 0 for t <= 0, 1 for t >= 1, C2 in between.
inline double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 + t * (-15 + 6 * t));
}
template <int Dim, int Order>
Taylor<Dim, Order> smooth_step(const Taylor<Dim, Order>& x) {
  const double t = std::clamp(x.value, 0.0, 1.0), u = t * (1 - t);
  return apply(x, smooth_step(t), 30 * u * u, 60 * u * (1 - 2 * t));
}

}  // namespace csrbf
