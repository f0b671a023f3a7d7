#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// How wide the supports of medial_supports() are.
struct MedialSupportOptions {
  double support = 1;  ///< rho: support over the distance to the medial axis (thesis eq. 6.19)
  double fewest = 3;   ///< a support is at least as large as the cells of so many centres ...
  double most = 16;    ///< ... and at most as those of so many
  Index coverage = 4;  ///< every sample is inside the supports of so many centres
};

struct MedialSupports {
  Eigen::VectorXd scales;    ///< distances of the centres to the poles (thesis eq. 6.22)
  Eigen::VectorXd areas;     ///< of the cells of the centres in their tangent planes
  Eigen::VectorXd supports;  ///< radii
};

/// Supports that end at the medial axis of the surface that the centres are on (thesis section 6.2.1), as far as the
/// centres are dense enough to know it. Guards keep enough neighbours in a support where a pole is near by mistake, and
/// no more than are useful where the surface is flat; they go by the areas of the cells in the tangent planes, so that
/// supports are wide between the lines where centres are on lines, and at the rims of holes. Samples at which the
/// supports would be too few widen those of their nearest centres. `normals` are those of the centres. O(M log M + N
/// log M).
MedialSupports medial_supports(const PointsRef<3>& centers, const PointsRef<3>& normals, const PointsRef<3>& samples,
                               const MedialSupportOptions& options = {});

}  // namespace csrbf
