#include "csrbf/approx/sums/chebyshev.hpp"

#include <numbers>

namespace csrbf {

Chebyshev::Chebyshev(int order) : nodes_(order), coefficients_(order, order) {
  const double step = std::numbers::pi / order;
  for (int j = 0; j < order; ++j) {
    nodes_[j] = std::cos((j + .5) * step);
    for (int k = 0; k < order; ++k) coefficients_(k, j) = (k == 0 ? 1. : 2.) / order * std::cos(k * (j + .5) * step);
  }
}

// By the recurrence T_k+1 = 2 x T_k - T_k-1 and its derivatives.
Eigen::MatrixXd Chebyshev::lagrange(const Eigen::Ref<const Eigen::VectorXd>& x, int derivative) const {
  const int p = order();
  const Eigen::ArrayXd twice = 2 * x.array();
  Eigen::MatrixXd lower;  // the derivative of one order less
  for (int d = 0;; ++d) {
    Eigen::MatrixXd T(x.size(), p);
    T.col(0).setConstant(d == 0 ? 1 : 0);
    if (p > 1) {
      if (d == 0)
        T.col(1) = x;
      else
        T.col(1).setConstant(d == 1 ? 1 : 0);
    }
    for (int k = 2; k < p; ++k) {
      T.col(k) = twice.matrix().cwiseProduct(T.col(k - 1)) - T.col(k - 2);
      if (d > 0) T.col(k) += 2. * d * lower.col(k - 1);
    }
    if (d == derivative) return T * coefficients_;
    lower = std::move(T);
  }
}

}  // namespace csrbf
