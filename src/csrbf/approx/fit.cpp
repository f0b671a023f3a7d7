#include "csrbf/approx/fit.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/levels/error_bounded.hpp"
#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/least_squares.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/multilevel.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"
#include "csrbf/approx/moving/along_tracks.hpp"
#include "csrbf/approx/samples/deviation.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/samples/periodic_field.hpp"
#include "csrbf/approx/samples/sample_limits.hpp"
#include "csrbf/approx/unity/choose_local_options.hpp"
#include "csrbf/approx/unity/local_variance.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/core/shared_evaluate.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace csrbf {
namespace {

constexpr double different_units = 10;      // ratio of the extents of axes that are scaled to equal extent in any case
constexpr double maybe_different = 2;       // ... or if cross-validation is in favour of it
constexpr Index checked_samples = 100'000;  // for the error at the samples
constexpr double rounding = 1e-12;          // relative
constexpr const char* tolerance_missed = "the tolerance does not hold at every sample";

// Samples up to which one system for all of them is solved. In four and more dimensions a patch needs hundreds of
// samples, and smooth functions are met better by orders of magnitude if none of them is out of reach.
Index few(int dimension) {
  return dimension < 4 ? 500 : 1000;
}

template <int Dim>
void check(const FitOptions& options) {
  require(options.method == "auto" || find_fit_method(options.method) != nullptr, "fit", "method", options.method,
          "unknown; use one of " + joined(fit_methods()));
  require(options.centers >= 0, "fit", "centers", options.centers, "must be positive, or 0 to let the method decide");
  require(options.tolerance >= 0 && std::isfinite(options.tolerance), "fit", "tolerance", options.tolerance,
          "must be a positive error in the unit of the values, or 0 for none");
  require(!options.smoothing || (*options.smoothing >= 0 && std::isfinite(*options.smoothing)), "fit", "smoothing",
          options.smoothing.value_or(0), "must not be negative");
  require(!options.degree || (*options.degree >= -1 && *options.degree <= 8), "fit", "degree",
          options.degree.value_or(0), "must be -1 (none), 0, ... or 8");
  require(options.periods.empty() || options.periods.size() == Dim, "fit", "periods", options.periods.size(),
          "one per axis, 0 for axes that are not periodic, or none at all");
  for (const double period : options.periods)
    require(period >= 0 && std::isfinite(period), "fit", "periods", period, "must be positive, or 0 for none");
  if (options.kernel != "auto") (void)Kernel(options.kernel, Dim, options.kernel_parameter);
}

FitMethod choose_method(const FitOptions& options, Index samples, int dimension) {
  if (const FitMethodInfo* given = find_fit_method(options.method)) return given->method;
  if (options.tolerance > 0) return FitMethod::error_bounded;
  if (options.centers > 0) return FitMethod::fixed_budget;
  const bool needs_polynomials = options.kernel != "auto" && Kernel(options.kernel, dimension).order() > 0;
  return samples <= few(dimension) || needs_polynomials ? FitMethod::interpolate : FitMethod::partition_of_unity;
}

PartitionOfUnityOptions local_options(const FitOptions& options) {
  PartitionOfUnityOptions local;
  if (options.kernel != "auto") local.kernel = options.kernel;
  local.degree = options.degree;
  local.smoothing = options.smoothing;
  local.progress = options.progress;
  return local;
}

// Says which options the method leaves unused, and what came of the others.
void warn(const FitOptions& options, const FitMethodInfo& method, FitReport& report) {
  const auto unused = [&](bool is_given, const char* option, bool is_used) {
    if (is_given && !is_used)
      report.warnings.push_back(std::string(option) + ": not used by the method " + method.name);
  };
  unused(options.centers > 0 && options.method != "auto", "centers", method.centers);
  unused(options.tolerance > 0 && options.method != "auto", "tolerance", method.tolerance);
  unused(options.degree.has_value(), "degree", method.degree);
  unused(options.smoothing.value_or(0) > 0, "smoothing", method.smoothing);
  if (report.levels > 1 && options.centers > 0 && report.centers > options.centers)
    report.warnings.push_back("centers: the levels together have more, " + std::to_string(report.centers));
  if (report.samples == 1) report.warnings.push_back("all samples are at one point: the function is constant");
  if (report.warnings.empty() && options.tolerance > 0 && !(report.max_error <= (1 + rounding) * options.tolerance))
    report.warnings.emplace_back(tolerance_missed);
}

// One fit in scaled coordinates; fills the report.
template <int Dim>
class Fitter {
 public:
  using Fields = std::vector<std::shared_ptr<const Field<Dim>>>;

  Fields variances = {};  // after fit()

