#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <variant>
#include <vector>

namespace csrbf {

#define CSRBF_ALTERNATIVE(Dim) std::shared_ptr<const Field<Dim>>,
/// A field of any dimension.
using AnyField = std::variant<CSRBF_FOR_MANY_DIMS(CSRBF_ALTERNATIVE) std::monostate>;
#undef CSRBF_ALTERNATIVE

/// A field of which some coordinates, z, enter linearly, and for variances quadratically:
///
///     f(x, z) = g(x) + beta z + (z - c(x))^T C (z - c(x))
///
/// with the field c_j of each covariate (universal kriging; Matheron 1969). Derivatives of fields with a quadratic part
/// are not provided: they are NaN. In many variables (CSRBF_FOR_MANY_DIMS), x are as many of the axes that are not of z
/// as g has, from the first on.
template <int Dim>
class DriftField : public Field<Dim> {
 public:
  struct Parts {
    std::vector<int> drift;            ///< the axes of z
    AnyField field;                    ///< g, of the other axes
    Eigen::VectorXd beta;              ///< one per axis of z
    std::vector<AnyField> covariates;  ///< c, or none
    Eigen::MatrixXd covariance;        ///< C, or empty
  };
  /// Throws InvalidInput unless the dimensions of the parts fit.
  DriftField(Parts parts, const Box<Dim>& bounds);

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }

  [[nodiscard]] const Parts& parts() const { return parts_; }
  /// The axes that are not of the drift: as many as there are, or as the fields have.
  [[nodiscard]] const std::vector<int>& others() const { return others_; }

 private:
  Parts parts_;
  std::vector<int> others_;
  Box<Dim> bounds_;
};

}  // namespace csrbf
