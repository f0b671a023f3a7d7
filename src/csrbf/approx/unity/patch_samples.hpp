#pragma once

#include "csrbf/approx/unity/cover.hpp"

#include <utility>
#include <vector>

namespace csrbf {

/// Whether samples hardly spread in some direction: the smallest variance is well below that of a filled ball. Then the
/// nearest samples alone, such as those of one track of soundings, do not determine how the function varies across it.
/// `chosen`: squared distances and columns of `points`, as found by Cover::nearest.
template <int Dim>
bool lopsided(const Points<Dim>& points, const std::vector<std::pair<double, std::uint32_t>>& chosen);

/// Some cells of a cover.
struct SpreadCells {
  std::vector<Index> cells;
  Index by_volume = 0;  ///< the first so many of them
};

/// About `count` cells, half of them spread over the volume, half over the points. Without voids: cells much larger
/// than the distances of the points around them, such as those between all points and one far from them, unless these
/// are usual, as among lines of points. What a patch there says is no measure of any other.
template <int Dim>
SpreadCells spread_cells(const Cover<Dim>& cover, Index count);

/// Finds the n samples that the local function of a cell is fitted to, sorted by distance: `search.found`.
///
/// They are those nearest to the middle of the cell. Where these are lopsided, half of them are replaced by others from
/// a wider neighbourhood: from the support of the cell if all are on a line or plane.
///
/// Returns a metric, up to a factor: C^(-anisotropy / 2) with the covariance C of the nearest ones about the middle,
/// whose condition is bounded. In it samples on other tracks are farther away than those on the same one. Without
/// anisotropy it is the identity.
template <int Dim>
Eigen::Matrix<double, Dim, Dim> find_patch_samples(const Cover<Dim>& cover, Index cell, Index n, double anisotropy,
                                                   typename Cover<Dim>::Search& search);

}  // namespace csrbf