  Fitter(const Samples<Dim>& samples, const FitOptions& options, FitMethod method, FitReport& report)
      : samples_(samples), options_(options), method_(method), report_(report) {}

  Fields fit() {
    if (options_.method == "auto" && options_.tolerance > 0 && options_.centers == 0 && samples_.size() > few(Dim)) {
      Fields fields = thinned_partition();
      if (!fields.empty()) return fields;
    }
    switch (method_) {
      case FitMethod::interpolate:
        return interpolant();
      case FitMethod::least_squares:
        return level_sum(least_squares(samples_, level_options<LeastSquaresOptions>()));
      case FitMethod::partition_of_unity:
        return patches_or_tracks();
      case FitMethod::multilevel:
        return levels();
      case FitMethod::pca_multiresolution:
        return clusters();
      case FitMethod::fixed_budget:
        return level_sum(fixed_budget(samples_, level_options<FixedBudgetOptions>()));
      case FitMethod::error_bounded:
        return within_tolerance();
      case FitMethod::moving_least_squares:
      case FitMethod::along_tracks:
        return moving();
    }
    return {};
  }

  // The one used, after fit().
  [[nodiscard]] FitMethod method() const { return method_; }

 private:
  template <class Options>
  void set_kernel(Options& options) {
    if (options_.kernel != "auto") options.kernel = options_.kernel;
    if (options_.smoothing) options.lambda0 = *options_.smoothing;
    options.progress = options_.progress;
    report_.kernel = options.kernel;
  }

  template <class Options>
  Options level_options() {
    Options options;
    set_kernel(options);
    options.centers = options_.centers;
    return options;
  }

  Fields level_sum(const LevelFit<Dim>& fit) {
    report_.levels = static_cast<Index>(fit.levels.size());
    report_.centers = 0;
    for (const auto& level : fit.fields.front()->levels()) report_.centers += level->basis().size();
    for (const LevelReport& level : fit.levels) report_.support = std::max(report_.support, level.largest_support);
    report_.smoothing = fit.levels.front().lambda0;
    if (!fit.converged) report_.warnings.emplace_back(tolerance_missed);
    return fit.model();
  }

  Fields levels() {
    auto options = level_options<MultilevelOptions>();
    options.tolerance = options_.tolerance;
    if (options_.smoothing.value_or(0) > 0) options.solve = LevelSolve::ridge;
    return level_sum(multilevel(samples_, options));
  }

  Fields clusters() {
    PcaMultiresolutionOptions options;
    set_kernel(options);
    if (options_.tolerance > 0) options.tolerance = options_.tolerance;
    if (options_.centers > 0) options.cluster_size = std::max<Index>(1, samples_.size() / options_.centers);
    return level_sum(pca_multiresolution(samples_, options));
  }

  Fields within_tolerance() {
    auto options = level_options<ErrorBoundedOptions>();
    if (options_.tolerance > 0) options.tolerance = options_.tolerance;
    return level_sum(error_bounded(samples_, options));
  }

  // A partition of unity of a share of the samples that is within the tolerance at all of them; none if there is none.
  Fields thinned_partition() {
    if (options_.kernel != "auto" && Kernel(options_.kernel, Dim).order() > 0) return {};
    struct Attempt {
      Index stride;
      double mean_error;  // as a share of the tolerance, which is for the largest one
    };
    constexpr std::array<Attempt, 4> attempts = {{{64, 1e-2}, {8, 1e-2}, {1, 1e-2}, {1, 1e-5}}};
    const FitReport before = report_;
    const std::vector<Index> order = morton_order<Dim>(samples_.points);
    for (const auto& [stride, mean_error] : attempts) {
      if (samples_.size() / stride < few(Dim)) continue;
      const Samples<Dim> share = merge_duplicates(subset(order, 0, stride)).samples;
      PartitionOfUnityOptions local = local_options(options_);
      local.accuracy = mean_error * options_.tolerance;
      Fields fields = partition(share, local);
      const Index stride_of_test = std::max<Index>(1, samples_.size() / tested_first);
      if (holds(fields, subset(order, stride / 2, stride_of_test)) && holds(fields, samples_)) {
        method_ = FitMethod::partition_of_unity;
        report_.samples_fitted = share.size();
        return fields;
      }
    }
    report_ = before;
    variances.clear();
    return {};
  }

