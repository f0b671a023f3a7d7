#include "csrbf/approx/levels/error_bounded.hpp"

#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"

#include <sstream>

namespace csrbf {
namespace {

constexpr const char* function = "error_bounded";
constexpr double roundings = 8;  // of the largest value, in a sum of a few levels; chosen by hand

void check(const ErrorBoundedOptions& options) {
  require(options.centers >= 0, function, "centers", options.centers, "must not be negative; 0 chooses the number");
  require(options.support > 1 && std::isfinite(options.support), function, "support", options.support,
          "must be above 1, or the supports do not cover the domain; 2 to 4 is usual");
  require(options.reduction > 0 && options.reduction < 1, function, "reduction", options.reduction,
          "must lie between 0 and 1");
  require(options.max_levels >= 1, function, "max_levels", options.max_levels, "must be at least 1");
}

// The picks from number `begin` on that are at least `separation` apart and not yet within the tolerance. `begin`
// moves behind them.
template <int Dim>
std::vector<Index> next_centers(const LevelBuilder<Dim>& builder, const FarthestPoints& picks, double separation,
                                double tolerance, std::size_t& begin) {
  std::vector<Index> ids;
  for (; begin < picks.indices.size() && picks.radii[begin] >= separation; ++begin)
    if (builder.error(picks.indices[begin]) > tolerance) ids.push_back(picks.indices[begin]);
  return ids;
}

}  // namespace

template <int Dim>
double checked_tolerance(const LevelBuilder<Dim>& builder, std::optional<double> tolerance, const char* caller) {
  constexpr double default_share = 0.01;  // of the range of the values, conventional
  const double bound = tolerance.value_or(std::max(default_share * builder.range(), builder.spread()));
  require(bound >= 0 && std::isfinite(bound), caller, "tolerance", bound, "must be finite and not negative");
  if (builder.spread() > bound) {
    std::ostringstream message;
    message << caller << ": tolerance = " << bound << ": samples at the same point differ by " << 2 * builder.spread()
            << ", so no function is within it; allow at least " << builder.spread() << " or merge them";
    throw SolverFailure(message.str());
  }
  const double largest = builder.samples().values.cwiseAbs().maxCoeff();
  const double rounding = roundings * std::numeric_limits<double>::epsilon() * largest;
  if (bound > 0 && tolerance && bound < rounding) {
    std::ostringstream message;
    message << caller << ": tolerance = " << bound << ": values of up to " << largest
            << " do not have that many digits; allow at least " << rounding;
    throw SolverFailure(message.str());
  }
  return bound;
}

template <int Dim>
LevelFit<Dim> error_bounded(const Samples<Dim>& samples, const ErrorBoundedOptions& options) {
  check(options);
  LevelBuilder<Dim> builder(samples, function, options.progress, DuplicateValue::midrange);
  const double tolerance = checked_tolerance(builder, options.tolerance, function);
  const Kernel kernel(options.kernel, Dim);
  const Points<Dim>& points = builder.samples().points;

  const Index budget = std::min(points.cols(), options.centers > 0 ? options.centers : (points.cols() + 49) / 50);
  const BudgetCenters<Dim> coarse = budget_centers<Dim>(points, budget, options.progress);
  builder.add(kernel, chosen_points<Dim>(points, coarse.ids), options.support * coarse.scales, LevelSolve::ridge,
              options.lambda0);
  if (builder.max_error() > tolerance) {
    const FarthestPoints picks = farthest_points<Dim>(points, points.cols(), {.progress = options.progress});
    auto begin = static_cast<std::size_t>(budget);
    while (begin < picks.indices.size() && builder.levels() < options.max_levels && builder.max_error() > tolerance) {
      report(options.progress, "levels", static_cast<double>(begin) / static_cast<double>(points.cols()));
      // Separation distance of the picks so far, of which the first has none; where the next pick is even closer, that
      // of the next.
      const double separation =
          std::min(begin > 1 ? options.reduction * picks.radii[begin - 1] : picks.radii[begin], picks.radii[begin]);
      const std::vector<Index> ids = next_centers(builder, picks, separation, tolerance, begin);
      if (ids.empty()) continue;
      builder.add(kernel, chosen_points<Dim>(points, ids),
                  Eigen::VectorXd::Constant(1, options.support * picks.radii[begin - 1]), LevelSolve::ridge,
                  options.lambda0);
    }
  }
  const std::vector<Index> rest = builder.violations(tolerance);
  if (!rest.empty()) builder.add_diagonal(kernel, rest);
  return builder.finish(tolerance);
}

#define CSRBF_INSTANTIATE(Dim)                                                                          \
  template double checked_tolerance<Dim>(const LevelBuilder<Dim>&, std::optional<double>, const char*); \
  template LevelFit<Dim> error_bounded<Dim>(const Samples<Dim>&, const ErrorBoundedOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
