#include <csrbf/csrbf.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

// Points along a spiral on the unit sphere, which are their own normals.
static csrbf::PointCloud sphere(csrbf::Index n) {
  csrbf::PointCloud cloud;
  cloud.points.resize(3, n);
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  for (csrbf::Index i = 0; i < n; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(n);
    const double r = std::sqrt(1 - z * z), angle = golden_angle * double(i);
    cloud.points.col(i) << r * std::cos(angle), r * std::sin(angle), z;
  }
  cloud.normals = cloud.points;
  return cloud;
}

int main() {
  const csrbf::Reconstruction surface = csrbf::reconstruct(sphere(1000));
  const csrbf::Mesh mesh = csrbf::polygonize(*surface.field, {.resolution = 32});
  const csrbf::Topology topology = csrbf::topology(mesh);
  std::printf("csrbf %s: %td triangles, %td components\n", CSRBF_VERSION, topology.triangles, topology.components);
  const bool is_sphere = topology.watertight() && topology.components == 1 && topology.euler == 2;
  return is_sphere ? EXIT_SUCCESS : EXIT_FAILURE;
}
