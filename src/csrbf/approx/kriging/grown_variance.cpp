#include "csrbf/approx/kriging/grown_variance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Distances of samples between which the growth begins; by chance one point in eight and one in twenty-three of the
// plane is as far. Chosen by hand.
constexpr double begin = 0.8, end = 1.0;
constexpr double largest_factor = 1e12;

}  // namespace

template <int Dim>
double SamplePlaces<Dim>::distance(const Point<Dim>& x) const {
  std::call_once(once_, [&] { tree_ = std::make_unique<const KdTree<Dim>>(points_); });
  Index nearest = 0;
  double squared_distance = std::numeric_limits<double>::infinity();
  tree_->nearest(x, 1, &nearest, &squared_distance);
  return std::sqrt(squared_distance);
}

double GrowthWithDistance::factor(double distance) const {
  if (!(distance > begin) || !(amount > 0)) return 1;
  const double power = std::log(amount) + exponent * std::log(distance),
               t = std::min(1.0, (distance - begin) / (end - begin));
  return std::min(largest_factor, std::exp(std::max(0.0, power) * t * t * (3 - 2 * t)));
}

template <int Dim>
void GrownVariance<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const Index n = x.cols();
  if (out.gradient != nullptr) std::fill_n(out.gradient, Dim * n, none);
  if (out.hessian != nullptr) std::fill_n(out.hessian, symmetric_size<Dim> * n, none);
  Eigen::VectorXd spacing(n);
  spacing_->evaluate_block(x, {spacing.data(), nullptr, nullptr});
  variance_->evaluate_block(x, {out.value, nullptr, nullptr});
  for (Index i = 0; i < n; ++i)
    if (spacing[i] > 0) out.value[i] *= growth_.factor(places_->distance(x.col(i)) / spacing[i]);
}

#define CSRBF_INSTANTIATE(Dim)      \
  template class SamplePlaces<Dim>; \
  template class GrownVariance<Dim>;
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
