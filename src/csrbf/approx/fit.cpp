#include "csrbf/approx/fit.hpp"

#include "csrbf/approx/choose_model.hpp"
#include "csrbf/approx/fit_by_covariances.hpp"
#include "csrbf/approx/fit_by_method.hpp"
#include "csrbf/approx/fit_on_sphere.hpp"
#include "csrbf/approx/fit_values.hpp"
#include "csrbf/approx/fit_with_drift.hpp"
#include "csrbf/approx/fit_with_faults.hpp"
#include "csrbf/approx/hermite/fit_with_derivatives.hpp"
#include "csrbf/approx/levels/fit_in_levels.hpp"
#include "csrbf/approx/measure_errors.hpp"
#include "csrbf/approx/outside/extrapolate.hpp"
#include "csrbf/approx/outside/variance_growth.hpp"
#include "csrbf/approx/replicate_noise.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/many_variables.hpp"
#include "csrbf/approx/samples/mapped_field.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/samples/missing_marks.hpp"
#include "csrbf/approx/samples/periodic_field.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/approx/selection/select_samples.hpp"
#include "csrbf/approx/transform/fit_transformed.hpp"
#include "csrbf/approx/transform/usual_units.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace csrbf {
namespace {

constexpr double rounding = 1e-12;  // relative

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

void warn_of_values(const Eigen::MatrixXd& values, const FitOptions& options, FitReport& report) {
  for (Index c = 0; c < values.cols(); ++c)
    if (const std::optional<double> value = value_beyond_all_others(values.col(c), options.missing))
      report.warnings.push_back((std::ostringstream() << *value).str() +
                                " is far from all other values; if it means that there is none, " +
                                "give it as missing");
}

// Says what may be wrong with the samples.
template <int Dim>
void warn_of_errors(const Samples<Dim>& samples, const FitOptions& options, FitReport& report) {
  if (!report.gross_errors.empty() && options.loss == "auto")
    report.warnings.push_back(warning_of_gross_errors(report.gross_errors, samples.size()));
  if (!report.suspects.empty() && options.loss == "auto")
    report.warnings.push_back(warning_of_suspects(report.suspects, samples.size()));
  const bool are_places = options.sphere.empty() && options.drift.empty() && options.periods.empty();
  if (const std::vector<Index> far = far_points<Dim>(samples.points); are_places && !far.empty())
    report.warnings.push_back(warning_of_far_points(far, samples.size()));
  warn_of_values(samples.values, options, report);
}

// fit() but for the warnings that name samples, as parts of another fit have numbers of their own.
template <int Dim>
Fit<Dim> fit_anywhere(const Samples<Dim>& samples, const FitOptions& options);

// The same of points whose dimension is known at run time only.
AnyFit fit_any(const Eigen::MatrixXd& points, const Eigen::MatrixXd& values, const Eigen::VectorXd& weights,
               const FitOptions& options) {
  switch (fitted_dimension(points.rows())) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return any_fit(fit_anywhere<Dim>(Samples<Dim>{with_zeros<Dim>(points), values, weights}, options));
    CSRBF_FOR_MANY_DIMS(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      throw InvalidInput("fit: dimension: unsupported");
  }
}

// Fields of their own coordinates or values in the frame that all fits have, and the errors at the samples.
template <int Dim>
Fit<Dim> framed(Fit<Dim> result, const Samples<Dim>& samples, const FitOptions& options) {
  const typename FittedField<Dim>::Frame frame{.box = box_of_samples(samples, options),
                                               .extrapolation = Extrapolation::trend};
  for (auto* fields : {&result.components, &result.variances, &result.function_variances})
    for (auto& field : *fields) field = std::make_shared<FittedField<Dim>>(std::move(field), frame);
  measure_errors(fitted_samples(samples, options, result.report), result);
  return result;
}

// What sees the samples in other coordinates, and fits them there.
template <int Dim>
Fit<Dim> fit_elsewhere(const Samples<Dim>& samples, const FitOptions& options) {
  [[maybe_unused]] const auto fit_there = []<int D>(const Samples<D>& there, const FitOptions& given) {
    return fit_anywhere<D>(there, given);
  };
  Fit<Dim> result;
  if (!options.drift.empty())
    result = fit_with_drift<Dim>(samples, options, fit_any);
  else if constexpr (Dim <= largest_dimension)
    result = fit_on_sphere<Dim>(samples, options, FitSamples<Dim>(fit_there),
                                FitSamples<SphereField<Dim>::space_dim>(fit_there));
  result = framed(std::move(result), samples, options);
  FitReport& report = result.report;
  if (options.tolerance > 0 && !(report.max_error <= (1 + rounding) * options.tolerance) &&
      std::find(report.warnings.begin(), report.warnings.end(), tolerance_missed) == report.warnings.end())
    report.warnings.emplace_back(tolerance_missed);
  return result;
}

// Fits that have ways of their own.
template <int Dim>
std::optional<Fit<Dim>> fit_otherwise(const Samples<Dim>& samples, const FitOptions& options) {
  const auto measured = [&](Fit<Dim> result) {
    measure_errors(fitted_samples(samples, options, result.report), result);
    return result;
  };
  if constexpr (Dim <= largest_dimension)
    if (options.gradients.size() > 0) return measured(fit_with_derivatives<Dim>(samples, options));
  if (!options.drift.empty()) return fit_elsewhere(samples, options);
  if (!options.faults.empty()) {
    if constexpr (Dim == 2)
      return measured(fit_with_faults(samples, options));
    else
      require(false, "fit", "faults", "given",
              "they are for two coordinates, besides those of a drift; there are " + std::to_string(Dim));
  }
  if (!options.sphere.empty()) return fit_elsewhere(samples, options);
  return std::nullopt;
}

template <int Dim>
Fit<Dim> fit_in_usual_units(const Samples<Dim>& samples, const FitOptions& options, bool may_thin);

// A fit without stages, if it predicts samples left out better: where the smoothness varies, what one system of some
// knows of it may be wrong for all patches. Not in many variables, where patches are predicted from afar.
template <int Dim>
std::optional<Fit<Dim>> better_without_stages(const Samples<Dim>& samples, const FitOptions& options,
                                              const FitReport& stages) {
  constexpr double noticeable = 1e-6;  // of the range of the values; chosen by hand
  const double range = (samples.values.colwise().maxCoeff() - samples.values.colwise().minCoeff()).maxCoeff();
  if (Dim > 3 || stages.cross_validation_rmse <= noticeable * range) return std::nullopt;
  Fit<Dim> other = fit_in_usual_units(samples, options, false);
  if (other.report.cross_validation_rmse < stages.cross_validation_rmse) return other;
  return std::nullopt;
}

// One fit of all samples and values by one method, in steps that each leave what the next ones need.
template <int Dim>
class DirectFit {
 public:
  DirectFit(const Samples<Dim>& given, const FitOptions& options, bool may_thin)
      : given_(given), options_(options), may_thin_(may_thin), selected_(select_samples(given, options)) {}

