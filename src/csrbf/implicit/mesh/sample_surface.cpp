#include "csrbf/implicit/mesh/sample_surface.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"

namespace csrbf {
namespace {

constexpr Index grain = 4096;  // triangles or samples per task

// Sums of twice the areas of the triangles up to and including each one.
std::vector<double> cumulative_area(const Mesh& mesh) {
  std::vector<double> area(mesh.triangles.cols());
  parallel_for(mesh.triangles.cols(), grain, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const auto corner = [&](int k) { return mesh.vertices.col(mesh.triangles(k, t)); };
      area[t] = area_vector(corner(0), corner(1), corner(2)).norm();
    }
  });
  for (std::size_t t = 1; t < area.size(); ++t) area[t] += area[t - 1];
  return area;
}

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, Index n, std::uint64_t seed) {
  require(n > 0, "sample_surface", "n", n, "must be positive");
  const std::vector<double> area = cumulative_area(mesh);
  const double total = area.empty() ? 0.0 : area.back();
  require(total > 0 && std::isfinite(total), "sample_surface", "area", total,
          "must be positive and finite; the mesh has no surface to sample");
  // The first triangle that reaches the total is the last one with an area.
  const auto last = std::lower_bound(area.begin(), area.end(), total);

  SurfaceSamples samples{Points<3>(3, n), Points<3>(3, n), std::vector<std::int32_t>(n)};
  parallel_for(n, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const auto counter = static_cast<std::uint64_t>(i);
      const double position = (static_cast<double>(i) + hash_uniform(seed, counter, 0)) / static_cast<double>(n);
      const Index t = std::upper_bound(area.begin(), last, position * total) - area.begin();
      double u = hash_uniform(seed, counter, 1), v = hash_uniform(seed, counter, 2);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const auto corner = [&](int k) -> Point<3> { return mesh.vertices.col(mesh.triangles(k, t)); };
      samples.points.col(i) = corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0));
      samples.normals.col(i) = area_vector(corner(0), corner(1), corner(2)).normalized();
      samples.triangle[i] = static_cast<std::int32_t>(t);
    }
  });
  return samples;
}

}  // namespace csrbf
