#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

namespace csrbf {

/// For every centre c_i the largest distance to a point of its Voronoi cell inside the box: the smallest radius s_i of
/// a ball that covers the cell (thesis section 3.2.2). The balls cover the box, and max_i s_i is the fill distance of
/// the centres in the box.
///
/// Exact up to rounding, in any dimension: each cell is the box cut by the bisectors towards its neighbours, nearest
/// first, until the next neighbour is twice as far as the farthest corner. Cells have about 6 corners in the plane, 27
/// in space, 160 in 4D, more than 1000 in 5D: beyond 4D prefer discrete_voronoi_scales. O(M log M) for evenly spread
/// centres. Coincident centres share a cell.
///
/// Throws InvalidInput for centres that are not finite or not in the box.
template <int Dim>
Eigen::VectorXd bounded_voronoi_scales(const PointsRef<Dim>& centers, const Box<Dim>& box,
                                       const Progress& progress = {});

/// The same with the box replaced by the points: the distance of each centre to the farthest of the points that are
/// nearer to it than to any other centre, 0 if there are none. The balls cover the points. O(N log M) in any dimension.
///
/// Throws InvalidInput when there are points but no centre, or a coordinate is not finite.
template <int Dim>
Eigen::VectorXd discrete_voronoi_scales(const PointsRef<Dim>& centers, const PointsRef<Dim>& points);

}  // namespace csrbf
