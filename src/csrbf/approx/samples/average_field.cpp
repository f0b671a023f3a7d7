#include "csrbf/approx/samples/average_field.hpp"

#include <algorithm>
#include <limits>

namespace csrbf {

template <int Dim>
void AverageField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  Eigen::Map<Eigen::VectorXd> result(out.value, n);
  if (!variances_.empty()) {
    Eigen::MatrixXd values(n, std::ssize(fields_));
    Eigen::VectorXd variance(n), mean = Eigen::VectorXd::Zero(n);
    result.setZero();
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      auto values_k = values.col(static_cast<Index>(k));
      fields_[k]->evaluate_block(x, {values_k.data(), nullptr, nullptr});
      variances_[k]->evaluate_block(x, {variance.data(), nullptr, nullptr});
      mean += weights_[k] * values_k;
      result += weights_[k] * variance;
    }
    if (other_) other_->evaluate_block(x, {mean.data(), nullptr, nullptr});
    for (std::size_t k = 0; k < fields_.size(); ++k)
      result += weights_[k] * (values.col(static_cast<Index>(k)) - mean).cwiseAbs2();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * n, nan);
    if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * n, nan);
    return;
  }
  Jet<Dim> jet(n, out.derivatives());
  const bool has_gradient = out.gradient != nullptr, has_hessian = out.hessian != nullptr;
  const JetBlock one = {jet.value.data(), has_gradient ? jet.gradient.data() : nullptr,
                        has_hessian ? jet.hessian.data() : nullptr};
  result.setZero();
  if (has_gradient) std::fill_n(out.gradient, Dim * n, 0.0);
  if (has_hessian) std::fill_n(out.hessian, symmetric_size<Dim> * n, 0.0);
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    fields_[k]->evaluate_block(x, one);
    result += weights_[k] * jet.value;
    if (has_gradient) Eigen::Map<Eigen::VectorXd>(out.gradient, Dim * n) += weights_[k] * jet.gradient.reshaped();
    if (has_hessian)
      Eigen::Map<Eigen::VectorXd>(out.hessian, symmetric_size<Dim> * n) += weights_[k] * jet.hessian.reshaped();
  }
}

template <int Dim>
Box<Dim> AverageField<Dim>::bounds() const {
  Box<Dim> box = fields_.front()->bounds();
  for (const Part& field : fields_) {
    box.lo = box.lo.cwiseMin(field->bounds().lo);
    box.hi = box.hi.cwiseMax(field->bounds().hi);
  }
  return box;
}

template <int Dim>
double AverageField<Dim>::feature_size() const {
  double smallest = fields_.front()->feature_size();
  for (const Part& field : fields_) smallest = std::min(smallest, field->feature_size());
  return smallest;
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> errors_of(
    const std::vector<std::shared_ptr<const Field<Dim>>>& fields,
    const std::vector<std::shared_ptr<const Field<Dim>>>& means,
    const std::vector<std::shared_ptr<const Field<Dim>>>& variances) {
  using Part = std::shared_ptr<const Field<Dim>>;
  std::vector<Part> errors;
  for (std::size_t c = 0; c < variances.size(); ++c) {
    // Of the errors of a mean, those of what it is a mean of: an average is in no other one.
    const auto* of_mean = dynamic_cast<const AverageField<Dim>*>(variances[c].get());
    if (of_mean != nullptr && !of_mean->variances().empty() && of_mean->other() == nullptr)
      errors.push_back(std::make_shared<const AverageField<Dim>>(of_mean->fields(), of_mean->weights(),
                                                                 of_mean->variances(), fields[c]));
    else
      errors.push_back(std::make_shared<const AverageField<Dim>>(std::vector<Part>{means[c]}, std::vector<double>{1},
                                                                 std::vector<Part>{variances[c]}, fields[c]));
  }
  return errors;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                      \
  template class AverageField<Dim>;                                                                                 \
  template std::vector<std::shared_ptr<const Field<Dim>>> errors_of<Dim>(                                           \
      const std::vector<std::shared_ptr<const Field<Dim>>>&, const std::vector<std::shared_ptr<const Field<Dim>>>&, \
      const std::vector<std::shared_ptr<const Field<Dim>>>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
