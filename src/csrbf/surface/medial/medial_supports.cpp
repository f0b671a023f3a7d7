#include "csrbf/surface/medial/medial_supports.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/voronoi_poles.hpp"
#include "csrbf/surface/normals/tangent_areas.hpp"

#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double fewest_cells = 3;    // least area of a support, in cells of its centre ...
constexpr double most_cells = 16;     // ... and largest; larger: denser systems
constexpr Index coverage = 4;         // every sample is inside the supports of at least this many centres
constexpr double margin = 1.25;       // radius of a support over the distance of a sample it must cover: the weight
                                      // there is not negligible
constexpr double farthest_rim = 3;    // largest extent of a cell, in distances to the medial axis ...
constexpr double widest_cell = 0.25;  // ... and in diagonals of the samples

void cover_samples(const PointsRef<3>& samples, const KdTree<3>& tree, Eigen::VectorXd& supports) {
  const Index k = std::min(coverage, tree.size());
  std::vector<Index> ids(k * samples.cols());
  std::vector<double> squared(ids.size());
  parallel_for(samples.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) tree.nearest(samples.col(i), k, &ids[k * i], &squared[k * i]);
  });
  for (std::size_t i = 0; i < ids.size(); ++i)
    supports[ids[i]] = std::max(supports[ids[i]], margin * std::sqrt(squared[i]));
}

}  // namespace

MedialSupports medial_supports(const PointsRef<3>& centers, const PointsRef<3>& normals, const PointsRef<3>& samples) {
  MedialSupports result;
  result.scales = medial_axis_distances<3>(centers, voronoi_poles<3>(centers));
  const double widest = widest_cell * bounding_box<3>(samples).diagonal();
  result.areas = tangent_areas(centers, normals, (farthest_rim * result.scales).cwiseMin(widest));
  // A disc with the area of n cells has the radius sqrt(n area / pi).
  const Eigen::VectorXd cell = (result.areas / std::numbers::pi).cwiseSqrt();
  result.supports = result.scales.cwiseMin(std::sqrt(most_cells) * cell).cwiseMax(std::sqrt(fewest_cells) * cell);
  cover_samples(samples, KdTree<3>(centers), result.supports);
  return result;
}

}  // namespace csrbf
