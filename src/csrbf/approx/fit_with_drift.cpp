#include "csrbf/approx/fit_with_drift.hpp"

#include "csrbf/approx/kriging/estimate_drift.hpp"
#include "csrbf/approx/samples/sphere_field.hpp"
#include "csrbf/core/error.hpp"

#include <algorithm>

namespace csrbf {
namespace {

constexpr Index few_covariates = 500;  // samples up to which the fields of covariates are fitted as any others

// The axes that are not of the drift; of many variables, without those that there are not.
template <int Dim>
std::vector<int> axes_without_drift(const Points<Dim>& points, const FitOptions& options) {
  std::vector<int> others;
  for (int a = 0; a < Dim; ++a)
    if (std::find(options.drift.begin(), options.drift.end(), a) == options.drift.end()) others.push_back(a);
  if constexpr (Dim > largest_dimension) {
    const int kept = options.sphere.empty() ? -1 : std::max(options.sphere[0], options.sphere[1]);
    while (others.size() > 1 && others.back() > kept && (points.row(others.back()).array() == 0).all())
      others.pop_back();
  }
  return others;
}

// The options for a fit of the other axes alone.
FitOptions options_of_others(const FitOptions& options, const std::vector<int>& others) {
  FitOptions result = options;
  result.drift.clear();
  for (int& axis : result.sphere)
    axis = static_cast<int>(std::find(others.begin(), others.end(), axis) - others.begin());
  if (options.periods.empty()) return result;
  result.periods.clear();
  for (const int a : others) result.periods.push_back(options.periods[static_cast<std::size_t>(a)]);
  return result;
}

// Coordinates in which distances are those that matter: on a sphere those in space, along a periodic axis those of a
// circle. Where extents differ much, in units of them: one for all coordinates of a sphere or a circle.
Eigen::MatrixXd metric_coordinates(const Eigen::MatrixXd& points, const FitOptions& options) {
  constexpr double turn = 6.28318530717958648, different_extents = 10;
  const std::vector<int>& sphere = options.sphere;
  std::vector<Eigen::MatrixXd> parts;
  if (!sphere.empty()) {
    Eigen::MatrixXd& places = parts.emplace_back(3, points.cols());
    for (Index i = 0; i < points.cols(); ++i)
      places.col(i) = point_on_sphere(points(sphere[0], i), points(sphere[1], i));
  }
  for (int a = 0; a < points.rows(); ++a) {
    if (std::find(sphere.begin(), sphere.end(), a) != sphere.end()) continue;
    const double period = options.periods.empty() ? 0 : options.periods[static_cast<std::size_t>(a)];
    Eigen::MatrixXd& axis = parts.emplace_back(points.row(a));
    if (!(period > 0)) continue;
    const Eigen::ArrayXd angle = turn / period * axis.row(0).transpose().array();
    axis.resize(2, points.cols());
    axis << period / turn * angle.cos().transpose(), period / turn * angle.sin().transpose();
  }
  Eigen::VectorXd extents(std::ssize(parts));
  Index rows = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    extents[static_cast<Index>(k)] = (parts[k].rowwise().maxCoeff() - parts[k].rowwise().minCoeff()).maxCoeff();
    rows += parts[k].rows();
  }
  const bool differ = extents.maxCoeff() > different_extents * extents.minCoeff();
  Eigen::MatrixXd result(rows, points.cols());
  rows = 0;
  for (std::size_t k = 0; k < parts.size(); rows += parts[k++].rows()) {
    const double extent = extents[static_cast<Index>(k)];
    result.middleRows(rows, parts[k].rows()) = parts[k] / (differ && extent > 0 ? extent : 1);
  }
  return result;
}

FitOptions options_of_covariates(FitOptions options, const char* method) {
  options.loss = "squares";
  options.tolerance = 0;
  options.centers = 0;
  options.kernel = "auto";
  options.extrapolation = Extrapolation::constant;
  options.method = method;
  return options;
}

// What was said of some of the samples, without the axes of the drift.
void in_all_axes(const std::vector<Index>& rows, const std::vector<int>& others, std::size_t dimension,
                 FitReport& report) {
  for (std::vector<Index>* found : {&report.gross_errors, &report.suspects})
    for (Index& row : *found) row = rows[static_cast<std::size_t>(row)];
  const auto embed = [&](std::vector<double>& numbers, double missing) {
    std::vector<double> embedded(dimension, missing);
    for (std::size_t k = 0; k < others.size(); ++k) embedded[static_cast<std::size_t>(others[k])] = numbers[k];
    numbers = std::move(embedded);
  };
  embed(report.axis_scales, 1);
  for (std::vector<double>& axis : report.axes) embed(axis, 0);
}

}  // namespace

