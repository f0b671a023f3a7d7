#include "csrbf/io/geometry/float_coordinates.hpp"

#include "csrbf/io/files/bytes.hpp"

#include <algorithm>

namespace csrbf {

double float_coordinate_loss(const PointsRef<3>& points) {
  Box<3> box;
  double moved = 0;
  for (const auto& point : points.colwise())
    for (int axis = 0; axis < 3; ++axis) {
      const double x = point(axis);
      if (!std::isfinite(x)) continue;
      box.lo(axis) = std::min(box.lo(axis), x);
      box.hi(axis) = std::max(box.hi(axis), x);
      moved = std::max(moved, std::abs(x - static_cast<double>(narrow_scalar<float>(x))));
    }
  constexpr double allowed = 1e-6;  // of the diagonal, chosen by hand; smaller: more files in double precision
  if (box.empty()) return 0;
  // Scaled first: the square of the extent may overflow.
  return moved > (allowed * box.hi - allowed * box.lo).stableNorm() ? moved : 0;
}

}  // namespace csrbf
