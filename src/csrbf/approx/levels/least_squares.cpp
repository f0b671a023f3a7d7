#include "csrbf/approx/levels/least_squares.hpp"

#include "csrbf/approx/levels/level_builder.hpp"
#include "csrbf/approx/samples/spacing.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/farthest_points.hpp"

namespace csrbf {
namespace {

constexpr const char* least_squares_function = "least_squares";

void check_least_squares(const LeastSquaresOptions& options) {
  require(options.centers >= 0, least_squares_function, "centers", options.centers,
          "must not be negative; 0 chooses the number");
  require(options.support >= 0 && std::isfinite(options.support), least_squares_function, "support", options.support,
          "must be positive, in spacings of the centres, or 0 for the default");
  require(options.penalty != LevelSolve::interpolation, least_squares_function, "penalty", "interpolation",
          "must be ridge or native; to interpolate use `interpolate` or `multilevel`");
}

template <int Dim>
LevelFit<Dim> fit(LevelBuilder<Dim>& builder, const PointsRef<Dim>& centers, const LeastSquaresOptions& options) {
  const double support = options.support > 0 ? options.support : default_support<Dim>();
  const double radius = support * center_spacing<Dim>(builder.samples().points, centers);
  builder.add(Kernel(options.kernel, Dim), centers, Eigen::VectorXd::Constant(1, radius), options.penalty,
              options.lambda0);
  return builder.finish();
}

}  // namespace

template <int Dim>
LevelFit<Dim> least_squares(const Samples<Dim>& samples, const LeastSquaresOptions& options) {
  check_least_squares(options);
  LevelBuilder<Dim> builder(samples, least_squares_function, options.progress);
  const Points<Dim>& points = builder.samples().points;
  const Index count = options.centers > 0 ? options.centers : std::max<Index>(1, points.cols() / 4);
  const FarthestPoints picks = farthest_points<Dim>(points, count, {.progress = options.progress});
  return fit<Dim>(builder, chosen_points<Dim>(points, picks.indices), options);
}

template <int Dim>
LevelFit<Dim> least_squares(const Samples<Dim>& samples, const PointsRef<Dim>& centers,
                            const LeastSquaresOptions& options) {
  check_least_squares(options);
  require(centers.cols() > 0, least_squares_function, "centers", "none", "at least one centre is needed");
  require(centers.allFinite(), least_squares_function, "centers", "NaN or infinity", "every coordinate must be finite");
  LevelBuilder<Dim> builder(samples, least_squares_function, options.progress);
  return fit<Dim>(builder, centers, options);
}

#define CSRBF_INSTANTIATE(Dim)                                                                \
  template LevelFit<Dim> least_squares<Dim>(const Samples<Dim>&, const LeastSquaresOptions&); \
  template LevelFit<Dim> least_squares<Dim>(const Samples<Dim>&, const PointsRef<Dim>&, const LeastSquaresOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
