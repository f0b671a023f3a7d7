#include "csrbf/implicit/render/render_tile.hpp"

namespace csrbf {
namespace {

int rays_per_sample(const RenderOptions& options) {
  const int samples = options.samples * options.samples;
  return (options.occlusion_rays + samples - 1) / samples;
}

// sRGB of linear light, clipped to the displayable range.
Eigen::Vector3f encoded(const LinearRgb& light) {
  return light.unaryExpr([](float c) { return srgb_from_linear(std::clamp(c, 0.0F, 1.0F)); });
}

}  // namespace

// Directions and intensities of the lights here and below were chosen by eye.
Studio::Studio(const Scene& shown, const RenderOptions& settings, const SurfaceColor& colors, const Camera& view,
               const Box<3>& surface_box)
    : scene(shown),
      options(settings),
      color(colors),
      camera(view),
      pattern(rays_per_sample(settings)),
      ground_pattern((pattern.rays_per_sample() + 1) / 2),
      box(surface_box),
      up(up_direction(settings.up)),
      key_light((-0.55 * camera.right + 0.75 * camera.up - 0.65 * camera.forward).normalized()),
      fill_light((0.80 * camera.right + 0.10 * camera.up - 0.60 * camera.forward).normalized()),
      reach(0.35 * box.diagonal()),
      ground_level(settings.ground == Ground::shadow ? box.lo.dot(up) : -std::numeric_limits<double>::infinity()),
      background(settings.background.data()) {}

Eigen::Vector3f Studio::ground_color(const ReceivedLight& light) const {
  return background * ((0.65F + 0.35F * light.open) * (0.88F + 0.12F * light.lit));
}

Eigen::Vector3f Studio::surface_color(const LinearRgb& material, const Point<3>& normal, const Point<3>& to_viewer,
                                      const ReceivedLight& light) const {
  const auto [open, lit] = light;
  if (color.unlit()) return encoded(material);
  const auto cosine = [&](const Point<3>& d) { return static_cast<float>(std::max(0.0, normal.dot(d))); };
  const float key = lit * cosine(key_light), fill = open * cosine(fill_light);
  const auto upward = static_cast<float>(0.5 + 0.5 * normal.dot(up));
  if (color.has_scale()) {
    // Light without colour and never brighter than the colour scale itself.
    const float sum = 0.30F + 0.25F * open * (0.6F + 0.4F * upward) + 0.39F * key + 0.06F * fill;
    return encoded(sum * material);
  }
  const LinearRgb sky(0.46F, 0.49F, 0.54F), earth(0.22F, 0.20F, 0.18F);
  const LinearRgb warm(0.86F, 0.81F, 0.74F), cool(0.10F, 0.12F, 0.15F);
  // Light reflected between nearby surfaces brightens corners of a bright material (Jimenez et al. 2016).
  const LinearRgb hollow = material.unaryExpr([o = open](float c) { return o / (1 - 0.6F * c * (1 - o)); });
  const LinearRgb ambient = (upward * sky + (1 - upward) * earth).cwiseProduct(hollow);
  const float gloss = 0.05F * lit * std::pow(cosine((key_light + to_viewer).normalized()), 24.0F);
  return encoded(material.cwiseProduct(ambient + key * warm + fill * cool) + gloss * warm);
}

}  // namespace csrbf
