#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf {

struct IterativeSystemOptions {
  double tolerance = 1e-8;  ///< largest residual at a sample, in units of the largest |value|
  /// Residual in the same unit that is a solution too where rounding allows no smaller one; at least `tolerance`.
  double acceptable = 0;
  Index neighbors = 0;  ///< of the preconditioner; 0: by the dimension and the smoothness of the kernel
  int most_iterations = 200;
  Progress progress = {};  ///< stages "factor", "solve"
};

struct IterativeSolution {
  Eigen::MatrixXd alpha;  ///< n x components
  Eigen::MatrixXd pi;     ///< q x components
  /// Diagonal of the inverse on the coefficients orthogonal to the polynomials, estimated: alpha_k over it is the
  /// leave-one-out error of sample k.
  Eigen::VectorXd inverse_diagonal;
  int iterations = 0;   ///< the most that a component took
  double residual = 0;  ///< largest |s_k - f(p_k) - D_kk alpha_k| found, by fast sums
};

/// Solves (A + D) alpha + G pi = s, G^T alpha = 0 for n samples in one to three dimensions, A_ij = phi(|p_i - p_j| /
/// support), D = diag(noise): by conjugate gradients on the coefficients orthogonal to G, with products in O(n)
/// (FastSum) and the preconditioner InverseFactor. About ten to thirty iterations whatever n. The accuracy of the sums
/// is raised until residuals measured by direct sums agree.
///
/// Throws SolverFailure when no acceptable residual is reached: the system is too ill conditioned.
template <int Dim>
IterativeSolution solve_iteratively(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                                    const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, const Eigen::MatrixXd& s,
                                    const IterativeSystemOptions& options = {});

}  // namespace csrbf
