#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// A convex set: all x with normals^T x <= offsets.
struct HalfSpaces {
  Eigen::MatrixXd normals;  ///< d x m, of length 1
  Eigen::VectorXd offsets;  ///< m

  /// Whether x is in the set, or at most `margin` outside.
  [[nodiscard]] bool contains(const Eigen::Ref<const Eigen::VectorXd>& x, double margin) const {
    return ((normals.transpose() * x - offsets).array() <= margin).all();
  }
};

/// The convex hull of points in one to three dimensions, by qhull (Barber, Dobkin and Huhdanpaa 1996). O(n log n).
/// Throws InvalidInput for points on a line or in a plane, and non-finite ones.
template <int Dim>
HalfSpaces convex_hull(const PointsRef<Dim>& points);

}  // namespace csrbf
