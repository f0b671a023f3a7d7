#pragma once

#include "csrbf/implicit/rays/candidate_cells.hpp"
#include "csrbf/implicit/render_options.hpp"

namespace csrbf {

/// Pinhole or orthographic camera.
struct Camera {
  Point<3> position = Point<3>::Zero();  ///< the pinhole; orthographic: the centre of the plane where rays start
  Point<3> right = Point<3>::UnitX();
  Point<3> up = Point<3>::UnitY();
  Point<3> forward = -Point<3>::UnitZ();
  double pixel = 1;  ///< side of a pixel: at distance 1 (perspective) or anywhere (orthographic)
  bool orthographic = false;
  double width = 0;   ///< pixels
  double height = 0;  ///< pixels

  /// Ray through the picture at x pixels from the left and y pixels from the top.
  [[nodiscard]] Ray ray(double x, double y) const;

  /// Side of a pixel at a distance from the start of the ray.
  [[nodiscard]] double pixel_at(double distance) const { return orthographic ? pixel : pixel * distance; }
};

/// Unit vector of the up axis.
Point<3> up_direction(UpAxis up);

/// The camera of the options at the nearest position from which all points are in the picture within its margin. Needs
/// at least one point.
Camera frame_points(const PointsRef<3>& points, const RenderOptions& options);

}  // namespace csrbf
