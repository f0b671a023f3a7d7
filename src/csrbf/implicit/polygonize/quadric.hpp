#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf::polygonization {

/// Sum of squared distances to planes (Garland and Heckbert 1997), and the mean of the points that define the planes.
/// For accuracy, points should be relative to a nearby origin.
class Quadric {
 public:
  /// The plane through a point with a unit normal; a zero normal counts for the mean only.
  void add(const Point<3>& point, const Point<3>& normal);
  Quadric& operator+=(const Quadric& other);

  /// Root mean square distance of x from the planes; infinite if there are none.
  [[nodiscard]] double distance(const Point<3>& x) const;
  /// Mean of the points.
  [[nodiscard]] Point<3> mean() const { return point_sum_ / points_; }

  /// Minimiser of the sum; if it is not unique, up to nearly parallel planes, the one closest to the mean. If it is
  /// outside the box, approximately the best point of the box.
  [[nodiscard]] Point<3> minimizer(const Box<3>& box) const;

 private:
  Eigen::Matrix3d A_ = Eigen::Matrix3d::Zero();  // x'Ax - 2 b'x + c
  Point<3> b_ = Point<3>::Zero();
  double c_ = 0;
  double planes_ = 0;
  Point<3> point_sum_ = Point<3>::Zero();
  double points_ = 0;
};

}  // namespace csrbf::polygonization
