#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// An entry of a matrix between points of a regular lattice: H_ij = weight when j - i = offset.
template <int Dim>
struct ToeplitzTap {
  std::array<Index, Dim> offset;
  double weight;
};

struct ToeplitzOptions {
  double tolerance = 1e-13;     ///< |residual| <= tolerance |right-hand side|
  Index max_iterations = 5000;  ///< per right-hand side
  /// Condition of the symbol above which the circulant preconditioner pays: below, its Fourier transforms cost more
  /// than the iterations that they save. Chosen by hand.
  double precondition_from = 200;
};

/// Solves H x = b for a symmetric positive definite matrix that depends only on the differences of the points of a
/// regular lattice, such as that of a positive definite kernel of compact support. By conjugate gradients, where the
/// product with H is a stencil; ill-conditioned systems are preconditioned by the inverse of the circulant matrix with
/// the same taps on a torus as large as lattice and stencil together, whose eigenvalues are the values of the symbol of
/// H (R. Chan 1989). The number of iterations then grows little with the condition and not at all with the size.
///
/// Memory: five numbers per point; preconditioned two and a half more per point of the torus. Bit-identical for every
/// thread count.
template <int Dim>
class ToeplitzSystem {
 public:
  /// `size`: points along each axis, x fastest; `taps`: one for every offset and its negative, of the same weight.
  /// Throws InvalidInput for sizes that are not positive and when there are no taps.
  ToeplitzSystem(const std::array<Index, Dim>& size, const std::vector<ToeplitzTap<Dim>>& taps,
                 const ToeplitzOptions& options = {});

  [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;

  /// Throws SolverFailure when the residual does not even reach the square root of the tolerance: H is not positive
  /// definite to working precision.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  /// Largest over smallest value of the symbol on the torus: about the condition of H.
  [[nodiscard]] double condition() const { return condition_; }
  [[nodiscard]] bool preconditioned() const { return !inverse_symbol_.empty(); }
  [[nodiscard]] Index iterations() const { return iterations_; }  ///< of all solves so far

 private:
  // Taps that share all offsets but the first: weights of neighbours along x, from `first` on.
  struct Run {
    std::array<Index, Dim> offset;
    std::vector<double> weights;
  };

  void make_runs(std::vector<ToeplitzTap<Dim>> taps);
  void make_symbol(const std::vector<ToeplitzTap<Dim>>& taps);
  void multiply_padded(const std::vector<double>& padded, Eigen::VectorXd& y) const;
  void precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z) const;

  std::array<Index, Dim> size_;
  std::array<Index, Dim> reach_{};
  std::array<Index, Dim> torus_{};
  Index points_ = 1;
  Index taps_ = 0;
  std::vector<Run> runs_;
  std::vector<double> inverse_symbol_;
  double condition_ = 1;
  ToeplitzOptions options_;
  mutable Index iterations_ = 0;
};

}  // namespace csrbf
