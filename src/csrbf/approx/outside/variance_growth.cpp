#include "csrbf/approx/outside/variance_growth.hpp"

#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/kriging/grown_variance.hpp"
#include "csrbf/approx/samples/blended_field.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Some hundred of n samples.
auto some(Index n) {
  constexpr Index at_most = 400;
  return Eigen::seq(0, n - 1, std::max<Index>(1, n / at_most));
}

// Where there are samples, the distance to the nearest one is 0: the tree that tells it is not asked for.
template <int Dim>
Eigen::VectorXd at_samples(const Field<Dim>& variance, const Points<Dim>& x) {
  if constexpr (Dim <= 3)
    if (const auto* grown = dynamic_cast<const GrownVariance<Dim>*>(&variance))
      return at_samples<Dim>(grown->variance(), x);
  const auto* blend = dynamic_cast<const BlendedField<Dim>*>(&variance);
  if (blend == nullptr) return variance.evaluate(x).value;
  Eigen::VectorXd one = at_samples<Dim>(blend->one(), x), other = Eigen::VectorXd::Zero(x.cols());
  if (blend->other() != nullptr) other = at_samples<Dim>(*blend->other(), x);
  return other + blend->share().evaluate(x).value.cwiseProduct(one - other);
}

}  // namespace

template <int Dim>
double noise_by(const Field<Dim>& variance, const Samples<Dim>& samples) {
  if (const auto* kriging = dynamic_cast<const KrigingVariance<Dim>*>(&variance)) return kriging->noise();
  const Points<Dim> x = samples.points(Eigen::all, some(samples.size()));
  return at_samples<Dim>(variance, x).cwiseMax(0).mean();
}

template <int Dim>
typename FittedField<Dim>::Growth variance_growth(const Samples<Dim>& samples, Index component, double noise) {
  constexpr double near = 0.04, far = 0.16, width = 1.5;  // in extents, and factors about these; chosen by hand
  const Points<Dim> x = samples.points(Eigen::all, some(samples.size()));
  const Eigen::VectorXd v = samples.values.col(component)(some(samples.size()));
  const double extent = bounding_box<Dim>(samples.points).extent().maxCoeff();
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
    return std::max(mean - 2 * noise, beyond_noise * mean);
  };
  const double exponent = std::clamp(std::log(at(1) / at(0)) / std::log(far / near), 0.5, 2.0);
  return {at(1) / std::pow(far * extent, exponent), exponent, 2 * spread};
}

#define CSRBF_INSTANTIATE(Dim)                                           \
  template double noise_by<Dim>(const Field<Dim>&, const Samples<Dim>&); \
  template typename FittedField<Dim>::Growth variance_growth<Dim>(const Samples<Dim>&, Index, double);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
