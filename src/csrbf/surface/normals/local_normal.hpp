#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// Principal axes of a neighbourhood, its points weighted by 1 - d^2 / h^2 with h just beyond the farthest.
struct LocalFrame {
  Point<3> center;  ///< from which distances are measured
  double h = 0;
  Eigen::Matrix3d axes;  ///< columns by increasing eigenvalue: normal, then two tangents
  Eigen::Vector3d eigenvalues;

  /// The neighbours spread in two directions: standard deviations differ by a factor of less than 10.
  [[nodiscard]] bool is_surface() const { return eigenvalues[1] > 0.01 * eigenvalues[2]; }
  /// They are collinear up to rounding.
  [[nodiscard]] bool is_line() const { return !(eigenvalues[1] > 1e-10 * eigenvalues[2]); }
};

/// Frame of the points `ids`, nearest first, at squared distances `d2` from `center`.
LocalFrame local_frame(const Points<3>& points, std::span<const Index> ids, std::span<const double> d2,
                       const Point<3>& center);

/// Height z(x, y) over the tangent plane of a frame: z0 + zx x + zy y + zxx x^2 + zxy x y + zyy y^2, lengths in units
/// of h.
struct LocalQuadric {
  LocalFrame frame;
  Eigen::Matrix<double, 6, 1> z = Eigen::Matrix<double, 6, 1>::Zero();

  /// Unit normal of the quadric under the point p.
  [[nodiscard]] Point<3> normal(const Point<3>& p) const;
  /// Height of the point p over the quadric, along the axis of the frame.
  [[nodiscard]] double height(const Point<3>& p) const;
};

/// Weighted least squares with a ridge of 1e-5 of the weights on the quadratic terms, which vanish for fewer than 8
/// points.
LocalQuadric fit_quadric(const Points<3>& points, std::span<const Index> ids, std::span<const double> d2,
                         const LocalFrame& frame);

}  // namespace csrbf
