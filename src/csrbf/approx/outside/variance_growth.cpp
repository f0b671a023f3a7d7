#include "csrbf/approx/outside/variance_growth.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {

template <int Dim>
typename FittedField<Dim>::Growth variance_growth(const Samples<Dim>& samples, Index component,
                                                  const Field<Dim>& variance) {
  constexpr Index at_most = 400;                          // samples
  constexpr double near = 0.04, far = 0.16, width = 1.5;  // in extents, and factors about these; chosen by hand
  const Index n = samples.size(), stride = std::max<Index>(1, n / at_most);
  const Points<Dim> x = samples.points(Eigen::all, Eigen::seq(0, n - 1, stride));
  const Eigen::VectorXd v = samples.values.col(component)(Eigen::seq(0, n - 1, stride));
  const double extent = bounding_box<Dim>(samples.points).extent().maxCoeff();
  const double noise = 2 * variance.evaluate(x).value.cwiseMax(0).mean();
  double squares[2] = {}, count[2] = {};
  for (Index j = 0; j < x.cols(); ++j)
    for (Index i = j + 1; i < x.cols(); ++i) {
      const double distance = (x.col(i) - x.col(j)).norm() / extent;
      for (const int k : {0, 1}) {
        const double middle = k == 0 ? near : far;
        if (distance < middle / width || distance > middle * width) continue;
        squares[k] += (v[i] - v[j]) * (v[i] - v[j]);
        count[k] += 1;
      }
    }
  const double spread = (v.array() - v.mean()).square().mean();
  if (!(extent > 0) || !(spread > 0)) return {};
  const double beyond_noise = 0.05;  // share that is left, at least
  const auto at = [&](int k) {
    const double mean = count[k] > 0 ? squares[k] / count[k] : spread;
    return std::max(mean - noise, beyond_noise * mean);
  };
  const double exponent = std::clamp(std::log(at(1) / at(0)) / std::log(far / near), 0.5, 2.0);
  return {at(1) / std::pow(far * extent, exponent), exponent, 2 * spread};
}

#define CSRBF_INSTANTIATE(Dim) \
  template typename FittedField<Dim>::Growth variance_growth<Dim>(const Samples<Dim>&, Index, const Field<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
