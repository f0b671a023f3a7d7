#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// Permutation that sorts points along a Morton (Z-order) curve over their bounding box: neighbours in the order are
/// close in space. Ties keep the input order. O(n log n).
template <int Dim>
std::vector<Index> morton_order(const PointsRef<Dim>& points);

/// Permutation that sorts cubes of a few points along the same curve; points of one cube keep the input order. Where
/// points are too clustered for cubes of one size, that of morton_order, at its cost. Otherwise O(n).
template <int Dim>
std::vector<Index> rough_morton_order(const PointsRef<Dim>& points);

}  // namespace csrbf
