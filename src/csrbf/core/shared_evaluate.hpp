#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/shared_work.hpp"

#include <numeric>

namespace csrbf {

/// field.evaluate(x, derivatives) as shared work. The blocks of points are the same, so the result is bit-identical.
template <int Dim>
Jet<Dim> shared_evaluate(const Field<Dim>& field, const std::type_identity_t<PointsRef<Dim>>& x,
                         Derivatives derivatives = Derivatives::none) {
  const Index n = x.cols();
  if (!is_shared(n, Field<Dim>::block_size)) return field.evaluate(x, derivatives);
  std::vector<Index> order = field.evaluation_order(x);
  const Index grain = order.empty() ? Field<Dim>::block_size : Field<Dim>::ordered_block_size(n);
  if (order.empty()) {
    order.resize(n);
    std::iota(order.begin(), order.end(), Index{0});
  }
  const Points<Dim> sorted = x(Eigen::all, order);
  Jet<Dim> jet(n, derivatives);
  const bool gradient = derivatives >= Derivatives::gradient, hessian = derivatives >= Derivatives::hessian;
  const JetBlock out{jet.value.data(), jet.gradient.data(), jet.hessian.data()};
  const auto compute = [&](Index begin, Index end) {
    field.evaluate_block(sorted.middleCols(begin, end - begin), out.from<Dim>(begin));
  };
  share_arrays("evaluate", n, grain, compute,
               {ResultArray::of(jet.value.data()), ResultArray::of(jet.gradient.data(), gradient ? Dim : 0),
                ResultArray::of(jet.hessian.data(), hessian ? symmetric_size<Dim> : 0)});
  Jet<Dim> result(n, derivatives);
  result.value(order) = jet.value;
  if (gradient) result.gradient(Eigen::all, order) = jet.gradient;
  if (hessian) result.hessian(Eigen::all, order) = jet.hessian;
  return result;
}

}  // namespace csrbf
