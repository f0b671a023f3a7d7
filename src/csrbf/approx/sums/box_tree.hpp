#pragma once

#include "csrbf/approx/sums/box_operators.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

namespace csrbf {

/// A cube of the tree: cell `cell` of 2^level along each axis.
template <int Dim>
struct TreeBox {
  int level = 0;
  BoxOffset<Dim> cell{};
  Index first = 0;  ///< its points are `count` ones from here on, in the order of the tree
  Index count = 0;
  Index parent = -1;
  std::array<std::int32_t, 1U << Dim> child{};  ///< by corner as in BoxOperators::to_parent; -1: none
  /// Where its sums come from directly; complete for those without children.
  std::vector<std::int32_t> near{};

  [[nodiscard]] bool leaf() const {
    return std::all_of(child.begin(), child.end(), [](std::int32_t c) { return c < 0; });
  }
};

/// Translations to consecutive boxes of one level, sorted by offset.
struct TranslationTask {
  struct Group {
    Index code;         // of BoxOperators
    unsigned mirrored;  // bit d: the offset along axis d is negative
    Index begin, end;   // of pairs
  };
  struct Pair {
    std::int32_t target, source;
  };
  std::vector<Group> groups{};
  std::vector<Pair> pairs{};
};

struct TreeOptions {
  double tolerance = 1e-7;
  /// Points; boxes with more are divided; 0: where direct sums at the points cost more than expansions, 40 for sums
  /// everywhere.
  Index leaf_size = 0;
  /// Whether boxes without points are divided as well, wherever sums there need it; otherwise sums are only found at
  /// the points.
  bool everywhere = false;
};

/// What a fast multipole method needs to know about n points: an octree (a quadtree in the plane), and for every box
/// from which others its sums come, through which operators. Boxes are divided until they hold few points, and near
/// dense ones until direct sums cost less than expansions (for sums everywhere: until all near them hold few).
/// O(n log n) in time, O(n) in memory.
template <int Dim>
struct BoxTree {
  Point<Dim> corner;                  ///< the lowest of the cube of level 0
  double side = 1;                    ///< of that cube
  std::vector<Index> order{};         ///< the points, box by box
  std::vector<TreeBox<Dim>> boxes{};  ///< level by level, neighbours together
  std::vector<Index> level_begin{};   ///< first box of each level, and the end
  /// Operators of each level, possibly shared by several, and the factor that they need; null where none is used.
  std::vector<std::shared_ptr<BoxOperators<Dim>>> operators{};
  std::vector<double> factor{};
  std::vector<std::vector<TranslationTask>> tasks{};  ///< of each level

  BoxTree(const PointsRef<Dim>& points, const Kernel& kernel, double support, const TreeOptions& options);

  [[nodiscard]] int levels() const { return static_cast<int>(level_begin.size()) - 1; }
  /// Whether it holds so few points that it is not divided on their account.
  [[nodiscard]] bool few(const TreeBox<Dim>& box) const {
    return box.count <= leaf_size[box.level] || box.level == last_level;
  }
  [[nodiscard]] double half(int level) const { return std::ldexp(.5 * side, -level); }
  [[nodiscard]] Point<Dim> center(const TreeBox<Dim>& box) const;
  /// The leaf that holds x, -1 outside the cube and where no box is.
  [[nodiscard]] Index leaf_at(const Point<Dim>& x) const;

  static constexpr int last_level = 30;

 private:
  void divide(Index box, const PointsRef<Dim>& points, std::vector<Index>& scratch);
  void choose_operators(int level, const Kernel& kernel, double support);
  void list(int level);
  void list_sources(Index target, std::vector<std::pair<std::int64_t, std::int32_t>>& far);
  [[nodiscard]] bool needs_division(const TreeBox<Dim>& box) const;

  std::vector<Index> leaf_size = {};  // of each level, increasing
  Index asked_leaf_size = 0;
  bool everywhere = false;
  double tolerance = 1e-7;
};

}  // namespace csrbf
