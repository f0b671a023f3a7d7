#include "figure_8_1.hpp"

#include "figure_8_6.hpp"
#include "signals.hpp"

#include <cmath>

namespace csrbf::thesis {

Figure figure_8_1() {
  constexpr Index pixels = 100, count = 15;
  Figure figure{.name = "figure-8.1",
                .title = "Fig. 8.1: lattices of centres",
                .text =
                    "Squares and triangles with about as many nodes on an image of 100 x 100 pixels. The fill distance "
                    "(3.7) is the radius of the largest circle without a node; supports are multiples of it (8.17)."};
  Grid grid;
  grid.size = {pixels, pixels, 1};
  const Nodes<2> squares = regular_nodes<2>(grid, {count, count}), triangles = triangular_nodes(grid, count * count);
  const Points<2> domain = lattice(10 * pixels, 0, pixels - 1);
  const auto add = [&](const std::string& name, const Nodes<2>& nodes) {
    Table table{.name = name, .columns = {"x", "y"}};
    for (const auto& p : nodes.points.colwise()) table.rows.push_back({p.x(), p.y()});
    figure.tables.push_back(std::move(table));
    return fill_distance<2>({nodes.points, {}}, domain);
  };
  const double of_squares = add("squares", squares), of_triangles = add("triangles", triangles);
  const auto unitless = [](double fill, const Nodes<2>& nodes) {
    return fill * std::sqrt(static_cast<double>(nodes.points.cols())) / pixels;
  };
  const double of_unit_squares = unitless(of_squares, squares), of_unit_triangles = unitless(of_triangles, triangles);
  figure.claims = {{"centres may be on lattices of squares or of triangles", "yes (scheme)",
                    "fill distance " + number(of_squares) + " pixels with " + std::to_string(squares.points.cols()) +
                        " nodes on squares, " + number(of_triangles) + " with " +
                        std::to_string(triangles.points.cols()) +
                        " on triangles; times the root of the nodes over the side of the image " +
                        number(of_unit_squares, 2) + " and " + number(of_unit_triangles, 2),
                    verdict(of_unit_triangles < of_unit_squares)}};
  return figure;
}

}  // namespace csrbf::thesis
