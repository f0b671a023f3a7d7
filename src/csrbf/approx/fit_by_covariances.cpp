#include "csrbf/approx/fit_by_covariances.hpp"

#include "csrbf/approx/kriging/center_fit.hpp"
#include "csrbf/approx/left_out/left_out_folds.hpp"
#include "csrbf/approx/left_out/left_out_gaps.hpp"
#include "csrbf/approx/left_out/left_out_planes.hpp"
#include "csrbf/approx/samples/average_field.hpp"
#include "csrbf/approx/samples/blended_field.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double nearly_exact = 1e-6;      // nugget
constexpr Index samples_of_system = 2000;  // that is right in gaps
constexpr Index few_to_leave_out = 80;     // samples; more tell their covariance

// Share of the squares of values that neighbours, along a curve through the points, do not have in common: 1 for noise
// (von Neumann 1941). The least of all columns.
template <int Dim>
double share_of_noise(const Samples<Dim>& samples) {
  const std::vector<Index> order = morton_order<Dim>(samples.points);
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(samples.components()), differences = squares;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Index i = order[k - 1], j = order[k];
    const double weight = std::sqrt(samples.weight(i) * samples.weight(j));
    const Eigen::ArrayXd one = samples.values.row(i), other = samples.values.row(j);
    squares += weight * (one.square() + other.square());
    differences += weight * (one - other).square();
  }
  return (squares > 0).select(differences / squares, 1).minCoeff();
}

template <int Dim>
using Fields = std::vector<std::shared_ptr<const Field<Dim>>>;

// Averages of averages are not made: a sum of variances, or what a single covariance says, stays one.
template <int Dim>
Fields<Dim> times(const Fields<Dim>& variances, const Eigen::VectorXd& factors) {
  Fields<Dim> result;
  for (std::size_t c = 0; c < variances.size(); ++c) {
    Fields<Dim> parts = {variances[c]};
    std::vector<double> weights = {1};
    if (const auto* average = dynamic_cast<const AverageField<Dim>*>(variances[c].get())) {
      parts = average->variances().empty() ? average->fields() : average->variances();
      weights = average->weights();
    }
    for (double& weight : weights) weight *= factors[static_cast<Index>(c)];
    result.push_back(std::make_shared<const AverageField<Dim>>(std::move(parts), std::move(weights)));
  }
  return result;
}

template <int Dim>
void set_in_gaps(Fields<Dim>& fields, const Fields<Dim>& others, const std::shared_ptr<const Field<Dim>>& outside) {
  for (std::size_t c = 0; c < std::min(fields.size(), others.size()); ++c)
    fields[c] = std::make_shared<const BlendedField<Dim>>(fields[c], others[c], outside);
}

template <int Dim>
MethodFields<Dim> thinned_system(const Samples<Dim>& samples, const FitOptions& options,
                                 const AxisCovariance<Dim>& covariance, Index size) {
  const std::vector<Index> thinned = farthest_points<Dim>(in_lengths<Dim>(samples.points, covariance), size).indices;
  FitReport report;
  return fit_by_covariances<Dim>(chosen_samples(samples, thinned), {}, options, {covariance}, report);
}

template <int Dim>
FittedParts<Dim> parts_of(MethodFields<Dim> fields) {
  return {std::move(fields.components), std::move(fields.variances)};
}

// What left-out samples say of gaps.
struct GapTrial {
  bool by_system = false;  // whether the system is right there, or patches
  Eigen::VectorXd growth;  // of the variances of the system
};

