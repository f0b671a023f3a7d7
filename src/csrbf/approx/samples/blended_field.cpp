#include "csrbf/approx/samples/blended_field.hpp"

#include <cmath>

namespace csrbf {
namespace {

constexpr double rounding = 1e-12;  // of shares: beyond, a field counts

// Of the field at some of the points, in their places; what is not asked for stays.
template <int Dim>
void evaluate_some(const Field<Dim>& field, const PointsRef<Dim>& x, const std::vector<Index>& chosen, Jet<Dim>& jet) {
  if (chosen.empty()) return;
  const bool has_gradient = jet.gradient.cols() > 0, has_hessian = jet.hessian.cols() > 0;
  const auto derivatives = has_hessian    ? Derivatives::hessian
                           : has_gradient ? Derivatives::gradient
                                          : Derivatives::none;
  Jet<Dim> some(std::ssize(chosen), derivatives);
  const Points<Dim> places = x(Eigen::all, chosen);
  field.evaluate_block(places, {some.value.data(), has_gradient ? some.gradient.data() : nullptr,
                                has_hessian ? some.hessian.data() : nullptr});
  jet.value(chosen) = some.value;
  if (has_gradient) jet.gradient(Eigen::all, chosen) = some.gradient;
  if (has_hessian) jet.hessian(Eigen::all, chosen) = some.hessian;
}

}  // namespace

template <int Dim>
void BlendedField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  const Derivatives derivatives = out.derivatives();
  Jet<Dim> share(n, derivatives), one(n, derivatives), other(n, derivatives);
  if (!other_) {
    other.value.setZero();
    other.gradient.setZero();
    other.hessian.setZero();
  }
  share_->evaluate_block(x, {share.value.data(), out.gradient != nullptr ? share.gradient.data() : nullptr,
                             out.hessian != nullptr ? share.hessian.data() : nullptr});
  std::vector<Index> in_one, in_other;
  for (Index i = 0; i < n; ++i) {
    if (std::abs(share.value[i]) > rounding) in_one.push_back(i);
    if (other_ && std::abs(share.value[i] - 1) > rounding) in_other.push_back(i);
  }
  evaluate_some(*one_, x, in_one, one);
  if (other_) evaluate_some(*other_, x, in_other, other);
  for (Index i = 0; i < n; ++i) {
    const double s = share.value[i];
    const bool is_one = other_ && std::abs(s - 1) <= rounding, is_blend = std::abs(s) > rounding && !is_one;
    const Jet<Dim>& whole = is_one ? one : other;
    const double difference = is_blend ? one.value[i] - other.value[i] : 0;
    out.value[i] = whole.value[i] + s * difference;
    if (out.gradient == nullptr) continue;
    Eigen::Map<Point<Dim>> gradient(out.gradient + Dim * i);
    gradient = whole.gradient.col(i);
    Point<Dim> slope = Point<Dim>::Zero();  // of the difference
    if (is_blend) {
      slope = one.gradient.col(i) - other.gradient.col(i);
      gradient += s * slope + difference * share.gradient.col(i);
    }
    if (out.hessian == nullptr) continue;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) {
        double& h = out.hessian[symmetric_size<Dim> * i + entry];
        h = whole.hessian(entry, i);
        if (is_blend)
          h += s * (one.hessian(entry, i) - other.hessian(entry, i)) + difference * share.hessian(entry, i) +
               share.gradient(a, i) * slope[b] + share.gradient(b, i) * slope[a];
      }
  }
}

#define CSRBF_INSTANTIATE(Dim) template class BlendedField<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
