#include "csrbf/surface/baselines/off_surface.hpp"

#include "csrbf/spatial/farthest_points.hpp"

#include <numeric>

namespace csrbf::baselines {
namespace {

// Chosen by hand.
constexpr double offset = 0.5;     // initial kappa over the distance to the nearest other point kept
constexpr double clearance = 0.7;  // least distance of an offset from all samples, over kappa; 1 without other sheets
constexpr int most_halvings = 5;   // of kappa

std::vector<Index> keep(const PreparedCloud& cloud, Index count) {
  const Index n = cloud.cloud.size();
  if (count > 0 && count < n) return farthest_points<3>(cloud.cloud.points, count).indices;
  std::vector<Index> all(n);
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

}  // namespace

Samples<3> off_surface_samples(const PreparedCloud& cloud, Index count, Offsets offsets) {
  const std::vector<Index> kept = keep(cloud, count);
  const auto n = static_cast<Index>(kept.size());
  const Points<3> points = cloud.cloud.points(Eigen::all, kept), normals = cloud.cloud.normals(Eigen::all, kept);
  const KdTree<3> tree(points);
  const Index sides = offsets == Offsets::none ? 0 : offsets == Offsets::inside ? 1 : 2;
  Samples<3> samples{Points<3>(3, n * (1 + sides)), Eigen::MatrixXd::Zero(n * (1 + sides), 1), {}};
  samples.points.leftCols(n) = points;
  for (Index i = 0; i < n; ++i) {
    std::array<Index, 2> ids{};
    std::array<double, 2> squared{};
    tree.nearest(points.col(i), 2, ids.data(), squared.data());
    for (Index side = 0; side < sides; ++side) {
      const double sign = side == 0 ? 1 : -1;
      double kappa = offset * std::sqrt(squared[1]);
      for (int k = 0; k < most_halvings; ++k, kappa /= 2) {
        Index nearest = 0;
        double distance2 = 0;
        cloud.tree->nearest(points.col(i) - sign * kappa * normals.col(i), 1, &nearest, &distance2);
        if (std::sqrt(distance2) >= clearance * kappa) break;
      }
      const Index at = n * (1 + side) + i;
      samples.points.col(at) = points.col(i) - sign * kappa * normals.col(i);
      samples.values(at, 0) = sign * kappa;
    }
  }
  return samples;
}

}  // namespace csrbf::baselines
