#include "csrbf/approx/measure_errors.hpp"

#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {

template <int Dim>
void measure_errors(const Samples<Dim>& samples, Fit<Dim>& fit) {
  constexpr Index checked_samples = 100'000;
  const Index stride = std::max<Index>(1, samples.size() / checked_samples);
  const auto some = Eigen::seq(0, samples.size() - 1, stride);
  const Points<Dim> points = samples.points(Eigen::all, some);
  Eigen::VectorXd norms(static_cast<Index>(fit.components.size()));
  fit.report.max_error = 0;
  for (std::size_t c = 0; c < fit.components.size(); ++c) {
    Eigen::VectorXd error = fit.components[c]->evaluate(points).value;
    error -= samples.values.col(static_cast<Index>(c))(some);
    norms[static_cast<Index>(c)] = error.stableNorm();
    fit.report.max_error = std::max(fit.report.max_error, error.cwiseAbs().maxCoeff());
  }
  fit.report.rmse = norms.stableNorm() / std::sqrt(static_cast<double>(points.cols() * norms.size()));
}

template <int Dim>
Samples<Dim> fitted_samples(const Samples<Dim>& given, const FitOptions& options, const FitReport& report) {
  std::vector<bool> is_left_out(static_cast<std::size_t>(given.size()), false);
  if (options.loss == "auto")
    for (const Index row : report.gross_errors) is_left_out[static_cast<std::size_t>(row)] = true;
  std::vector<Index> rows;
  for (Index i = 0; i < given.size(); ++i)
    if (!is_left_out[static_cast<std::size_t>(i)] &&
        (!options.missing || (given.values.row(i).array() != *options.missing).all()))
      rows.push_back(i);
  return {chosen_points<Dim>(given.points, rows), given.values(rows, Eigen::all), {}};
}

template <int Dim>
std::shared_ptr<const Points<Dim>> places_of(const Samples<Dim>& samples, const FitReport& report) {
  constexpr Index much_smaller = 4;
  const Index n = samples.size(), size = std::min(report.samples_fitted, report.centers > 0 ? report.centers : n);
  if (much_smaller * size > n) return std::make_shared<const Points<Dim>>(samples.points);
  const std::vector<Index> order = morton_order<Dim>(samples.points);
  std::vector<Index> some(2 * Dim);
  for (Index a = 0; a < Dim; ++a) {
    samples.points.row(a).minCoeff(&some[static_cast<std::size_t>(2 * a)]);
    samples.points.row(a).maxCoeff(&some[static_cast<std::size_t>(2 * a + 1)]);
  }
  const Index stride = n / std::max<Index>(1, much_smaller * size);
  for (Index i = 0; i < n; i += std::max<Index>(1, stride)) some.push_back(order[static_cast<std::size_t>(i)]);
  return std::make_shared<const Points<Dim>>(samples.points(Eigen::all, some));
}

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template void measure_errors<Dim>(const Samples<Dim>&, Fit<Dim>&);                                   \
  template Samples<Dim> fitted_samples<Dim>(const Samples<Dim>&, const FitOptions&, const FitReport&); \
  template std::shared_ptr<const Points<Dim>> places_of<Dim>(const Samples<Dim>&, const FitReport&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
