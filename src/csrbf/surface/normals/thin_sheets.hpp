#pragma once

#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

/// Two sheets back to back, as on plates that are thinner than the distance between points: local fits see one rough
/// sheet there.
struct ThinSheets {
  Points<3> normals{3, 0};  ///< unit, pointing away from each other; zero for all other points; empty without sheets
  double noise = 0;         ///< standard deviation of the points from the sheets, in the median

  [[nodiscard]] bool any() const { return normals.cols() > 0; }
  [[nodiscard]] bool has(Index i) const { return normals.col(i).squaredNorm() > 0; }
};

/// Finds them, if at least a twentieth of some hundred places has any.
///
/// Two parallel quadrics through 48 points, found in turns with the side of each point, have two sheets if the points
/// lie near them, compared with their distance; points scattered by noise lie between them, too. Points in Morton
/// order. O(n log n) where there are such sheets, else O(log n).
ThinSheets thin_sheets(const Points<3>& points, const KdTree<3>& tree);

/// Whether the normals do not tell the sheets apart in some place: the normals of both should point away from each
/// other or, across a gap, towards each other. That they point the same way bounds no solid.
bool contradict(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals, const ThinSheets& sheets);

}  // namespace csrbf
