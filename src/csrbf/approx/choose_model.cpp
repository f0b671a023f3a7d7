#include "csrbf/approx/choose_model.hpp"

#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/kriging/left_out_extremes.hpp"
#include "csrbf/approx/unity/choose_local_options.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double different_units = 10;  // ratio of the extents of axes that are scaled to equal extent in any case
constexpr double maybe_different = 2;   // ... or if cross-validation is in favour of it
constexpr double much_better = 2;       // errors of one system over those of patches, which have no covariance
constexpr Index one_system = 2500;      // samples that one system is tried for; chosen by hand
constexpr Index few_patches = 50;       // samples that patches are tried for beside one system; chosen by hand

// What the coordinates are divided by.
template <int Dim>
Point<Dim> choose_scales(const Samples<Dim>& samples, const FitOptions& options, FitMethod method) {
  if (!options.scale_axes) return Point<Dim>::Ones();
  const Point<Dim> extent = bounding_box<Dim>(samples.points).extent();
  Point<Dim> equal = Point<Dim>::Ones();
  double largest = 0, smallest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < Dim; ++a) {
    if (!(extent[a] > 0)) continue;
    equal[a] = extent[a];
    largest = std::max(largest, extent[a]);
    smallest = std::min(smallest, extent[a]);
  }
  if (largest > different_units * smallest) return equal;
  if (method != FitMethod::partition_of_unity || !(largest > maybe_different * smallest)) return Point<Dim>::Ones();
  Samples<Dim> scaled = samples;
  scaled.points.array().colwise() /= equal.array();
  const PartitionOfUnityOptions local = partition_options(options);
  return choose_local_options(scaled, local).error < choose_local_options(samples, local).error
             ? equal
             : Point<Dim>(Point<Dim>::Ones());
}

// For one system of all samples, when the kernel is left to choose: of few samples, and of more, unless a partition of
// unity predicts samples left out much better, which `method` then becomes. Few without noise are not asked.
template <int Dim>
CovarianceEstimate<Dim> learn(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                              FitMethod& method) {
  const bool is_free = options.kernel == "auto" && std::isnan(options.kernel_parameter) && !options.smoothing;
  const bool is_cheap = method == FitMethod::interpolate && Dim <= 3 && samples.size() >= few_patches;
  const bool compare = (is_cheap || method == FitMethod::partition_of_unity) && options.method == "auto" &&
                       !options.degree && samples.size() <= one_system;
  if (!is_free || !(compare || method == FitMethod::interpolate) || samples.size() > InterpolateOptions{}.dense_limit)
    return {};
  Samples<Dim> used = without_zero_weights(samples);
  auto covariance = estimate_axis_covariance(used, replicates, !options.scale_axes);
  if (!covariance.best || !compare || (is_cheap && covariance.best->nugget == 0)) return covariance;
  const double of_one = left_out_error(used, *covariance.best);
  used.points.array().colwise() /= choose_scales(used, options, FitMethod::partition_of_unity).array();
  if (of_one < much_better * choose_local_options(used, partition_options(options)).error) return covariance;
  method = FitMethod::partition_of_unity;
  return {};
}

}  // namespace

template <int Dim>
std::optional<Eigen::Matrix<double, Dim, Dim>> ModelChoice<Dim>::map() const {
  if (covariances.size() != 1 || !covariances.front().axes) return std::nullopt;
  return scales.cwiseInverse().asDiagonal() * covariances.front().axes->transpose();
}

template <int Dim>
ModelChoice<Dim> choose_model(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                              FitMethod method) {
  ModelChoice<Dim> choice{.method = method, .scales = {}, .extrapolation = options.extrapolation};
  CovarianceEstimate<Dim> estimate = learn(samples, replicates, options, choice.method);
  choice.covariances = std::move(estimate.likely);
  if (choice.covariances.empty() && estimate.best) choice.covariances.push_back(*estimate.best);
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

#define CSRBF_INSTANTIATE(Dim)      \
  template struct ModelChoice<Dim>; \
  template ModelChoice<Dim> choose_model<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&, FitMethod);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
