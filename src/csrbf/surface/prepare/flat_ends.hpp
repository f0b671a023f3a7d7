#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// Samples of flat ends half a spacing beyond the first and the last of slices across a unit normal, as
/// reconstruct_contours() makes them, where a solid goes on there: closed contours that the slope of the wall does not
/// close before the next slice. No sample tells where such a solid ends. Empty if there is none.
OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal);

}  // namespace csrbf
