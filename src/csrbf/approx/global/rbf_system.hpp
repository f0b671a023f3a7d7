#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <cstdint>
#include <vector>

namespace csrbf {

/// The monomials of degree at most m in a number of variables known at run time, by degree: monomial j > 0 is variable
/// axis[j] times monomial parent[j].
struct MonomialSteps {
  int dimension = 0;
  std::vector<std::int16_t> parent;
  std::vector<std::int16_t> axis;

  /// degree -1: none.
  MonomialSteps(int dimension, int degree);

  [[nodiscard]] Index size() const { return static_cast<Index>(parent.size()); }

  /// Their powers: size() x dimension.
  [[nodiscard]] Eigen::MatrixXi powers() const;

  /// Their values at n points: n x size().
  [[nodiscard]] Eigen::MatrixXd values(const Eigen::Ref<const Eigen::MatrixXd>& x) const;
};

/// f(x) = sum_i alpha_i phi(epsilon |x - y_i|) + sum_q pi_q m_q((x - shift) / scale) for k components.
struct RbfCoefficients {
  Eigen::MatrixXd alpha;  ///< n x k
  Eigen::MatrixXd pi;     ///< Q x k
  Eigen::VectorXd shift;  ///< d, the centre of the bounding box of the y_i
  Eigen::VectorXd scale;  ///< d, half its extent; 1 where that is 0
};

/// Kernel and polynomials of interpolants in d dimensions.
struct RbfBasis {
  Kernel kernel;
  double epsilon2 = 1;  ///< squared
  MonomialSteps monomials;

  /// The coefficients without alpha and pi: the frame of the polynomials for points y (d x n).
  [[nodiscard]] static RbfCoefficients frame(const Eigen::MatrixXd& y);

  /// A_ij = phi(epsilon |y_i - y_j|) + smoothing_i delta_ij; only its lower triangle.
  [[nodiscard]] Eigen::MatrixXd matrix(const Eigen::MatrixXd& y,
                                       const Eigen::Ref<const Eigen::VectorXd>& smoothing) const;

  /// Coefficients that interpolate, or smooth, the values s (k x n) at y (d x n): by solve_saddle(), or where the
  /// system is not positive definite (very smooth kernels, degrees below the kernel's order) by an LU decomposition.
  /// Throws SolverFailure when the system is singular. O(n^3 / 3) or O(2 n^3 / 3).
  [[nodiscard]] RbfCoefficients solve(const Eigen::MatrixXd& y, const Eigen::Ref<const Eigen::MatrixXd>& s,
                                      const Eigen::Ref<const Eigen::VectorXd>& smoothing) const;

  /// Writes f (k x m) at the points x (d x m), on the calling thread.
  void evaluate(const Eigen::MatrixXd& y, const RbfCoefficients& f, const Eigen::Ref<const Eigen::MatrixXd>& x,
                Eigen::Ref<Eigen::MatrixXd> values) const;
};

}  // namespace csrbf
