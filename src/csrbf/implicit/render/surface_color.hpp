#pragma once

#include "csrbf/implicit/mesh/triangle_tree.hpp"
#include "csrbf/implicit/render/scene.hpp"

#include <optional>

namespace csrbf {

/// Maps the displayed quantity of a surface to colours.
class SurfaceColor {
 public:
  /// `diagonal`: of the box of the surface. Throws InvalidInput if the reference mesh is needed and missing.
  SurfaceColor(const RenderOptions& options, double diagonal);

  /// Whether the colour depends on a colour scale.
  [[nodiscard]] bool has_scale() const { return color_ != RenderColor::plain && color_ != RenderColor::normal; }

  /// Value at a hit in units of the colour scale: curvature times a power of the diagonal, or the relative error.
  [[nodiscard]] double value(const SurfaceHit& hit) const;

  /// Sets the ends of the colour scale: the option, else a percentile of the values at the visible surface.
  void set_scale(std::vector<double> visible_values);

  [[nodiscard]] LinearRgb operator()(const SurfaceHit& hit) const;

  /// Whether the colour is shown without lighting.
  [[nodiscard]] bool unlit() const { return color_ == RenderColor::normal; }

 private:
  RenderColor color_;
  double diagonal_;
  double limit_;
  std::optional<TriangleTree> reference_;
};

}  // namespace csrbf
