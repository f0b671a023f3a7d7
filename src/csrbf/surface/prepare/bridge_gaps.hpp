#pragma once

#include "csrbf/surface/prepare/prepare.hpp"

namespace csrbf {

/// Joins components of the cloud, such as a fingertip, to the part from which a gap in the data separates them: adds
/// samples of the surface of least energy, a triharmonic spline through samples on both sides, from the rim of the
/// component across the gap to the facing rim. Only components more closed than half a ball are joined (next to others
/// the winding number is undecided, and coarser patches complete the surface), and only at rims (chains of samples)
/// that face each other across at most four times the width of the opening: bodies that are closed, or open elsewhere,
/// stay separate. The added samples follow those of the input, whose indices do not change. Returns the number of
/// components joined. O(points near the components), plus a dense system of at most 900 samples for each.
Index bridge_gaps(PreparedCloud& prepared);

}  // namespace csrbf
