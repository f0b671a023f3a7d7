#include "csrbf/approx/sums/chebyshev.hpp"

#include <gtest/gtest.h>

namespace csrbf::chebyshev_test {
namespace {

TEST(Chebyshev, LagrangePolynomialsAreOneAtTheirNodeAndZeroAtOthers) {
  for (const int order : {1, 2, 7, 14}) {
    const Chebyshev chebyshev(order);
    const Eigen::MatrixXd L = chebyshev.lagrange(chebyshev.nodes());
    EXPECT_LT((L - Eigen::MatrixXd::Identity(order, order)).cwiseAbs().maxCoeff(), 1e-13) << order;
  }
}

TEST(Chebyshev, InterpolatesPolynomialsAndTheirDerivativesExactly) {
  const Chebyshev chebyshev(6);
  const Eigen::ArrayXd t = chebyshev.nodes().array();
  const Eigen::VectorXd values = t.pow(5) - 2 * t.pow(3) + 1;
  const Eigen::ArrayXd x = Eigen::ArrayXd::LinSpaced(9, -1, 1);
  const Eigen::ArrayXd expected[] = {x.pow(5) - 2 * x.pow(3) + 1, 5 * x.pow(4) - 6 * x.pow(2), 20 * x.pow(3) - 12 * x};
  for (int d = 0; d < 3; ++d)
    EXPECT_LT(((chebyshev.lagrange(x.matrix(), d) * values).array() - expected[d]).abs().maxCoeff(), 1e-12) << d;
}

}  // namespace
}  // namespace csrbf::chebyshev_test
