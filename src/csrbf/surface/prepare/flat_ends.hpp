#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Samples of flat ends half a spacing beyond the first and the last of slices across a unit normal, as
/// reconstruct_contours() makes them, where a solid goes on there: closed contours that the slope of the wall does not
/// close before the next slice. Where there are samples of a cap within the contours, in the cloud or among isolated
/// points left out of it, the end is at their height. Empty if there is none. O(n log n), and at most 100,000 places
/// for each end.
OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal, const Points<3>& isolated);

}  // namespace csrbf
