#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/estimate_normals.hpp"

namespace csrbf {

/// estimate_normals() of different points in Morton order that are not all on one line, whose tree there is already.
Points<3> estimate_normals(const Points<3>& points, const KdTree<3>& tree, Orient orient, const Progress& progress);

}  // namespace csrbf
