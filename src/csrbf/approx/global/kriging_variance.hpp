#pragma once

#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/core/once.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace csrbf {

/// Squared power function of interpolation by radial basis functions and a polynomial, plus lambda:
///
///     P^2(x) + lambda = phi(0) - b(x)^T M^-1 b(x) + lambda,   b = (phi_j(x), g_q(x)),   M the matrix of the system
///
/// (Schaback 1993). 0 at the samples for lambda = 0, and growing with the distance to them. The system is factorised at
/// the first evaluation, O(n^3 / 3); then O(n^2) per point. Thread safe.
///
/// More than 4000 centres are represented at each point by the 64 nearest ones and 64 that cover all of them: the
/// variance of a prediction from fewer samples, which is larger, by little where near samples hide those behind.
template <int Dim>
class PowerFunction {
 public:
  /// Of the system that interpolate() solved: one centre per sample; `degree` of the polynomial; `smoothing` lambda and
  /// `weights` (n, or empty) in A + lambda diag(1 / weights).
  PowerFunction(std::shared_ptr<const RadialBasis<Dim>> basis, int degree, double smoothing, Eigen::VectorXd weights);
  PowerFunction(const PowerFunction&) = delete;
  PowerFunction& operator=(const PowerFunction&) = delete;
  ~PowerFunction();

  /// Never negative. Rounding limits it to about 1e-16 of phi(0), or of the largest |phi| between samples.
  [[nodiscard]] Eigen::VectorXd evaluate(const PointsRef<Dim>& x) const;

  /// P^2 that is usual between the samples: at nine in ten of them, without the sample, it is less. Of dense systems.
  [[nodiscard]] double usual() const;

  [[nodiscard]] std::shared_ptr<const RadialBasis<Dim>> basis() const { return basis_; }
  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] double smoothing() const { return smoothing_; }
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }

 private:
  struct System;
  struct Neighborhoods;
  [[nodiscard]] const System& system() const;
  [[nodiscard]] Eigen::VectorXd evaluate_all(const PointsRef<Dim>& x) const;
  [[nodiscard]] Eigen::VectorXd evaluate_nearest(const PointsRef<Dim>& x) const;

  std::shared_ptr<const RadialBasis<Dim>> basis_;
  int degree_;
  double smoothing_;
  Eigen::VectorXd weights_;
  mutable Once once_, once_usual_;
  mutable double usual_ = 0;
  mutable std::unique_ptr<const System> system_;
  mutable std::unique_ptr<const Neighborhoods> neighborhoods_;
};

/// By how much errors outgrow what a covariance says of them: P^2 is multiplied by a factor that grows from 1, where
/// P^2 is usual, to `factor` where it is `distance` times that, as a power of P^2, and no more beyond; P^2 + lambda is
/// `least` at least. See left_out_blocks().
struct ErrorGrowth {
  double distance = 1, factor = 1, least = 0;
};

/// Variance sigma^2 (P^2 + lambda) of the difference between a sample of weight 1 and the interpolant, seen as the best
/// linear unbiased prediction of a random function with (generalised) covariance sigma^2 phi from values with noise of
/// variance sigma^2 lambda; P^2 grows as told. Derivatives are not provided: they are NaN.
template <int Dim>
class KrigingVariance : public Field<Dim> {
 public:
  KrigingVariance(std::shared_ptr<const PowerFunction<Dim>> power, double sigma2, const Box<Dim>& bounds,
                  ErrorGrowth growth = {})
      : power_(std::move(power)), sigma2_(sigma2), bounds_(bounds), growth_(growth) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }

  [[nodiscard]] const PowerFunction<Dim>& power() const { return *power_; }
  [[nodiscard]] const std::shared_ptr<const PowerFunction<Dim>>& shared_power() const { return power_; }
  [[nodiscard]] double sigma2() const { return sigma2_; }
  [[nodiscard]] ErrorGrowth growth() const { return growth_; }
  /// Of the noise of a sample of weight 1: the variance where P^2 = 0.
  [[nodiscard]] double noise() const { return sigma2_ * std::max(power_->smoothing(), growth_.least); }

  /// The same of another sigma^2 and growth.
  [[nodiscard]] std::shared_ptr<const KrigingVariance> with(double sigma2, ErrorGrowth growth) const {
    return std::make_shared<const KrigingVariance>(power_, sigma2, bounds_, growth);
  }

 private:
  std::shared_ptr<const PowerFunction<Dim>> power_;
  double sigma2_;
  Box<Dim> bounds_;
  ErrorGrowth growth_;
};

}  // namespace csrbf
