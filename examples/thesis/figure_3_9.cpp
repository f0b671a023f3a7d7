#include "figure_3_9.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"
#include "signals.hpp"

#include <algorithm>

namespace csrbf::thesis {

namespace {

constexpr Index lattice_side = 61;
constexpr double tolerance_shown = 0.1;

Samples<2> peaks_samples() {
  const Points<2> points = random_points<2>(500, 1, -3, 3);
  return {points, values_at(points, peaks), {}};
}

}  // namespace

PeaksLevels peaks_levels(double tolerance) {
  const LevelFit<2> fit = pca_multiresolution<2>(peaks_samples(), {.tolerance = tolerance, .cluster_size = 100});
  const Points<2> x = lattice(lattice_side, -3, 3);
  PeaksLevels result{.levels = values_by_level<2>(*fit.fields[0], x), .truth = values_at(x, peaks)};
  for (std::size_t i = 0; i < fit.levels.size(); ++i) {
    result.centers.push_back(static_cast<double>(fit.levels[i].centers));
    result.rmse.push_back(rms(result.levels.col(static_cast<Index>(i)), result.truth));
    result.max_errors.push_back(fit.levels[i].max_error);
  }
  return result;
}

double peaks_default_fit() {
  const Points<2> x = lattice(lattice_side, -3, 3);
  return rms(fit<2>(peaks_samples()).components[0]->evaluate(x).value, values_at(x, peaks));
}

Figure figure_3_9() {
  Figure figure{.name = "figure-3.9",
                .title = "Figs. 3.7-3.9: peaks from 500 random samples, level by level",
                .text =
                    "PCA multiresolution, Wendland C2, first clusters of at most 100 samples, bound 0.1 at every "
                    "sample; peaks ranges from -6.5 to 8.1. Errors on a lattice of 61 x 61 points that are not "
                    "samples."};
  const PeaksLevels p = peaks_levels(tolerance_shown);
  Table errors{.name = "errors by level", .columns = {"level", "centers", "RMSE", "largest error at the samples"}};
  const auto levels = static_cast<Index>(p.rmse.size());
  for (Index level = 0; level < levels; ++level) {
    const auto i = static_cast<std::size_t>(level);
    errors.rows.push_back({static_cast<double>(level + 1), p.centers[i], p.rmse[i], p.max_errors[i]});
  }
  figure.tables = {errors};
  for (const Index level : {Index{0}, levels / 3, 2 * levels / 3, levels - 1}) {
    const std::string name = "level " + std::to_string(level + 1);
    figure.pictures.push_back({name, lattice_side, lattice_side, p.levels.col(level)});
    figure.pictures.push_back({"error of " + name, lattice_side, lattice_side, p.levels.col(level) - p.truth});
  }
  const bool falls = std::is_sorted(p.rmse.rbegin(), p.rmse.rend());
  figure.claims = {
      {"error per level", "highly decreasing with higher resolution (6 levels shown)",
       "RMSE " + number(p.rmse.front(), 2) + " to " + number(p.rmse.back(), 2) + " in " + std::to_string(levels) +
           " levels",
       verdict(falls || p.rmse.back() < p.rmse.front() / 10)},
      {"error of the last level", "almost null (scale of the plot cannot be read)",
       "at the samples " + number(p.max_errors.back(), 2) + " (bound " + number(tolerance_shown) +
           "), between them RMSE " + number(100 * p.rmse.back() / 14.6, 2) + " % of the range",
       verdict(p.max_errors.back() <= tolerance_shown * (1 + 1e-9))},
      {"default fit of the library", "-", "RMSE " + number(peaks_default_fit(), 2), Verdict::not_comparable}};
  return figure;
}

}  // namespace csrbf::thesis
