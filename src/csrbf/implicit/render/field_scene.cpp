#include "csrbf/implicit/render/field_scene.hpp"

#include "csrbf/implicit/curvature.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {
namespace {

// Start of rays to the lights above the surface; larger than the error of polygonizations of smooth surfaces, so that
// these cast no shadow on themselves. Chosen by hand; larger: contact shadows fade.
constexpr double clearance_in_cells = 0.1;

RenderOptions mesh_options(RenderOptions options) {
  options.shading = MeshShading::smooth;
  options.color = RenderColor::plain;
  return options;
}

}  // namespace

FieldScene::FieldScene(const Field<3>& field, const RenderOptions& options)
    : field_(field),
      color_(options.color),
      mesh_(polygonize(field, {.resolution = options.field_resolution, .progress = options.progress})),
      triangles_(mesh_, mesh_options(options)),
      caster_(field, options.field_resolution, mesh_, options.progress),
      clearance_(clearance_in_cells * field.bounds().extent().maxCoeff() / options.field_resolution) {
  for (int k = 0; k < 3; ++k) material_[k] = linear_from_srgb(options.material[k]);
}

void FieldScene::trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  std::vector<RayHit> found(rays.size());
  caster_.cast(rays, std::numeric_limits<double>::infinity(), found);
  std::vector<std::size_t> met;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] = SurfaceHit();
    if (!found[i].exists() || !found[i].normal.allFinite()) continue;
    SurfaceHit& hit = hits[i];
    hit.t = found[i].t;
    hit.position = rays[i].origin + hit.t * rays[i].direction;
    hit.normal = found[i].normal;
    hit.inside = hit.normal.dot(rays[i].direction) > 0;
    hit.facet = hit.inside ? Point<3>(-hit.normal) : hit.normal;
    hit.shadow_origin = hit.position + clearance_ * hit.facet;
    hit.color = material_;
    met.push_back(i);
  }
  if (color_ != RenderColor::mean_curvature && color_ != RenderColor::gaussian_curvature) return;
  Points<3> x(3, std::ssize(met));
  for (Index i = 0; i < x.cols(); ++i) x.col(i) = hits[met[i]].position;
  const Jet<3> jet = field_.evaluate(x, Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    const PrincipalCurvatures at = principal_curvatures(jet.gradient.col(i), jet.hessian_matrix(i));
    hits[met[i]].curvature = color_ == RenderColor::mean_curvature ? at.mean() : at.gaussian();
  }
}

}  // namespace csrbf
