#include "figure_3_16.hpp"

#include "csrbf/approx/levels/error_bounded.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "signals.hpp"

namespace csrbf::thesis {

BoundedLevels bounded_levels(const SampledSlice& sampled, double tolerance, Index centers) {
  BoundedLevels result{.tolerance = tolerance * sampled.range()};
  const LevelFit<2> fit = error_bounded<2>(sampled.samples, {.tolerance = result.tolerance, .centers = centers});
  result.levels = values_by_level<2>(*fit.fields[0], sampled.slice.pixels());
  const auto count = result.levels.cols();
  result.max_errors.resize(count);
  result.above.resize(count);
  for (Index level = 0; level < count; ++level) {
    const Eigen::VectorXd at_samples = result.levels(sampled.ids, level);
    const Eigen::ArrayXd errors = (at_samples - sampled.samples.values.col(0)).cwiseAbs();
    result.max_errors[level] = errors.maxCoeff();
    result.above[level] = static_cast<double>((errors > result.tolerance).count()) / static_cast<double>(errors.size());
    result.rmse.push_back(rms(result.levels.col(level), sampled.slice.values));
    result.centers.push_back(static_cast<double>(fit.levels[level].centers));
  }
  const Eigen::VectorXd at_samples = fit.fields[0]->evaluate(sampled.samples.points).value;
  result.largest_error = (at_samples - sampled.samples.values.col(0)).cwiseAbs().maxCoeff();
  return result;
}

Figure figure_3_16() {
  Figure figure{.name = "figure-3.16",
                .title = "Fig. 3.16: the same slice within 2 % at every sample",
                .text =
                    "error_bounded (Wendland C2) from a first level of 1,172 functions; 2 % of the range of the grey "
                    "values. The last level gives every sample that is still above the bound a function that "
                    "vanishes at all others, so that the bound always holds."};
  const std::optional<Slice> slice = brain_slice();
  if (!slice) return without_brain(figure);
  const SampledSlice sampled = sample_slice(*slice, 0.3, 1);
  const BoundedLevels b = bounded_levels(sampled, 0.02, 1172);
  Table table{.name = "levels",
              .columns = {"level", "functions", "largest error / range", "samples above 2 %", "RMSE / range"}};
  const auto count = b.levels.cols();
  double functions = 0;
  for (Index level = 0; level < count; ++level) {
    functions += b.centers[level];
    table.rows.push_back({static_cast<double>(level), b.centers[level], b.max_errors[level] / sampled.range(),
                          b.above[level], b.rmse[level] / sampled.range()});
  }
  figure.tables.push_back(table);
  figure.pictures.push_back({"original", slice->width, slice->height, slice->values});
  for (const Index level : {Index{0}, count / 2, count - 1}) {
    const std::string name = "level " + std::to_string(level);
    figure.pictures.push_back({name, slice->width, slice->height, b.levels.col(level)});
    figure.pictures.push_back(
        {"error of " + name, slice->width, slice->height, (b.levels.col(level) - slice->values).cwiseAbs()});
  }
  figure.claims = {
      {"largest error at the samples", "below 2 %",
       number(100 * b.largest_error / sampled.range(), 4) + " % of the range",
       verdict(b.largest_error <= b.tolerance * (1 + 1e-9))},
      {"level that reaches it", "6 (the first is 0)", std::to_string(count - 1), verdict(count - 1 <= 6)},
      {"functions in all levels", "not printed",
       number(functions, 6) + " of " + std::to_string(sampled.samples.size()) + " samples", Verdict::not_comparable},
      {"RMSE over all pixels", "not printed", number(100 * b.rmse.back() / sampled.range()) + " % of the range",
       Verdict::not_comparable}};
  return figure;
}

}  // namespace csrbf::thesis
