#include "csrbf/approx/choose_model.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/kriging/local_kriging.hpp"
#include "csrbf/approx/left_out/left_out_extremes.hpp"
#include "csrbf/approx/moving/on_lines.hpp"
#include "csrbf/approx/unity/choose_local_options.hpp"
#include "csrbf/approx/unity/held_out_error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

constexpr double maybe_different = 2;  // ratio of extents that are made equal if cross-validation is in favour of it
constexpr double much_better = 2;      // errors of one system over those of patches, which have no covariance
constexpr double better_than_thinned = 4;  // the same where it is measured on fewer samples than it will have
template <int Dim>
constexpr Index one_system = Dim > 3 ? 4000 : 2500;  // samples that one system is tried for; chosen by hand
template <int Dim>
constexpr Index most_in_stages = Dim > 3 ? 400'000 : (Dim == 3 ? 20'000 : (Dim == 2 ? 5000 : 0));  // clean samples
constexpr Index few_systems = 2500;          // samples from which on only that of the likeliest covariance is solved
constexpr Index most_thinned = 2000;         // samples of one system for some of many
constexpr Index fewest_thinned = 500;        // the same, if they are very many
constexpr double clean = 1e-6;               // nugget
constexpr std::size_t tried_thinned = 1000;  // of these, to find out what they leave
constexpr Index tried_pairs = 2000;          // samples that tell
constexpr double unresolved = 0.05;          // share of the deviation of the values that is too much
constexpr double like_noise = 0.8;           // the same of that of the noise, which is in one system, too
constexpr double least_nugget = 1e-14;       // some roundings
constexpr double evaluations = 2e8;          // of radial functions, at all samples
constexpr Index few_patches = 50;            // samples that patches are tried for beside one system; chosen by hand

// What the coordinates are divided by.
template <int Dim>
Point<Dim> choose_scales(const Samples<Dim>& samples, const FitOptions& options, FitMethod method) {
  if (!options.scale_axes) return Point<Dim>::Ones();
  const Point<Dim> extent = usual_extent<Dim>(samples.points);
  const Point<Dim> equal = (extent.array() > 0).select(extent, Point<Dim>::Ones());
  const double ratio = ratio_of_extents<Dim>(extent);
  if (ratio > different_units) return equal;
  if constexpr (Dim <= largest_dimension) {
    if (method != FitMethod::partition_of_unity || !(ratio > maybe_different)) return Point<Dim>::Ones();
    Samples<Dim> scaled = samples;
    scaled.points.array().colwise() /= equal.array();
    const PartitionOfUnityOptions local = partition_options(options);
    if (choose_local_options(scaled, local).error < choose_local_options(samples, local).error) return equal;
  }
  return Point<Dim>::Ones();
}

// Samples of one system for some of `n`; 0 where they are too many.
Index thinned_size(Index n) {
  const auto count = std::min(static_cast<Index>(evaluations / static_cast<double>(n)), most_thinned);
  return count < fewest_thinned ? 0 : count;
}

// Whether one system of some samples, points in the lengths of the covariance, leaves little of the others. Noise has
// no covariance between neighbours, what is finer than the system has.
template <int Dim>
bool resolves(const Samples<Dim>& samples, const AxisCovariance<Dim>& covariance, std::vector<Index> some) {
  some.resize(std::min(some.size(), tried_thinned));
  InterpolateOptions options;
  options.kernel = covariance.kernel.name();
  options.parameter = covariance.kernel.parameter();
  options.support = 1;
  options.smoothing = std::max(covariance.nugget, least_nugget);
  options.degree = covariance.degree;
  options.require_degree = false;
  options.keep_weights = true;
  Samples<Dim> system = chosen_samples(samples, some);
  try {
    const Interpolation<Dim> coarse = interpolate(system, options);
    const std::vector<Index> pairs = even_pairs(morton_order<Dim>(samples.points), tried_pairs);
    const Points<Dim> places = samples.points(Eigen::all, pairs);
    for (Index c = 0; c < samples.components(); ++c) {
      const Eigen::VectorXd values = samples.values(pairs, c);
      const Eigen::VectorXd rest = values - coarse.components[static_cast<std::size_t>(c)]->evaluate(places).value;
      double all = 0, common = 0, noise = 0;
      for (Index k = 0; k + 1 < rest.size(); k += 2) {
        const double weight = std::sqrt(samples.weight(pairs[k]) * samples.weight(pairs[k + 1]));
        all += weight * (values.segment<2>(k).array() - values.mean()).square().sum();
        common += weight * 2 * rest[k] * rest[k + 1];
        noise += weight * std::pow(rest[k] - rest[k + 1], 2);
      }
      if (common > std::max(unresolved * unresolved * all, like_noise * like_noise * noise)) return false;
    }
    return true;
  } catch (const SolverFailure&) {
    return false;
  }
}

