#pragma once

#include "csrbf/core/image.hpp"
#include "csrbf/implicit/render/light_pattern.hpp"
#include "csrbf/implicit/render/surface_color.hpp"

namespace csrbf {

/// How much light a point of a surface receives.
struct ReceivedLight {
  float open = 1;  ///< part of the sky, weighted by the cosine with the normal
  float lit = 1;   ///< part of the key light
};

/// Scene, camera, colours and lights of a picture. A warm key light from the upper left of the camera, a weak cool fill
/// light from the right, and a bright sky over a darker ground. The references must outlive it.
struct Studio {
  const Scene& scene;
  const RenderOptions& options;
  const SurfaceColor& color;
  Camera camera;
  LightPattern pattern;
  LightPattern ground_pattern;  ///< half of the rays: light changes slowly on the ground
  Box<3> box;                   ///< of the surface
  Point<3> up;                  ///< unit vector
  Point<3> key_light;           ///< unit vector towards the light
  Point<3> fill_light;          ///< unit vector towards the light
  double reach = 0;             ///< surfaces farther away do not occlude the sky
  double ground_level = 0;      ///< along `up`; -inf without ground
  Eigen::Vector3f background;   ///< sRGB

  Studio(const Scene& shown, const RenderOptions& settings, const SurfaceColor& colors, const Camera& view,
         const Box<3>& surface_box);

  /// sRGB of the ground: the background where it receives all light.
  [[nodiscard]] Eigen::Vector3f ground_color(const ReceivedLight& light) const;

  /// sRGB of a surface with the given material colour, unit normal towards the viewer and unit vector to the viewer.
  [[nodiscard]] Eigen::Vector3f surface_color(const LinearRgb& material, const Point<3>& normal,
                                              const Point<3>& to_viewer, const ReceivedLight& light) const;
};

/// Pixels [x_begin, x_end) x [y_begin, y_end).
struct Tile {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Renders one tile into the image on the calling thread. The pixels do not depend on how the picture is tiled.
void render_tile(const Studio& studio, const Tile& tile, RgbImage& image);

}  // namespace csrbf