void check_drift(const FitOptions& options, int dimension) {
  std::vector<bool> used(static_cast<std::size_t>(dimension), false);
  for (const int a : options.drift) {
    require(a >= 0 && a < dimension && !used[static_cast<std::size_t>(a)], "fit", "drift", a,
            "must be different axes, numbered from 0");
    used[static_cast<std::size_t>(a)] = true;
    require(std::find(options.sphere.begin(), options.sphere.end(), a) == options.sphere.end(), "fit", "drift", a,
            "is an axis of the sphere");
    if (std::ssize(options.periods) == dimension)
      require(options.periods[static_cast<std::size_t>(a)] == 0, "fit", "periods",
              options.periods[static_cast<std::size_t>(a)], "an axis of the drift has no period");
  }
  require(std::ssize(options.drift) < dimension, "fit", "drift", options.drift.size(),
          "must leave one axis at least that is a coordinate");
}

template <int Dim>
Fit<Dim> fit_with_drift(const Samples<Dim>& given, const FitOptions& options, const FitAny& fit) {
  std::vector<Index> rows;
  for (Index i = 0; i < given.size(); ++i)
    if (!options.missing || (given.values.row(i).array() != *options.missing).all()) rows.push_back(i);
  require(!rows.empty(), "fit", "missing", options.missing.value_or(0),
          "all samples have this value; there is none to fit");
  const std::vector<int> others = axes_without_drift<Dim>(given.points, options);
  FitOptions rest = options_of_others(options, others);
  rest.missing.reset();
  const Eigen::MatrixXd x = given.points(others, rows);
  const Eigen::MatrixXd Z = given.points(options.drift, rows).transpose();
  const Eigen::MatrixXd values = given.values(rows, Eigen::all);
  const Eigen::VectorXd weights = given.weights.size() > 0 ? Eigen::VectorXd(given.weights(rows)) : Eigen::VectorXd();

  const DriftEstimate drift = estimate_drift(metric_coordinates(x, rest), values, Z, weights, options.loss);
  AnyFit residual = fit(x, values - Z * drift.beta, weights, rest);

  Fit<Dim> result;
  result.report = std::move(residual.report);
  FitReport& report = result.report;
  report.missing = given.size() - std::ssize(rows);
  in_all_axes(rows, others, Dim, report);
  const Box<Dim> box = bounding_box<Dim>(given.points);
  AnyFit covariates;
  if (!residual.variances.empty()) {
    const bool by_patches = x.cols() > few_covariates && x.rows() <= largest_dimension;
    covariates = fit(x, Z, weights, options_of_covariates(rest, by_patches ? "partition-of-unity" : "auto"));
  }
  for (Index c = 0; c < values.cols(); ++c) {
    const Eigen::MatrixXd C = drift.covariance(c);
    for (Index j = 0; j < Z.cols(); ++j) {
      report.drift.push_back(drift.beta(j, c));
      report.drift_deviations.push_back(std::sqrt(C(j, j)));
    }
    const auto k = static_cast<std::size_t>(c);
    result.components.push_back(std::make_shared<DriftField<Dim>>(
        typename DriftField<Dim>::Parts{options.drift, residual.components[k], drift.beta.col(c), {}, {}}, box));
    if (!residual.variances.empty())
      result.variances.push_back(std::make_shared<DriftField<Dim>>(
          typename DriftField<Dim>::Parts{options.drift, residual.variances[k], Eigen::VectorXd::Zero(Z.cols()),
                                          covariates.components, C},
          box));
  }
  return result;
}

#define CSRBF_INSTANTIATE(Dim) \
  template Fit<Dim> fit_with_drift<Dim>(const Samples<Dim>&, const FitOptions&, const FitAny&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
