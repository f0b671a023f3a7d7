#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// A closed contour: the indices of its vertices in order.
using ContourLoop = std::vector<Index>;

/// The closed contours formed by the edges, each starting at its smallest vertex. Chains with two ends are closed by a
/// straight segment; contours with fewer than three vertices are left out; both are reported in `warnings`. Vertices
/// without an edge are ignored. Throws InvalidInput for coordinates that are not finite, edges to vertices that do not
/// exist, and vertices with more than two edges.
std::vector<ContourLoop> contour_loops(const Polylines& contours, std::vector<std::string>& warnings);

/// Whether contours zigzag, like those traced from pixels: they turn to alternating sides at most of their corners, and
/// by more than a few degrees. Those of fewer than 16 points do not count.
bool are_jagged(const Points<3>& points, const std::vector<ContourLoop>& loops);

/// The contours of one plane. Inside is determined by the even-odd rule: a contour within another one is a hole.
class Slice {
 public:
  /// `aside`: a point off the normal through the origin; it fixes the plane's own coordinates.
  Slice(const Point<3>& origin, const Point<3>& normal, const Point<3>& aside);

  void add(Points<3> loop);  ///< loop: at least three points in order

  [[nodiscard]] const std::vector<Points<3>>& loops() const { return loops_; }
  [[nodiscard]] const Point<3>& origin() const { return origin_; }
  [[nodiscard]] const Point<3>& normal() const { return normal_; }  ///< unit
  /// Distance to the plane, positive on the side of the normal.
  [[nodiscard]] double height(const Point<3>& p) const { return normal_.dot(p - origin_); }
  /// The projection of p in the plane's own coordinates, and the inverse map.
  [[nodiscard]] Point<2> to_plane(const Point<3>& p) const { return axes_.transpose() * (p - origin_); }
  [[nodiscard]] Point<3> to_space(const Point<2>& q) const { return origin_ + axes_ * q; }
  /// Signed distance to the contours within the plane: positive inside. O(number of points).
  [[nodiscard]] double depth(const Point<2>& q) const;
  /// Box of the contours in the plane's own coordinates.
  [[nodiscard]] const Box<2>& box() const { return box_; }

 private:
  Point<3> origin_, normal_;
  Eigen::Matrix<double, 3, 2> axes_;
  std::vector<Points<3>> loops_;
  Points<2> from_{2, 0}, to_{2, 0};  // the segments of all contours
  Box<2> box_;
};

/// Slices, and the slice of each loop.
struct Slices {
  std::vector<Slice> slices;
  std::vector<Index> slice_of;  ///< one for each loop
};

/// Groups contours by plane, the largest first. `points` in a unit in which the diagonal of their box is 1. Throws
/// InvalidInput for contours that are not planar, and for those whose points are collinear.
Slices gather_slices(const Points<3>& points, const std::vector<ContourLoop>& loops);

}  // namespace csrbf
