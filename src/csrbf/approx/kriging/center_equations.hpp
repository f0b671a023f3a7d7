#pragma once

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/approx/kriging/center_fit.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"

#include <memory>
#include <optional>

namespace csrbf {

/// The normal equations of penalised least squares: with K = L L^T of the centres, functions k(x) L^-T u + g(x) pi of
/// penalty lambda |u|^2, which are as well conditioned as can be. Points are in the lengths of the covariance.
template <int Dim>
class CenterEquations {
 public:
  /// `mean`: what is subtracted from the values.
  CenterEquations(const AxisCovariance<Dim>& covariance, const Points<Dim>& centers, PolynomialBlock<Dim> trend,
                  Eigen::RowVectorXd mean);

  /// Whether the centres are independent, but for rounding.
  [[nodiscard]] bool is_regular() const { return is_regular_; }

  /// O(n m^2).
  void add(const Samples<Dim>& samples) { add(samples, 1); }

  /// Takes away samples that were added. O(n m^2).
  void remove(const Samples<Dim>& samples) { add(samples, -1); }

  /// Minus twice the logarithm of the restricted likelihood, but for a constant; infinite where the matrix is singular
  /// by rounding.
  [[nodiscard]] double deviance(double nugget) const;

  /// `samples`: all that were added; `covariance`: what they are in the lengths of. None where the matrix is singular
  /// by rounding.
  [[nodiscard]] std::optional<CenterFit<Dim>> fit(double nugget, const Samples<Dim>& samples,
                                                  const AxisCovariance<Dim>& covariance, bool with_variances) const;

 private:
  struct Solved {
    bool is_regular = false;
    Eigen::MatrixXd factor = {}, white = {};
    Eigen::VectorXd misfit = {};  // the least of the objective, by component
  };

  void add(const Samples<Dim>& samples, int sign);
  [[nodiscard]] double degrees() const { return static_cast<double>(samples_ - (A_.rows() - centers_.cols())); }
  [[nodiscard]] Eigen::MatrixXd covariances(const Points<Dim>& x) const;  // with the centres: one column each
  [[nodiscard]] Solved solve(double nugget) const;
  void add_variances(const Eigen::VectorXd& noise, const Eigen::VectorXd& left_out, const Samples<Dim>& samples,
                     const std::shared_ptr<const RadialBasis<Dim>>& basis, const typename MappedField<Dim>::Map& map,
                     CenterFit<Dim>& result) const;
  [[nodiscard]] Eigen::VectorXd weights_of(const Samples<Dim>& samples) const;

  Kernel kernel_;
  Points<Dim> centers_;
  PolynomialBlock<Dim> trend_;
  Eigen::RowVectorXd mean_;
  bool is_regular_ = false;
  Eigen::MatrixXd L_, A_, b_;  // A's lower triangle
  Eigen::VectorXd squares_;
  double weight_ = 0;
  Index samples_ = 0;
};

}  // namespace csrbf
