#pragma once

#include "csrbf/core/types.hpp"

#include <array>
#include <vector>

namespace csrbf {

/// Node of a bounding volume hierarchy with four children, whose boxes are interleaved so that one instruction tests
/// all of them. Slots without a child hold an empty box (lo = inf, hi = -inf).
struct alignas(64) TreeNode {
  using PerChild = Eigen::Array<float, 4, 1>;

  std::array<PerChild, 3> lo;
  std::array<PerChild, 3> hi;
  std::array<std::int32_t, 4> child;  ///< index of a node, or ~index of the first triangle of a leaf in leaf order

  TreeNode();
};

/// Box of one triangle in single precision, and which triangle it is.
struct TriangleBox {
  std::array<float, 3> lo;
  std::array<float, 3> hi;
  std::int32_t triangle;
};

/// Builds the hierarchy over `boxes`, reordering them into leaf order; node 0 is the root. The last triangle of every
/// leaf is marked: its number is complemented (~triangle). Splits by the surface area heuristic on 16 bins (Wald 2007);
/// leaves hold at most four triangles. The result does not depend on the number of threads. O(t log t).
std::vector<TreeNode> build_triangle_tree(std::vector<TriangleBox>& boxes);

/// Upper bound of the depth of the hierarchy: sizes the stacks of traversals.
inline constexpr int max_tree_depth = 72;

}  // namespace csrbf