  Fit<Dim> fit() {
    csrbf::report(options_.progress, "choose", 0);
    auto start = std::chrono::steady_clock::now();
    report().missing = selected_.missing;
    report().gross_errors = selected_.gross_errors;
    report().suspects = selected_.suspects;
    merge();
    choose();
    report().choose_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    MethodFields<Dim> fields = fit_by_choice();
    if (choice_.covariances.empty() && merged_.replicates.count == 0 && fields.method == FitMethod::interpolate)
      set_variances_of_few(scaled_, merged_.replicates, options_, fields);
    if (!choice_.thinned.empty() && !choice_.lines)
      if (auto other = better_without_stages(given_, options_, report())) return std::move(*other);
    if (choice_.covariances.empty() && !keep_duplicates_)
      add_replicate_noise<Dim>(samples(), merged_.place, merged_.replicates, scaled_.points, fields);
    frame_components(fields);
    frame_variances(fields);
    report().fit_seconds = seconds_since(start);
    measure_errors(samples(), result_);
    report().method = info_of(fields.method).name;
    report().noise = std::move(fields.noise);
    warn(options_, info_of(fields.method), report());
    return std::move(result_);
  }

 private:
  [[nodiscard]] const Samples<Dim>& samples() const { return selected_.samples ? *selected_.samples : given_; }
  FitReport& report() { return result_.report; }

  // Samples repeated along periodic axes, one at each point; weights have the mean 1.
  void merge() {
    frame_.box = bounding_box<Dim>(samples().points);
    frame_.extrapolation = options_.extrapolation;
    for (std::size_t a = 0; a < options_.periods.size(); ++a)
      frame_.periods[static_cast<Index>(a)] = options_.periods[a];
    // error_bounded treats duplicates itself: the bound holds for each of them.
    const FitMethodInfo* given = find_fit_method(options_.method);
    keep_duplicates_ = given != nullptr ? given->keeps_duplicates : options_.tolerance > 0;
    scaled_ =
        frame_.periods.maxCoeff() > 0 ? repeat_periodically<Dim>(samples(), frame_.periods, frame_.box.lo) : samples();
    if (scaled_.weights.size() > 0)
      scaled_.weights *= static_cast<double>((scaled_.weights.array() > 0).count()) / scaled_.weights.sum();
    merged_ = keep_duplicates_ ? merge_duplicates(scaled_) : merge_duplicates(std::move(scaled_));
    const auto place = merged_.place.begin();  // the samples come before their repetitions
    report().merged_duplicates = samples().size() - 1 - *std::max_element(place, place + samples().size());
    if (!keep_duplicates_) scaled_ = std::move(merged_.samples);
    report().samples = report().samples_fitted = samples().size() - (keep_duplicates_ ? 0 : report().merged_duplicates);
  }

