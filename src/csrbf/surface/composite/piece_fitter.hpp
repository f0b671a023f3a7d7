#pragma once

#include "csrbf/surface/composite/composite.hpp"

#include <Eigen/Cholesky>

#include <span>

namespace csrbf {

/// A smooth piece of a patch with its CSRBF residual. Points and vectors in local coordinates.
struct FittedPiece {
  Patch patch;
  Points<3> centers{3, 0};
  Eigen::VectorXd alpha{0};
  Point<3> normal = Point<3>::UnitZ();  ///< unit, outward, of its samples on average
  Point<3> middle = Point<3>::Zero();   ///< of its samples

  /// Value and gradient at the points q, one per row.
  [[nodiscard]] Eigen::MatrixX4d evaluate(const Eigen::MatrixX3d& q) const;

  /// Distances of q (one per row) to the surface of the piece, unit of the cloud, searched along the piece's normal
  /// from the plane through its middle: the search does not start at q, so that q has no influence on which sheet is
  /// found.
  [[nodiscard]] Eigen::VectorXd distances(const Eigen::MatrixX3d& q) const;
};

/// Fits one piece (thesis 6.1.3 and 6.1.4) and keeps the system for the leverage of its samples. Reuses its work
/// arrays.
class PieceFitter {
 public:
  /// Fits samples `ids` of the cloud in the frame of `piece.patch`.
  void fit(const OrientedPoints& cloud, std::span<const Index> ids, const CompositeOptions& options,
           FittedPiece& piece);

  /// Largest difference |grad f + n| between gradient and normal at a sample, 2 for a normal turned round.
  [[nodiscard]] double largest_normal_residual(const FittedPiece& piece) const;

  /// Share of each of the samples `rows` (positions in the ids fitted) in its own value; ignores off-surface rows.
  [[nodiscard]] Eigen::VectorXd leverage(const FittedPiece& piece, std::span<const Index> rows) const;

 private:
  void choose_centers(std::span<const Index> ids, const CompositeOptions& options);
  void localize(const OrientedPoints& cloud, std::span<const Index> ids, const Patch& patch);
  void fit_quadric(Patch& patch);
  void fit_residual(const CompositeOptions& options, FittedPiece& piece);
  void gradient_columns(const FittedPiece& piece);
  void off_surface_columns(const FittedPiece& piece);

  Index samples_ = 0;
  bool gradient_rows_ = true;
  double normal_weight_ = 0;
  std::vector<Index> centers_;  // positions in the samples
  // Samples in local coordinates, padded with samples of weight zero: positions and gradient targets (-n), a column per
  // component, and the positions of the centres; weights, and square roots of those of values and gradients.
  Eigen::MatrixX3d q_, target_, center_q_;
  Eigen::VectorXd weight_, root_w_, root_g_, offset_;
  // Weighted rows of the model, values before gradients; the data are the last column.
  Eigen::MatrixXd quadric_columns_, columns_;
  Eigen::MatrixXd gram_;
  Eigen::LDLT<Eigen::Matrix<double, 10, 10>> quadric_matrix_;
  Eigen::LDLT<Eigen::MatrixXd> residual_matrix_;
};

}  // namespace csrbf
