#pragma once

#include "csrbf/surface/contours/slices.hpp"

namespace csrbf {

/// A point of a contour with its normal within the slice.
struct ContourPoint {
  Point<3> position;
  Point<3> outward = Point<3>::Zero();  ///< unit normal of the contour within its slice; 0 if undefined
  double offset = 0;  ///< position - offset * outward is clear of other contours; negative: outside; 0: no such point
  double slope = 1;   ///< of a signed distance within the slice: the cosine of the angle between the slice and the
                      ///< normal of the surface
};

/// Contour points with normals, estimated from the contour within half a spacing, and offsets of at most half a
/// spacing. `places`: indices into the concatenation of all loops.
std::vector<ContourPoint> contour_points(const Points<3>& points, const std::vector<ContourLoop>& loops,
                                         const Slices& slices, const std::vector<Index>& places, double spacing);

}  // namespace csrbf
