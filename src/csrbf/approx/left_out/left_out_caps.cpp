#include "csrbf/approx/left_out/left_out_caps.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_samples = 200, fewest_samples = 16;
constexpr std::array<double, 3> shares = {0.1, 0.2, 0.33};  // of the samples in a cap
constexpr int directions_each = 2;
constexpr Index most_targets = 30;  // samples predicted in a cap
constexpr double alike = 4;         // errors of a cap that tell as much as one
constexpr double share_within = 0.95, within = 1.96;
constexpr double largest_factor = 1e8, least_distance = 2;

// What samples in a cap say.
struct Errors {
  std::vector<double> distances;             // P^2 over what is usual
  std::vector<std::vector<double>> factors;  // by component: of P^2, that take an error to the end of its interval
};

// The samples whose coordinates along a direction are the largest, and the others.
template <int Dim>
std::pair<std::vector<Index>, std::vector<Index>> split_off_cap(const Points<Dim>& points, const Point<Dim>& direction,
                                                                double share) {
  const Eigen::VectorXd along = points.transpose() * direction;
  const auto n = static_cast<double>(along.size());
  const double limit =
      order_statistic(std::vector<double>(along.begin(), along.end()), static_cast<Index>(std::floor((1 - share) * n)));
  std::pair<std::vector<Index>, std::vector<Index>> split;
  for (Index i = 0; i < along.size(); ++i) (along[i] >= limit ? split.first : split.second).push_back(i);
  return split;
}

template <int Dim>
void add_errors(const Samples<Dim>& samples, const std::vector<Index>& cap, const std::vector<Index>& others,
                const InterpolateOptions& options, const Eigen::VectorXd& sigma2, Errors& errors) {
  const Samples<Dim> there = chosen_samples(samples, even_samples(cap, most_targets));
  const Index count = there.size();
  const Interpolation<Dim> fit = interpolate(chosen_samples(samples, others), options);
  if (fit.variances.empty()) return;
  const PowerFunction<Dim>& power = fit.variances.front()->power();
  const double usual = power.usual();
  const Eigen::VectorXd power2 = power.evaluate(there.points).array() - power.smoothing();
  for (Index k = 0; k < count; ++k)
    if (power2[k] > usual) errors.distances.push_back(power2[k] / usual);
  for (Index c = 0; c < samples.components(); ++c) {
    const Eigen::VectorXd f = fit.components[static_cast<std::size_t>(c)]->evaluate(there.points).value;
    for (Index k = 0; k < count; ++k) {
      if (!(power2[k] > usual)) continue;
      const double half = (there.values(k, c) - f[k]) / within;
      const double noise = sigma2[c] * power.smoothing() / there.weight(k);
      const double expected = sigma2[c] * power2[k];
      errors.factors[static_cast<std::size_t>(c)].push_back(expected > 0 ? (half * half - noise) / expected : 0);
    }
  }
}

// Of a function that is not smooth, samples say nothing of what happens between those that are closest: a step of the
// function, or noise. Rounding alone for smooth ones, whose slope tells it.
template <int Dim>
double least_tried(const Samples<Dim>& samples, const InterpolateOptions& options) {
  constexpr double rounding = 1e-16;
  const Kernel kernel(options.kernel, Dim, options.parameter);
  if (kernel.smoothness() > 0 || samples.size() < 2 || options.support <= 0) return rounding;
  const KdTree<Dim> tree(samples.points);
  double least2 = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < samples.size(); ++i) {
    std::array<Index, 2> nearest = {};
    std::array<double, 2> r2 = {};
    tree.nearest(samples.points.col(i), 2, nearest.data(), r2.data());
    least2 = std::min(least2, r2[1]);
  }
  return std::clamp(1 - kernel.value(std::sqrt(least2) / options.support), rounding, 1.0);
}

void learn(Errors errors, const Eigen::VectorXd& sigma2, std::vector<ErrorGrowth>& growth) {
  if (errors.distances.size() < static_cast<std::size_t>(fewest_samples)) return;
  const double distance = median(errors.distances);
  const auto count = static_cast<double>(errors.factors.front().size());
  const double doubt = 2 * std::sqrt(share_within * (1 - share_within) * alike / count);
  for (std::size_t c = 0; c < growth.size(); ++c) {
    std::vector<double>& factors = errors.factors[c];
    if (!(sigma2[static_cast<Index>(c)] > 0) || !(percentile(factors, share_within - doubt) > 1)) continue;
    growth[c].distance = std::max(distance, least_distance);
    growth[c].factor = std::min(percentile(factors, share_within), largest_factor);
  }
}

}  // namespace

template <int Dim>
std::vector<ErrorGrowth> left_out_caps(const Samples<Dim>& all, const InterpolateOptions& given,
                                       const Eigen::VectorXd& sigma2) {
  const Samples<Dim> samples = without_zero_weights(all);
  const Index C = samples.components();
  std::vector<ErrorGrowth> growth(static_cast<std::size_t>(C), ErrorGrowth{.least = least_tried(samples, given)});
  if (samples.size() < fewest_samples || !(sigma2.maxCoeff() > 0)) return growth;
  const Samples<Dim> some = chosen_samples(samples, even_samples(morton_order<Dim>(samples.points), most_samples));
  InterpolateOptions options = given;
  options.progress = {};
  options.require_degree = false;  // that of all samples, which some may not determine
  Errors errors;
  errors.factors.resize(static_cast<std::size_t>(C));
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  for (const double share : shares)
    for (int k = 0; k < directions_each; ++k) {
      Point<Dim> direction;
      for (double& d : direction) d = std::ldexp(static_cast<double>(random()), -64) - 0.5;
      const auto [cap, others] = split_off_cap<Dim>(some.points, direction, share);
      if (cap.size() >= others.size()) continue;
      try {
        add_errors(some, cap, others, options, sigma2, errors);
      } catch (const SolverFailure&) {
      }
    }
  learn(std::move(errors), sigma2, growth);
  return growth;
}

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template std::vector<ErrorGrowth> left_out_caps<Dim>(const Samples<Dim>&, const InterpolateOptions&, \
                                                       const Eigen::VectorXd&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
