#include "figure_7_1.hpp"

namespace csrbf::thesis {
namespace {

const Point<3> around(155, 155, 0);
constexpr double around_radius = 140;

}  // namespace

SegmentedImage active_contour(int steps) {
  const Phantom phantom = holed_shape();
  CollocationOptions options;
  options.eps = 1.25;
  options.step = 0.5;
  options.iterations = steps;
  return collocate_nodes(phantom, regular_nodes<2>(phantom.image.grid, {100, 100}),
                         ball_labels(phantom.image.grid, around, around_radius), options);
}

Figure figure_7_1() {
  Figure figure{.name = "figure-7.1",
                .title = "Figs. 7.1-7.3: an active contour and the function behind it",
                .text =
                    "Two means, a delta of 1.25 node spacings, f cut off at 3 spacings, from a circle around the "
                    "object: the contour changes its topology by itself. Left the image with the contour, right f, "
                    "its inside red. The thesis moves f by finite differences; here by collocation."};
  const Phantom phantom = holed_shape();
  Table table{.name = "steps", .columns = {"step", "Dice"}};
  double before = 0;
  bool rising = true;
  for (const int steps : {0, 20, 30, 150}) {
    const SegmentedImage run = active_contour(steps);
    const std::string step = "step " + std::to_string(run.iterations);
    table.rows.push_back({static_cast<double>(run.iterations), run.dice});
    rising = rising && run.dice > before;
    before = run.dice;
    const double height = 3 * 310.0 / 99;
    figure.renders.push_back({step, drawn(phantom.image, {run.field.get()})});
    figure.renders.push_back({step + ", f", relief(*run.field, height)});
  }
  figure.claims = {{"a contour around the object finds it and both holes", "yes (picture)",
                    "Dice " + number(before, 4) + " after " + number(table.rows.back()[0]) + " steps",
                    verdict(rising && before > 0.99)}};
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
