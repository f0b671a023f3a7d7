#pragma once

#include "csrbf/spatial/kd_tree.hpp"

#include <vector>

namespace csrbf {

/// A subset of a cloud on rows (scan lines, tracks, contours on slices) that has no direction in which it is much
/// denser than in others on the surface: indices, ascending, or none to take all points. Neighbours of points in rows
/// lie on a line and say nothing about the surface between the rows.
///
/// A third of the points are on rows if the 12 nearest of so many, or, for noise, the 12 nearest of those that are
/// twice the usual distance apart, spread along one direction, and less than 0.4 of that along the next. Then points
/// nearer to each other than a distance are left out, which grows by sqrt(2) until fewer than a third are. None if the
/// cloud has too few points for that, such as thin wires. In 354 clouds of surfaces with random samples at most 2 % of
/// the points are on rows; of three solids with samples on planes twice, four and eight spacings apart about half, nine
/// tenths and eight tenths. O(n log n); for clouds without rows 2000 searches in the tree.
std::vector<Index> all_but_crowded_rows(const Points<3>& points, const KdTree<3>& tree);

}  // namespace csrbf
