#include "figure_1_1.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "signals.hpp"

#include <algorithm>
#include <limits>

namespace csrbf::thesis {
namespace {

using Data = PartitionOfUnity<1>::Data;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double rounding = 1e-10;

// The weight of a support, before it is divided by the sum of all.
double bump(const Data& data, Index patch, double x) {
  const Box<1> cell = data.cover.cell(patch);
  const double t = 2 * (x - cell.center()[0]) / (data.cover.growth() * (cell.hi[0] - cell.lo[0]));
  return std::abs(t) < 1 ? std::pow(1 - t * t, 4) : 0;
}

double local_value(const Data& data, Index patch, double x) {
  constexpr int lanes = LocalEvaluator<1>::lanes;
  double at[lanes], f[LocalEvaluator<1>::terms][lanes];
  std::fill_n(at, lanes, x);
  LocalEvaluator<1>(data.models).evaluate(patch, 0, at, Derivatives::none, f);
  return f[0][0];
}

struct Checks {
  double unity = 0, sum = 0, at_samples = 0, beyond = 0;
};

// The curves at one place: signal, f, then weight and local function of every patch.
std::vector<double> row(const Data& data, double x, double f, Checks& checks) {
  const double truth = wavy_signal(x);
  std::vector<double> values{x, truth, f};
  double total = 0, blended = 0, worst = 0, weights = 0;
  for (Index i = 0; i < data.models.size(); ++i) total += bump(data, i, x);
  for (Index i = 0; i < data.models.size(); ++i) {
    const double weight = bump(data, i, x) / total, local = local_value(data, i, x);
    weights += weight;
    blended += weight * local;
    if (weight > 0) worst = std::max(worst, std::abs(local - truth));
    values.insert(values.end(), {weight, weight > 0 ? local : none});
  }
  checks.unity = std::max(checks.unity, std::abs(weights - 1));
  checks.sum = std::max(checks.sum, std::abs(blended - f));
  checks.beyond = std::max(checks.beyond, std::abs(f - truth) - worst);
  return values;
}

// A cover of points in the plane: cells and the supports that they grow to.
void add_cover(Figure& figure) {
  Points<2> points = random_points<2>(400, 3);
  points.leftCols(200) *= 0.45;
  const Cover<2> cover(points, 40, cover_growth<2>);
  Table at{.name = "points in the plane", .columns = {"x", "y"}};
  for (const auto& p : points.colwise()) at.rows.push_back({p.x(), p.y()});
  Table cells{.name = "cells", .columns = {"x", "y", "width", "height", "growth"}};
  for (Index i = 0; i < cover.size(); ++i) {
    const Box<2>& cell = cover.cell(i);
    cells.rows.push_back({cell.lo[0], cell.lo[1], cell.hi[0] - cell.lo[0], cell.hi[1] - cell.lo[1], cover.growth()});
  }
  figure.tables.push_back(std::move(at));
  figure.tables.push_back(std::move(cells));
}

}  // namespace

Figure figure_1_1() {
  Figure figure{.name = "figure-1.1",
                .title = "Figs. 1.1, 6.2: partition of unity",
                .text =
                    "70 random samples of (3.5), a cover of the interval, weights with the sum 1, local functions "
                    "(a quadratic polynomial and Wendland's C4 function at each of 16 samples) and their blend (1.10). "
                    "In the plane: the cells that a kd-tree makes of 400 points, and the supports that they grow to."};
  // Evenly spread, so that the 16 samples that a local function is fitted to are all of those in its support.
  Points<1> points = random_points<1>(70, 5);
  for (Index i = 0; i < points.cols(); ++i) points(0, i) = (static_cast<double>(i) + 0.8 * points(0, i)) / 70;
  const Eigen::VectorXd values = values_at(points, [](const Point<1>& p) { return wavy_signal(p[0]); });
  const auto fit = partition_of_unity<1>(
      {points, values, {}},
      {.kernel = "wendland-c4", .degree = 2, .samples_per_patch = 16, .centers_per_patch = 16, .smoothing = 0});
  const auto f = fit.fields()[0];
  const Data& data = *fit.data;
  Table samples{.name = "samples", .columns = {"x", "s"}};
  for (Index i = 0; i < points.cols(); ++i) samples.rows.push_back({points(0, i), values[i]});
  Table curves{.name = "curves", .columns = {"x", "signal", "f"}};
  for (Index i = 0; i < data.models.size(); ++i) {
    const std::string patch = std::to_string(i + 1);
    curves.columns.insert(curves.columns.end(), {"weight " + patch, "f " + patch});
  }
  Checks checks;
  const Box<1> box = data.cover.box();
  const Points<1> x = box.lo[0] + (box.hi[0] - box.lo[0]) * line(1201).array();
  const Eigen::VectorXd at_x = f->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) curves.rows.push_back(row(data, x(0, i), at_x[i], checks));
  checks.at_samples = (f->evaluate(points).value - values).cwiseAbs().maxCoeff();
  figure.tables = {std::move(samples), std::move(curves)};
  add_cover(figure);
  figure.claims = {{"the weights have the sum 1", "by definition", "within " + number(checks.unity, 2),
                    verdict(checks.unity < rounding)},
                   {"f is the blend (1.10) of the local functions", "by definition",
                    "within " + number(checks.sum, 2) + " (f as the library evaluates it, against the sum written out)",
                    verdict(checks.sum < rounding)},
                   {"f interpolates if all local functions do", "yes",
                    "largest error at a sample " + number(checks.at_samples, 2), verdict(checks.at_samples < 1e-6)},
                   {"the error of f is at most the largest local error", "with the maximum of all patches",
                    "also with that of the patches over the place: never above it by more than " +
                        number(std::max(0.0, checks.beyond), 2),
                    verdict(checks.beyond < rounding)}};
  return figure;
}

