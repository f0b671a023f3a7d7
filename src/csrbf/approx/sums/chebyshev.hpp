#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Interpolation at the `order` zeros of a Chebyshev polynomial in [-1, 1], cos((j + 1/2) pi / order).
class Chebyshev {
 public:
  explicit Chebyshev(int order);

  [[nodiscard]] int order() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return nodes_; }

  /// The Lagrange polynomials of the nodes, or their derivatives of order 1 or 2, at n coordinates: n x order.
  [[nodiscard]] Eigen::MatrixXd lagrange(const Eigen::Ref<const Eigen::VectorXd>& x, int derivative = 0) const;

 private:
  Eigen::VectorXd nodes_;
  Eigen::MatrixXd coefficients_;  // of the Lagrange polynomials (columns) in Chebyshev polynomials (rows)
};

}  // namespace csrbf
