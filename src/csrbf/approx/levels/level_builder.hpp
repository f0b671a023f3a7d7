#pragma once

#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/linalg/sparse_least_squares.hpp"

#include <optional>

namespace csrbf {

/// The common part of the multilevel fits: keeps the residual at the samples and adds one expansion after the other,
/// each fitted to the residual. The first level contains the weighted mean of the data as a constant, so the model
/// tends to it away from the data.
template <int Dim>
class LevelBuilder {
 public:
  /// Checks the samples in the name of `function` and merges duplicates.
  LevelBuilder(const Samples<Dim>& samples, const char* function, Progress progress,
               DuplicateValue duplicates = DuplicateValue::mean);

  [[nodiscard]] const Samples<Dim>& samples() const { return merged_.samples; }  ///< merged
  [[nodiscard]] const Eigen::MatrixXd& residual() const { return residual_; }
  [[nodiscard]] Index levels() const { return static_cast<Index>(reports_.size()); }

  /// Largest error of a component at merged sample i and all those that were merged into it (exact for midranges).
  [[nodiscard]] double error(Index i) const { return residual_.row(i).cwiseAbs().maxCoeff() + merged_.spread[i]; }
  [[nodiscard]] double max_error() const {
    return (residual_.rowwise().template lpNorm<Eigen::Infinity>() + merged_.spread).maxCoeff();
  }

  /// Half the largest difference between values at one point: no function has a smaller maximum error.
  [[nodiscard]] double spread() const { return merged_.spread.maxCoeff(); }

  /// Largest difference between two values of a component.
  [[nodiscard]] double range() const {
    return (samples().values.colwise().maxCoeff() - samples().values.colwise().minCoeff()).maxCoeff();
  }

  /// Adds a level. `lambda0` as in sparse_least_squares, not used by interpolation.
  void add(const Kernel& kernel, const PointsRef<Dim>& centers, const Eigen::VectorXd& supports, LevelSolve solve,
           std::optional<double> lambda0);

  /// Adds the level that removes all errors (thesis section 3.3, modified to be always possible): at the given samples
  /// a basis function that vanishes at every other sample, with their residuals as coefficients. Their errors become 0,
  /// the others do not change.
  void add_diagonal(const Kernel& kernel, const std::vector<Index>& ids);

  /// The ids of the samples with errors above the tolerance, found by evaluating the model so far.
  [[nodiscard]] std::vector<Index> violations(double tolerance);

  /// The model; `tolerance`: what `converged` is measured against, rounding aside.
  [[nodiscard]] LevelFit<Dim> finish(double tolerance = std::numeric_limits<double>::infinity()) const;

 private:
  void append(const std::shared_ptr<const RadialBasis<Dim>>& basis, const Eigen::MatrixXd& coefficients,
              double lambda0);

  MergedSamples<Dim> merged_;
  Progress progress_;
  Eigen::RowVectorXd mean_;
  Eigen::MatrixXd residual_;
  std::vector<std::vector<std::shared_ptr<const Expansion<Dim>>>> expansions_;  // per component
  std::vector<LevelReport> reports_;
};

}  // namespace csrbf
