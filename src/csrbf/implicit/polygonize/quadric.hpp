#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf::polygonization {

/// Squared distances to planes, summed (Garland and Heckbert 1997), and the mean of the points through which the planes
/// were laid. Points are best measured from an origin nearby.
class Quadric {
 public:
  /// The plane through a point with a unit normal; a zero normal counts for the mean only.
  void add(const Point<3>& point, const Point<3>& normal);
  Quadric& operator+=(const Quadric& other);

  /// Root mean square distance of x from the planes; infinite when there are none.
  [[nodiscard]] double distance(const Point<3>& x) const;
  /// Mean of the points.
  [[nodiscard]] Point<3> mean() const { return point_sum_ / points_; }

  /// Where the sum is least; of all such points, up to planes that differ by little more than rounding, the one next to
  /// the mean. Where that is outside the box, about the best point of the box.
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
