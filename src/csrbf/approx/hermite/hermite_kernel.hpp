#pragma once

#include <array>
#include <string>
#include <vector>

namespace csrbf {

/// A radial covariance phi(r) for values and derivatives: with psi_0 = phi and psi_(k+1) = psi_k' / r,
///
///     cov(f(x), f(y)) = psi_0,   cov(f(x), f_b(y)) = -z_b psi_1,   cov(f_a(x), f_b(y)) = -delta_ab psi_1 - z_a z_b
///     psi_2
///
/// for z = x - y, r = |z|. Matern with nu = 5/2, 7/2, 9/2 (phi = M_p / M_p(0), psi_k = (-1)^k M_(p-k) / M_p(0)), and
/// exp(-r^2).
class HermiteKernel {
 public:
  /// matern-c4, matern-c6, matern-c8 or gaussian. Throws InvalidInput for others.
  explicit HermiteKernel(const std::string& name);

  /// psi_0 ... psi_3 at a squared distance; psi_3 is 0 at 0 where it is unbounded.
  [[nodiscard]] std::array<double, 4> psi(double r2) const;
  [[nodiscard]] const std::string& name() const { return name_; }

  /// From rough to smooth.
  [[nodiscard]] static const std::vector<std::string>& names();

 private:
  std::string name_;
  int order_;  // p of the Matern functions; -1: gaussian
};

}  // namespace csrbf