  // The model, and the samples in its coordinates.
  void choose() {
    const FitMethod chosen = choose_method(options_, report().samples, Dim);
    require(std::isnan(options_.kernel_parameter) || info_of(chosen).kernel_parameter, "fit", "kernel_parameter",
            options_.kernel_parameter,
            std::string("is for the method interpolate; ") + info_of(chosen).name + " uses the default of the kernel");
    choice_ = choose_model(scaled_, merged_.replicates, options_, chosen, may_thin_);
    const std::vector<AxisCovariance<Dim>>& covariances = choice_.covariances;
    map_ = choice_.map();  // instead of the scales
    frame_.extrapolation = choice_.extrapolation;
    if (frame_.extrapolation == Extrapolation::automatic) frame_.rim = FittedField<Dim>::rim_of(samples().points);
    report().axis_scales.assign(choice_.scales.data(), choice_.scales.data() + Dim);
    if (!covariances.empty() && covariances.front().axes)
      for (const auto& axis : covariances.front().axes->colwise()) report().axes.emplace_back(axis.begin(), axis.end());
    if (covariances.size() == 1) learned_ = learned_covariance(scaled_, merged_.replicates, covariances.front());
    if (map_) scaled_.points = *map_ * scaled_.points;
    if (!map_ && covariances.size() < 2) frame_.scales = choice_.scales;  // several have scales of their own
    scaled_.points.array().colwise() /= frame_.scales.array();
  }

  MethodFields<Dim> fit_by_choice() {
    if (choice_.covariances.size() > 1)
      return fit_few_by_covariances(scaled_, merged_.replicates, options_, choice_.covariances, report());
    if constexpr (Dim <= largest_dimension)
      if (!choice_.thinned.empty())
        return fit_coarse_to_fine(scaled_, choice_.thinned, choice_.lines, options_, *learned_, report());
    MethodFields<Dim> fields =
        fit_by_method(scaled_, options_, choice_.method, learned_ ? &*learned_ : nullptr, report());
    if constexpr (Dim > 1 && Dim <= 3)
      if (fields.outside_gaps && options_.kernel == "auto" && !options_.smoothing && !options_.degree)
        fill_gaps_by_covariance(scaled_, options_, fields);
    return fields;
  }

  // A field of the coordinates that scales alone make.
  std::shared_ptr<const Field<Dim>> unmapped(std::shared_ptr<const Field<Dim>>& field) const {
    if (map_) return std::make_shared<MappedField<Dim>>(std::move(field), *map_);
    return std::move(field);
  }

  void frame_components(MethodFields<Dim>& fields) {
    if (frame_.extrapolation == Extrapolation::trend && fields.method != FitMethod::interpolate)
      frame_.extrapolation = Extrapolation::linear;
    for (auto& field : fields.components)
      result_.components.push_back(std::make_shared<FittedField<Dim>>(unmapped(field), frame_));
  }

  void frame_variances(MethodFields<Dim>& fields) {
    const bool is_cut_off =
        choice_.extrapolation == Extrapolation::constant || choice_.extrapolation == Extrapolation::linear;
    frame_.rim.setZero();
    // Where values end up constant, they are not what a covariance says of them.
    const bool by_covariance = fields.method == FitMethod::interpolate &&
                               (Dim > largest_dimension || choice_.extrapolation != Extrapolation::automatic);
    if (options_.extrapolation != Extrapolation::nan)
      frame_.extrapolation = by_covariance ? Extrapolation::trend : Extrapolation::constant;
    std::vector<double> noise;
    if constexpr (Dim <= largest_dimension)
      if (!by_covariance)
        for (const auto& variance : fields.variances) noise.push_back(noise_by<Dim>(*variance, scaled_));
    if (map_ && !by_covariance) scaled_.points = inverse_of(*map_) * scaled_.points;
    for (std::size_t c = 0; c < fields.variances.size(); ++c) {
      if constexpr (Dim <= largest_dimension)
        if (!by_covariance) frame_.growth = variance_growth<Dim>(scaled_, static_cast<Index>(c), noise[c]);
      result_.variances.push_back(std::make_shared<FittedField<Dim>>(unmapped(fields.variances[c]), frame_));
    }
    if (by_covariance && is_cut_off)
      result_.variances = with_errors_outside<Dim>(result_.components, result_.variances);
  }