Figure figure_1_2() {
  Figure figure{.name = "figure-1.2",
                .title = "Fig. 1.2: interpolation by radial basis functions",
                .text =
                    "Nine samples, one basis function at each (Wendland's C2 function, support 0.35) times its "
                    "coefficient, and the sum of all."};
  Points<1> points(1, 9);
  points << 0.03, 0.12, 0.2, 0.36, 0.47, 0.55, 0.71, 0.84, 0.97;
  const Eigen::VectorXd values =
      values_at(points, [](const Point<1>& p) { return 0.6 + 0.35 * std::sin(7 * p[0]) + 0.2 * std::cos(19 * p[0]); });
  const auto f =
      interpolate<1>({points, values, {}}, {.kernel = "wendland-c2", .support = 0.35, .degree = -1}).components[0];
  Table samples{.name = "samples", .columns = {"x", "s"}};
  for (Index i = 0; i < points.cols(); ++i) samples.rows.push_back({points(0, i), values[i]});
  Table curves{.name = "curves", .columns = {"x", "f"}};
  for (Index j = 0; j < points.cols(); ++j) curves.columns.push_back("term " + std::to_string(j + 1));
  const Points<1> x = line(801);
  const Eigen::MatrixXd terms = f->basis().dense_matrix(x) * f->coefficients().asDiagonal();
  const Eigen::VectorXd sum = f->evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) {
    curves.rows.push_back({x(0, i), sum[i]});
    curves.rows.back().insert(curves.rows.back().end(), terms.row(i).begin(), terms.row(i).end());
  }
  const double error = (f->evaluate(points).value - values).cwiseAbs().maxCoeff();
  figure.claims = {{"the sum of the basis functions interpolates the samples", "yes (picture)",
                    "largest error at a sample " + number(error, 2), verdict(error < rounding)}};
  figure.tables = {std::move(samples), std::move(curves)};
  return figure;
}

}  // namespace csrbf::thesis
