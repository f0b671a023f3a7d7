#include "csrbf/implicit/compare.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/mesh/sample_surface.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"
#include "csrbf/implicit/mesh/triangle_tree.hpp"

#include <numbers>

namespace csrbf {
namespace {

// Distance of every query point, and the angle between its normal and that of the closest triangle: NaN if either has
// no normal.
struct Distances {
  std::vector<double> distance;
  std::vector<double> angle;
};

double angle_between(const Point<3>& a, const Point<3>& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Distances measure(const PointsRef<3>& points, const PointsRef<3>& normals, const Mesh& mesh, const TriangleTree& tree) {
  const Index n = points.cols();
  Distances result{std::vector<double>(n), std::vector<double>(n, std::numeric_limits<double>::quiet_NaN())};
  constexpr Index grain = 512;
  parallel_for(n, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const TriangleTree::Closest closest = tree.closest(points.col(i));
      result.distance[i] = closest.distance;
      if (normals.cols() == 0) continue;
      const auto corner = [&](int k) { return mesh.vertices.col(mesh.triangles(k, closest.triangle)); };
      const Point<3> n_closest = area_vector(corner(0), corner(1), corner(2));
      const Point<3> n_point = normals.col(i);
      if (n_closest.norm() > 0 && n_point.norm() > 0)
        result.angle[i] = angle_between(n_point.normalized(), n_closest.normalized());
    }
  });
  return result;
}

DistanceStatistics statistics(std::vector<double> distances, double diagonal) {
  DistanceStatistics result;
  for (double& d : distances) {
    d /= diagonal;
    result.mean += d;
    result.rms += d * d;
    result.max = std::max(result.max, d);
  }
  const auto n = static_cast<double>(distances.size());
  result.mean /= n;
  result.rms = std::sqrt(result.rms / n);
  result.p99 = percentile(distances, 0.99);
  return result;
}

double mean_degrees(const std::vector<double>& a, const std::vector<double>& b = {}) {
  double sum = 0;
  Index count = 0;
  for (const auto* angles : {&a, &b}) {
    for (const double angle : *angles) {
      if (std::isnan(angle)) continue;
      sum += angle;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) * (180 / std::numbers::pi)
                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

MeshComparison compare(const Mesh& mesh, const Mesh& reference, const CompareOptions& options) {
  require(options.samples > 0, "compare", "samples", options.samples, "must be positive");
  report(options.progress, "compare", 0);
  const TriangleTree tree(mesh);
  const TriangleTree reference_tree(reference);
  report(options.progress, "compare", 0.2);

  MeshComparison result;
  result.diagonal = reference_tree.bounds().diagonal();
  const SurfaceSamples on_mesh = sample_surface(mesh, options.samples, options.seed);
  const Distances to_reference = measure(on_mesh.points, on_mesh.normals, reference, reference_tree);
  report(options.progress, "compare", 0.6);
  const SurfaceSamples on_reference = sample_surface(reference, options.samples, options.seed);
  const Distances to_mesh = measure(on_reference.points, on_reference.normals, mesh, tree);
  report(options.progress, "compare", 0.9);

  result.accuracy = statistics(to_reference.distance, result.diagonal);
  stop_if_interrupted();
  result.completeness = statistics(to_mesh.distance, result.diagonal);
  result.chamfer_mean = 0.5 * (result.accuracy.mean + result.completeness.mean);
  result.hausdorff99 = std::max(result.accuracy.p99, result.completeness.p99);
  result.normal_error_deg = mean_degrees(to_reference.angle, to_mesh.angle);
  stop_if_interrupted();
  result.topology = topology(mesh);
  report(options.progress, "compare", 1);
  return result;
}

PointComparison compare(const Mesh& mesh, const PointCloud& reference, const CompareOptions& options) {
  require(reference.size() > 0, "compare", "points", reference.size(), "must be at least one; the cloud is empty");
  require(reference.points.allFinite(), "compare", "points", "NaN or infinite",
          "must be finite; remove invalid points first");
  report(options.progress, "compare", 0);
  PointComparison result;
  result.diagonal = bounding_box<3>(reference.points).diagonal();
  require(result.diagonal > 0, "compare", "diagonal of the points", result.diagonal,
          "must be positive; all points are the same");
  const TriangleTree tree(mesh);
  report(options.progress, "compare", 0.3);
  const Points<3> no_normals(3, 0);
  const Distances distances =
      measure(reference.points, reference.has_normals() ? reference.normals : no_normals, mesh, tree);
  result.distance = statistics(distances.distance, result.diagonal);
  result.normal_error_deg = mean_degrees(distances.angle);
  result.topology = topology(mesh);
  report(options.progress, "compare", 1);
  return result;
}

}  // namespace csrbf
