#pragma once

#include "csrbf/implicit/rays/ray_caster.hpp"
#include "csrbf/implicit/render/mesh_scene.hpp"

namespace csrbf {

/// The zero set of a field as a scene. Rays of the camera meet the zero set itself (RayCaster), where position, normal
/// and curvature are those of the field; rays to the lights meet a polygonization. References the field.
class FieldScene : public Scene {
 public:
  /// Throws InvalidInput and SolverFailure: see `render` and `polygonize`.
  FieldScene(const Field<3>& field, const RenderOptions& options);

  [[nodiscard]] const Points<3>& outline() const override { return triangles_.outline(); }
  void trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  [[nodiscard]] bool occluded(const Ray& ray, double t_max) const override { return triangles_.occluded(ray, t_max); }

 private:
  const Field<3>& field_;
  RenderColor color_;
  Mesh mesh_;
  MeshScene triangles_;
  RayCaster caster_;
  double clearance_;  // of rays to the lights from the polygonization
  LinearRgb material_;
};

}  // namespace csrbf
