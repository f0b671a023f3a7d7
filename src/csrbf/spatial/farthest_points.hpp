#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <optional>
#include <vector>

namespace csrbf {

struct FarthestPointsOptions {
  /// Index of the first pick; unset: the point nearest to the lower corner of the bounding box.
  std::optional<Index> first = {};
  Progress progress = {};  ///< stage "farthest points"
};

struct FarthestPoints {
  std::vector<Index> indices;  ///< the picks in order
  std::vector<double> radii;   ///< distance of each pick to those before it: never increases; infinite for the first
  double covering_radius = 0;  ///< largest distance from a point to the nearest pick; at most the last radius
};

/// Farthest point sampling (Gonzalez 1985; thesis Algorithm 2): each pick is the point farthest from all earlier ones;
/// among ties the one with the smallest index. After any number of picks these are at least the last radius apart, and
/// every point is within it of a pick; no other choice of as many points covers all points within half the covering
/// radius.
///
/// Returns min(count, number of distinct points) picks: it stops if no point is left at a positive distance. The picks
/// are those of the direct method, which takes O(count n), but found in about O(n log n + n log count): a new pick
/// visits only those parts of a hierarchy of boxes that it is closer to than all earlier ones.
///
/// Throws InvalidInput if a coordinate is not finite, count is negative or `first` is not an index; Cancelled.
template <int Dim>
FarthestPoints farthest_points(const PointsRef<Dim>& points, Index count, const FarthestPointsOptions& options = {});

}  // namespace csrbf