// As many of the samples as tell the error of one system when they are spread over all: neighbours alone, which are
// predicted better, make a singular system in many variables, and where the function hardly changes along some axes.
template <int Dim>
Samples<Dim> spread_over(const Samples<Dim>& samples) {
  constexpr Index enough = 800;  // chosen by hand
  if (samples.size() <= enough) return samples;
  return chosen_samples(samples, even_samples(morton_order<Dim>(samples.points), enough));
}

// What one sample far from all others says of itself is no measure of any other.
template <int Dim>
Samples<Dim> without_far_points(const Samples<Dim>& samples) {
  const std::vector<Index> far = far_points<Dim>(samples.points);
  if (far.empty()) return samples;
  std::vector<Index> near;
  for (Index i = 0; i < samples.size(); ++i)
    if (!std::binary_search(far.begin(), far.end(), i)) near.push_back(i);
  return chosen_samples(samples, near);
}

// Mean absolute errors of samples left out, by one system and by patches, for which coordinates are scaled.
struct TwoErrors {
  double of_one, of_patches;
};

// Of single samples, by all others.
template <int Dim>
TwoErrors errors_at_samples(const Samples<Dim>& samples, const Samples<Dim>& scaled,
                            const AxisCovariance<Dim>& covariance, const FitOptions& options) {
  double of_one = left_out_error(Dim > 3 ? spread_over(samples) : samples, covariance);
  if (!std::isfinite(of_one)) of_one = left_out_error(spread_over(samples), covariance);
  return {of_one, choose_local_options(scaled, partition_options(options)).error};
}

// Of those in gaps, by those around these.
template <int Dim>
TwoErrors errors_in_gaps(const Samples<Dim>& samples, const Samples<Dim>& scaled, const HeldOutRows& rows,
                         const AxisCovariance<Dim>& covariance, const FitOptions& options) {
  constexpr Index around = 200;  // samples of a system; chosen by hand
  const LocalOptions local = choose_local_options(scaled, partition_options(options)).options;
  const double of_patches = HeldOutError(HeldOutSamples<Dim>(normalize_weights(scaled), rows).errors(local)).mean;
  Samples<Dim> in_place = samples;
  in_place.points = in_lengths<Dim>(samples.points, covariance);
  const HeldOutSamples<Dim> parts(in_place, rows);
  const Covariance model = in_lengths(covariance, samples.components());
  const KdTree<Dim> tree(parts.others().points);
  const Index count = parts.held_out().size();
  Eigen::VectorXd errors(count);
  parallel_for(count, 4, [&](Index begin, Index end) {
    std::vector<Index> near(static_cast<std::size_t>(std::min(around, parts.others().size())));
    std::vector<double> r2(near.size());
    for (Index k = begin; k < end; ++k) {
      const Point<Dim> x = parts.held_out().points.col(k);
      tree.nearest(x, std::ssize(near), near.data(), r2.data());
      const Eigen::VectorXd value = KrigingPatch<Dim>(parts.others(), model, x, near).value(x);
      errors[k] = (parts.held_out().values.row(k).transpose() - value).cwiseAbs().mean();
    }
  });
  return {errors.mean(), of_patches};
}

