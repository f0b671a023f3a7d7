#include "csrbf/surface/medial/medial_axis.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/medial/quadric_fitter.hpp"
#include "csrbf/surface/medial/slope_penalty.hpp"

#include <utility>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index samples_per_center = 8, fewest_centers = 500, most_centers = 10000;  // default number of centres
constexpr Index rows_per_center = 40;  // samples per centre that the coefficients are fitted to; more: slower
constexpr double thinnest = 12;        // least support, in rms residuals of its quadric: wider ones average out noise
constexpr double growth = 1.4;         // factor on a support that is too small ...
constexpr int most_growths = 6;        // ... applied at most this often: 7.5 in all
constexpr double winding_smoothing = 0.7;  // spacings: the least that leaves no bumps between centres
constexpr double far_spacings = 1.5;       // spacings: |f| where the winding number takes over

void check(const OrientedPoints& cloud, const MedialAxisOptions& options) {
  constexpr const char* function = "fit_medial_axis";
  require(cloud.size() > 0, function, "cloud", "empty", "at least one sample is needed");
  require(options.centers >= 0, function, "centers", options.centers, "must be positive, or 0 for the default");
  require(!options.smoothing || *options.smoothing >= 0, function, "smoothing", options.smoothing.value_or(0),
          "must not be negative");
}

// In the order of the cloud, in which neighbours follow each other.
std::vector<Index> choose_centers(const OrientedPoints& cloud, const MedialAxisOptions& options) {
  std::vector<Index> centers = options.center_indices;
  if (centers.empty()) {
    const Index few = std::min(fewest_centers, cloud.size());
    const Index budget =
        options.centers > 0 ? options.centers : std::clamp(cloud.size() / samples_per_center, few, most_centers);
    centers = farthest_points<3>(cloud.points, budget, {.progress = options.progress}).indices;
  }
  std::sort(centers.begin(), centers.end());
  return centers;
}

// On the surface the winding number is 1/2. Noise spreads the centres over a slab, where the total area of their cells
// exceeds that of the surface: areas are scaled down accordingly.
WindingNumber calibrated_winding(WindingNumber::Data centers) {
  WindingNumber winding(centers);
  Eigen::VectorXd u = winding.evaluate(centers.points).value;
  const double usual = median(u);
  if (usual <= 0) return winding;
  centers.areas /= usual + 1;
  return WindingNumber(centers);
}

}  // namespace

MedialAxisFit fit_medial_axis(const OrientedPoints& cloud, const KdTree<3>& tree, const MedialAxisOptions& options) {
  check(cloud, options);
  const std::vector<Index> chosen = choose_centers(cloud, options);
  const auto M = static_cast<Index>(chosen.size());
  MedialAxisField::Data data;
  data.centers = cloud.points(Eigen::all, chosen);
  const Points<3> normals = cloud.normals(Eigen::all, chosen);

  report(options.progress, "poles", 0);
  MedialSupports supports = medial_supports(data.centers, normals, cloud.points);
  data.supports = std::move(supports.supports);

  report(options.progress, "fit", 0);
  data.quadrics.resize(10, M);
  parallel_for(M, 16, [&](Index begin, Index end) {
    QuadricFitter fitter(cloud, tree);
    for (Index i = begin; i < end; ++i) {
      const Point<3> center = data.centers.col(i);
      data.quadrics.col(i) = fitter.fit(center, data.supports[i]);
      for (int k = 0; k < most_growths && data.supports[i] < thinnest * fitter.residual(); ++k)
        data.quadrics.col(i) = fitter.fit(center, data.supports[i] *= growth);
    }
  });
  const Index stride = std::max<Index>(1, cloud.size() / (rows_per_center * M));
  const auto rows = Eigen::seq(0, cloud.size() - 1, stride);
  const SlopeSystem system =
      slope_system(data, Points<3>(cloud.points(Eigen::all, rows)), Points<3>(cloud.normals(Eigen::all, rows)));
  const SlopeSolution solution = solve_slope_system(system, options.smoothing, options.progress);
  data.quadrics.row(0) += solution.alpha.transpose();

  const Eigen::VectorXd spacing = supports.areas.cwiseSqrt();
  data.winding = calibrated_winding({data.centers, normals, supports.areas, winding_smoothing * spacing});
  data.far_value = far_spacings * spacing.mean();
  return {std::make_shared<const MedialAxisField>(std::move(data)), std::move(supports.scales), solution.smoothing};
}

}  // namespace csrbf
