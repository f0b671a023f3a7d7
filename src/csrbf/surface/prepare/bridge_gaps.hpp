#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/surface/prepare/prepare.hpp"

namespace csrbf {

/// Joins components of the cloud to the part that a gap in the data cuts them off from, such as the tip of a finger:
/// adds samples of the surface of least energy from the rim of the component across the gap to the rim that faces it, a
/// triharmonic spline through samples on both sides. Only components more closed than half a ball are joined (beside
/// others the winding number leaves the surface open to be completed), and only by rims, chains of samples, that face
/// each other over at most four times the width of the opening: bodies which are closed, or open elsewhere, stay apart.
/// The samples added stand after those of the input, whose indices stay. Returns the number of components joined.
/// O(points near the components), and a dense system of at most 900 samples for each.
Index bridge_gaps(PreparedCloud& prepared);

}  // namespace csrbf
