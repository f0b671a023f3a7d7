#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

#include <optional>
#include <span>
#include <vector>

namespace csrbf {

/// Points on parallel planes, such as contours on slices: their order by height along the normal of the planes, and
/// where slices begin in it; the last entry is the number of points.
struct SliceStack {
  std::vector<Index> order;
  std::vector<std::size_t> begin;
  double apart = 0;  ///< median distance of slices

  [[nodiscard]] std::size_t slices() const { return begin.size() - 1; }
  [[nodiscard]] std::span<const Index> slice(std::size_t s) const {
    return std::span(order).subspan(begin[s], begin[s + 1] - begin[s]);
  }
};

/// The slices that points lie on, across a unit normal; none if they do not lie on at least three thin ones. O(n log
/// n).
std::optional<SliceStack> find_slices(const Points<3>& points, const Point<3>& normal);

/// The common normal of the planes that points lie on, as contours on parallel slices do: unit; none if there is no
/// stack of them. `near`: their neighbours. O(n log n); hardly any time where
/// few points have neighbours in a common plane, 2 s for a million in one.
std::optional<Point<3>> normal_of_slices(const Points<3>& points, const NeighborTable& near);

}  // namespace csrbf
