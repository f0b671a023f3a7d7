#include "csrbf/implicit/render/mesh_scene.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double crease_cosine = 0.766;  // 40 degrees: normals are not averaged over sharper edges
constexpr double opening = 0.25;         // least share of openings in the area of a sheet; half a sphere has 0.5

const Property* find_property(const Mesh& mesh, std::string_view name) {
  for (const Property& property : mesh.properties) {
    if (property.name != name) continue;
    require(property.values.size() == mesh.vertices.cols(), "render", "values of property " + property.name,
            property.values.size(), "must be one per vertex");
    return &property;
  }
  return nullptr;
}

const Property* find_curvature(const Mesh& mesh, RenderColor color) {
  if (color != RenderColor::mean_curvature && color != RenderColor::gaussian_curvature) return nullptr;
  const char* name = color == RenderColor::mean_curvature ? "mean_curvature" : "gaussian_curvature";
  const Property* property = find_property(mesh, name);
  require(property != nullptr, "render", "color", name,
          "needs a vertex property of that name; render the model instead of the mesh, or compute curvatures first");
  return property;
}

}  // namespace

MeshScene::MeshScene(const Mesh& mesh, const RenderOptions& options)
    : mesh_(mesh),
      tree_(mesh),
      shading_(options.shading),
      clearance_(1e-6 * tree_.bounds().diagonal()),
      curvature_(find_curvature(mesh, options.color)) {
  require(tree_.bounds().diagonal() > 0, "render", "diagonal of the mesh", tree_.bounds().diagonal(),
          "must be positive; all vertices coincide");
  require(mesh.normals.cols() == 0 || mesh.normals.cols() == mesh.vertices.cols(), "render", "number of vertex normals",
          mesh.normals.cols(), "must be 0 or the number of vertices");
  if (options.color == RenderColor::plain)
    rgb_ = {find_property(mesh, "red"), find_property(mesh, "green"), find_property(mesh, "blue")};
  if (rgb_[0] != nullptr && rgb_[1] != nullptr && rgb_[2] != nullptr) {
    const bool unit_range = rgb_[0]->type == "float" || rgb_[0]->type == "double";
    rgb_scale_ = unit_range ? 1 : 1.0 / 255;
  } else {
    rgb_[0] = nullptr;
  }
  for (int k = 0; k < 3; ++k) material_[k] = linear_from_srgb(options.material[k]);

  find_sides();
  if (shading_ == MeshShading::smooth) collect_fans();
  keep_used_vertices();
}

Point<3> MeshScene::area_of(Index triangle) const {
  const auto corner = [&](int k) { return mesh_.vertices.col(mesh_.triangles(k, triangle)); };
  return orientation_ * area_vector(corner(0), corner(1), corner(2));
}

// The area vectors of a closed surface add up to zero, those of others to minus that of their openings. A sheet has no
// inside: its sides look alike. Other surfaces whose volume is negative are inside out.
void MeshScene::find_sides() {
  constexpr Index grain = 8192;
  const Index n = mesh_.triangles.cols();
  const Point<3> center = tree_.bounds().center();
  struct Sums {
    double volume = 0, area = 0;
    Point<3> vector = Point<3>::Zero();
  };
  std::vector<Sums> parts((n + grain - 1) / grain);
  parallel_for(n, grain, [&](Index begin, Index end) {
    Sums& part = parts[begin / grain];
    for (Index t = begin; t < end; ++t) {
      const Point<3> area = area_of(t);
      part.volume += area.dot(mesh_.vertices.col(mesh_.triangles(0, t)) - center);
      part.area += area.norm();
      part.vector += area;
    }
  });
  Sums sums;
  for (const Sums& part : parts) {
    sums.volume += part.volume;
    sums.area += part.area;
    sums.vector += part.vector;
  }
  is_sheet_ = sums.vector.norm() > opening * sums.area;
  if (!is_sheet_ && sums.volume < 0) orientation_ = -1;
}

// Lists the triangles around each vertex.
void MeshScene::collect_fans() {
  fan_begin_.assign(mesh_.vertices.cols() + 2, 0);
  for (Index i = 0; i < mesh_.triangles.size(); ++i) ++fan_begin_[mesh_.triangles.data()[i] + 2];
  for (std::size_t v = 2; v < fan_begin_.size(); ++v) fan_begin_[v] += fan_begin_[v - 1];
  fan_.resize(mesh_.triangles.size());
  for (Index i = 0; i < mesh_.triangles.size(); ++i)
    fan_[fan_begin_[mesh_.triangles.data()[i] + 1]++] = static_cast<std::int32_t>(i / 3);
}

