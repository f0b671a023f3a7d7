#pragma once

#include "csrbf/core/field.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// The mean of fields, each as likely as its weight: sum_k w_k f_k. With the variances v_k of their errors instead that
/// of the mean: sum_k w_k (v_k + (f_k - mean)^2), whose derivatives are NaN.
template <int Dim>
class AverageField : public Field<Dim> {
 public:
  using Part = std::shared_ptr<const Field<Dim>>;

  /// `weights`: positive; of sum 1 where there are `variances`, as many as fields.
  AverageField(std::vector<Part> fields, std::vector<double> weights, std::vector<Part> variances = {})
      : fields_(std::move(fields)), weights_(std::move(weights)), variances_(std::move(variances)) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override {
    return fields_.front()->evaluation_order(x);
  }
  [[nodiscard]] Box<Dim> bounds() const override;
  [[nodiscard]] double feature_size() const override;

  [[nodiscard]] const std::vector<Part>& fields() const { return fields_; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] const std::vector<Part>& variances() const { return variances_; }

 private:
  std::vector<Part> fields_;
  std::vector<double> weights_;
  std::vector<Part> variances_;
};

}  // namespace csrbf
