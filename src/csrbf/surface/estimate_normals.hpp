#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

/// How normals, which a neighbourhood gives up to their sign, are turned.
enum class Orient {
  consistent,  ///< all to the same side of the surface, outward where it is closed: see orient_normals()
  viewpoint,   ///< towards a point, such as the scanner
  none,        ///< as they come
};

struct NormalOptions {
  /// Points of a neighbourhood, at least 3; 0 = 12: enough to average, few enough to follow bends.
  Index neighbors = 0;
  Orient orient = Orient::consistent;
  /// Where normals point with Orient::viewpoint.
  Point<3> viewpoint = Point<3>::Zero();
  Progress progress;
};

/// Unit normals of a surface from its points (Hoppe et al. 1992, spec 5.1): the direction in which the neighbours of a
/// point spread least. A neighbourhood that lies on a line, as in a scan line or among duplicates, is doubled until it
/// does not. n columns in the order of the points. O(n log n). Throws InvalidInput for fewer than 3 points, points that
/// are not finite or all on one line, neighbors below 3, and a viewpoint that is not finite.
Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options = {});

}  // namespace csrbf
