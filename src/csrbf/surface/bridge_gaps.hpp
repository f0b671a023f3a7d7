#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/surface/prepare.hpp"

namespace csrbf {

/// Joins islands of the cloud to the part that a gap in the data cuts them off from, such as the tip of a finger: adds
/// samples of the surface of least energy from the rim of the island across the gap to the rim that faces it, a
/// triharmonic spline through samples on both sides. Only islands more closed than half a ball are joined (beside
/// others the winding number leaves the surface open to be completed), and only by rims, chains of samples, that face
/// each other over at most four times the width of the opening: bodies which are closed, or open elsewhere, stay apart.
/// The samples added stand after those of the input, whose indices stay. Returns the number of islands joined. O(points
/// near the islands), and a dense system of at most 900 samples for each.
Index bridge_gaps(PreparedCloud& prepared);

}  // namespace csrbf
