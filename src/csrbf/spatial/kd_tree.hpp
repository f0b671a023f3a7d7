#pragma once

#include "csrbf/core/types.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Nearest-neighbour search in a fixed point set. The points are referenced, not copied: they must outlive the tree.
/// Queries are thread safe. Build O(n log n); queries O(log n + k). Fastest when points are in Morton order.
template <int Dim>
class KdTree {
 public:
  explicit KdTree(const PointsRef<Dim>& points);
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree();

  [[nodiscard]] Index size() const;

  /// Writes the k points nearest to x, nearest first, to `indices` and `squared_distances` (k entries each) and returns
  /// how many were found: min(k, size()).
  Index nearest(const Point<Dim>& x, Index k, Index* indices, double* squared_distances) const;

  /// Indices of all points with |p - x| < radius, in ascending order; replaces the contents of `indices`.
  void within(const Point<Dim>& x, double radius, std::vector<Index>& indices) const;

  /// Whether there is a point with |p - x| < radius; stops at the first one found.
  [[nodiscard]] bool any_within(const Point<Dim>& x, double radius) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Of the points of a tree, the first ones that are not nearer to each other than a distance: indices, ascending. A
/// search for each of them, which together find every point at most some ten times: O(n log n), on one thread.
std::vector<Index> points_apart(const Points<3>& points, const KdTree<3>& tree, double distance);

}  // namespace csrbf
