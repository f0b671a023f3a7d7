#include "csrbf/surface/medial/medial_supports.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/voronoi_poles.hpp"
#include "csrbf/surface/normals/tangent_areas.hpp"

#include <numbers>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double margin = 1.25;       // radius of a support over the distance of a sample it must cover: the weight
                                      // there is not negligible
constexpr double farthest_rim = 3;    // largest extent of a cell, in distances to the medial axis ...
constexpr double widest_cell = 0.25;  // ... and in diagonals of the samples

void cover_samples(const PointsRef<3>& samples, const KdTree<3>& tree, Index coverage, Eigen::VectorXd& supports) {
  const auto k = static_cast<std::size_t>(std::min(coverage, tree.size()));
  std::vector<Index> ids(k * static_cast<std::size_t>(samples.cols()));
  std::vector<double> squared(ids.size());
  parallel_for(samples.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const std::size_t at = k * static_cast<std::size_t>(i);
      tree.nearest(samples.col(i), static_cast<Index>(k), &ids[at], &squared[at]);
    }
  });
  for (std::size_t i = 0; i < ids.size(); ++i)
    supports[ids[i]] = std::max(supports[ids[i]], margin * std::sqrt(squared[i]));
}

}  // namespace

MedialSupports medial_supports(const PointsRef<3>& centers, const PointsRef<3>& normals, const PointsRef<3>& samples,
                               const MedialSupportOptions& options) {
  MedialSupports result;
  result.scales = medial_axis_distances<3>(centers, voronoi_poles<3>(centers));
  const double widest = widest_cell * bounding_box<3>(samples).diagonal();
  result.areas = tangent_areas(centers, normals, (farthest_rim * result.scales).cwiseMin(widest));
  // A disc with the area of n cells has the radius sqrt(n area / pi).
  const Eigen::VectorXd cell = (result.areas / std::numbers::pi).cwiseSqrt();
  result.supports = (options.support * result.scales)
                        .cwiseMin(std::sqrt(options.most) * cell)
                        .cwiseMax(std::sqrt(options.fewest) * cell);
  cover_samples(samples, KdTree<3>(centers), options.coverage, result.supports);
  return result;
}

}  // namespace csrbf