void MeshScene::keep_used_vertices() {
  std::vector<bool> used(mesh_.vertices.cols(), false);
  for (Index i = 0; i < mesh_.triangles.size(); ++i) used[mesh_.triangles.data()[i]] = true;
  outline_.resize(3, std::count(used.begin(), used.end(), true));
  for (Index v = 0, kept = 0; v < mesh_.vertices.cols(); ++v)
    if (used[v]) outline_.col(kept++) = mesh_.vertices.col(v);
}

void MeshScene::trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const TriangleTree::Hit hit = tree_.first_hit(rays[i].origin, rays[i].direction);
    hits[i] = hit.triangle >= 0 ? shade(rays[i], hit) : SurfaceHit();
  }
}

Point<3> MeshScene::corner_normal(Index triangle, int corner, const Point<3>& facet) const {
  const std::int32_t v = mesh_.triangles(corner, triangle);
  if (mesh_.normals.cols() > 0) {
    const Point<3> n = mesh_.normals.col(v);
    if (!n.allFinite() || n.norm() == 0) return facet;
    // On a sharp edge the normal is that of one side.
    if (std::abs(n.dot(facet)) > crease_cosine * n.norm()) return n.normalized();
  }
  Point<3> sum = Point<3>::Zero();
  for (std::int32_t i = fan_begin_[v]; i < fan_begin_[v + 1]; ++i) {
    const Point<3> a = area_of(fan_[i]);
    if (a.dot(facet) > crease_cosine * a.norm()) sum += a;
  }
  return sum.norm() > 0 ? sum.normalized() : facet;
}

SurfaceHit MeshScene::shade(const Ray& ray, const TriangleTree::Hit& hit) const {
  SurfaceHit surface;
  surface.t = hit.t;
  Point<3> outward = area_of(hit.triangle).normalized();
  surface.inside = outward.dot(ray.direction) > 0;
  if (is_sheet_ && surface.inside) {
    outward = -outward;
    surface.inside = false;
  }
  surface.facet = surface.inside ? Point<3>(-outward) : outward;
  surface.normal = outward;
  surface.color = material_;

  const auto vertex = [&](int k) -> Index { return mesh_.triangles(k, hit.triangle); };
  Point<3> p = Point<3>::Zero();
  for (int k = 0; k < 3; ++k) p += hit.weights[k] * mesh_.vertices.col(vertex(k));
  surface.position = p;
  Point<3> origin = p;
  if (shading_ == MeshShading::smooth) {
    Point<3> normal = Point<3>::Zero(), lifted = Point<3>::Zero();
    const double side = surface.inside ? -1 : 1;
    for (int k = 0; k < 3; ++k) {
      Point<3> n = corner_normal(hit.triangle, k, outward);
      if (n.dot(outward) < 0) n = -n;  // normals of a file may belong to the other side
      // Lifting the origin of shadow rays towards the tangent planes of the corners hides the facets of coarse meshes
      // at the shadow's edge (Hanika 2021).
      const double below = std::min(0.0, side * n.dot(p - mesh_.vertices.col(vertex(k))));
      normal += hit.weights[k] * n;
      lifted -= hit.weights[k] * below * side * n;
    }
    if (normal.norm() > 0) surface.normal = normal.normalized();
    origin += lifted;
  }
  surface.shadow_origin = origin + clearance_ * surface.facet;

  if (curvature_ != nullptr)
    for (int k = 0; k < 3; ++k) surface.curvature += hit.weights[k] * curvature_->values[vertex(k)];
  if (rgb_[0] != nullptr) {
    surface.color.setZero();
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) {
        const double value = rgb_scale_ * rgb_[c]->values[vertex(k)];
        const double encoded = std::min(1.0, std::max(0.0, value));  // NaN becomes 0
        surface.color[c] += static_cast<float>(hit.weights[k]) * linear_from_srgb(static_cast<float>(encoded));
      }
    }
  }
  return surface;
}

}  // namespace csrbf
