#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// How partition() splits. The defaults were chosen by hand.
struct PointPartitionOptions {
  /// Largest number of points in a leaf. At least 1.
  Index leaf_size = 16;
  /// A leaf whose points leave a gap wider than this many local spacings along one of its principal axes bridges two
  /// sheets and is cut there. Smaller values also cut unevenly sampled sheets. Needs `spacing`.
  double max_gap = 2.5;
  /// A leaf whose mean unit normal is shorter than this spans both sides of a sheet or a sharp bend and is cut by the
  /// direction of its normals. Larger values also cut where curvature is high. Needs `normals`.
  double min_mean_normal = 0.6;
};

/// Points grouped in leaves: leaf i holds order[begin[i]] ... order[begin[i + 1] - 1]. Consecutive leaves are
/// neighbours in space.
struct PointPartition {
  std::vector<Index> order;
  std::vector<Index> begin;
  /// Of the cut where each leaf begins: how many cuts of parts that it is in came before; 0 for the first leaf, -1 for
  /// a cut between sheets.
  std::vector<int> depth;

  [[nodiscard]] Index leaves() const { return std::ssize(begin) - 1; }
};

/// Splits points without overlap by recursive cuts across the principal axis, into leaves of nearly equal size, then
/// cuts every leaf that bridges two sheets (see PointPartitionOptions). Cuts follow the points, not the coordinate
/// axes, so the leaves rotate with the cloud. `normals` (Dim x n) and `spacing` (n) may be empty: their tests are then
/// skipped. O(n log n). Replaces the overlapping cover of the thesis (Algorithm 4), which copies points at every level.
template <int Dim>
PointPartition partition(const PointsRef<Dim>& points, const PointsRef<Dim>& normals,
                         const Eigen::Ref<const Eigen::VectorXd>& spacing, const PointPartitionOptions& options = {});

/// Halves the n points `ids` as partition() does (`normals` may be empty): reorders them and returns the size of the
/// first half (n / 2).
template <int Dim>
Index halve(const PointsRef<Dim>& points, const PointsRef<Dim>& normals, Index* ids, Index n);

}  // namespace csrbf
