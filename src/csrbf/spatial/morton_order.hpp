#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Permutation that sorts points along a Morton (Z-order) curve over their bounding box: neighbours in the order are
/// close in space. Ties keep the input order. O(n log n).
template <int Dim>
std::vector<Index> morton_order(const PointsRef<Dim>& points);

/// Permutation that sorts points along the same curve by cubes that hold a few of them, which keep the input order.
/// O(n). Where points are too clustered for cubes of one size it is that of morton_order, at its cost.
template <int Dim>
std::vector<Index> rough_morton_order(const PointsRef<Dim>& points);

}  // namespace csrbf
