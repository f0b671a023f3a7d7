#pragma once

#include "csrbf/surface/winding/winding_tree.hpp"

namespace csrbf::winding {

/// The winding number w of the samples of a tree at points visited only once, without the cubes of WindingNumber: error
/// up to 1e-2. x in the user's coordinates, consecutive points close to each other.
/// O(n log n) for n points; on all threads.
Eigen::VectorXf sum_at(const Tree& tree, const PointsRef<3>& x);

}  // namespace csrbf::winding
