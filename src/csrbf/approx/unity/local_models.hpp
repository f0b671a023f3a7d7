#pragma once

#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <vector>

namespace csrbf {

/// The local functions of a partition of unity, one after the other: polynomials plus CSRBF sums in coordinates
/// q = metric (x - center) / radius of their own. All have the same degree, kernel and number of centres; `support` is
/// that of the kernel in units of the radius.
template <int Dim>
struct LocalModels {
  static constexpr int lanes = 8;

  int degree = 0;
  Kernel kernel{"wendland-c4", Dim};
  double support = 4;
  Index centers_each = 0;
  Index components = 1;
  bool anisotropic = false;  ///< then there are radial functions

  Points<Dim> center;
  Eigen::VectorXd radius;
  std::vector<double> metric;      ///< if anisotropic: matrices by columns, Dim x Dim each; else empty, the identity
  std::vector<double> position;    ///< of the centres: Dim each, centers_each per model
  std::vector<double> alpha;       ///< component-major per model: components x centers_each
  std::vector<double> polynomial;  ///< the same: components x Q

  void resize(Index models);
  [[nodiscard]] Index size() const { return radius.size(); }
  [[nodiscard]] Index polynomial_size() const { return Polynomials<Dim>::size(degree); }
};

/// Evaluates single models for `LocalModels::lanes` points at a time. Keeps its work arrays: one per thread.
template <int Dim>
class LocalEvaluator {
 public:
  static constexpr int lanes = LocalModels<Dim>::lanes;
  /// Value, gradient and Hessian (upper triangle) of a lane each.
  static constexpr int terms = 1 + Dim + symmetric_size<Dim>;

  explicit LocalEvaluator(const LocalModels<Dim>& models);

  /// f[t][lane] of model i at the points x (Dim x lanes, by coordinate), as many terms as requested, in the coordinates
  /// of x.
  void evaluate(Index i, Index component, const double* x, Derivatives derivatives, double (*f)[lanes]);

 private:
  const LocalModels<Dim>& models_;
  std::vector<std::int16_t> parent_, axis_;  // of the monomials
  std::vector<Index> nested_order_;
  std::vector<double> nested_;  // coefficients of the model that was last evaluated ...
  Index first_ = -1;            // ... and the place of its first one
  std::vector<double> q_, monomial_, r2_, phi_, g_, h_;
};

}  // namespace csrbf
