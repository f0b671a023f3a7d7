#pragma once

#include "csrbf/approx/global/rbf_system.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>

namespace csrbf {

/// Interpolants of RbfBasis for many points in one to three dimensions: their systems solved by solve_iteratively(),
/// their values by FastSum, O(n).
class ManyRbfs {
 public:
  /// Of a system that is not singular.
  class IllConditioned : public SolverFailure {
   public:
    using SolverFailure::SolverFailure;
  };

  /// Whether there is one for points of `dimension` coordinates: from 4000 on, for polynomials with which the kernel is
  /// definite.
  [[nodiscard]] static bool suits(const RbfBasis& basis, Index dimension, Index n);

  /// As RbfBasis::solve(), with `smoothing` >= 0: coincident points need positive ones. Throws SolverFailure when the
  /// system is singular, IllConditioned when it is too ill conditioned for iterations.
  [[nodiscard]] static RbfCoefficients solve(const RbfBasis& basis, const Eigen::MatrixXd& y,
                                             const Eigen::Ref<const Eigen::MatrixXd>& s,
                                             const Eigen::Ref<const Eigen::VectorXd>& smoothing,
                                             const Progress& progress);

  /// Ready to be evaluated.
  static std::unique_ptr<const ManyRbfs> make(const RbfBasis& basis, const Eigen::MatrixXd& y,
                                              const RbfCoefficients& f);

  ManyRbfs() = default;
  ManyRbfs(const ManyRbfs&) = delete;
  ManyRbfs& operator=(const ManyRbfs&) = delete;
  virtual ~ManyRbfs() = default;

  /// Values (k x m) at the points x (d x m), on all threads; NaN where a coordinate is.
  [[nodiscard]] virtual Eigen::MatrixXd evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x) const = 0;
};

}  // namespace csrbf
