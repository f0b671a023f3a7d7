#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

struct MedialSupports {
  Eigen::VectorXd scales;    ///< distances of the centres to the poles (thesis eq. 6.22)
  Eigen::VectorXd areas;     ///< of the cells of the centres in their tangent planes
  Eigen::VectorXd supports;  ///< radii
};

/// Supports that end at the medial axis of the surface (thesis section 6.2.1), as far as the centres are dense enough
/// to determine it (rho = 1 in thesis eq. 6.19). Bounds keep enough neighbours in a support where a pole is spuriously
/// close, and no more than are useful where the surface is flat; they are set by the areas of the cells in the tangent
/// planes, so that supports are wide between scan lines and at the rims of holes. Samples covered by too few supports
/// widen those of their nearest centres. `normals` are those of the centres. O(M log M + N log M).
MedialSupports medial_supports(const PointsRef<3>& centers, const PointsRef<3>& normals, const PointsRef<3>& samples);

}  // namespace csrbf
