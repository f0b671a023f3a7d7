#include "csrbf/approx/transform/transformed_back.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
template <int Dim>
void TransformedBack<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  if (parts_.of != Of::value) {
    Eigen::VectorXd variance(n);
    parts_.mean->evaluate_block(x, {out.value, nullptr, nullptr});
    parts_.variance->evaluate_block(x, {variance.data(), nullptr, nullptr});
    variance = variance.unaryExpr([&](double v) { return v > parts_.largest ? parts_.largest : v; });  // keeps NaN
    const bool is_sample = parts_.of == Of::sample;
    for (Index i = 0; i < n; ++i) {
      // The mean over the noise is a function of z as the value is: but for a factor, or a constant.
      const double without = std::max(variance[i] - parts_.noise * parts_.noise, 0.0);
      const double factor =
          is_sample || parts_.transform != Transform::logarithm ? 1 : std::exp(parts_.noise * parts_.noise);
      out.value[i] = factor * squared_error(parts_.transform, out.value[i], is_sample ? variance[i] : without,
                                            is_sample ? parts_.noise : 0);
    }
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * n, nan);
    if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * n, nan);
    return;
  }
  // Second derivatives of the values are made of both of z.
  parts_.mean->evaluate_block(x, out);
  for (Index i = 0; i < n; ++i) {
    const MeanValue mean = mean_value(parts_.transform, out.value[i], parts_.noise);
    out.value[i] = mean.value;
    if (out.gradient == nullptr) continue;
    double* gradient = out.gradient + Dim * i;
    if (out.hessian != nullptr) {
      double* entry = out.hessian + symmetric_size<Dim> * i;
      for (int a = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b, ++entry) *entry = mean.slope * *entry + mean.bend * gradient[a] * gradient[b];
    }
    for (int a = 0; a < Dim; ++a) gradient[a] *= mean.slope;
  }
}

template <int Dim>
Eigen::VectorXd TransformedBack<Dim>::evaluate_grid(const GridAxes<Dim>& axes) const {
  if (parts_.of != Of::value) return Field<Dim>::evaluate_grid(axes);
  return parts_.mean->evaluate_grid(axes).unaryExpr(
      [&](double z) { return mean_value(parts_.transform, z, parts_.noise).value; });
}

#define CSRBF_INSTANTIATE(Dim) template class TransformedBack<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