// One system fails where smoothness varies, and patches almost everywhere else: their errors must be clearly less, as
// the system gains more by the samples that the trial does without. Only smooth functions gain so; none for others, nor
// for gaps that cannot be tried.
template <int Dim>
std::optional<GapTrial> try_in_gaps(const Samples<Dim>& samples, const FitOptions& options,
                                    const AxisCovariance<Dim>& covariance, const Field<Dim>& outside_gaps) {
  constexpr Index most_tried = 1000;  // samples of the system; both chosen by hand
  constexpr double clearly_better = 2;
  constexpr int smooth = 6;    // derivatives
  constexpr double doubt = 2;  // of variances: few places tell them
  if (covariance.kernel.smoothness() < smooth) return std::nullopt;
  const auto by_patches = [&](const Samples<Dim>& some) {
    FitReport report;
    return parts_of(fit_by_method<Dim>(some, options, FitMethod::partition_of_unity, nullptr, report));
  };
  const auto by_system = [&](const Samples<Dim>& some) {
    return parts_of(thinned_system(some, options, covariance, most_tried));
  };
  const std::vector<LeftOutErrors> tried = left_out_gaps<Dim>(samples, outside_gaps, {by_patches, by_system});
  if (tried.empty()) return std::nullopt;
  constexpr double least = 1e-300;
  const Index C = samples.components();
  GapTrial trial{false, Eigen::VectorXd::Ones(C)};
  double ratio = 0;  // mean logarithm
  for (Index c = 0; c < C; ++c) {
    const double of_patches = std::sqrt(tried[0].mean_square(c)), of_system = std::sqrt(tried[1].mean_square(c));
    ratio += std::log(std::max(of_system, least) / std::max(of_patches, least)) / static_cast<double>(C);
    trial.growth[c] = std::max(1.0, doubt * tried[1].growth(c));
  }
  trial.by_system = ratio < std::log(clearly_better);
  return trial;
}

// Of noise all samples tell more than those of a system of some.
template <int Dim>
std::optional<MethodFields<Dim>> at_centers(const Samples<Dim>& samples, const FitOptions& options,
                                            const LearnedCovariance& learned, FitReport& report) {
  const AxisCovariance<Dim> covariance{learned.kernel, Point<Dim>::Constant(learned.support), learned.nugget,
                                       learned.degree};
  auto fit = fit_at_centers(without_zero_weights(samples), covariance, {.progress = options.progress});
  if (!fit) return std::nullopt;
  report.centers = fit->centers;
  report.smoothing = fit->covariance.nugget;
  report.samples_fitted = report.samples;
  report.cross_validation_rmse = fit->error;
  return MethodFields<Dim>{std::move(fit->components), std::move(fit->variances), FitMethod::interpolate,
                           std::move(fit->noise), nullptr};
}

}  // namespace

template <int Dim>
LearnedCovariance learned_covariance(const Samples<Dim>& samples, const Replicates& replicates,
                                     const AxisCovariance<Dim>& covariance) {
  return {covariance.kernel,
          covariance.lengths.minCoeff(),
          covariance.nugget,
          covariance.degree,
          variance_by_planes(without_zero_weights(samples), covariance),
          replicates,
          Eigen::VectorXd::Ones(samples.components())};
}

