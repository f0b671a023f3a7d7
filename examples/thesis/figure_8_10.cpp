#include "figure_8_10.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/volume.hpp"
#include "signals.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf::thesis {
namespace {

constexpr int half_window = 3;
constexpr int many = 200;  // iterations
const Point<3> wall_start(20, 84, 0);
constexpr double wall_radius = 9;

void add_wall(Figure& figure, const Phantom& wall) {
  const auto start = disc_field(wall.image.grid, wall_start.head<2>(), wall_radius);
  const SegmentedImage during = wall_run(wall, 1), last = wall_run(wall, many);
  figure.renders.push_back({"Fig. 8.10 a: start", drawn(wall.image, {start.get()})});
  figure.renders.push_back({"b: after 1 iteration", drawn(wall.image, {during.field.get()})});
  figure.renders.push_back({"c: after " + std::to_string(last.iterations) + ", Dice " + number(last.dice, 3),
                            drawn(wall.image, {last.field.get()})});
  figure.claims.push_back({"600 nodes find all borders of blood and tissue from a start in the cavity", "yes (picture)",
                           "Dice " + number(last.dice, 3) + " in " + number(last.seconds, 2) + " s",
                           verdict(last.dice > 0.95)});
}

struct Law {
  const char* name;
  SegmentEnergy energy;
  int half_window;
};

void add_cavities(Figure& figure) {
  constexpr Law laws[] = {{"two means, no window", SegmentEnergy::chan_vese, 0},
                          {"two means", SegmentEnergy::chan_vese, half_window},
                          {"Rayleigh", SegmentEnergy::rayleigh, half_window},
                          {"gamma", SegmentEnergy::gamma, half_window},
                          {"generalised Gaussian", SegmentEnergy::generalized_gaussian, half_window}};
  Table table{.name = "laws", .columns = {"seed"}};
  for (const Law& law : laws) table.columns.emplace_back(law.name);
  std::vector<double> means;
  constexpr unsigned seeds = 5;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Phantom cavities = speckled_cavities(seed);
    table.rows.push_back({static_cast<double>(seed)});
    for (const Law& law : laws) {
      const SegmentedImage run = speckle_run(cavities, law.energy, law.half_window);
      table.rows.back().push_back(run.dice);
      if (seed == 1 && law.energy == SegmentEnergy::generalized_gaussian)
        figure.renders.push_back(
            {"segment(), generalised Gaussian, Dice " + number(run.dice, 3), drawn(cavities.image, {run.field.get()})});
    }
  }
  for (std::size_t column = 1; column < table.columns.size(); ++column) {
    means.push_back(0);
    for (const auto& row : table.rows) means.back() += row[column] / seeds;
  }
  constexpr double no_difference = 2e-3;
  const double gain = means[4] - means[1];
  figure.claims.push_back({"generalised Gaussians over a window (8.32) suit speckle", "yes (picture)",
                           "Dice " + number(means[4], 4) + " (mean of " + std::to_string(seeds) +
                               " seeds); two means over the same window " + number(means[1], 4) + ", without window " +
                               number(means[0], 4) +
                               (gain < no_difference ? ": the law makes no difference" : ": these laws undo the blur"),
                           verdict(gain >= no_difference)});
  figure.tables = {std::move(table)};
}

void add_file(Figure& figure, const std::string& path) {
  const auto image = read_volume<float>(path);
  SegmentOptions options;
  options.energy = SegmentEnergy::generalized_gaussian;
  options.window = half_window;
  // What lies outside the sector has the least value, and takes no part.
  const float least = *std::min_element(image.values.begin(), image.values.end());
  for (const float value : image.values) options.mask.push_back(value > least ? 1 : 0);
  const Segmentation<2> found = segment<2>(image, options);
  figure.renders.push_back({"segment() of the image given", drawn(image, {found.fields[0].get()})});
}

}  // namespace

SegmentedImage wall_run(const Phantom& wall, int iterations) {
  CollocationOptions options = published_options();
  options.iterations = iterations;
  return collocate_nodes(wall, regular_nodes<2>(wall.image.grid, {10, 60}),
                         ball_labels(wall.image.grid, wall_start, wall_radius), options,
                         generalized_gaussian_force(wall.image, half_window));
}

SegmentedImage speckle_run(const Phantom& phantom, SegmentEnergy energy, int window) {
  const Grid& grid = phantom.image.grid;
  SegmentOptions options;
  options.energy = energy;
  options.window = window;
  options.seed = ball_labels(
      grid, Point<3>(0.5 * static_cast<double>(grid.size[0]), 0.5 * static_cast<double>(grid.size[1]), 0), 15);
  return segmented(phantom, options);
}

Figure figure_8_10(const std::string& ultrasound) {
  Figure figure{.name = "figure-8.10",
                .title = "Figs. 8.10, 8.11: echocardiography with generalised Gaussians",
                .text =
                    "The thesis's images are not at hand. Ours are made: log-compressed speckle, 40 lines of 249 "
                    "samples with a cavity between two walls (the size of the thesis's, 60 x 10 nodes), and 249 x "
                    "249 pixels with two cavities. Forces (8.32) averaged over boxes of 7 x 7 pixels. An image of "
                    "yours is segmented too when it is given (--ultrasound FILE)."};
  add_wall(figure, speckled_wall(1));
  add_cavities(figure);
  if (!ultrasound.empty()) add_file(figure, ultrasound);
  return figure;
}

}  // namespace csrbf::thesis
