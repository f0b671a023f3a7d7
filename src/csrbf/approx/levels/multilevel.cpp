#include "csrbf/approx/levels/multilevel.hpp"

#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"

namespace csrbf {
namespace {

constexpr const char* multilevel_function = "multilevel";

void check_multilevel(const MultilevelOptions& options) {
  require(options.support >= 0 && std::isfinite(options.support), multilevel_function, "support", options.support,
          "must be positive, in separation distances, or 0 for the default");
  require(options.coarsest >= 0, multilevel_function, "coarsest", options.coarsest, "must not be negative");
  require(options.centers >= 0, multilevel_function, "centers", options.centers,
          "must not be negative; 0 takes all samples");
  require(options.max_levels > 0, multilevel_function, "max_levels", options.max_levels, "must be at least 1");
  require(options.tolerance >= 0, multilevel_function, "tolerance", options.tolerance, "must not be negative");
}

template <int Dim>
Index default_coarsest() {
  Index count = 2;
  for (int axis = 0; axis < Dim; ++axis) count *= 3;
  return count;
}

// Number of picks that are at least `radius` from those before them.
Index count_down_to(const FarthestPoints& picks, double radius) {
  const auto end = std::partition_point(picks.radii.begin(), picks.radii.end(), [&](double r) { return r >= radius; });
  return end - picks.radii.begin();
}

}  // namespace

template <int Dim>
LevelFit<Dim> multilevel(const Samples<Dim>& samples, const MultilevelOptions& options) {
  check_multilevel(options);
  LevelBuilder<Dim> builder(samples, multilevel_function, options.progress);
  const Kernel kernel(options.kernel, Dim);
  const double support = options.support > 0 ? options.support : default_support<Dim>();
  const Points<Dim>& points = builder.samples().points;
  const Index most = options.centers > 0 ? std::min(options.centers, points.cols()) : points.cols();
  const FarthestPoints picks = farthest_points<Dim>(points, most, {.progress = options.progress});

  Index count = std::min(most, options.coarsest > 0 ? options.coarsest : default_coarsest<Dim>());
  for (Index level = 0; level < options.max_levels; ++level) {
    report(options.progress, "levels", static_cast<double>(count) / static_cast<double>(most));
    // The last radius is the separation distance of the picks; one pick has none.
    const double separation = count > 1 ? picks.radii[static_cast<std::size_t>(count) - 1]
                                        : center_spacing<Dim>(points, points.col(picks.indices[0]));
    const std::vector<Index> ids(picks.indices.begin(), picks.indices.begin() + count);
    builder.add(kernel, chosen_points<Dim>(points, ids), Eigen::VectorXd::Constant(1, support * separation),
                options.solve, options.lambda0);
    if (count == most || builder.max_error() <= options.tolerance) break;
    // At least one more centre, also where the density jumps.
    count = std::max(count_down_to(picks, 0.5 * separation), count + 1);
  }
  return builder.finish(options.tolerance > 0 ? options.tolerance : std::numeric_limits<double>::infinity());
}

#define CSRBF_INSTANTIATE(Dim) template LevelFit<Dim> multilevel<Dim>(const Samples<Dim>&, const MultilevelOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