  const Samples<Dim>& given_;
  const FitOptions& options_;
  bool may_thin_;
  SelectedSamples<Dim> selected_;
  Fit<Dim> result_;
  typename FittedField<Dim>::Frame frame_;
  bool keep_duplicates_ = false;
  MergedSamples<Dim> merged_;
  Samples<Dim> scaled_;  // those merged, in the coordinates of the model
  ModelChoice<Dim> choice_ = {};
  std::optional<Eigen::Matrix<double, Dim, Dim>> map_;
  std::optional<LearnedCovariance> learned_;
};

template <int Dim>
Fit<Dim> fit_in_usual_units(const Samples<Dim>& samples, const FitOptions& options, bool may_thin) {
  if (std::optional<Fit<Dim>> other = fit_otherwise(samples, options)) return std::move(*other);
  return DirectFit<Dim>(samples, options, may_thin).fit();
}

// One fit of all values, or several where they differ, on the scale where they vary evenly.
template <int Dim>
Fit<Dim> fit_all_values(const Samples<Dim>& samples, const FitOptions& options) {
  const auto fit_as_they_are = [](const Samples<Dim>& all, const FitOptions& given) {
    return fit_values<Dim>(all, given, [](const Samples<Dim>& some, const FitOptions& of_some) {
      return fit_in_usual_units(some, of_some, true);
    });
  };
  if (options.transform == "none") return fit_as_they_are(samples, options);
  if (auto other = fit_transformed<Dim>(samples, options, fit_as_they_are)) {
    Fit<Dim> result = framed(std::move(*other), samples, options);
    const Samples<Dim> fitted = fitted_samples(samples, options, result.report);
    for (auto* variances : {&result.variances, &result.function_variances}) bound_outside<Dim>(fitted, *variances);
    return result;
  }
  FitOptions given = options;
  given.transform = "none";
  return fit_as_they_are(samples, given);
}

// Of samples divided by both units, with the errors and the tolerance in that of the values.
template <int Dim>
Fit<Dim> fit_in_units(Samples<Dim> samples, const FitOptions& options, double unit, double values) {
  Point<Dim> coordinates = Point<Dim>::Constant(unit);
  for (const int a : options.drift) coordinates[a] = 1;
  samples.points.array().colwise() /= coordinates.array();
  samples.values /= values;
  Fit<Dim> result = fit_all_values(samples, in_units(options, unit, values));
  const auto place = [&](std::vector<std::shared_ptr<const Field<Dim>>>& fields, double values_unit) {
    for (auto& field : fields) field = dynamic_cast<const FittedField<Dim>&>(*field).in_units(coordinates, values_unit);
  };
  place(result.components, values);
  place(result.variances, 1);
  place(result.function_variances, 1);
  result.variance_unit = values;
  in_units(coordinates, values, result.report);
  return result;
}

template <int Dim>
Fit<Dim> fit_anywhere(const Samples<Dim>& samples, const FitOptions& options) {
  check_options(options, Dim);
  check_sphere(options, Dim);
  check_drift(options, Dim);
  check_transform(options);
  require_valid(samples, "fit");
  double coordinates = 1;
  if (options.sphere.empty()) {
    Point<Dim> largest = samples.points.cwiseAbs().rowwise().maxCoeff();
    for (const int a : options.drift) largest[a] = 0;
    coordinates = unit_of(largest.maxCoeff());
  }
  const double values =
      unit_of(samples.values.unaryExpr([&](double v) { return options.missing == v ? 0.0 : std::abs(v); }).maxCoeff());
  Fit<Dim> result = coordinates == 1 && values == 1 ? fit_all_values(samples, options)
                                                    : fit_in_units(samples, options, coordinates, values);
  result.report.sphere = options.sphere;
  result.report.drift_axes = options.drift;
  result.places = places_of(samples, result.report);
  // Whatever it was called.
  if (result.report.kernel == options.kernel && options.kernel != "auto")
    result.report.kernel = Kernel(options.kernel, Dim).name();
  return result;
}

}  // namespace

template <int Dim>
Fit<Dim> fit(const Samples<Dim>& samples, const FitOptions& options) {
  Fit<Dim> result = fit_anywhere(samples, options);
  warn_of_errors(samples, options, result.report);
  return result;
}

#define CSRBF_INSTANTIATE(Dim) template Fit<Dim> fit<Dim>(const Samples<Dim>&, const FitOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
