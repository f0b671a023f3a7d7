#include "figure_8_6.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace csrbf::thesis {
namespace {

constexpr double along_ratio = 4, along_width = 12, along_support = 2;

// Pixels taken one by one, those closest to the border first, each of which clears a disc around itself.
std::vector<Index> spaced_pixels(const Grid& grid, const std::vector<Index>& order, const std::vector<double>& spacing,
                                 double scale) {
  std::vector<char> taken(order.size(), 0);
  std::vector<Index> chosen;
  for (const Index i : order) {
    if (taken[i] != 0) continue;
    chosen.push_back(i);
    const double radius = scale * spacing[i];
    const auto reach = static_cast<Index>(radius);
    const Index x = i % grid.size[0], y = i / grid.size[0];
    for (Index v = std::max<Index>(0, y - reach); v <= std::min(grid.size[1] - 1, y + reach); ++v)
      for (Index u = std::max<Index>(0, x - reach); u <= std::min(grid.size[0] - 1, x + reach); ++u)
        if (std::hypot(static_cast<double>(u - x), static_cast<double>(v - y)) < radius) taken[grid.index(u, v)] = 1;
  }
  return chosen;
}

RgbImage dotted(RgbImage picture, const Nodes<2>& nodes, Index image_width) {
  const int zoom = picture.width / static_cast<int>(image_width);
  for (Index i = 0; i < nodes.points.cols(); ++i) {
    const int x = static_cast<int>(zoom * (nodes.points(0, i) + 0.5)),
              y = static_cast<int>(zoom * (nodes.points(1, i) + 0.5));
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        const int u = std::min(x + dx, picture.width - 1), v = std::min(y + dy, picture.height - 1);
        const auto at = static_cast<std::size_t>(3 * (u + picture.width * v));
        picture.pixels[at] = 80, picture.pixels[at + 1] = 220, picture.pixels[at + 2] = 255;
      }
  }
  return picture;
}

}  // namespace

Nodes<2> nodes_along(const Grid& grid, const std::vector<std::uint8_t>& shape, Index count, double ratio,
                     double width) {
  require(count >= 16, "nodes_along", "count", count, "must be at least 16");
  std::vector<float> distance = signed_distance(grid, shape.data());
  for (float& d : distance) d = std::abs(d);
  std::vector<Index> order(distance.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return distance[a] < distance[b]; });
  std::vector<double> spacing(distance.size());
  std::transform(distance.begin(), distance.end(), spacing.begin(),
                 [&](double d) { return 1 + (ratio - 1) * std::min(1.0, d / width); });
  double least = 0.5, most = std::sqrt(static_cast<double>(grid.voxels()) / static_cast<double>(count)) * 2;
  std::vector<Index> best = spaced_pixels(grid, order, spacing, most);
  constexpr int bisections = 14;
  const auto off = [count](const std::vector<Index>& ids) { return std::abs(static_cast<Index>(ids.size()) - count); };
  for (int k = 0; k < bisections; ++k) {
    const double scale = 0.5 * (least + most);
    std::vector<Index> ids = spaced_pixels(grid, order, spacing, scale);
    (static_cast<Index>(ids.size()) > count ? least : most) = scale;
    if (off(ids) < off(best)) best.swap(ids);
  }
  return {grid.centers<2>()(Eigen::all, best), {}};
}

Nodes<2> triangular_nodes(const Grid& grid, Index count) {
  const auto width = static_cast<double>(grid.size[0] - 1), height = static_cast<double>(grid.size[1] - 1);
  const double side = std::sqrt(width * height / static_cast<double>(count) * 2 / std::sqrt(3.0));
  const auto rows = static_cast<Index>(std::lround(height / (side * std::sqrt(3.0) / 2))) + 1;
  const auto columns = static_cast<Index>(std::lround(width / side)) + 1;
  std::vector<Point<2>> points;
  for (Index j = 0; j < rows; ++j) {
    const double y = height * static_cast<double>(j) / static_cast<double>(rows - 1);
    const double step = width / static_cast<double>(columns - 1);
    // Rows in between are shifted by half a side, and end at the border.
    if (j % 2 == 1) points.emplace_back(0, y);
    for (Index i = 0; i + j % 2 < columns; ++i)
      points.emplace_back((static_cast<double>(i) + (j % 2 == 1 ? 0.5 : 0)) * step, y);
    if (j % 2 == 1) points.emplace_back(width, y);
  }
  Nodes<2> nodes{Points<2>(2, static_cast<Index>(points.size())), {}};
  for (std::size_t i = 0; i < points.size(); ++i) nodes.points.col(static_cast<Index>(i)) = points[i];
  return nodes;
}

