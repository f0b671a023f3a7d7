#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <optional>
#include <vector>

namespace csrbf {

struct FarthestPointsOptions {
  std::optional<Index> first =
      {};                  ///< index of the first pick; default: the point nearest to the bounding box's min corner
  Progress progress = {};  ///< stage "farthest points"
};

struct FarthestPoints {
  std::vector<Index> indices;  ///< the picks in order
  std::vector<double> radii;   ///< distance of each pick to those before it: non-increasing, infinite for the first
  double covering_radius = 0;  ///< largest distance from a point to the picks; at most the last radius
};

/// Farthest point sampling (Gonzalez 1985; thesis Algorithm 2): each pick is the point farthest from all earlier picks,
/// the one with the smallest index among ties. After any number of picks they are pairwise at least the last radius
/// apart and cover the points within it; no choice of as many centres covers them within half the covering radius.
///
/// Returns min(count, number of distinct points) picks: it stops when no point is left at a positive distance. The
/// picks are those of the direct O(count n) method, found in about O(n log n + n log count): a new pick visits only
/// those parts of a hierarchy of boxes to which it is closer than all earlier picks.
///
/// Throws InvalidInput when a coordinate is not finite, count is negative or `first` is not an index.
template <int Dim>
FarthestPoints farthest_points(const PointsRef<Dim>& points, Index count, const FarthestPointsOptions& options = {});

}  // namespace csrbf
