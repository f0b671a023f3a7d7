#pragma once

#include "csrbf/implicit/render/camera.hpp"
#include "csrbf/implicit/render/color_map.hpp"

namespace csrbf {

/// Where a ray meets a surface.
struct SurfaceHit {
  double t = std::numeric_limits<double>::infinity();  ///< distance along the ray; infinite if there is no hit
  Point<3> position = Point<3>::Zero();
  Point<3> shadow_origin = Point<3>::Zero();  ///< where rays to the lights start, clear of the surface
  Point<3> normal = Point<3>::UnitZ();        ///< outward, for shading
  Point<3> facet = Point<3>::UnitZ();         ///< towards the ray's origin: rays to the lights stay above this plane
  bool inside = false;                        ///< seen from the inside
  LinearRgb color = LinearRgb::Ones();        ///< of the material
  double curvature = 0;                       ///< if the picture shows one

  [[nodiscard]] bool exists() const { return t < std::numeric_limits<double>::infinity(); }
};

/// A surface that rays can meet. All functions are thread safe.
class Scene {
 public:
  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  virtual ~Scene() = default;

  /// Points whose convex hull contains the surface.
  [[nodiscard]] virtual const Points<3>& outline() const = 0;

  /// First hit of each ray.
  virtual void trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const = 0;

  /// Whether the ray meets the surface within distance t_max.
  [[nodiscard]] virtual bool occluded(const Ray& ray, double t_max) const = 0;
};

}  // namespace csrbf
