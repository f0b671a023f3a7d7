#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct RaycastOptions {
  /// Cells along the longest side of the field's bounds, 4 ... 1024; 0 = automatic_resolution(field), at most 512.
  int resolution = 0;
  /// Only hits nearer than this along the ray count; > 0.
  double t_max = std::numeric_limits<double>::infinity();
  Progress progress{};  ///< stages "polygonize", "cells" and "raycast"
};

/// Where n rays first meet the surface.
struct RayHits {
  Eigen::VectorXd t;  ///< n, distances; infinite for rays that meet nothing
  Points<3> normals;  ///< 3 x n, outward; NaN for rays that meet nothing
  bool guaranteed = false;
};

/// First zero of f along each ray origin + t direction, 0 <= t < t_max, from either side, in the bounds of the field
/// (plus four cells). Directions may have any nonzero length; t is in units of length. Zeros are exact up to rounding.
/// None is missed for fields with enclosures (`guaranteed`); for others, parts that polygonize() misses are not
/// searched, and high curvature between the vertices of a polygonization may hide a hit. Zeros where f touches 0
/// without changing sign do not count. About five gradients for each ray that comes near the surface, after a
/// preparation that costs as much as polygonize().
///
/// Throws InvalidInput for origins or directions that are not finite, zero directions, different numbers of both, and
/// options out of range; Cancelled.
RayHits raycast(const Field<3>& field, const PointsRef<3>& origins, const PointsRef<3>& directions,
                const RaycastOptions& options = {});

}  // namespace csrbf