  // Every stride-th sample from `first` on, and those that span the box of all.
  Samples<Dim> subset(const std::vector<Index>& order, Index first, Index stride) const {
    std::vector<Index> chosen(2 * Dim);
    for (Index a = 0; a < Dim; ++a) {
      samples_.points.row(a).minCoeff(&chosen[static_cast<std::size_t>(2 * a)]);
      samples_.points.row(a).maxCoeff(&chosen[static_cast<std::size_t>(2 * a + 1)]);
    }
    for (Index i = std::min(first, samples_.size() - 1); i < samples_.size(); i += stride)
      chosen.push_back(order[static_cast<std::size_t>(i)]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    Samples<Dim> share{samples_.points(Eigen::all, chosen), samples_.values(chosen, Eigen::all), {}};
    if (samples_.weights.size() > 0) share.weights = samples_.weights(chosen);
    return share;
  }

  // Whether every sample is within the tolerance.
  bool holds(const Fields& fields, const Samples<Dim>& samples) const {
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const Eigen::VectorXd f = shared_evaluate(*fields[c], samples.points).value;
      if (!((f - samples.values.col(static_cast<Index>(c))).cwiseAbs().maxCoeff() <= options_.tolerance)) return false;
    }
    return true;
  }

  Fields partition(const Samples<Dim>& samples, const PartitionOfUnityOptions& options) {
    if (options_.kernel != "auto")
      require(Kernel(options_.kernel, Dim).order() == 0, "fit", "kernel", options_.kernel,
              "is only conditionally positive definite; a partition of unity needs another one, such as wendland-c4");
    const PartitionOfUnityFit<Dim> fit = partition_of_unity(samples, options);
    const LocalOptions& local = local_ = fit.report.local;
    report_.kernel = local.kernel;
    report_.degree = local.degree;
    report_.centers = fit.report.centers;
    report_.patches = fit.report.patches;
    report_.samples_per_patch = local.samples;
    report_.anisotropy = local.anisotropy;
    report_.smoothing = local.smoothing;
    report_.cross_validation_rmse = fit.report.cross_validation_rmse;
    variances = local_variance(samples, fit);
    return fit.fields();
  }

  bool tracks_may_matter() const {
    const bool rough = Kernel(report_.kernel, Dim).is_rough();
    const bool free = options_.method == "auto" && options_.kernel == "auto" && !options_.degree && !options_.smoothing;
    const bool exact = report_.cross_validation_rmse <= rounding * samples_.values.cwiseAbs().maxCoeff();
    return Dim > 1 && free && rough && !exact && samples_.size() >= fewest_for_tracks;
  }

  Fields patches_or_tracks() {
    const FitReport before = report_;
    Fields fields = partition(samples_, local_options(options_));
    const auto error = tracks_may_matter() ? better_along_tracks(samples_, local_) : std::nullopt;
    if (!error) return fields;
    report_ = before;
    method_ = FitMethod::along_tracks;
    report_.cross_validation_rmse = error->rmse;
    variances.clear();
    return moving();
  }

  Fields moving() {
    auto options = method_ == FitMethod::along_tracks ? along_tracks : MovingLeastSquaresOptions{};
    if (options_.kernel != "auto") options.kernel = options_.kernel;
    if (options_.degree) options.degree = *options_.degree;
    report_.kernel = options.kernel;
    report_.degree = options.degree;
    report_.centers = samples_.size();
    return moving_least_squares(samples_, options);
  }

  // Without noise the samples are met; whether there is any, leave-one-out tells.
  Fields interpolant() {
    InterpolateOptions options;
    options.kernel = options_.kernel;
    options.parameter = options_.kernel_parameter;
    options.smoothing = options_.smoothing.value_or(0);
    if (options_.degree) options.degree = *options_.degree;
    options.progress = options_.progress;
    Interpolation<Dim> best = interpolate(samples_, options);
    if (!options_.smoothing && samples_.size() > 2 * Dim) {
      options.smoothing.reset();
      Interpolation<Dim> smoothed = interpolate(samples_, options);
      const double deviation = weighted_deviation(samples_.values, samples_.all_weights());
      const bool is_noise = samples_.size() >= enough_to_tell && best.report.leave_one_out > explained * deviation;
      const double gain = is_noise ? 1 / smoother_gain : smoother_gain;
      if (smoothed.report.leave_one_out < gain * best.report.leave_one_out) best = std::move(smoothed);
    }
    report_.kernel = best.report.kernel;
    report_.degree = best.report.degree;
    report_.support = best.report.support;
    report_.smoothing = best.report.smoothing;
    report_.cross_validation_rmse = best.report.leave_one_out;
    report_.centers = best.components.front()->basis().size();
    variances = {best.variances.begin(), best.variances.end()};
    return {best.components.begin(), best.components.end()};
  }

  static constexpr Index tested_first = 10'000, fewest_for_tracks = 1000, enough_to_tell = 50;  // samples
  static constexpr double smoother_gain = 0.95;  // of the leave-one-out error, that makes smoothing worth it
  static constexpr double explained = 0.9;       // of the deviation of the values; above, samples need not be met

