#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <cstdint>
#include <vector>

namespace csrbf {

/// A sparse factor of the inverse of a radial basis function system K = A + D, A_ij = phi(|p_i - p_j| / sigma), on the
/// coefficients that are orthogonal to the polynomials (the columns of G):
///
///     B = sum_i c_i c_i^T / d_i,   d_i = c_i^T K c_i.
///
/// The points are taken from coarse to fine (farthest_points()). c_i is sample i minus its best linear unbiased
/// prediction from the nearest of the samples before it; so it vanishes on polynomials, also where K is only
/// conditionally positive definite. With all samples before it B is the inverse; with the nearest ones it is the
/// closest to it that is as sparse (Vecchia 1988; Schaefer, Katzfuss and Owhadi 2021). Predictions from near samples
/// hide those behind, hence few do. The first thousand or so, a coarse level, are predicted from all before them; where
/// the nearest samples do not determine the polynomials, as on tracks, some of the first help.
///
/// O(n k^3) operations and O(n k) memory for k neighbours; each product O(n k). The same for any number of threads.
class InverseFactor {
 public:
  using Ranks = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic>;

  /// `noise`: the diagonal D (n, or one entry for all); `G`: n x q.
  template <int Dim>
  InverseFactor(const PointsRef<Dim>& points, const Kernel& kernel, double support, const Eigen::VectorXd& noise,
                const Eigen::MatrixXd& G, Index neighbors, const Progress& progress = {});

  /// B r.
  [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& r) const;

  /// d_i of most samples (the 5 % quantile) in units of the largest |phi| between the points: errors of K should not be
  /// larger than that.
  [[nodiscard]] double common_variance() const { return common_variance_; }

  /// B_ii.
  [[nodiscard]] Eigen::VectorXd diagonal() const;

 private:
  // `order`: of the points, from coarse to fine; `x`: these in it; `nearest`: see nearest_before().
  void build(const std::vector<Index>& order, const Eigen::MatrixXd& x, const Ranks& nearest, const Kernel& kernel,
             double support, const Eigen::VectorXd& noise, const Eigen::MatrixXd& G);

  double common_variance_ = 1;
  std::vector<Index> begin_;          // of the entries of each c_i
  std::vector<std::int32_t> sample_;  // of each entry
  std::vector<double> entry_;         // of c_i / sqrt(d_i)
};

}  // namespace csrbf
