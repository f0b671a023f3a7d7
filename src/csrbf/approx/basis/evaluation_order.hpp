#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// An order in which neighbours follow each other, for fields evaluated through trees; empty when the points already
/// are in such an order (rows of a grid) or are few. O(n), and O(n log n) where they must be sorted.
template <int Dim>
std::vector<Index> evaluation_order_of(const PointsRef<Dim>& x);

}  // namespace csrbf
