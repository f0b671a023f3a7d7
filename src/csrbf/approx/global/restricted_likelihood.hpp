#pragma once

#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// Samples as values of a random function: a trend (constant, or linear), a part of mean 0 and covariance sigma^2
/// phi(|T (x - y)|) with T = diag(1 / length), and noise of variance sigma^2 nugget / weight. Minus the logarithm of
/// the restricted likelihood (Patterson and Thompson 1971) of lengths and nugget, sigma^2 at its best for every
/// component, the rest common to all.
class RestrictedLikelihood {
 public:
  /// `samples`: distinct points; values of size 1 about. `replicates`: what duplicates of their points say about the
  /// noise.
  RestrictedLikelihood(Samples<Eigen::Dynamic> samples, Replicates replicates);

  struct Parameters {
    Eigen::VectorXd log_lengths;
    double log_nugget = 0;
  };
  struct Value {
    double value;                   ///< infinite where the covariance is not positive definite
    Eigen::VectorXd d_log_lengths;  ///< derivatives
    double d_log_nugget = 0;
    double leave_one_out = 0;  ///< weighted root mean square of the errors of samples left out
    double kurtosis = 0;       ///< of these errors over their standard deviations: 3 of normal ones
  };
  /// O(n^3 / 3).
  [[nodiscard]] double value(const Kernel& kernel, int degree, const Parameters& at) const;
  /// The derivatives, too, and the errors: seven times as long.
  [[nodiscard]] Value with_derivatives(const Kernel& kernel, int degree, const Parameters& at) const;
  /// Whether the errors of samples left out may be normal. At kinks and steps, which no kernel follows, their tails are
  /// heavier. As long as with_derivatives().
  [[nodiscard]] bool leaves_noise(const Kernel& kernel, int degree, const Parameters& at) const;

  /// Samples left out one by one: how far each is from what the others say, and the variance that they expect (Dubrule
  /// 1983); n x k each. None where the covariance is not positive definite. O(n^3).
  struct LeftOut {
    Eigen::MatrixXd errors, variances;
    Eigen::VectorXd sigma2;  ///< k
  };
  [[nodiscard]] std::optional<LeftOut> left_out(const Kernel& kernel, int degree, const Parameters& at) const;

  [[nodiscard]] Index size() const { return samples_.size(); }
  /// Samples with those of the replicates.
  [[nodiscard]] Index observations() const { return size() + replicates_.count; }
  /// Of the largest trend that the samples determine well: 0 or 1.
  [[nodiscard]] int largest_degree() const { return largest_degree_; }

 private:
  struct Solved;
  // C times P, see with_derivatives(), of which the lower triangle counts.
  [[nodiscard]] Eigen::MatrixXd projected_inverse(const Solved& solved, double C) const;
  bool solve(const Kernel& kernel, int degree, const Parameters& at, bool derivatives, Solved& solved) const;

  Samples<Eigen::Dynamic> samples_;
  Replicates replicates_;
  Eigen::VectorXd inverse_weights_;
  Eigen::MatrixXd trend_;  // 1 and the coordinates
  int largest_degree_ = 0;
  double log_trend_[2];  // log det G^T G by degree: makes likelihoods of both comparable (Harville 1974)
};

/// That of some of the samples, places in these units about an origin, values of size 1. Without values that do not
/// vary: a constant has no covariance, and would be likeliest without noise.
RestrictedLikelihood likelihood_of(const SampleView& samples, const Replicates& replicates,
                                   const std::vector<Index>& chosen, const Eigen::VectorXd& origin,
                                   const Eigen::VectorXd& units);

}  // namespace csrbf
