#pragma once

#include "csrbf/core/types.hpp"

namespace csrbf {

/// The poles of the Voronoi cells of points (Amenta and Bern 1998; thesis section 6.2.1.1).
template <int Dim>
struct VoronoiPoles {
  Points<Dim> positive;  ///< Dim x n: the corner of the cell farthest from its point
  Points<Dim> negative;  ///< Dim x n: the farthest corner on the other side of the point; NaN where there is none
};

/// Poles by the quickhull algorithm (Barber et al. 1996). Unbounded cells are cut off by sites at the corners of a box
/// six times as large as that of the points: their positive poles are far away, in the direction in which the cell is
/// open. For samples of a surface the negative poles are close to its medial axis where the sampling is dense.
/// Coincident points share a cell: all but one of them have no poles, nor does a single point. About 30 us per point of
/// a surface in space.
///
/// Throws InvalidInput for points that are not finite; SolverFailure when rounding defeats the algorithm.
template <int Dim>
VoronoiPoles<Dim> voronoi_poles(const PointsRef<Dim>& points);

/// Distance of every point to the nearest negative pole of any point: a local feature size (thesis eq. 6.22). It is at
/// most the distance to its own negative pole and at least the smallest such distance of all, because the balls around
/// poles contain no point. Infinite when there are no negative poles. O(n log n).
template <int Dim>
Eigen::VectorXd medial_axis_distances(const PointsRef<Dim>& points, const VoronoiPoles<Dim>& poles);

}  // namespace csrbf
