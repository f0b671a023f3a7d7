#include "csrbf/implicit/raycast.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/rays/ray_caster.hpp"

namespace csrbf {

RayHits raycast(const Field<3>& field, const PointsRef<3>& origins, const PointsRef<3>& directions,
                const RaycastOptions& options) {
  constexpr const char* f = "raycast";
  const Index n = origins.cols();
  require(directions.cols() == n, f, "number of directions", directions.cols(), "must be the number of origins");
  require(origins.allFinite(), f, "origins", "NaN or infinity", "must be finite");
  require(directions.allFinite(), f, "directions", "NaN or infinity", "must be finite");
  const double shortest = n > 0 ? directions.colwise().lpNorm<Eigen::Infinity>().minCoeff() : 1;
  require(shortest > 0, f, "length of a direction", shortest, "must be positive");
  require(options.t_max > 0, f, "t_max", options.t_max, "must be positive");
  constexpr int largest_automatic_resolution = 512;  // of the cells: preparation grows with the square
  const int resolution = options.resolution != 0 ? options.resolution
                                                 : std::min(automatic_resolution(field), largest_automatic_resolution);
  const RayCaster caster(field, resolution, options.progress);
  RayHits result{Eigen::VectorXd(n), Points<3>(3, n), caster.guaranteed()};
  constexpr Index part = Index{1} << 15, grain = 256;  // rays between two progress reports, and per task
  for (Index first = 0; first < n; first += part) {
    report(options.progress, "raycast", static_cast<double>(first) / static_cast<double>(n));
    parallel_for(std::min(part, n - first), grain, [&](Index begin, Index end) {
      std::vector<Ray> rays;
      for (Index i = first + begin; i < first + end; ++i)
        rays.push_back({origins.col(i), directions.col(i).stableNormalized()});
      std::vector<RayHit> hits(rays.size());
      caster.cast(rays, options.t_max, hits);
      for (Index k = 0; k < std::ssize(hits); ++k) {
        const Index i = first + begin + k;
        result.t[i] = hits[k].t;
        result.normals.col(i) =
            hits[k].exists() ? hits[k].normal : Point<3>::Constant(std::numeric_limits<double>::quiet_NaN());
      }
    });
  }
  report(options.progress, "raycast", 1);
  return result;
}

}  // namespace csrbf
