#include "figure_3_4.hpp"

#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"
#include "csrbf/core/percentile.hpp"
#include "signals.hpp"

#include <algorithm>
#include <limits>

namespace csrbf::thesis {

namespace {

constexpr Index sample_count = 100;
constexpr Index cluster_size = 40;
constexpr unsigned shown_draw = 3;

Samples<1> draw_samples(unsigned seed) {
  const Points<1> points = random_points<1>(sample_count, seed);
  return {points, values_at(points, [](const Point<1>& p) { return wavy_signal(p[0]); }), {}};
}

}  // namespace

SignalLevels signal_levels(double tolerance) {
  const Samples<1> samples = draw_samples(shown_draw);
  const LevelFit<1> fit = pca_multiresolution<1>(samples, {.tolerance = tolerance, .cluster_size = cluster_size});
  const Points<1> x = line(1001);
  SignalLevels result{.points = samples.points.row(0),
                      .values = samples.values.col(0),
                      .x = x.row(0),
                      .truth = values_at(x, [](const Point<1>& p) { return wavy_signal(p[0]); }),
                      .levels = values_by_level<1>(*fit.fields[0], x)};
  for (const LevelReport& level : fit.levels) {
    result.max_errors.push_back(level.max_error);
    result.centers.push_back(static_cast<double>(level.centers));
  }
  return result;
}

std::size_t ThresholdCurve::best() const {
  return static_cast<std::size_t>(std::min_element(errors.begin(), errors.end()) - errors.begin());
}

ThresholdCurve threshold_curve(double snr, const std::vector<double>& thresholds, int draws) {
  ThresholdCurve curve{.snr = snr, .thresholds = thresholds};
  std::vector<std::vector<double>> errors(thresholds.size());
  for (int draw = 0; draw < draws; ++draw) {
    const auto seed = static_cast<unsigned>(draw);
    Samples<1> samples = draw_samples(seed + 1);
    const Eigen::VectorXd truth = samples.values.col(0);
    curve.noise += add_noise(samples.values.col(0), snr, seed + 1000) / draws;
    for (std::size_t i = 0; i < thresholds.size(); ++i) {
      const LevelFit<1> fit =
          pca_multiresolution<1>(samples, {.tolerance = thresholds[i], .cluster_size = cluster_size});
      errors[i].push_back(rms(fit.fields[0]->evaluate(samples.points).value, truth));
    }
  }
  for (std::vector<double>& of_draws : errors) curve.errors.push_back(median(of_draws));
  return curve;
}

namespace {

void add_levels(Figure& figure) {
  const SignalLevels s = signal_levels(0.1);
  Table samples{.name = "samples", .columns = {"x", "s"}};
  for (Index i = 0; i < s.points.size(); ++i) samples.rows.push_back({s.points[i], s.values[i]});
  Table curves{.name = "levels", .columns = {"x", "signal"}};
  for (Index level = 0; level < s.levels.cols(); ++level)
    curves.columns.push_back("level " + std::to_string(level + 1));
  for (Index i = 0; i < s.x.size(); ++i) {
    curves.rows.push_back({s.x[i], s.truth[i]});
    for (Index level = 0; level < s.levels.cols(); ++level) curves.rows.back().push_back(s.levels(i, level));
  }
  Table errors{.name = "errors by level", .columns = {"level", "centers", "largest error at the samples", "RMSE"}};
  for (Index level = 0; level < s.levels.cols(); ++level) {
    const auto i = static_cast<std::size_t>(level);
    errors.rows.push_back(
        {static_cast<double>(level + 1), s.centers[i], s.max_errors[i], rms(s.levels.col(level), s.truth)});
  }
  figure.tables.insert(figure.tables.end(), {samples, curves, errors});
  figure.claims.push_back({"Fig. 3.4: largest error at a sample, threshold 0.1, no noise", "below 0.1 (implied)",
                           number(s.max_errors.back()), verdict(s.max_errors.back() <= 0.1 * (1 + 1e-9))});
  figure.claims.push_back({"Fig. 3.4: levels", "4",
                           std::to_string(s.levels.cols()) + ", with all clusters checked at "
                                                             "every level",
                           Verdict::not_comparable});
}

void add_noisy_curves(Figure& figure, const ThresholdCurve& curve) {
  Samples<1> samples = draw_samples(shown_draw);
  add_noise(samples.values.col(0), curve.snr, 1000 + shown_draw);
  const Points<1> x = line(1001);
  const double best = curve.thresholds[curve.best()];
  Table table{.name = "noisy curves", .columns = {"x", "signal"}};
  for (Index i = 0; i < x.cols(); ++i) table.rows.push_back({x(0, i), wavy_signal(x(0, i))});
  for (const double threshold : {best / 4, best, 4 * best}) {
    table.columns.push_back("threshold " + number(threshold, 2));
    const LevelFit<1> fit = pca_multiresolution<1>(samples, {.tolerance = threshold, .cluster_size = cluster_size});
    const Eigen::VectorXd f = fit.fields[0]->evaluate(x).value;
    for (Index i = 0; i < x.cols(); ++i) table.rows[i].push_back(f[i]);
  }
  Table noisy{.name = "noisy samples", .columns = {"x", "s"}};
  for (Index i = 0; i < samples.size(); ++i) noisy.rows.push_back({samples.points(0, i), samples.values(i, 0)});
  figure.tables.insert(figure.tables.end(), {table, noisy});
}

}  // namespace

Figure figure_3_4() {
  Figure figure{
      .name = "figure-3.4",
      .title = "Figs. 3.3-3.6: a signal from 100 irregular samples, and the threshold under noise",
      .text =
          "PCA multiresolution of the signal (3.5), clusters of at most 40 samples, Wendland C2; the curves are of "
          "one draw of places with an error near the median. Errors against the threshold are root mean squares of "
          "the difference to the signal without noise at the samples, medians of 20 draws of places and noise. The "
          "thesis defines neither its SNR nor its error. With 10 log10 of the ratio of powers the best threshold is "
          "about twice the standard deviation of the noise, so that its 0.37 belongs to a stronger noise than 30 dB "
          "are here."};
  add_levels(figure);

  std::vector<double> thresholds;
  for (int i = 0; i <= 24; ++i) thresholds.push_back(0.01 * std::pow(80, i / 24.0));
  Table table{.name = "thresholds", .columns = {"threshold"}};
  for (const double t : thresholds) table.rows.push_back({t});
  std::vector<std::string> optima;
  bool inside = true;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (const double snr : {15.0, 21.0, 27.0, 30.0, 33.0}) {
    const ThresholdCurve curve = threshold_curve(snr, thresholds, 20);
    table.columns.push_back(number(snr) + " dB");
    for (std::size_t i = 0; i < thresholds.size(); ++i) table.rows[i].push_back(curve.errors[i]);
    inside = inside && curve.best() > 0 && curve.best() + 1 < thresholds.size();
    optima.push_back(number(thresholds[curve.best()], 2) + " (noise " + number(curve.noise, 2) + ", error " +
                     number(curve.errors[curve.best()], 2) + ")");
    inside = inside && 1.05 * curve.errors[curve.best()] < curve.errors.front();
    smallest = std::min(smallest, *std::min_element(curve.errors.begin(), curve.errors.end()));
    largest = std::max(largest, *std::max_element(curve.errors.begin(), curve.errors.end()));
    if (snr == 21) add_noisy_curves(figure, curve);
  }
  figure.tables.push_back(table);
  figure.claims.push_back({"Fig. 3.6: there is an optimal threshold for 27, 30, 33 dB", "always",
                           "best at " + optima[2] + ", " + optima[3] + ", " + optima[4], verdict(inside)});
  figure.claims.push_back({"Fig. 3.5: optimal threshold at 30 dB", "0.37 (definition of SNR not given)",
                           optima[3] + "; at 21 dB " + optima[1] + "; at 15 dB " + optima[0], Verdict::not_comparable});
  figure.claims.push_back({"Fig. 3.5: range of the signal", "axes from -1 to 1.5",
                           "(3.5) as printed has its maximum of 2.5 at x = 0.046: formula and figure do not agree",
                           Verdict::not_comparable});
  figure.claims.push_back({"Fig. 3.6: errors", "axis from 0 to 0.35, curves cannot be read",
                           "medians from " + number(smallest, 2) + " to " + number(largest, 2),
                           Verdict::not_comparable});
  return figure;
}

}  // namespace csrbf::thesis
