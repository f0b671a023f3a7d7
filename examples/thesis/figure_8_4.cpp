#include "figure_8_4.hpp"

#include "csrbf/implicit/contour_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace csrbf::thesis {
namespace {

constexpr int shown = 25;  // iterations, as in Fig. 8.5

double last_of(const std::vector<double>& values, int count) {
  return *std::max_element(values.end() - count, values.end());
}

Table curves(const Evolution& without, const Evolution& with) {
  Table table{.name = "iterations",
              .columns = {"iteration", "change without", "change with", "energy without", "energy with"}};
  for (std::size_t i = 0; i < shown; ++i)
    table.rows.push_back({static_cast<double>(i + 1), without.coefficient_changes[i], with.coefficient_changes[i],
                          without.energy[i], with.energy[i]});
  return table;
}

// The first iteration from which the energy stays within a part in ten thousand of its last value.
std::size_t at_rest(const std::vector<double>& energy) {
  constexpr double close = 1e-4;
  std::size_t i = energy.size();
  while (i > 0 && std::abs(energy[i - 1] / energy.back() - 1) < close) --i;
  return i + 1;
}

}  // namespace

Evolution evolution(LevelSetBound bound, int iterations) {
  Phantom phantom = holed_shape();
  add_white_noise(phantom.image, 30, 1);
  const Grid& grid = phantom.image.grid;
  const Nodes<2> nodes = regular_nodes<2>(grid, {100, 100});
  const std::vector<std::uint8_t> start = ball_labels(grid, Point<3>(155, 215, 0), 40);
  Evolution made;
  const ForceUpdate force = chan_vese_force(phantom.image, &made.energy);
  CollocationOptions options = published_options();
  options.bound = bound;
  options.eps = 8 / std::numbers::sqrt2;  // 2 sigma in node spacings: sigma = 4 h, and h is half a cell's diagonal
  options.step = 1;
  // It stops when labels are at rest, so it is set going again from where it was.
  while (static_cast<int>(made.coefficient_changes.size()) < iterations) {
    options.iterations = iterations - static_cast<int>(made.coefficient_changes.size());
    CollocationResult<2> result = made.field == nullptr ? collocate<2>(grid, nodes, start.data(), force, options)
                                                        : collocate<2>(grid, nodes, *made.field, force, options);
    options.largest_value = std::numeric_limits<double>::max();  // that of the start, which is not cut off again
    made.coefficient_changes.insert(made.coefficient_changes.end(), result.coefficient_changes.begin(),
                                    result.coefficient_changes.end());
    made.field = result.field;
    made.labels = std::move(result.labels);
    made.support = result.support;
  }
  made.largest = made.field->evaluate(nodes.points).value.cwiseAbs().maxCoeff();
  const ContourLines lines = contour_lines(*made.field, {.resolution = 512});
  made.steepest = made.field->evaluate(lines.points, Derivatives::gradient).gradient.colwise().norm().maxCoeff();
  return made;
}

Figure figure_8_4() {
  Figure figure{.name = "figure-8.4",
                .title = "Figs. 8.4, 8.5: with and without the normalisation (8.28)",
                .text =
                    "The image of Fig. 8.2 at 30 dB, 100 x 100 nodes, support 4 h, eps = 2 sigma. Fig. 8.4: f after "
                    "100 iterations, its inside red, each drawn to its own height. Fig. 8.5: the largest change of "
                    "a coefficient and the energy of two means over 25 iterations. V is scaled to 1, so that "
                    "the numbers on the axes of the thesis are not ours."};
  const Evolution without = evolution(LevelSetBound::none, 100), with = evolution(LevelSetBound::l1_norm, 100);
  figure.tables = {curves(without, with)};
  figure.renders = {{"Fig. 8.4 a: without normalisation", relief(*without.field, without.largest)},
                    {"Fig. 8.4 b: with normalisation", relief(*with.field, with.largest)}};
  figure.claims = {
      {"without normalisation f grows steep", "yes (picture)",
       "|f| to " + number(without.largest / without.support, 2) + " sigma, |grad f| to " + number(without.steepest, 2) +
           " on the contour after 100 iterations",
       verdict(without.steepest > 2)},
      {"with it f stays within [-sigma, sigma]", "yes",
       "|f| to " + number(with.largest / with.support, 2) + " sigma: the bound is loose by orders of magnitude",
       verdict(with.largest <= with.support)},
      {"without it coefficients go on changing", "constant, not zero, after 15 iterations",
       number(last_of(without.coefficient_changes, 10), 2) +
           " pixels in each of the last iterations; the energy rests after " + std::to_string(at_rest(without.energy)),
       verdict(last_of(without.coefficient_changes, 10) > 0.1 * without.coefficient_changes.front())},
      {"with it they come to rest", "5e-3 to about 0",
       number(with.coefficient_changes.front(), 2) + " to " + number(last_of(with.coefficient_changes, 10), 2) +
           " pixels; the energy rests after " + std::to_string(at_rest(with.energy)),
       verdict(last_of(with.coefficient_changes, 10) < 1e-2 * with.coefficient_changes.front())},
      {"both find the same contour", "yes", "Dice of the two " + number(dice(without.labels, with.labels), 4),
       verdict(dice(without.labels, with.labels) > 0.99)}};
  return figure;
}

}  // namespace csrbf::thesis
