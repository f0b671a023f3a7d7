#pragma once

#include "csrbf/approx/sums/box_operators.hpp"

#include <array>

namespace csrbf {

/// Lagrange polynomials of the nodes of a box, and their derivatives up to an order, at points in units of half the box
/// from its centre.
template <int Dim>
class NodalProducts {
 public:
  NodalProducts(const BoxOperators<Dim>& level, const Points<Dim>& unit, int derivatives) : level_(level) {
    for (int d = 0; d < Dim; ++d)
      for (int k = 0; k <= derivatives; ++k) axis_[d][k] = level.chebyshev().lagrange(unit.row(d).transpose(), k);
  }

  /// Along the first axis: n x order.
  [[nodiscard]] const Eigen::MatrixXd& first(int derivative) const { return axis_[0][derivative]; }

  /// Products over the other axes: slab x n.
  [[nodiscard]] Eigen::MatrixXd others(const std::array<int, 3>& derivative) const {
    const Index n = axis_[0][0].rows();
    const int p = level_.chebyshev().order();
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(level_.slab(), n);
    if constexpr (Dim == 1) T.row(0).setOnes();
    if constexpr (Dim == 2) T.topRows(p) = axis_[1][derivative[1]].transpose();
    if constexpr (Dim == 3) {
      const Eigen::MatrixXd b = axis_[1][derivative[1]].transpose(), c = axis_[2][derivative[2]].transpose();
      for (Index i = 0; i < n; ++i)
        for (int k = 0; k < p; ++k) T.col(i).segment(p * k, p) = c(k, i) * b.col(i);
    }
    return T;
  }

 private:
  const BoxOperators<Dim>& level_;
  std::array<std::array<Eigen::MatrixXd, 3>, Dim> axis_;
};

}  // namespace csrbf
