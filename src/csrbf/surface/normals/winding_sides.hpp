#pragma once

#include "csrbf/core/types.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {

/// What the winding number w of oriented points says beside them, two spacings away on both sides, and on them.
struct WindingSides {
  double mean = 0;    ///< of w: 1/2 for a solid, about 0.1 or less for a sheet without inside
  double defect = 0;  ///< mean of 4 min(w^2, (1 - w)^2): 0 for a solid, up to 1 and more where it is undecided
  double energy = 0;  ///< mean of (2 w - 1)^2 on the points: 0 for a solid, 1 where both sides are the same
};

/// Looks beside some thousand of the points. Spacings: those along the own sheet of each point, so that the sheets of
/// two bodies that touch both have their full area. The defect is that at `places`, if there are any. O(n log n).
WindingSides winding_sides(const Points<3>& points, const Points<3>& normals, const Eigen::VectorXd& spacing,
                           const Points<3>& places = Points<3>(3, 0));

/// Places two spacings beside up to 2000 of the points, on both sides, but none near other points: between two sheets
/// the winding number of right normals is undecided, too. Points with a zero normal have none. O(n).
Points<3> free_places(const Points<3>& points, const KdTree<3>& tree, const Points<3>& normals,
                      const Eigen::VectorXd& spacing);

/// The defect of oriented points at other places. O(n log n).
double winding_defect(const Points<3>& points, const Points<3>& normals, const Eigen::VectorXd& spacing,
                      const Points<3>& places);

}  // namespace csrbf
