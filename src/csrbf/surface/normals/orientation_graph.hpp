#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

/// The parts of orient_normals. Internal.
namespace csrbf::orientation {

/// Disjoint sets of points, with the sign of every point relative to the root of its set.
class SignedSets {
 public:
  explicit SignedSets(Index n);

  struct Found {
    std::uint32_t root;
    int sign;  ///< 1 or -1
  };
  Found find(Index i);
  /// Joins the sets of a and b, where sign(a) = sign * sign(b); false when they are one already.
  bool join(Index a, Index b, int sign);
  [[nodiscard]] Index size(std::uint32_t root) const { return size_[root]; }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<signed char> sign_;  // relative to the parent
  std::vector<std::uint32_t> size_;
};

struct Edge {
  std::uint32_t a, b;
};

/// Pairs of points whose normals should agree, the most certain ones first.
struct Graph {
  std::vector<Edge> edges;
  std::size_t certain = 0;  ///< edges before this one are reliable
  std::size_t near = 0;     ///< edges before this one join neighbours; the others bridge gaps between components
};

/// Cost of an edge between two points: 1 - |n_a . n_b|, plus the mean sine of the angles between the edge and the two
/// tangent planes, which keeps the two sides of a thin sheet apart. In [0, 2]; infinite for a zero normal.
double cost(const Point<3>& pa, const Point<3>& na, const Point<3>& pb, const Point<3>& nb);

/// The neighbour graph, ordered by cost plus the roughness around both points, with additional edges between ever
/// sparser subsets of the points until it is connected. Points with a zero normal have no edges. Where the signs are
/// given, neighbours that contradict each other are not certain. O(n log n).
Graph make_graph(const Points<3>& points, const Points<3>& normals, const NeighborTable& table,
                 bool signs_given = false);

/// A partition of the points into clusters whose relative signs are trusted.
struct Clusters {
  std::vector<std::int32_t> of;        ///< cluster of each point, -1 for zero normals
  std::vector<signed char> sign;       ///< of each point relative to its cluster
  std::vector<signed char> tree_sign;  ///< of each cluster by the spanning tree
  std::vector<std::int32_t> parent;    ///< parent in the spanning tree, -1 for none; smaller than the cluster's number
  Index tree_edges = 0;                ///< number of edges of the spanning tree of the points
  Index flipped_edges = 0;             ///< of these, those whose normals disagree
  [[nodiscard]] Index size() const { return static_cast<Index>(tree_sign.size()); }
};

/// Cuts the minimum spanning tree of the graph into at most `max_clusters` clusters: edges from `trusted` on join
/// clusters only while one of them is small.
Clusters make_clusters(const Graph& graph, const Points<3>& normals, std::size_t trusted, Index max_clusters);

}  // namespace csrbf::orientation