  const Samples<Dim>& samples_;
  const FitOptions& options_;
  FitMethod method_;
  FitReport& report_;
  LocalOptions local_ = {};  // of the last partition of unity
};

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
  if (!(largest > maybe_different * smallest)) return Point<Dim>::Ones();
  if (largest > different_units * smallest) return equal;
  if (method != FitMethod::partition_of_unity) return Point<Dim>::Ones();
  Samples<Dim> scaled = samples;
  scaled.points.array().colwise() /= equal.array();
  const PartitionOfUnityOptions local = local_options(options);
  return choose_local_options(scaled, local).error < choose_local_options(samples, local).error
             ? equal
             : Point<Dim>(Point<Dim>::Ones());
}

template <int Dim>
void measure_errors(const Samples<Dim>& samples, Fit<Dim>& fit) {
  const Index stride = std::max<Index>(1, samples.size() / checked_samples);
  const auto some = Eigen::seq(0, samples.size() - 1, stride);
  const Points<Dim> points = samples.points(Eigen::all, some);
  Eigen::VectorXd norms(static_cast<Index>(fit.components.size()));
  for (std::size_t c = 0; c < fit.components.size(); ++c) {
    Eigen::VectorXd error = shared_evaluate(*fit.components[c], points).value;
    error -= samples.values.col(static_cast<Index>(c))(some);
    norms[static_cast<Index>(c)] = error.stableNorm();
    fit.report.max_error = std::max(fit.report.max_error, error.cwiseAbs().maxCoeff());
  }
  fit.report.rmse = norms.stableNorm() / std::sqrt(static_cast<double>(points.cols() * norms.size()));
}

}  // namespace

template <int Dim>
Fit<Dim> fit(const Samples<Dim>& samples, const FitOptions& options) {
  require_within_limits(samples, "fit");
  check<Dim>(options);
  csrbf::report(options.progress, "choose", 0);
  auto start = std::chrono::steady_clock::now();
  Fit<Dim> result;
  FitReport& report = result.report;
  typename FittedField<Dim>::Frame frame;
  frame.box = bounding_box<Dim>(samples.points);
  frame.extrapolation = options.extrapolation;
  for (std::size_t a = 0; a < options.periods.size(); ++a) frame.periods[static_cast<Index>(a)] = options.periods[a];

  // error_bounded treats duplicates itself: the bound holds for each of them.
  const FitMethodInfo* given = find_fit_method(options.method);
  const bool keep_duplicates = given != nullptr ? given->keeps_duplicates : options.tolerance > 0;
  Samples<Dim> scaled =
      frame.periods.maxCoeff() > 0 ? repeat_periodically<Dim>(samples, frame.periods, frame.box.lo) : samples;
  MergedSamples<Dim> merged = keep_duplicates ? merge_duplicates(scaled) : merge_duplicates(std::move(scaled));
  const auto place = merged.place.begin();  // the samples come before their repetitions
  report.merged_duplicates = samples.size() - 1 - *std::max_element(place, place + samples.size());
  if (!keep_duplicates) scaled = std::move(merged.samples);
  report.samples = report.samples_fitted = samples.size() - (keep_duplicates ? 0 : report.merged_duplicates);
  const FitMethodInfo& method = info_of(choose_method(options, report.samples, Dim));
  require(std::isnan(options.kernel_parameter) || method.kernel_parameter, "fit", "kernel_parameter",
          options.kernel_parameter,
          std::string("is for the method interpolate; ") + method.name + " uses the default of the kernel");
  frame.scales = choose_scales(scaled, options, method.method);
  if ((frame.scales.array() != 1).any()) scaled.points.array().colwise() /= frame.scales.array();
  report.axis_scales.assign(frame.scales.data(), frame.scales.data() + Dim);
  report.choose_seconds = seconds_since(start);
  start = std::chrono::steady_clock::now();
  Fitter<Dim> fitter(scaled, options, method.method, report);
  for (auto& field : fitter.fit())
    result.components.push_back(std::make_shared<FittedField<Dim>>(std::move(field), frame));
  frame.extrapolation = Extrapolation::nan;  // what the function is there is a convention, with no error to tell
  for (auto& field : fitter.variances)
    result.variances.push_back(std::make_shared<FittedField<Dim>>(std::move(field), frame));
  report.fit_seconds = seconds_since(start);
  measure_errors(samples, result);
  report.method = info_of(fitter.method()).name;
  warn(options, info_of(fitter.method()), report);
  return result;
}

#define CSRBF_INSTANTIATE(Dim) template Fit<Dim> fit<Dim>(const Samples<Dim>&, const FitOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
