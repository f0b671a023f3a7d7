#pragma once

#include "csrbf/core/shared_work.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/composite/composite.hpp"

#include <Eigen/Cholesky>

namespace csrbf {

/// A patch with its CSRBF residual.
struct FittedPatch {
  Patch patch;
  Points<3> centers{3, 0};   ///< local coordinates
  Eigen::VectorXd alpha{0};  ///< coefficients

  /// The step -f grad f / |grad f|^2 from x to the surface of the patch, exact to first order; ignores the support.
  [[nodiscard]] Point<3> step_to_surface(const Point<3>& x) const;

  /// Distance of x to the surface of the patch, searched along the patch's normal from its tangent plane: the search
  /// does not start at x, so that x has no influence on which sheet is found.
  [[nodiscard]] double distance(const Point<3>& x) const;

  void pack(ByteWriter& out) const;
  void unpack(ByteReader& in);

 private:
  /// Value and gradient in local coordinates.
  [[nodiscard]] Eigen::Vector4d evaluate(const Point<3>& q) const;
};

/// Fits patches to leaves of a cloud (thesis 6.1.3 and 6.1.4). Reuses its work arrays: one fitter per thread. The
/// cloud, its tree and the options must outlive it.
class PatchFitter {
 public:
  PatchFitter(const OrientedPoints& cloud, const KdTree<3>& tree, const CompositeOptions& options)
      : cloud_(cloud), tree_(tree), options_(options) {}

  /// The patch over the n points `ids`.
  FittedPatch fit(const Index* ids, Index n);

  /// Whether the last patch meets the tolerance of every sample in the inner part of its support.
  [[nodiscard]] bool within_tolerance(const FittedPatch& patch) const;

  /// Error of the last patch at samples of other sheets in its support, summed over them: blended with their own
  /// patches, it contributes its distance times its share of the weights.
  [[nodiscard]] double error_on_other_sheets(const FittedPatch& patch) const;

  /// Distances of samples from the surface of the last patch as if it had been fitted without their positions (their
  /// normals remain); ignores off-surface rows.
  void left_out_distances(const FittedPatch& patch, std::span<const Index> ids, double* distance);

  /// Area of the last patch divided by the number of its samples.
  [[nodiscard]] double area_per_sample() const { return area_per_sample_; }

 private:
  void frame(const Index* ids, Index n, Patch& patch) const;
  void gather(const Index* ids, Index n, Patch& patch);
  void thin();
  void choose_centers();
  void localize(const Patch& patch);
  void fit_quadric(Patch& patch);
  void fit_residual(FittedPatch& result);
  void gradient_columns(const FittedPatch& result);
  void off_surface_columns(const FittedPatch& result);

  const OrientedPoints& cloud_;
  const KdTree<3>& tree_;
  const CompositeOptions& options_;
  std::vector<Index> support_;
  std::vector<Index> foreign_;  // in the ball of the support, but of another sheet
  std::vector<Index> centers_;  // positions in support_
  // Samples in local coordinates, padded with samples of weight zero: positions and gradient targets (-n), a column per
  // component, and the positions of the centres; weights, and square roots of those of values and gradients.
  Eigen::MatrixX3d q_, target_, center_q_;
  Eigen::VectorXd weight_, root_w_, root_g_, offset_;
  // Weighted rows of the model, values before gradients; the data are the last column.
  Eigen::MatrixXd quadric_columns_, columns_;
  Eigen::MatrixXd gram_;
  Eigen::LDLT<Eigen::Matrix<double, 10, 10>> quadric_matrix_;
  Eigen::LDLT<Eigen::MatrixXd> residual_matrix_;
  double area_per_sample_ = 0;
};

}  // namespace csrbf
