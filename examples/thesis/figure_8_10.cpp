#include "figure_8_10.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/volume.hpp"
#include "signals.hpp"

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

void add_cavities(Figure& figure) {
  Table table{.name = "laws", .columns = {"seed", "chan-vese", "rayleigh", "gamma", "generalized-gaussian"}};
  std::vector<double> means(5, 0.0);
  constexpr unsigned seeds = 5;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Phantom cavities = speckled_cavities(seed);
    std::vector<double> row{static_cast<double>(seed)};
    for (const SegmentEnergy energy : {SegmentEnergy::chan_vese, SegmentEnergy::rayleigh, SegmentEnergy::gamma,
                                       SegmentEnergy::generalized_gaussian}) {
      const SegmentedImage run = speckle_run(cavities, energy);
      row.push_back(run.dice);
      if (seed == 1 && energy == SegmentEnergy::generalized_gaussian)
        figure.renders.push_back(
            {"segment(), generalised Gaussian, Dice " + number(run.dice, 3), drawn(cavities.image, {run.field.get()})});
    }
    for (std::size_t i = 1; i < row.size(); ++i) means[i] += row[i] / seeds;
    table.rows.push_back(std::move(row));
  }
  figure.claims.push_back({"generalised Gaussians suit speckle (8.32)", "yes",
                           "Dice " + number(means[4], 4) + ", two means " + number(means[1], 4) + " (mean of " +
                               std::to_string(seeds) + " seeds)",
                           verdict(means[4] >= means[1])});
  figure.tables = {std::move(table)};
}

void add_file(Figure& figure, const std::string& path) {
  const auto image = read_volume<float>(path);
  SegmentOptions options;
  options.energy = SegmentEnergy::generalized_gaussian;
  options.window = half_window;
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

SegmentedImage speckle_run(const Phantom& phantom, SegmentEnergy energy) {
  const Grid& grid = phantom.image.grid;
  SegmentOptions options;
  options.energy = energy;
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
                    "249 pixels with two cavities. Forces (8.32) averaged over boxes of 7 x 7 pixels. Another "
                    "image is segmented too when csrbf-thesis is given --ultrasound FILE."};
  add_wall(figure, speckled_wall(1));
  add_cavities(figure);
  if (!ultrasound.empty()) add_file(figure, ultrasound);
  return figure;
}

}  // namespace csrbf::thesis
