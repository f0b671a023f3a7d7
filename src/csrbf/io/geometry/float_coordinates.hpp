#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The largest change of a coordinate by rounding to float32, when it exceeds a millionth of the diagonal of the
/// bounding box (infinite beyond the range of float32); 0 when float32 suffices. Non-finite coordinates are ignored.
/// O(n).
double float_coordinate_loss(const PointsRef<3>& points);

}  // namespace csrbf