template <int Dim>
MethodFields<Dim> fit_by_covariances(const Samples<Dim>& samples, const Replicates& replicates,
                                     const FitOptions& options, const std::vector<AxisCovariance<Dim>>& likely,
                                     FitReport& report, const Eigen::VectorXd& growth) {
  const auto C = static_cast<std::size_t>(samples.components());
  std::vector<Fields<Dim>> components(C), variances(C);
  std::vector<double> weights, noise(C, 0.0);
  const FitReport before = report;
  MethodFields<Dim> result;
  for (const AxisCovariance<Dim>& covariance : likely) {
    typename MappedField<Dim>::Map map =
        (covariance.lengths.minCoeff() / covariance.lengths.array()).matrix().asDiagonal();
    if (covariance.axes) map *= covariance.axes->transpose();
    Samples<Dim> mapped = samples;
    mapped.points = map * samples.points;
    LearnedCovariance learned = learned_covariance(samples, replicates, covariance);
    if (growth.size() > 0) learned.growth = growth;
    FitReport one = before;
    MethodFields<Dim> fields;
    try {
      fields = fit_by_method(mapped, options, FitMethod::interpolate, &learned, one);
    } catch (const SolverFailure&) {
      if (weights.empty() && &covariance == &likely.back()) throw;
      continue;
    }
    for (std::size_t c = 0; c < C; ++c) {
      components[c].push_back(std::make_shared<const MappedField<Dim>>(fields.components[c], map));
      if (c < fields.variances.size())
        variances[c].push_back(std::make_shared<const MappedField<Dim>>(fields.variances[c], map));
      if (c < fields.noise.size()) noise[c] += covariance.weight * fields.noise[c] * fields.noise[c];
    }
    weights.push_back(covariance.weight);
    if (weights.size() == 1) report = std::move(one);
    result.method = fields.method;
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  for (std::size_t c = 0; c < C; ++c) {
    result.components.push_back(std::make_shared<const AverageField<Dim>>(components[c], weights));
    if (variances[c].size() == components[c].size()) {
      result.variances.push_back(std::make_shared<const AverageField<Dim>>(components[c], weights, variances[c]));
      result.noise.push_back(std::sqrt(noise[c] / sum));
    }
  }
  return result;
}

template <int Dim>
MethodFields<Dim> fit_few_by_covariances(const Samples<Dim>& samples, const Replicates& replicates,
                                         const FitOptions& options, const std::vector<AxisCovariance<Dim>>& likely,
                                         FitReport& report) {
  const Samples<Dim> used = without_zero_weights(samples);
  const bool is_exact = likely.front().nugget < nearly_exact && options.periods.empty();
  if (used.size() > few_to_leave_out || !is_exact)
    return fit_by_covariances(samples, replicates, options, likely, report);
  FitOptions quiet = options;
  quiet.progress = {};
  const auto by_others = [&](const Samples<Dim>& others) {
    CovarianceEstimate<Dim> estimate = estimate_axis_covariance(others, {}, !options.scale_axes);
    if (estimate.likely.empty() && estimate.best) estimate.likely.push_back(*estimate.best);
    if (estimate.likely.empty()) return FittedParts<Dim>{};
    FitReport ignored;
    return parts_of(fit_by_covariances(others, {}, quiet, estimate.likely, ignored));
  };
  return fit_by_covariances(samples, replicates, options, likely, report, left_out_folds<Dim>(used, by_others));
}

template <int Dim>
void set_variances_of_few(const Samples<Dim>& samples, const Replicates& replicates, const FitOptions& options,
                          MethodFields<Dim>& fields) {
  const Samples<Dim> used = without_zero_weights(samples);
  const bool is_free = options.kernel == "auto" && std::isnan(options.kernel_parameter) && !options.smoothing &&
                       !options.degree && options.tolerance == 0;
  if (!is_free || used.size() > Dim + 3 || fields.variances.empty()) return;
  CovarianceEstimate<Dim> estimate = estimate_axis_covariance(used, replicates, true, 0);
  if (estimate.likely.empty() && estimate.best) estimate.likely.push_back(*estimate.best);
  if (estimate.likely.empty()) return;
  FitOptions quiet = options;
  quiet.progress = {};
  FitReport ignored;
  const MethodFields<Dim> likely = fit_by_covariances(samples, replicates, quiet, estimate.likely, ignored);
  fields.variances = errors_of<Dim>(fields.components, likely.components, likely.variances);
}

template <int Dim>
MethodFields<Dim> fit_coarse_to_fine(const Samples<Dim>& samples, const std::vector<Index>& thinned, bool lines,
                                     const FitOptions& options, const LearnedCovariance& learned, FitReport& report) {
  using Part = std::shared_ptr<const Field<Dim>>;
  // Chosen by hand.
  constexpr double clearly_better = 0.95;  // error of predictions over what is predicted
  constexpr double noticeable = 1e-6;      // of the range of the values
  const Index C = samples.components();
  Samples<Dim> some = chosen_samples(samples, thinned);
  MethodFields<Dim> coarse = fit_by_method(some, options, FitMethod::interpolate, &learned, report);
  const auto with_gaps = [&](MethodFields<Dim> fields) {
    if (Dim == 1 || Dim > 3 || lines) return fields;
    FitReport of_patches = report;
    const auto patches = fit_by_method<Dim>(samples, options, FitMethod::partition_of_unity, nullptr, of_patches);
    if (!patches.outside_gaps) return fields;
    const AxisCovariance<Dim> covariance{learned.kernel, Point<Dim>::Constant(learned.support), learned.nugget,
                                         learned.degree};
    const auto trial = try_in_gaps(without_zero_weights(samples), options, covariance, *patches.outside_gaps);
    if (trial && !trial->by_system) set_in_gaps(fields.components, patches.components, patches.outside_gaps);
    const auto variances = trial && trial->by_system ? times(fields.variances, trial->growth) : patches.variances;
    set_in_gaps(fields.variances, variances, patches.outside_gaps);
    return fields;
  };
  Samples<Dim> rest = samples;
  for (Index c = 0; c < C; ++c)
    rest.values.col(c) -= coarse.components[static_cast<std::size_t>(c)]->evaluate(samples.points).value;
  Eigen::VectorXd weights = samples.all_weights();
  weights(thinned).setZero();
  if (!(weights.sum() > 0)) return with_gaps(coarse);  // all that count are in the system
  const double left = std::sqrt(weights.dot(rest.values.cwiseAbs2().rowwise().mean()) / weights.sum());
  const Index given = report.samples_fitted;
  report.samples_fitted = std::min(given, std::ssize(thinned));
  report.cross_validation_rmse = left;
  const double range = (some.values.colwise().maxCoeff() - some.values.colwise().minCoeff()).maxCoeff();
  if (left <= noticeable * range) return with_gaps(coarse);
  if (share_of_noise(rest) > clearly_better * clearly_better) {
    if (lines)
      if (auto all = at_centers(samples, options, learned, report)) return *all;
    return with_gaps(coarse);
  }
  FitReport fine_report = report;
  const MethodFields<Dim> fine = fit_by_method<Dim>(rest, options, FitMethod::partition_of_unity, nullptr, fine_report);
  if (!(fine_report.cross_validation_rmse < clearly_better * left)) return with_gaps(coarse);
  report.samples_fitted = given;
  report.cross_validation_rmse = fine_report.cross_validation_rmse;
  report.centers += fine_report.centers;
  report.partition = fine_report.partition;
  report.levels = 2;
  const auto add = [](std::vector<Part>& sums, const std::vector<Part>& others) {
    for (std::size_t c = 0; c < sums.size() && c < others.size(); ++c)
      sums[c] =
          std::make_shared<const AverageField<Dim>>(std::vector<Part>{sums[c], others[c]}, std::vector<double>{1, 1});
  };
  add(coarse.components, fine.components);
  add(coarse.variances, fine.variances);
  return with_gaps(coarse);
}

template <int Dim>
void fill_gaps_by_covariance(const Samples<Dim>& samples, const FitOptions& options, MethodFields<Dim>& fields) {
  const Samples<Dim> used = without_zero_weights(samples);
  const auto estimate = estimate_axis_covariance(used, {}, !options.scale_axes);
  if (!estimate.best || estimate.best->nugget > nearly_exact) return;
  const auto trial = try_in_gaps(used, options, *estimate.best, *fields.outside_gaps);
  if (!trial || !trial->by_system) return;
  try {
    const auto system = thinned_system(used, options, *estimate.best, samples_of_system);
    set_in_gaps(fields.components, system.components, fields.outside_gaps);
    set_in_gaps(fields.variances, times(system.variances, trial->growth), fields.outside_gaps);
  } catch (const SolverFailure&) {  // patches stay
  }
}

#define CSRBF_INSTANTIATE(Dim)                                                                                      \
  template LearnedCovariance learned_covariance<Dim>(const Samples<Dim>&, const Replicates&,                        \
                                                     const AxisCovariance<Dim>&);                                   \
  template MethodFields<Dim> fit_by_covariances<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&,     \
                                                     const std::vector<AxisCovariance<Dim>>&, FitReport&,           \
                                                     const Eigen::VectorXd&);                                       \
  template MethodFields<Dim> fit_few_by_covariances<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&, \
                                                         const std::vector<AxisCovariance<Dim>>&, FitReport&);      \
  template void set_variances_of_few<Dim>(const Samples<Dim>&, const Replicates&, const FitOptions&,                \
                                          MethodFields<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)                                                                             \
  template void fill_gaps_by_covariance<Dim>(const Samples<Dim>&, const FitOptions&, MethodFields<Dim>&);  \
  template MethodFields<Dim> fit_coarse_to_fine<Dim>(const Samples<Dim>&, const std::vector<Index>&, bool, \
                                                     const FitOptions&, const LearnedCovariance&, FitReport&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
