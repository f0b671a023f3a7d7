#pragma once

#include "csrbf/surface/composite/composite.hpp"

namespace csrbf {

/// How thin the thinnest parts are: the distance between sheets back to back which is smaller at a fiftieth of the
/// samples; infinity if fewer of them have such a sheet among their nearest samples. Sheets closer than `least` do not
/// count. Not gaps: smaller cells give them more handles, not fewer (bent bars with gaps of .3 to 1 spacings). Measured
/// at some thousand samples; O(log n).
double thinnest_parts(const OrientedPoints& cloud, const KdTree<3>& tree, double least);

}  // namespace csrbf
