#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// The mean of fields, each as likely as its weight: sum_k w_k f_k. With the variances v_k of their errors instead that
/// of the mean: sum_k w_k (v_k + (f_k - mean)^2), or with another field in its place, the mean square of the error of
/// that one. Their derivatives are NaN.
template <int Dim>
class AverageField : public Field<Dim> {
 public:
  using Part = std::shared_ptr<const Field<Dim>>;

  /// `weights`: positive; of sum 1 where there are `variances`, as many as fields. `other`: in place of the mean, with
  /// variances only; null: none.
  AverageField(std::vector<Part> fields, std::vector<double> weights, std::vector<Part> variances = {}, Part other = {})
      : fields_(std::move(fields)),
        weights_(std::move(weights)),
        variances_(std::move(variances)),
        other_(std::move(other)) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override {
    return fields_.front()->evaluation_order(x);
  }
  [[nodiscard]] Box<Dim> bounds() const override;
  [[nodiscard]] double feature_size() const override;

  [[nodiscard]] const std::vector<Part>& fields() const { return fields_; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] const std::vector<Part>& variances() const { return variances_; }
  [[nodiscard]] const Field<Dim>* other() const { return other_.get(); }

 private:
  std::vector<Part> fields_;
  std::vector<double> weights_;
  std::vector<Part> variances_;
  Part other_;
};

/// The mean squares of the errors of `fields`, where the values have these means and variances: one of each per
/// component.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> errors_of(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& means,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances);

}  // namespace csrbf
