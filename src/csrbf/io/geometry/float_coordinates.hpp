#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The farthest that rounding to float32 moves a coordinate, when that is more than a millionth of the diagonal of the
/// bounding box (infinite beyond the range of float32); 0 when float32 will do. Coordinates that are not finite do not
/// count. O(n).
double float_coordinate_loss(const PointsRef<3>& points);

}  // namespace csrbf
