#pragma once

#include "csrbf/implicit/mesh_scene.hpp"

namespace csrbf {

/// The zero set of a field as a scene. Rays meet a fine polygonization; the point met is then moved along the gradient
/// onto the zero set, where normal and curvature are those of the field. References the field.
class FieldScene : public Scene {
 public:
  /// Throws InvalidInput and SolverFailure as `render` and `polygonize` say.
  FieldScene(const Field<3>& field, const RenderOptions& options);

  [[nodiscard]] const Points<3>& outline() const override { return triangles_.outline(); }
  void trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  [[nodiscard]] bool occluded(const Ray& ray, double t_max) const override { return triangles_.occluded(ray, t_max); }

 private:
  const Field<3>& field_;
  RenderColor color_;
  Mesh mesh_;
  MeshScene triangles_;
  double longest_step_;
};

}  // namespace csrbf
