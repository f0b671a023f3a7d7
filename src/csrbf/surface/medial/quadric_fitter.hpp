#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Fits quadrics to the samples in balls (thesis eq. 6.24 in local, scaled coordinates q = (p - center) / support):
/// minimises sum phi(|q|) (g^2 + kappa |grad g + n|^2) with Wendland's C2 function phi. Samples of all sheets count: a
/// quadric can follow both sheets of a thin plate. Reuses its work arrays: one fitter per thread.
class QuadricFitter {
 public:
  /// Coefficients of b0 + b . d + d^T A d, d = x - center, as in BallTree.
  using Quadric = Eigen::Matrix<double, 10, 1>;

  /// The cloud and its tree must outlive the fitter.
  QuadricFitter(const OrientedPoints& cloud, const KdTree<3>& tree) : cloud_(cloud), tree_(tree) {}

  Quadric fit(const Point<3>& center, double support);

  /// Weighted root mean square of the last quadric at its samples.
  [[nodiscard]] double residual() const { return residual_; }
  /// The samples in the ball of the last fit.
  [[nodiscard]] const std::vector<Index>& samples() const { return ids_; }

 private:
  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  std::vector<Index> ids_;
  double residual_ = 0;
};

/// Value of a quadric at d = x - center, then its gradient.
Eigen::Vector4d evaluate_quadric(const Eigen::Ref<const QuadricFitter::Quadric>& c, const Point<3>& d);

}  // namespace csrbf
