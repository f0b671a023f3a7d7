#include "csrbf/approx/levels/fixed_budget.hpp"

#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/spatial/bounded_voronoi.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"

namespace csrbf {

template <int Dim>
BudgetCenters<Dim> budget_centers(const PointsRef<Dim>& points, Index count, const Progress& progress) {
  BudgetCenters<Dim> chosen;
  chosen.ids = farthest_points<Dim>(points, count, {.progress = progress}).indices;
  const Points<Dim> centers = chosen_points<Dim>(points, chosen.ids);
  constexpr int most_dimensions_of_exact_cells = 4;  // beyond, cells have too many corners: bounded_voronoi_scales()
  if constexpr (Dim <= most_dimensions_of_exact_cells)
    chosen.scales = bounded_voronoi_scales<Dim>(centers, bounding_box<Dim>(points), progress);
  else
    chosen.scales = discrete_voronoi_scales<Dim>(centers, points);
  for (Index j = 0; j < centers.cols(); ++j)
    if (!(chosen.scales[j] > 0)) chosen.scales[j] = center_spacing<Dim>(centers.col(j), centers);
  return chosen;
}

template <int Dim>
LevelFit<Dim> fixed_budget(const Samples<Dim>& samples, const FixedBudgetOptions& options) {
  constexpr const char* function = "fixed_budget";
  require(options.centers >= 0, function, "centers", options.centers, "must not be negative; 0 chooses the number");
  require(options.support > 1 && std::isfinite(options.support), function, "support", options.support,
          "must be above 1, or the supports do not cover the domain; 2 to 4 is usual");
  LevelBuilder<Dim> builder(samples, function, options.progress);
  const Points<Dim>& points = builder.samples().points;
  const Index budget = options.centers > 0 ? options.centers : std::max<Index>(1, points.cols() / 10);
  const BudgetCenters<Dim> chosen = budget_centers<Dim>(points, budget, options.progress);
  builder.add(Kernel(options.kernel, Dim), chosen_points<Dim>(points, chosen.ids), options.support * chosen.scales,
              LevelSolve::ridge, options.lambda0);
  return builder.finish();
}

#define CSRBF_INSTANTIATE(Dim)                                                                    \
  template BudgetCenters<Dim> budget_centers<Dim>(const PointsRef<Dim>&, Index, const Progress&); \
  template LevelFit<Dim> fixed_budget<Dim>(const Samples<Dim>&, const FixedBudgetOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
