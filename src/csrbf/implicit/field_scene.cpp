#include "csrbf/implicit/field_scene.hpp"

#include "csrbf/implicit/curvature.hpp"
#include "csrbf/implicit/polygonize.hpp"

namespace csrbf {
namespace {

RenderOptions mesh_options(RenderOptions options) {
  options.shading = MeshShading::smooth;
  options.color = RenderColor::plain;
  return options;
}

}  // namespace

FieldScene::FieldScene(const Field<3>& field, const RenderOptions& options)
    : field_(field),
      color_(options.color),
      mesh_(polygonize(field, {.resolution = options.field_resolution})),
      triangles_(mesh_, mesh_options(options)),
      longest_step_(field.bounds().extent().maxCoeff() / options.field_resolution) {}

void FieldScene::trace(std::span<const Ray> rays, std::span<SurfaceHit> hits) const {
  triangles_.trace(rays, hits);
  std::vector<std::size_t> met;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].exists()) met.push_back(i);
  Points<3> x(3, static_cast<Index>(met.size()));
  for (std::size_t i = 0; i < met.size(); ++i) x.col(static_cast<Index>(i)) = hits[met[i]].position;

  // The vertices are on the zero set, so the start is off by the square of the cell size: two steps reach rounding.
  constexpr int steps = 2;
  for (int step = 0; step < steps; ++step) {
    const Jet<3> jet = field_.evaluate(x, Derivatives::gradient);
    for (Index i = 0; i < x.cols(); ++i) {
      const double length = std::abs(jet.value[i]) / jet.gradient.col(i).norm();
      if (length <= longest_step_) x.col(i) -= std::copysign(length, jet.value[i]) * jet.gradient.col(i).normalized();
    }
  }
  const bool curved = color_ == RenderColor::mean_curvature || color_ == RenderColor::gaussian_curvature;
  const Jet<3> jet = field_.evaluate(x, curved ? Derivatives::hessian : Derivatives::gradient);
  for (Index i = 0; i < x.cols(); ++i) {
    SurfaceHit& hit = hits[met[i]];
    const Point<3> g = jet.gradient.col(i);
    if (!(g.norm() > 0) || !g.allFinite()) continue;
    hit.position = x.col(i);
    hit.normal = -g.normalized();
    if (!curved) continue;
    const PrincipalCurvatures at = principal_curvatures(g, jet.hessian_matrix(i));
    hit.curvature = color_ == RenderColor::mean_curvature ? at.mean() : at.gaussian();
  }
}

}  // namespace csrbf
