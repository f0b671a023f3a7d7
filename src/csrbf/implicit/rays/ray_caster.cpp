#include "csrbf/implicit/rays/ray_caster.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/rays/ray_search.hpp"

namespace csrbf {
namespace {

constexpr int largest_resolution = 1024;      // cells along the longest side: bounds memory
constexpr double relative_tolerance = 1e-13;  // of hits, in diagonals of the bounds: close to rounding
constexpr std::size_t rays_together = 256;    // evaluated in one block

int checked_resolution(int resolution) {
  require(resolution >= 4 && resolution <= largest_resolution, "raycast", "resolution", resolution,
          "must be in [4, 1024]");
  return resolution;
}

// Empty for fields that have no surface or need no mesh.
Mesh mesh_for(const Field<3>& field, int resolution, const Progress& progress) {
  if (field.enclose(field.bounds())) return {};
  try {
    return polygonize(field, {.resolution = checked_resolution(resolution), .normals = false, .progress = progress});
  } catch (const SolverFailure&) {
    return {};
  }
}

}  // namespace

RayCaster::RayCaster(const Field<3>& field, int resolution, const Progress& progress)
    : RayCaster(field, resolution, mesh_for(field, resolution, progress), progress) {}

RayCaster::RayCaster(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress)
    : field_(field),
      cells_(field, static_cast<int>(checked_resolution(resolution) / CandidateCells::finer), mesh, progress),
      tolerance_(relative_tolerance * field.bounds().diagonal()) {}

void RayCaster::cast(std::span<const Ray> rays, double t_max, std::span<RayHit> hits) const {
  std::vector<RaySearch> searches;
  searches.reserve(rays_together);
  std::vector<std::size_t> open;
  Points<3> x(3, rays_together), gradient(3, rays_together);
  Eigen::VectorXd value(rays_together);
  for (std::size_t first = 0; first < rays.size(); first += rays_together) {
    const std::size_t count = std::min(rays_together, rays.size() - first);
    searches.clear();
    open.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& ray = rays[first + i];
      const double far = ray.origin.cwiseAbs().maxCoeff();  // rounding of positions on the ray
      searches.emplace_back(cells_, ray, t_max, std::max(tolerance_, 1e-15 * far));
      if (!searches.back().done()) open.push_back(i);
    }
    while (!open.empty()) {
      const auto n = static_cast<Index>(open.size());
      for (Index k = 0; k < n; ++k) x.col(k) = searches[open[k]].query();
      field_.evaluate_block(x.leftCols(n), {value.data(), gradient.data(), nullptr});
      for (Index k = 0; k < n; ++k) searches[open[k]].answer(value[k], gradient.col(k));
      std::erase_if(open, [&](std::size_t i) { return searches[i].done(); });
    }
    for (std::size_t i = 0; i < count; ++i) {
      hits[first + i] = RayHit{};
      if (searches[i].hit()) hits[first + i] = {searches[i].t(), -searches[i].gradient().normalized()};
    }
  }
}

}  // namespace csrbf
