#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// A grid of cubes that are halved again and again, fixed in space: the same points fall into the same cubes whatever
/// else there is.
template <int Dim>
struct ThinningGrid {
  Point<Dim> origin = Point<Dim>::Zero();
  double cube = 1;       ///< side of the smallest cubes
  int spacing_bits = 0;  ///< cubes of 2^spacing_bits smallest ones are about as wide as the spacing of the points

  static constexpr int bits = std::min(31, 63 / Dim);  ///< cubes of 2^bits smallest ones hold all points

  /// For points in the box that are `spacing` apart.
  static ThinningGrid over(const Box<Dim>& box, double spacing);

  /// Levels of thinning: level k has at most one point in a cube 2^k spacings wide; level 0 has all.
  [[nodiscard]] int levels() const { return std::max(1, bits - spacing_bits - 2); }

  /// Position along the Morton curve of the smallest cubes.
  [[nodiscard]] std::uint64_t key(const Point<Dim>& x) const;
};

/// The points in the order of the curve, and which of them (as positions in that order) make each level from 1 on: of
/// each cube the point nearest to the mean of those in it. O(n log n).
struct ThinnedPoints {
  std::vector<Index> order;
  std::vector<std::vector<Index>> levels;  ///< level k at k - 1, ascending
};
template <int Dim>
ThinnedPoints thin(const PointsRef<Dim>& points, const ThinningGrid<Dim>& grid);

/// The level of thinning that suits points at a distance from where a function is wanted: 0 up to `halo`, 1 up to
/// twice as far, 2 up to four times, ...
int level_at(double distance, double halo);

/// Typical distance between n neighbouring points, from a sample of them (Dim x m): the side of the square, or cube,
/// that each has on a surface, or in space, of `dimension`.
template <int Dim>
double typical_spacing(const PointsRef<Dim>& sample, Index n, int dimension);

}  // namespace csrbf
