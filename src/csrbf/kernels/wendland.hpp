#pragma once

#include "csrbf/core/types.hpp"

#include <array>

namespace csrbf {

/// Wendland's compactly supported function phi_{d,k} (Wendland 1995; thesis section 2.2): phi(0) = 1, phi(r) = 0 for
/// r >= 1, C^{2k}, positive definite on R^d. For even d it is the function of d + 1.
///
/// With x = p - c, r = |x| / sigma, g = phi'/r, q = phi'' - phi'/r and h = q / r^2 the basis function phi(|p - c| /
/// sigma) has
///
///     gradient  g x / sigma^2
///     Hessian   (g I + q x x^T / |x|^2) / sigma^2 = (g I + h x x^T / sigma^2) / sigma^2
///
/// All are closed forms without cancellation near r = 1 and, for k >= 1, valid at r = 0, where q = 0 and the second
/// term of the Hessian vanishes. For k = 0 neither derivative exists at the centre: g, q and h are 0 there by
/// convention. Arguments r are >= 0; NaN gives NaN.
class Wendland {
 public:
  /// Throws InvalidInput unless dimension >= 1 and smoothness k is 0, 1, 2 or 3.
  Wendland(int dimension, int smoothness);

  /// The dimension d it was made for.
  [[nodiscard]] int dimension() const { return dimension_; }

  /// k: the function has 2k continuous derivatives.
  [[nodiscard]] int smoothness() const { return smoothness_; }

  /// Whether it is positive definite on R^d: d <= dimension(), or one more when that is even.
  [[nodiscard]] bool positive_definite_in(int d) const { return d >= 1 && d / 2 <= dimension_ / 2; }

  [[nodiscard]] double value(double r) const;  ///< phi
  [[nodiscard]] double g(double r) const;      ///< phi' / r
  [[nodiscard]] double q(double r) const;      ///< phi'' - phi' / r
  [[nodiscard]] double h(double r) const;  ///< q / r^2; 0 at r = 0 for k <= 1, where q ~ r but h x x^T still vanishes
  [[nodiscard]] double second(double r) const;  ///< phi''; one-sided at r = 0 for k = 0

  /// K' = max |phi'|: the gradient of a basis function of support sigma has norm at most K' / sigma; this bound is
  /// sharp.
  [[nodiscard]] double gradient_bound() const;

  /// K'' = max(|phi''|, |phi'/r|) = |phi''(0)|: its Hessian has norm at most K'' / sigma^2. Infinite for k = 0.
  [[nodiscard]] double hessian_bound() const;

  /// phi[i] = phi(sqrt(r2[i])), i < n. `r2` holds squared distances in units of the support, any values >= 0. The
  /// arrays must not overlap. Costs about one square root per entry.
  void values(const double* r2, Index n, double* phi) const;

  /// As `values`, and g[i].
  void gradients(const double* r2, Index n, double* phi, double* g) const;

  /// As `gradients`, and h[i].
  void hessians(const double* r2, Index n, double* phi, double* g, double* h) const;

 private:
  int dimension_;
  int smoothness_;
  int l_ = 0;                      // floor(d/2) + k + 1
  std::array<double, 4> value_{};  // phi = (1-r)^(l+k) sum_j value_[j] r^j, degree k
  std::array<double, 3> g_{};      // g = (1-r)^(l+k-1) sum_j g_[j] r^j, degree k - 1
  std::array<double, 2> h_{};      // h = (1-r)^(l+k-2) sum_j h_[j] r^j, degree k - 2; over r for k = 1
};

}  // namespace csrbf
