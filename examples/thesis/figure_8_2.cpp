#include "figure_8_2.hpp"

#include <cmath>
#include <limits>

namespace csrbf::thesis {
namespace {

constexpr unsigned seeds = 5;
constexpr double no_noise = std::numeric_limits<double>::infinity();
constexpr double first_radius = 40;
const Point<3> first_center(155, 215, 0);  // in the object, over the rim of a hole

Phantom noisy_shape(double snr, unsigned seed) {
  Phantom phantom = holed_shape();
  if (std::isfinite(snr)) add_white_noise(phantom.image, snr, seed);
  return phantom;
}

std::vector<std::uint8_t> first_labels(const Phantom& phantom) {
  return ball_labels(phantom.image.grid, first_center, first_radius);
}

struct Average {
  double sum = 0, least = 1, seconds = 0;
  int runs = 0;
  void add(const SegmentedImage& run) {
    sum += run.dice, seconds += run.seconds, ++runs;
    least = std::min(least, run.dice);
  }
  [[nodiscard]] double mean() const { return sum / runs; }
};

std::string words(double snr) {
  return std::isfinite(snr) ? number(snr) + " dB" : "no noise";
}

void draw_case(Figure& figure, double snr) {
  const Phantom phantom = noisy_shape(snr, 1);
  const NoiseCase found = noise_case(snr, 1);
  if (std::isinf(snr)) {
    const auto start = disc_field(phantom.image.grid, first_center.head<2>(), first_radius);
    figure.renders.push_back({"start", drawn(phantom.image, {start.get()})});
  }
  figure.renders.push_back({words(snr) + ", collocation", drawn(phantom.image, {found.published.field.get()})});
  figure.renders.push_back({words(snr) + ", segment()", drawn(phantom.image, {found.ours.field.get()})});
}

void add_supports(Figure& figure) {
  constexpr double snr = 20;
  Table table{.name = "supports", .columns = {"rho", "Dice", "length [pixels]", "time [s]"}};
  std::vector<double> lengths;
  for (const double rho : {4.0, 8.0, 16.0}) {
    const SegmentedImage run = with_support(snr, rho, 1);
    lengths.push_back(contour_length(*run.field));
    table.rows.push_back({rho, run.dice, lengths.back(), run.seconds});
    figure.renders.push_back({"20 dB, rho = " + number(rho), drawn(noisy_shape(snr, 1).image, {run.field.get()})});
  }
  constexpr double no_difference = 1e-3;
  const double change = lengths.back() / lengths.front() - 1;
  figure.claims.push_back({"larger supports smooth the contour (Fig. 8.3)", "yes",
                           "the length of the contour changes by " + number(100 * change, 2) +
                               " % from rho = 4 to 16: values at the nodes do not depend on the support",
                           verdict(change < -no_difference)});
  figure.tables.push_back(std::move(table));
}

}  // namespace

NoiseCase noise_case(double snr, unsigned seed) {
  const Phantom phantom = noisy_shape(snr, seed);
  const std::vector<std::uint8_t> start = first_labels(phantom);
  return {snr, collocate_nodes(phantom, regular_nodes<2>(phantom.image.grid, {100, 100}), start, published_options()),
          segmented(phantom, {})};
}

SegmentedImage with_support(double snr, double rho, unsigned seed) {
  const Phantom phantom = noisy_shape(snr, seed);
  return collocate_nodes(phantom, regular_nodes<2>(phantom.image.grid, {100, 100}), first_labels(phantom),
                         published_options(rho));
}

Figure figure_8_2() {
  Figure figure{.name = "figure-8.2",
                .title = "Figs. 8.2, 8.3: a shape with two holes under noise; supports",
                .text =
                    "A made image of the size of the thesis's (311 x 311, edges blurred by 3 pixels) with white "
                    "noise of 30, 20 and 10 dB (10 log10 of the ratio of variances), " +
                    std::to_string(seeds) +
                    " seeds each. Collocation: 100 x 100 nodes, support 4 h, normalisation (8.28), signs of the "
                    "errata, velocities averaged around the nodes. segment(): its defaults. Dice: overlap with "
                    "the regions that the image was made from. The thesis shows pictures only."};
  Table table{.name = "noise",
              .columns = {"SNR [dB]", "Dice, collocation", "Dice, segment()", "least, collocation", "least, segment()",
                          "time, collocation [s]", "time, segment() [s]"}};
  for (const double snr : {no_noise, 30.0, 20.0, 10.0}) {
    Average published, ours;
    for (unsigned seed = 1; seed <= (std::isfinite(snr) ? seeds : 1); ++seed) {
      const NoiseCase found = noise_case(snr, seed);
      published.add(found.published);
      ours.add(found.ours);
    }
    table.rows.push_back({std::isfinite(snr) ? snr : 99, published.mean(), ours.mean(), published.least, ours.least,
                          published.seconds / published.runs, ours.seconds / ours.runs});
    const bool shown = std::isinf(snr) || snr >= 20;
    constexpr double correct = 0.99;
    figure.claims.push_back(
        {words(snr) + ": segmented correctly, holes included", shown ? "yes" : "-",
         "Dice " + number(published.mean(), 4) + " (collocation), " + number(ours.mean(), 4) + " (segment())",
         verdict(published.least > correct && ours.least > correct)});
    draw_case(figure, snr);
  }
  figure.tables.push_back(std::move(table));
  add_supports(figure);
  return figure;
}

}  // namespace csrbf::thesis
