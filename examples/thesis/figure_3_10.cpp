#include "figure_3_10.hpp"

#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "signals.hpp"

#include <algorithm>

namespace csrbf::thesis {
namespace {

constexpr Index budget_samples = 500, budget = 40, fine = 801;

// Largest distance of a fine lattice of the box to the centre nearest to it, for every centre; and the largest share of
// its scale at which a place is from some centre.
struct Raster {
  Eigen::VectorXd farthest = Eigen::VectorXd::Zero(budget);
  double uncovered = 0;
};

Raster raster(const Points<2>& centers, const Eigen::VectorXd& scales, const Box<2>& box) {
  Raster found;
  const KdTree<2> tree(centers);
  const Points<2> unit = lattice(fine, 0, 1);
  for (const auto& u : unit.colwise()) {
    const Point<2> p = box.lo + u.cwiseProduct(box.hi - box.lo);
    Index nearest = 0;
    double squared = 0;
    tree.nearest(p, 1, &nearest, &squared);
    found.farthest[nearest] = std::max(found.farthest[nearest], std::sqrt(squared));
    const double least = ((centers.colwise() - p).colwise().norm().transpose().array() / scales.array()).minCoeff();
    found.uncovered = std::max(found.uncovered, least);
  }
  return found;
}

}  // namespace

Figure figure_3_10() {
  Figure figure{.name = "figure-3.10",
                .title = "Figs. 3.10-3.12: furthest points, bounded Voronoi cells, supports",
                .text =
                    "40 of 500 random samples chosen as furthest points (the first is the one nearest to the lower "
                    "left corner), the cells of their Voronoi diagram cut off by the box of the samples, and the "
                    "circles about them that hold their cells (rho = 1). Checked on a lattice of 801 x 801 places."};
  const Points<2> points = random_points<2>(budget_samples, 21);
  const FarthestPoints picks = farthest_points<2>(points, budget);
  const BudgetCenters<2> chosen = budget_centers<2>(points, budget);
  const Points<2> centers = points(Eigen::all, chosen.ids);
  const Box<2> box = bounding_box<2>(points);
  const Raster seen = raster(centers, chosen.scales, box);
  Table samples{.name = "samples", .columns = {"x", "y"}};
  for (const auto& p : points.colwise()) samples.rows.push_back({p.x(), p.y()});
  Table table{.name = "centers", .columns = {"x", "y", "scale", "distance to earlier picks"}};
  for (Index i = 0; i < budget; ++i)
    table.rows.push_back({centers(0, i), centers(1, i), chosen.scales[i], picks.radii[i]});
  const double cell = (box.hi - box.lo).norm() / static_cast<double>(fine - 1);
  const double off = (chosen.scales - seen.farthest).cwiseAbs().maxCoeff();
  const bool falls = std::is_sorted(picks.radii.rbegin(), picks.radii.rend());
  figure.claims = {
      {"each pick is the sample farthest from all before (Fig. 3.10)", "by definition",
       std::string("distances to the picks before ") + (falls ? "never rise" : "rise") + ", from " +
           number(picks.radii[1], 2) + " to " + number(picks.radii.back(), 2),
       verdict(falls)},
      {"the scale is that of the bounded Voronoi cell (3.8, Fig. 3.11)", "by definition",
       "within " + number(off, 1) + " of that of the lattice, whose cells have a diagonal of " + number(cell, 1),
       verdict(off <= cell)},
      {"circles of rho = 1 cover the domain (Fig. 3.12)", "yes",
       "the place covered least is at " + number(seen.uncovered, 6) +
           " of a scale: on a circle, where functions of this support are 0, so rho has to be above 1",
       verdict(seen.uncovered <= 1)}};
  figure.tables = {std::move(samples), std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
