#pragma once

#include "csrbf/core/types.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace csrbf {

/// Least side of a box to split, as a share of its coordinates: below, splits are lost in rounding.
constexpr double smallest_side = 64 * std::numeric_limits<double>::epsilon();

/// A point and its number.
template <int Dim>
struct Located {
  Point<Dim> x;
  std::uint32_t id;
};

/// The tree of a Cover: nodes in preorder.
struct CellNodes {
  std::vector<std::int8_t> axis;     ///< of the split; -1 for cells
  std::vector<double> split;         ///< its coordinate; 0 for cells
  std::vector<std::uint32_t> right;  ///< the upper part; for cells their number
  std::vector<Index> ends;           ///< of the points of each cell
};

/// Splits a box around points into cells of at most `leaf_size` of them, as described at Cover; `located` gets the
/// points in the order of the cells. Points in the order of the cells of another tree need not be sorted again: with
/// that tree as `sorted` only its cells are split, and parts that it splits keep the order of their points. Work shared
/// by processes. O(n log n).
template <int Dim>
CellNodes split_into_cells(const PointsRef<Dim>& points, const Box<Dim>& box, Index leaf_size,
                           std::vector<Located<Dim>>& located, const CellNodes& sorted = {});

}  // namespace csrbf
