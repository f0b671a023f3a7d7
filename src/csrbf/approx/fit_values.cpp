#include "csrbf/approx/fit_values.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/fit_by_method.hpp"
#include "csrbf/approx/measure_errors.hpp"
#include "csrbf/approx/outside/extrapolate.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/approx/unity/choose_local_options.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

// Columns of the values by what patches choose for each of them: one group where all choose alike.
template <int Dim>
std::vector<std::vector<Index>> groups_of_values(const Samples<Dim>& samples, const FitOptions& options) {
  std::vector<std::vector<Index>> groups;
  std::vector<LocalOptions> choices;
  for (Index c = 0; c < samples.components(); ++c) {
    if constexpr (Dim > largest_dimension) {  // each has lengths of its own
      groups.push_back({c});
      continue;
    } else {
      const Samples<Dim> one =
          merge_duplicates(Samples<Dim>{samples.points, samples.values.col(c), samples.weights}).samples;
      LocalOptions choice = choose_local_options(normalize_weights(one), partition_options(options)).options;
      choice.smoothing = choice.smoothing > 0 ? 1 : 0;
      const auto found = std::find(choices.begin(), choices.end(), choice);
      if (found == choices.end()) {
        choices.push_back(choice);
        groups.push_back({c});
      } else {
        groups[static_cast<std::size_t>(found - choices.begin())].push_back(c);
      }
    }
  }
  return groups;
}

bool values_may_differ(const FitOptions& options, Index components, Index samples) {
  constexpr Index most_components = 32, fewest_samples = 50;
  const bool is_free = options.kernel == "auto" && !options.smoothing && !options.degree && options.tolerance == 0 &&
                       options.centers == 0;
  const bool has_choice =
      options.method == "auto" || options.method == "partition-of-unity" || options.method == "interpolate";
  const bool is_plain = options.sphere.empty() && options.drift.empty() && options.faults.empty() &&
                        options.gradients.size() == 0 && options.periods.empty() && !options.missing;
  return components > 1 && components <= most_components && samples >= fewest_samples && is_free && has_choice &&
         is_plain;
}

// Adds what is said of a fit of some of the values.
void add_report(const FitReport& one, FitReport& report) {
  report.centers += one.centers;
  report.choose_seconds += one.choose_seconds;
  report.fit_seconds += one.fit_seconds;
  report.gross_errors.insert(report.gross_errors.end(), one.gross_errors.begin(), one.gross_errors.end());
  report.suspects.insert(report.suspects.end(), one.suspects.begin(), one.suspects.end());
  for (std::vector<Index>* rows : {&report.gross_errors, &report.suspects}) {
    std::sort(rows->begin(), rows->end());
    rows->erase(std::unique(rows->begin(), rows->end()), rows->end());
  }
  for (const std::string& warning : one.warnings)
    if (std::find(report.warnings.begin(), report.warnings.end(), warning) == report.warnings.end())
      report.warnings.push_back(warning);
}

// A fit of each group of values on its own, put together.
template <int Dim>
Fit<Dim> fit_groups(const Samples<Dim>& samples, const FitOptions& options,
                    const std::vector<std::vector<Index>>& groups, const FitTogether<Dim>& fit_together) {
  Fit<Dim> result;
  const auto k = static_cast<std::size_t>(samples.components());
  result.components.resize(k);
  result.variances.resize(k);
  std::vector<std::string> kernels(k);
  std::vector<double> noise(k);
  bool all_variances = true, all_noise = true;
  double squares = 0;
  for (const std::vector<Index>& columns : groups) {
    const Samples<Dim> some{samples.points, samples.values(Eigen::all, columns), samples.weights};
    Fit<Dim> one = fit_together(some, options);
    all_variances = all_variances && !one.variances.empty();
    all_noise = all_noise && std::ssize(one.report.noise) == std::ssize(columns);
    squares += static_cast<double>(columns.size()) * std::pow(one.report.cross_validation_rmse, 2);
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const auto c = static_cast<std::size_t>(columns[j]);
      result.components[c] = one.components[j];
      if (!one.variances.empty()) result.variances[c] = one.variances[j];
      kernels[c] = one.report.kernel;
      if (all_noise) noise[c] = one.report.noise[j];
    }
    if (&columns == &groups.front())
      result.report = std::move(one.report);
    else
      add_report(one.report, result.report);
  }
  FitReport& report = result.report;
  if (!all_variances) result.variances.clear();
  report.noise = all_noise ? std::move(noise) : std::vector<double>();
  report.value_kernels = std::move(kernels);
  report.cross_validation_rmse = std::sqrt(squares / static_cast<double>(k));
  measure_errors(fitted_samples(samples, options, report), result);
  return result;
}

