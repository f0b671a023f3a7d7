#include "report/left_out.hpp"

#include "report/plots.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace csrbf::app {
namespace {

constexpr Index fifth = 5;  // of the samples is left out

// Samples that are left out in turn, and what a function fitted to the others says of them.
struct LeftOut {
  std::vector<Index> samples, kept;
  Eigen::VectorXd predicted;  // the first value
  Index total = 0;            // samples, of which some are left out
};

// All samples, or the `most` in the middle of them, nearest first.
std::vector<Index> samples_in_the_middle(const SampleTable& samples, const Eigen::MatrixXd& bounds, Index most) {
  const Index n = samples.coordinates.cols();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  if (n <= most) return order;
  const Eigen::VectorXd extent = bounds.col(1) - bounds.col(0);
  const Eigen::VectorXd scale = (extent.array() > 0).select(extent.cwiseInverse(), 0);
  const Eigen::VectorXd middle = samples.coordinates.rowwise().mean();
  Eigen::VectorXd distance(n);
  for (Index i = 0; i < n; ++i) distance[i] = (samples.coordinates.col(i) - middle).cwiseProduct(scale).squaredNorm();
  const auto nearer = [&](Index a, Index b) { return distance[a] < distance[b]; };
  std::partial_sort(order.begin(), order.begin() + most, order.end(), nearer);
  order.resize(static_cast<std::size_t>(most));
  return order;
}

// Every fifth sample is left out once: one more fit with what the first one chose. Where that would take long, of the
// samples in the middle, and there of the inner ones, which others surround.
LeftOut leave_out(const NamedFunction& model, const SampleTable& samples, const FitOptions& options) {
  constexpr Index least = 20;                             // samples
  constexpr Index most_dense = 500, most_patches = 1000;  // samples that are fitted in about a tenth of a second
  const FitReport& r = model.function.report();
  const Index n = samples.coordinates.cols();
  LeftOut left;
  if (n < least) return left;
  const std::vector<Index> used =
      samples_in_the_middle(samples, model.function.bounds(), r.partition ? most_patches : most_dense);
  left.total = std::ssize(used);
  constexpr double inner_share = 0.6;
  const Index inner = left.total < n ? static_cast<Index>(inner_share * static_cast<double>(left.total)) : n;
  for (Index i = 0; i < left.total; ++i) (i % fifth == 0 && i < inner ? left.samples : left.kept).push_back(used[i]);
  FitOptions quiet = options;
  quiet.progress = {};
  quiet.method = r.method;
  quiet.kernel = r.kernel;
  quiet.smoothing = r.smoothing;
  if (r.degree >= 0) quiet.degree = r.degree;
  try {
    const Function function = fit_function(
        samples.coordinates(Eigen::all, left.kept), samples.values(left.kept, Eigen::seqN(0, 1)),
        samples.weights.size() > 0 ? Eigen::VectorXd(samples.weights(left.kept)) : Eigen::VectorXd(), quiet);
    left.predicted = function.evaluate(samples.coordinates(Eigen::all, left.samples)).value.col(0);
  } catch (const std::runtime_error&) {
    left.samples.clear();  // too few are left for the method
  } catch (const InvalidInput&) {
    left.samples.clear();
  }
  return left;
}

Figure prediction_plot(const LeftOut& left, const SampleTable& samples, const std::string& value) {
  Scatter plot{.x_label = "left-out " + value, .y_label = "predicted", .same_axes = true};
  plot.dots.resize(2, std::ssize(left.samples));
  plot.dots << samples.values(left.samples, 0).transpose(), left.predicted.transpose();
  const bool has_all = left.total == samples.coordinates.cols();
  const std::string which =
      has_all ? "Every fifth sample" : "Every fifth of the inner samples of " + grouped(left.total) + " in the middle";
  return {"Predicted against left-out values", draw(plot),
          which +
              " was left out, and predicted from the others with the same settings. On the dashed line both are "
              "equal."};
}

// Means of the errors over equal numbers of left-out samples, by their distance from the nearest sample kept.
Figure error_by_distance(const LeftOut& left, const SampleTable& samples, const Eigen::VectorXd& extent,
                         const std::string& value) {
  std::vector<std::pair<double, double>> pairs;
  const Eigen::VectorXd scale = extent.cwiseInverse();
  for (std::size_t k = 0; k < left.samples.size(); ++k) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto place = samples.coordinates.col(left.samples[k]);
    for (const Index i : left.kept)
      nearest = std::min(nearest, (samples.coordinates.col(i) - place).cwiseProduct(scale).norm());
    const double error = std::abs(left.predicted[static_cast<Index>(k)] - samples.values(left.samples[k], 0));
    if (std::isfinite(nearest) && std::isfinite(error)) pairs.emplace_back(nearest, error);
  }
  std::sort(pairs.begin(), pairs.end());
  Scatter plot{.x_label = "distance from the nearest other sample, sides of the box",
               .y_label = "error, in the unit of " + value};
  const Index n = std::ssize(pairs), groups = std::min<Index>(8, n / 5);
  plot.dots.resize(2, n);
  for (Index i = 0; i < n; ++i) plot.dots.col(i) << pairs[i].first, pairs[i].second;
  plot.line.resize(2, groups);
  for (Index g = 0; g < groups; ++g) {
    const Index begin = g * n / groups, end = (g + 1) * n / groups;
    plot.line.col(g) = plot.dots.middleCols(begin, end - begin).rowwise().mean();
  }
  return {"Errors of left-out samples by distance", draw(plot), "The line goes through means of equally many samples."};
}

}  // namespace

void add_left_out(const NamedFunction& model, const SampleTable& samples, const FitOptions& options, Page& page) {
  const LeftOut left = leave_out(model, samples, options);
  if (left.samples.empty()) return;
  const std::string& value = model.value_names.front();
  page.figures.push_back(prediction_plot(left, samples, value));
  const Eigen::MatrixXd bounds = model.function.bounds();
  const Eigen::VectorXd extent = bounds.col(1) - bounds.col(0);
  if (extent.minCoeff() > 0) page.figures.push_back(error_by_distance(left, samples, extent, value));
}

}  // namespace csrbf::app
