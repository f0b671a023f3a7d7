#pragma once

#include "csrbf/core/types.hpp"

#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

class RadialFunction;

/// A radial kernel phi(r), r = |p - c| / sigma: compactly supported or global, positive definite or conditionally so.
///
/// | name | phi(r), a = max(1 - r, 0) | dimensions | derivatives |
/// |---|---|---|---|
/// | wendland-c0, -c2, -c4, -c6 | Wendland (1995); of the given dimension | all | 0, 2, 4, 6 |
/// | missing-wendland | (2r^2 + 1) e + 3 r^2 log(r / (1 + e)), e = sqrt(1 - r^2) (Schaback 2011) | 1, 2 | 1 |
/// | wu-c0, -c2, -c4, -c6 | Wu (1995), the first one positive definite in the dimension | 7, 5, 3, 1 | 0, 2, 4, 6 |
/// | buhmann-c1, -c2, -c3 | Buhmann (1998) | 6, 4, 3 | 1, 2, 3 |
/// | gaussian | exp(-r^2) | all | all |
/// | powered-exponential | exp(-r^b), b = parameter up to 2, default 1.4 | all | ceil(b) - 1; for b = 2 all |
/// | matern-c0, -c2, -c4, -c6 | Matern with nu = 1/2, 3/2, 5/2, 7/2 | all | 0, 2, 4, 6 |
/// | matern | 2^(1 - nu) / Gamma(nu) r^nu K_nu(r), nu = parameter, default 3/2 | all | ceil(2 nu) - 1 |
/// | inverse-multiquadric | (1 + r^2)^-b, b = parameter, default 1/2 | all | all |
/// | inverse-quadratic | (1 + r^2)^-1 | all | all |
/// | multiquadric | (-1)^ceil(b) (1 + r^2)^b, b = parameter, not an integer, default 1/2; order ceil(b) | all | all |
/// | linear, cubic, quintic, septic | -r, r^3, -r^5, r^7; order 1, 2, 3, 4 | all | 0, 2, 4, 6 |
/// | thin-plate, thin-plate-r4 | r^2 log r, -r^4 log r; order 2, 3 | all | 1, 3 |
/// | polyharmonic | (-1)^ceil(b/2) r^b, order ceil(b/2); (-1)^(b/2+1) r^b log r, order b/2 + 1, for even b = parameter,
/// default 3 | all | ceil(b) - 1 |
///
/// With x = p - c, g = phi'/r, q = phi'' - phi'/r and h = q / r^2 the function phi(|p - c| / sigma) has
///
///     gradient   g x / sigma^2
///     Hessian    (g I + h x x^T / sigma^2) / sigma^2
///     Laplacian  (d g + q) / sigma^2
///
/// At r = 0, derivatives that do not exist are 0 by convention, and so is h if it is unbounded although h x x^T tends
/// to 0. Distances below 1e-100 count as 0. Arguments r are >= 0; NaN gives NaN. A value type that is cheap to copy.
class Kernel {
 public:
  /// Throws InvalidInput for unknown names (with the list of names), for kernels that are not (conditionally) positive
  /// definite in the dimension (with a list of those that are), for parameters out of range, and for a parameter of a
  /// kernel that has none. `parameter` NaN: the default of the kernel.
  explicit Kernel(std::string_view name, int dimension, double parameter = std::numeric_limits<double>::quiet_NaN());

  [[nodiscard]] const std::string& name() const { return name_; }

  /// The dimension it was made for; it may be used in lower ones, too.
  [[nodiscard]] int dimension() const { return dimension_; }

  /// The parameter; NaN for kernels without one.
  [[nodiscard]] double parameter() const { return parameter_; }

  /// Whether phi = 0 for all r >= 1.
  [[nodiscard]] bool compact() const { return compact_; }

  /// Whether fits depend on the support. False for pure powers and thin plates, which a change of unit alters only by a
  /// factor and a polynomial.
  [[nodiscard]] bool has_scale() const { return has_scale_; }

  /// 0: positive definite. m > 0: conditionally positive definite of order m (with this sign): for coefficients
  /// orthogonal to all polynomials of degree m - 1, which the expansion must then contain.
  [[nodiscard]] int order() const { return order_; }

  /// Number of continuous derivatives on R^d; 100 for analytic kernels.
  [[nodiscard]] int smoothness() const { return smoothness_; }

  /// Whether it suits rough data: fewer than two continuous derivatives.
  [[nodiscard]] bool is_rough() const { return smoothness_ < 2; }

  [[nodiscard]] double value(double r) const;      ///< phi
  [[nodiscard]] double g(double r) const;          ///< phi' / r
  [[nodiscard]] double q(double r) const;          ///< phi'' - phi' / r
  [[nodiscard]] double h(double r) const;          ///< q / r^2
  [[nodiscard]] double laplacian(double r) const;  ///< dimension() g + q

  /// phi[i] = phi(sqrt(r2[i])), i < n, for squared distances in units of the support. The arrays must not overlap.
  void values(const double* r2, Index n, double* phi) const;

  /// As `values`, and g[i].
  void gradients(const double* r2, Index n, double* phi, double* g) const;

  /// As `gradients`, and h[i].
  void hessians(const double* r2, Index n, double* phi, double* g, double* h) const;

  /// The names of all kernels that are (conditionally) positive definite in R^dimension.
  [[nodiscard]] static std::vector<std::string> names(int dimension);

 private:
  std::string name_;
  int dimension_;
  double parameter_;
  bool compact_ = false;
  bool has_scale_ = true;
  int order_ = 0;
  int smoothness_ = 0;
  std::shared_ptr<const RadialFunction> function_;
};

}  // namespace csrbf