template <int Dim>
Fit<Dim> fit_in_groups(const Samples<Dim>& samples, const FitOptions& options, const FitTogether<Dim>& fit_together) {
  if (!values_may_differ(options, samples.components(), samples.size())) return fit_together(samples, options);
  const std::vector<std::vector<Index>> groups = groups_of_values(samples, options);
  return groups.size() == 1 ? fit_together(samples, options) : fit_groups(samples, options, groups, fit_together);
}

template <int Dim>
std::shared_ptr<const Field<Dim>> constant_field(double value, const typename FittedField<Dim>::Frame& frame) {
  const Point<Dim> extent = frame.box.extent().cwiseQuotient(frame.scales);
  const double size = extent.maxCoeff() > 0 ? extent.maxCoeff() : 1;
  const PolynomialTail<Dim> tail{.degree = 0, .coefficients = Eigen::VectorXd::Constant(1, value)};
  return std::make_shared<const FittedField<Dim>>(
      make_expansion<Dim>(Kernel("wendland-c2", Dim), frame.box.center().cwiseQuotient(frame.scales),
                          Eigen::VectorXd::Constant(1, size), Eigen::VectorXd::Zero(1), tail),
      frame);
}

bool varies(const Eigen::VectorXd& column) {
  constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
  const double least = column.minCoeff(), largest = column.maxCoeff();
  return largest - least > rounding * std::max(std::abs(least), std::abs(largest));
}

// Columns of one value everywhere, but for rounding, say nothing of the noise, the lengths and the errors of others.
template <int Dim>
Fit<Dim> fit_varying(const Samples<Dim>& samples, const FitOptions& options, const FitTogether<Dim>& fit_together) {
  std::vector<Index> varying;
  for (Index c = 0; c < samples.components(); ++c)
    if (varies(samples.values.col(c))) varying.push_back(c);
  const bool is_plain = options.drift.empty() && options.gradients.size() == 0 && !options.missing;
  if (varying.empty() || std::ssize(varying) == samples.components() || !is_plain)
    return fit_in_groups(samples, options, fit_together);
  Fit<Dim> fit =
      fit_in_groups({samples.points, samples.values(Eigen::all, varying), samples.weights}, options, fit_together);
  auto frame = dynamic_cast<const FittedField<Dim>&>(*fit.components.front()).frame();
  frame.rim.setZero();
  frame.growth = {};
  FitReport& report = fit.report;
  for (Index c = 0; c < samples.components(); ++c) {
    if (std::binary_search(varying.begin(), varying.end(), c)) continue;
    fit.components.insert(fit.components.begin() + c, constant_field<Dim>(samples.values(0, c), frame));
    if (!fit.variances.empty()) fit.variances.insert(fit.variances.begin() + c, constant_field<Dim>(0, frame));
    if (!report.noise.empty()) report.noise.insert(report.noise.begin() + c, 0);
    if (!report.value_kernels.empty()) report.value_kernels.insert(report.value_kernels.begin() + c, report.kernel);
  }
  return fit;
}

// Variances of a fit without, by what the method auto says of the same samples.
template <int Dim>
void add_variances(const Samples<Dim>& samples, const FitOptions& given, const FitTogether<Dim>& fit_together,
                   Fit<Dim>& fit) {
  FitOptions options = given;
  const FitOptions automatic;
  options.method = automatic.method;
  options.kernel = automatic.kernel;
  options.kernel_parameter = automatic.kernel_parameter;
  options.centers = automatic.centers;
  options.tolerance = automatic.tolerance;
  options.smoothing = automatic.smoothing;
  options.degree = automatic.degree;
  options.extrapolation = automatic.extrapolation;
  options.standard_deviation = false;
  Fit<Dim> likely = fit_varying(samples, options, fit_together);
  fit.report.noise = std::move(likely.report.noise);
  fit.report.fit_seconds += likely.report.choose_seconds + likely.report.fit_seconds;
  fit.variances = variances_by<Dim>(fit.components, likely.components, likely.variances);
  if (fit.variances.empty())
    fit.report.warnings.emplace_back("standard_deviation: there are too few samples to estimate it");
}

}  // namespace

template <int Dim>
Fit<Dim> fit_values(const Samples<Dim>& samples, const FitOptions& options, const FitTogether<Dim>& fit_together) {
  Fit<Dim> fit = fit_varying(samples, options, fit_together);
  if (options.standard_deviation && fit.variances.empty()) add_variances(samples, options, fit_together, fit);
  return fit;
}

#define CSRBF_INSTANTIATE(Dim) \
  template Fit<Dim> fit_values<Dim>(const Samples<Dim>&, const FitOptions&, const FitTogether<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
