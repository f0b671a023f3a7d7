#pragma once

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/levelset/baselines/nodes.hpp"

#include <memory>

namespace csrbf {

/// The matrix H of a level set on nodes (thesis 8.2.1): from values at the nodes to coefficients and back.
///
/// H_ij = phi(r_ij) - diffusion (laplacian phi + bias phi)(r_ij), r_ij = |p_i - p_j| / sigma; diffusion 0 interpolates.
/// The bias makes the laplacian of constants 0 on regular nodes, see laplacian_bias(). For conditionally positive
/// definite kernels bordered by the polynomials of degree order - 1, and the right-hand sides padded with zeros.
/// Prepared once, then solved for any number of right-hand sides:
///
/// * compact kernel, regular nodes: a Toeplitz system by conjugate gradients, no factor at all;
/// * compact kernel, scattered nodes (or few): sparse Cholesky factor;
/// * other kernels: a dense factor, O(n^3) once, for at most `dense_limit` nodes.
template <int Dim>
class NodeSystem {
 public:
  /// Throws InvalidInput for a support that is not positive, negative diffusion, a diffusion with a kernel of order > 0
  /// or fewer than 2 derivatives, coincident nodes, regular ones whose number is not the product of their counts, and
  /// more than `dense_limit` nodes with a kernel that is not compact; SolverFailure when H is singular to working
  /// precision.
  NodeSystem(const Nodes<Dim>& nodes, const Kernel& kernel, double support, double diffusion = 0);
  ~NodeSystem();

  /// Coefficients (n, and Q of the polynomial behind them) for values at the nodes (n).
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& values) const;

  /// Values at the nodes (n) for coefficients (n + Q): H mu.
  [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& mu) const;

  /// The function with these coefficients (n + Q); `bounds` as in Expansion. `constant` is added to it, for kernels of
  /// order 0.
  [[nodiscard]] std::shared_ptr<const Expansion<Dim>> expansion(const Eigen::VectorXd& mu, const Box<Dim>& bounds = {},
                                                                double constant = 0) const;

  /// What to add to the laplacian of an interpolant at the nodes, times its value. The interpolant of a constant on a
  /// lattice ripples between the nodes, so that its laplacian there is -bias times the constant: for a support of few
  /// node spacings h as large as .5 / h^2, and not less on a finer lattice. With the bias added, laplacians of smooth
  /// functions are right to .2 % from wendland-c4 with a support of 5.5 h on. The diffusion stays positive definite for
  /// any size. 0 for scattered nodes and kernels that are not compact or have fewer than two derivatives.
  [[nodiscard]] double laplacian_bias() const;

  [[nodiscard]] Index nodes() const;
  [[nodiscard]] const RadialBasis<Dim>& basis() const;

  static constexpr Index dense_limit = 4000;  ///< 128 MB for the matrix, and as much for its factor

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace csrbf
