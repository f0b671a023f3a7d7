#pragma once

#include "csrbf/implicit/mesh/triangle_tree.hpp"
#include "csrbf/implicit/render/scene.hpp"

namespace csrbf {

/// The triangles of a mesh as a scene. References the mesh.
class MeshScene : public Scene {
 public:
  /// Throws InvalidInput: see `render`.
  MeshScene(const Mesh& mesh, const RenderOptions& options);

  [[nodiscard]] const Points<3>& outline() const override { return outline_; }
  void trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const override;
  [[nodiscard]] bool occluded(const Ray& ray, double t_max) const override {
    return tree_.occluded(ray.origin, ray.direction, t_max);
  }

 private:
  [[nodiscard]] SurfaceHit shade(const Ray& ray, const TriangleTree::Hit& hit) const;
  [[nodiscard]] Point<3> area_of(Index triangle) const;
  void find_sides();
  [[nodiscard]] Point<3> corner_normal(Index triangle, int corner, const Point<3>& facet) const;
  void collect_fans();
  void keep_used_vertices();

  const Mesh& mesh_;
  TriangleTree tree_;
  MeshShading shading_;
  double orientation_ = 1;  // -1 if the triangles face inwards
  bool is_sheet_ = false;   // without inside: both sides look alike
  double clearance_;
  const Property* curvature_ = nullptr;
  std::array<const Property*, 3> rgb_{};
  double rgb_scale_ = 1;
  LinearRgb material_;
  Points<3> outline_;
  std::vector<std::int32_t> fan_begin_;  // triangles around each vertex
  std::vector<std::int32_t> fan_;
};

}  // namespace csrbf