SegmentedImage star_run(const Phantom& star, const Nodes<2>& nodes, double rho) {
  const std::vector<std::uint8_t> start = ball_labels(star.image.grid, Point<3>(222.5, 222.5, 0), 100);
  return collocate_nodes(star, nodes, start, published_options(rho));
}

Figure figure_8_6() {
  Figure figure{.name = "figure-8.6",
                .title = "Figs. 8.6, 8.7: number and places of the centres",
                .text =
                    "A made star of eleven rays in 446 x 446 pixels, without noise. Collocation with normalisation; "
                    "support 4 h on lattices. Along a shape known before (here the truth itself, as in the thesis) "
                    "nodes are up to four times as dense within 12 pixels of its border; there h is that of the "
                    "widest gap, and the support 2 h. segment() has lattices only; its column is for the same "
                    "spacing."};
  const Phantom image = star();
  const Grid& grid = image.image.grid;
  Table table{.name = "centres", .columns = {"kind", "centers", "Dice, collocation", "Dice, segment()", "time [s]"}};
  std::vector<double> dices;
  for (const Index n : {20, 40, 150}) {
    const SegmentedImage run = star_run(image, regular_nodes<2>(grid, {n, n}), 4);
    SegmentOptions options;
    options.center_spacing = 445.0 / static_cast<double>(n - 1);
    const SegmentedImage ours = segmented(image, options);
    table.rows.push_back({0, static_cast<double>(n * n), run.dice, ours.dice, run.seconds});
    dices.push_back(run.dice);
    figure.renders.push_back({std::to_string(n) + " x " + std::to_string(n) + " centres, Dice " + number(run.dice, 4),
                              drawn(image.image, {run.field.get()})});
  }
  const Nodes<2> triangles = triangular_nodes(grid, 1600);
  const SegmentedImage triangular = star_run(image, triangles, 4);
  table.rows.push_back({1, static_cast<double>(triangles.points.cols()), triangular.dice, 0, triangular.seconds});
  std::vector<double> along;
  for (const Index count : {5000, 10000}) {
    const Nodes<2> nodes = nodes_along(grid, image.truth, count, along_ratio, along_width);
    const SegmentedImage run = star_run(image, nodes, along_support);
    const auto found = static_cast<double>(nodes.points.cols());
    table.rows.push_back({2, found, run.dice, 0, run.seconds});
    along.push_back(run.dice);
    const RgbImage picture = drawn(image.image, {run.field.get()});
    figure.renders.push_back({number(found, 5) + " centres along the border", dotted(picture, nodes, grid.size[0])});
    figure.renders.push_back({number(found, 5) + " centres, Dice " + number(run.dice, 4), picture});
  }
  figure.tables = {std::move(table)};
  figure.claims = {
      {"more centres are more accurate (Fig. 8.6)", "yes",
       "Dice " + number(dices[0], 4) + ", " + number(dices[1], 4) + ", " + number(dices[2], 4) +
           " for 20^2, 40^2, 150^2",
       verdict(dices[0] < dices[1] && dices[1] < dices[2])},
      {"10,000 centres along the shape match 22,500 on a lattice (Fig. 8.7)", "qualitatively",
       "Dice " + number(along[1], 4) + " against " + number(dices[2], 4), verdict(along[1] > dices[2] - 1e-3)},
      {"more of them are better (Fig. 8.7)", "yes", "Dice " + number(along[0], 4) + ", " + number(along[1], 4),
       verdict(along[0] < along[1])},
      {"lattices of squares or triangles (Fig. 8.1)", "either",
       "Dice " + number(dices[1], 4) + " and " + number(triangular.dice, 4) + " with 40^2 nodes",
       Verdict::not_comparable}};
  return figure;
}

}  // namespace csrbf::thesis
