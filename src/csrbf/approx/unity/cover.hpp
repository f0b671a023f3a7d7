#pragma once

#include "csrbf/core/types.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace csrbf {

struct CellNodes;

/// What a cover is for: find() and supports_over() are available for evaluation only.
enum class CoverUse { fitting, evaluation };

/// A cover of the bounding box of scattered points: a kd-tree whose leaves, the cells, tile the box, each with a
/// support that is the cell grown about its centre, so that supports overlap (thesis 3.3.1 and Algorithm 4, corrected:
/// cells are split without overlap and grown afterwards, so the box has no holes and no point is counted more often
/// than the growth requires).
///
/// A cell is halved across its longest side, near the median of its points but not nearer than 30 % to its ends, until
/// it holds at most `leaf_size` of them: cells stay compact, and where there are no points there are few cells.
template <int Dim>
class Cover {
 public:
  /// `growth` > 1: side of a support over that of its cell. O(n log n).
  Cover(const PointsRef<Dim>& points, Index leaf_size, double growth, CoverUse use = CoverUse::evaluation);

  /// The same for the points of another cover, which are already sorted: only cells that hold too many are split. Cells
  /// that the other cover splits keep the order of their points.
  Cover(Cover sorted, Index leaf_size);

  /// The cells and tree of a saved cover, see `Tree`, without points.
  struct Tree {
    Box<Dim> box;
    std::vector<std::int8_t> axis;  ///< of the split of each node in preorder; -1 for cells
    std::vector<double> split;      ///< its coordinate; 0 for cells
    /// Node of the upper part (the lower part is the next node); for cells their number.
    std::vector<std::uint32_t> right;
    double growth = 1;
  };
  explicit Cover(Tree tree);
  [[nodiscard]] const Tree& tree() const { return tree_; }

  /// Number of cells, which is that of supports.
  [[nodiscard]] Index size() const { return static_cast<Index>(cells_.size()); }
  [[nodiscard]] const Box<Dim>& box() const { return tree_.box; }
  [[nodiscard]] double growth() const { return tree_.growth; }
  [[nodiscard]] const Box<Dim>& cell(Index i) const { return cells_[i]; }

  /// The cell of the tree that x falls into, also for x outside the box.
  [[nodiscard]] Index find(const Point<Dim>& x) const;

  /// The supports that reach into a cell, in ascending order.
  [[nodiscard]] std::span<const std::uint32_t> supports_over(Index cell) const {
    const auto i = static_cast<std::size_t>(cell);
    return {over_.data() + over_begin_[i], over_begin_[i + 1] - over_begin_[i]};
  }

  /// The supports that reach into some cell that meets a box, in ascending order.
  void supports_over(const Box<Dim>& box, std::vector<std::uint32_t>& supports) const;

  /// The points, cell by cell.
  [[nodiscard]] const Points<Dim>& points() const { return points_; }
  /// Their numbers in the input.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }
  /// Rows of numbers, one per point of the input, in the order of points(); none when none are given. Throws
  /// InvalidInput unless there is a row per point or none.
  [[nodiscard]] Eigen::MatrixXd in_order(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;
  /// Number of points in a cell.
  [[nodiscard]] Index count(Index cell) const { return begin_[static_cast<std::size_t>(cell) + 1] - begin_[cell]; }

  /// Work space of `nearest`.
  struct Search {
    std::vector<std::pair<double, std::uint32_t>> found;  ///< squared distances and columns

    std::vector<std::pair<double, std::uint32_t>> near, sorted;
    std::vector<std::uint32_t> bucket, end;
  };
  /// Columns of points() of the n points nearest to x, sorted by distance; fewer only if there are fewer points.
  /// `reach` is an estimate of the distance of the last one.
  void nearest(const Point<Dim>& x, Index n, double reach, Search& search) const;

  /// Whether there is one of the points within `reach` of x.
  [[nodiscard]] bool any_within(const Point<Dim>& x, double reach) const;

 private:
  /// Calls visit(cell) for the cells that points of the box fall into, in order.
  template <class Visit>
  void for_each_cell(const Box<Dim>& box, const Visit& visit) const;
  std::size_t collect(const Point<Dim>& x, double reach, std::size_t limit, Search& search) const;
  [[nodiscard]] double shrink(const Point<Dim>& x, Index n, double reach) const;
  void build(const PointsRef<Dim>& points, const CellNodes& sorted, Index leaf_size, CoverUse use);
  void make_cells();
  void make_grid();
  void find_supports();

  Tree tree_;
  std::vector<Box<Dim>> cells_;
  // A regular grid over the box, with as many parts as there are cells: the deepest node that holds each part.
  Index parts_ = 1;  // per axis
  Point<Dim> parts_per_length_ = Point<Dim>::Zero();
  std::vector<std::uint32_t> start_;
  std::vector<std::size_t> over_begin_;
  std::vector<std::uint32_t> over_;
  Points<Dim> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Index> begin_;
};

template <int Dim>
template <class Visit>
void Cover<Dim>::for_each_cell(const Box<Dim>& box, const Visit& visit) const {
  std::array<std::uint32_t, 512> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t node = stack[--depth];
    const int axis = tree_.axis[node];
    if (axis < 0) {
      visit(tree_.right[node]);
      continue;
    }
    if (box.hi[axis] >= tree_.split[node]) stack[depth++] = tree_.right[node];
    if (box.lo[axis] < tree_.split[node]) stack[depth++] = node + 1;
  }
}

}  // namespace csrbf