// For one system of all samples, when the kernel is left to choose: of few samples, and of more, unless a partition of
// unity predicts samples left out much better, which `method` then becomes. Few without noise are not asked, and none
// that lie on lines: those left out are predicted along them, all others across. `lines`: whether they do. Where there
// are too many for one system, it is that of some of them, on lines or without noise. In many variables there are no
// patches to ask.
template <int Dim>
CovarianceEstimate<Dim> learn(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                              FitMethod& method, bool may_thin, bool& lines) {
  const bool is_free = options.kernel == "auto" && std::isnan(options.kernel_parameter) && !options.smoothing;
  if constexpr (Dim > largest_dimension) {
    if (!is_free || options.tolerance > 0) return {};
    return estimate_axis_covariance(without_zero_weights(samples), replicates, !options.scale_axes);
  } else {
    const bool is_cheap = method == FitMethod::interpolate && Dim <= 3 && samples.size() >= few_patches;
    bool compare = (is_cheap || method == FitMethod::partition_of_unity) && options.method == "auto" && !options.degree;
    const bool can_thin =
        may_thin && compare && method == FitMethod::partition_of_unity && thinned_size(samples.size()) > 0;
    lines = can_thin && is_free && on_lines<Dim>(samples.points);
    const bool thins = can_thin && !lines && samples.size() > one_system<Dim> && samples.size() <= most_in_stages<Dim>;
    compare = compare && !lines && (thins || samples.size() <= one_system<Dim>);
    const bool is_small = samples.size() <= InterpolateOptions{}.dense_limit;
    if (!is_free || !(lines || thins || (is_small && (compare || method == FitMethod::interpolate)))) return {};
    Samples<Dim> used = without_zero_weights(samples);
    auto covariance = estimate_axis_covariance(used, replicates, !options.scale_axes);
    if (thins && covariance.best && covariance.best->nugget > clean) return {};
    if (!covariance.best || !compare || (is_cheap && covariance.best->nugget == 0)) return covariance;
    used = without_far_points(used);
    Samples<Dim> scaled = used;
    scaled.points.array().colwise() /= choose_scales(used, options, FitMethod::partition_of_unity).array();
    const auto rows = held_out_in_gaps<Dim>(scaled.points);
    const TwoErrors errors = rows ? errors_in_gaps(used, scaled, *rows, *covariance.best, options)
                                  : errors_at_samples(used, scaled, *covariance.best, options);
    const double better = thins || Dim > 3 ? better_than_thinned : much_better;
    if (errors.of_one < better * errors.of_patches) return covariance;
    method = FitMethod::partition_of_unity;
    return {};
  }
}

}  // namespace

template <int Dim>
std::optional<Eigen::Matrix<double, Dim, Dim>> ModelChoice<Dim>::map() const {
  if (covariances.size() != 1 || !covariances.front().axes) return std::nullopt;
  return scales.cwiseInverse().asDiagonal() * covariances.front().axes->transpose();
}

template <int Dim>
ModelChoice<Dim> choose_model(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                              FitMethod method, bool may_thin) {
  ModelChoice<Dim> choice{.method = method, .scales = {}, .extrapolation = options.extrapolation};
  CovarianceEstimate<Dim> estimate = learn(samples, replicates, options, choice.method, may_thin, choice.lines);
  choice.covariances = std::move(estimate.likely);
  if (choice.covariances.empty() && estimate.best) choice.covariances.push_back(*estimate.best);
  if (samples.size() > few_systems && !choice.covariances.empty())
    choice.covariances.erase(choice.covariances.begin() + 1, choice.covariances.end());
  const bool thins = Dim <= largest_dimension && options.method == "auto" && samples.size() > one_system<Dim>;
  if (thins && !choice.covariances.empty()) {
    const AxisCovariance<Dim>& covariance = choice.covariances.front();
    std::vector<Index> counting;
    for (Index i = 0; i < samples.size(); ++i)
      if (samples.weight(i) > 0) counting.push_back(i);
    Samples<Dim> used = without_zero_weights(samples);
    used.points = in_lengths<Dim>(used.points, covariance);
    choice.thinned = farthest_points<Dim>(used.points, thinned_size(samples.size())).indices;
    if (!choice.lines || resolves(used, covariance, choice.thinned)) {
      for (Index& i : choice.thinned) i = counting[static_cast<std::size_t>(i)];
    } else {
      choice.thinned.clear();
      choice.covariances.clear();
    }
  }
  if (choice.covariances.empty()) {
    choice.scales = choose_scales(samples, options, choice.method);
    return choice;
  }
  const AxisCovariance<Dim>& likeliest = choice.covariances.front();
  choice.method = FitMethod::interpolate;
  choice.scales = likeliest.lengths / likeliest.lengths.minCoeff();
  if (choice.extrapolation == Extrapolation::automatic)
    choice.extrapolation = best_for_extremes(without_zero_weights(samples), likeliest);
  return choice;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                      \
  template struct ModelChoice<Dim>;                                                                                 \
  template ModelChoice<Dim> choose_model<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&, FitMethod, \
                                              bool);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
