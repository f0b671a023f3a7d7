#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

namespace csrbf {

struct RaycastOptions {
  /// Cells along the longest side of the bounds of the field, 4 to 1024; 0: automatic_resolution(field), at most 512.
  int resolution = 0;
  /// Only hits nearer than this count, in units of length; above 0.
  double t_max = std::numeric_limits<double>::infinity();
  Progress progress{};  ///< stages "polygonize", "cells" and "raycast"
};

/// Where n rays first hit the surface.
struct RayHits {
  Eigen::VectorXd t;        ///< n, distances; infinite for rays without a hit
  Points<3> normals;        ///< 3 x n, outward; NaN for rays without a hit
  bool guaranteed = false;  ///< whether no hit can have been missed
};

/// Finds the first zero of f along each ray origin + t direction, 0 <= t < t_max, from either side, within the bounds
/// of the field plus four cells. `origins` and `directions`: 3 x n; directions may have any nonzero length, and t is in
/// units of length. Zeros are exact up to rounding. Zeros where f touches 0 without changing sign do not count.
///
/// For fields that enclose() their values no zero is missed (`guaranteed`). For others, parts that polygonize() misses
/// are not searched, and high curvature between the vertices of a polygonization may hide a hit. Cost: about five
/// gradients for each ray that comes near the surface, after a preparation that costs as much as polygonize().
///
/// Throws InvalidInput for origins or directions that are not finite, zero directions, different numbers of both, and
/// options out of range; Cancelled.
RayHits raycast(const Field<3>& field, const PointsRef<3>& origins, const PointsRef<3>& directions,
                const RaycastOptions& options = {});

}  // namespace csrbf
