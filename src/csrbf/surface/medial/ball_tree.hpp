#pragma once

#include "csrbf/approx/basis/support_tree.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/taylor.hpp"

namespace csrbf {

/// W = sum phi and S = sum phi g over balls, with derivatives: value, gradient, upper triangle of the Hessian. Kept as
/// partial sums in SIMD lanes, which total() adds up.
struct BallSums {
  static constexpr int lanes = 8;   ///< doubles in the widest SIMD registers (AVX-512)
  static constexpr int terms = 10;  ///< value, 3 first, 6 second derivatives

  alignas(64) double W[terms][lanes];
  alignas(64) double S[terms][lanes];
};

/// The total of the lanes of one of the sums; derivatives only if they were summed.
template <class Scalar>
Scalar total(const double (&sum)[BallSums::terms][BallSums::lanes], Derivatives derivatives);

/// Writes the parts of a value that `out` asks for to its point i.
void store(const Taylor<3>& f, Index i, const JetBlock& out);

/// Balls with a quadric each:
///
///     g_i(x) = b0 + b . d + d^T A d,  d = x - c_i,  phi_i = (1 - r)^4 (4 r + 1),  r = |d| / sigma_i (Wendland's C2).
class BallTree {
 public:
  /// A column is b0, b (3), A (6) with A as its upper triangle by rows.
  using Quadrics = Eigen::Matrix<double, 10, Eigen::Dynamic>;

  BallTree(const PointsRef<3>& centers, const Eigen::VectorXd& supports, const Quadrics& quadrics);

  /// Workspace.
  using Runs = std::vector<SupportTree<3>::Run>;

  /// Sums over the balls at x.
  void sum(const Point<3>& x, Derivatives derivatives, Runs& runs, BallSums& sums) const;

 private:
  SupportTree<3> tree_;
  Eigen::MatrixXd slots_;  // slots x 14: centre, 1 / sigma^2, quadric
};

}  // namespace csrbf
