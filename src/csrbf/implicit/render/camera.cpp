#include "csrbf/implicit/render/camera.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

constexpr double radians(double degrees) {
  return degrees * (std::numbers::pi / 180);
}

// Largest of s.p over the points.
double support(const PointsRef<3>& points, const Point<3>& s) {
  return (s.transpose() * points).maxCoeff();
}

// Position along one picture axis, and depth, of the pinhole nearest to the points that sees them all between slopes
// -slope and slope: x - slope * depth <= X - slope * D and -x - slope * depth <= -X - slope * D for the pinhole (X, D).
std::array<double, 2> fit_pinhole(const PointsRef<3>& points, const Point<3>& axis, const Point<3>& forward,
                                  double slope) {
  const double above = support(points, axis - slope * forward);
  const double below = support(points, -axis - slope * forward);
  return {0.5 * (above - below), -0.5 * (above + below) / slope};
}

}  // namespace

Point<3> up_direction(UpAxis up) {
  return Point<3>::Unit(static_cast<Index>(up));
}

Ray Camera::ray(double x, double y) const {
  const Point<3> offset = pixel * ((x - 0.5 * width) * right + (0.5 * height - y) * up);
  if (orthographic) return {position + offset, forward};
  return {position, (forward + offset).normalized()};
}

Camera frame_points(const PointsRef<3>& points, const RenderOptions& options) {
  Camera camera;
  const auto up_axis = static_cast<Index>(options.up);
  const Point<3> e0 = Point<3>::Unit((up_axis + 1) % 3), e1 = Point<3>::Unit((up_axis + 2) % 3);
  const double azimuth = radians(options.view[0]), elevation = radians(options.view[1]);
  const Point<3> around = std::cos(azimuth) * e0 + std::sin(azimuth) * e1;
  camera.forward = -(std::cos(elevation) * around + std::sin(elevation) * Point<3>::Unit(up_axis));
  camera.right = std::cos(azimuth) * e1 - std::sin(azimuth) * e0;
  camera.up = camera.right.cross(camera.forward);
  camera.width = options.width;
  camera.height = options.height;
  camera.orthographic = options.field_of_view == 0;

  const double shorter = std::min(camera.width, camera.height);
  const double inner = 1 - 2 * options.margin;
  const Point<3> reference = points.col(0);  // keeps the numbers small when the surface is far from the origin
  const Points<3> local = points.colwise() - reference;
  const double diagonal = bounding_box<3>(local).diagonal();
  if (camera.orthographic) {
    const double r = support(local, camera.right), l = support(local, -camera.right);
    const double u = support(local, camera.up), d = support(local, -camera.up);
    camera.pixel = std::max((r + l) / (inner * camera.width), (u + d) / (inner * camera.height));
    camera.pixel = std::max(camera.pixel, 1e-3 * diagonal / shorter);  // all points behind each other
    const double depth = support(local, -camera.forward) + diagonal;
    camera.position = reference + 0.5 * (r - l) * camera.right + 0.5 * (u - d) * camera.up - depth * camera.forward;
    return camera;
  }
  camera.pixel = 2 * std::tan(0.5 * radians(options.field_of_view)) / shorter;
  const double half = 0.5 * inner * camera.pixel;
  const auto [x, x_depth] = fit_pinhole(local, camera.right, camera.forward, half * camera.width);
  const auto [y, y_depth] = fit_pinhole(local, camera.up, camera.forward, half * camera.height);
  const double in_front = -support(local, -camera.forward) - 1e-2 * diagonal;
  const double depth = std::min({x_depth, y_depth, in_front});
  camera.position = reference + x * camera.right + y * camera.up + depth * camera.forward;
  return camera;
}

}  // namespace csrbf
