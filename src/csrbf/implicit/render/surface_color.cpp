#include "csrbf/implicit/render/surface_color.hpp"

#include "csrbf/core/percentile.hpp"

namespace csrbf {

SurfaceColor::SurfaceColor(const RenderOptions& options, double diagonal)
    : color_(options.color), diagonal_(diagonal), limit_(options.color_limit) {
  if (color_ != RenderColor::error) return;
  require(options.reference != nullptr, "render", "reference", "none",
          "must be a mesh if the colour shows the error; set options.reference");
  reference_.emplace(*options.reference);
  require(reference_->bounds().diagonal() > 0, "render", "diagonal of the reference", reference_->bounds().diagonal(),
          "must be positive; all its vertices coincide");
}

double SurfaceColor::value(const SurfaceHit& hit) const {
  switch (color_) {
    case RenderColor::mean_curvature:
      return hit.curvature * diagonal_;
    case RenderColor::gaussian_curvature:
      return hit.curvature * diagonal_ * diagonal_;
    case RenderColor::error:
      return reference_->closest(hit.position).distance / reference_->bounds().diagonal();
    default:
      return 0;
  }
}

void SurfaceColor::set_scale(std::vector<double> visible_values) {
  if (limit_ > 0 || !has_scale()) return;
  for (double& value : visible_values) value = std::isfinite(value) ? std::abs(value) : 0.0;
  const double fraction = color_ == RenderColor::error ? 0.99 : 0.95;
  // Below these a surface counts as flat, or as equal to the reference, so that the scale does not amplify rounding.
  const double smallest = color_ == RenderColor::error ? 1e-7 : 1e-2;
  if (!visible_values.empty()) {
    const auto rank = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(visible_values.size() - 1));
    limit_ = order_statistic(visible_values, rank);
  }
  limit_ = std::max(limit_, smallest);
}

LinearRgb SurfaceColor::operator()(const SurfaceHit& hit) const {
  if (color_ == RenderColor::plain) return hit.color;
  if (color_ == RenderColor::normal) {
    const Eigen::Vector3f encoded = (0.5 * (hit.normal + Point<3>::Ones())).cast<float>();
    return encoded.unaryExpr([](float c) { return linear_from_srgb(c); });
  }
  const double t = value(hit) / limit_;
  return color_ == RenderColor::error ? sequential_color(t) : diverging_color(std::isfinite(t) ? t : 0.0);
}

}  // namespace csrbf
