#pragma once

#include "csrbf/core/mesh.hpp"

namespace csrbf {

/// Simplifies a closed manifold mesh by collapsing edges, one at a time. It remains a closed manifold with the same
/// topology: an edge is collapsed only if its ends have no common neighbours but the two opposite it (the link
/// condition; Dey, Edelsbrunner, Guha, Nekhayev 1999). O(valence) for each collapse.
class EdgeCollapser {
 public:
  /// Holds a reference to the mesh, whose triangles change. Throws SolverFailure beyond 2^31 corners.
  explicit EdgeCollapser(Mesh& mesh);

  /// Moves u to p and merges v into it. Returns false and changes nothing if the topology would change, or a triangle
  /// would turn by more than about 80 degrees or become a needle.
  bool collapse(int u, int v, const Point<3>& p);

  /// Vertices joined to v by an edge, each once; empty for vertices that are gone. Valid until the next call.
  [[nodiscard]] const std::vector<int>& neighbours(int v);

  /// Removes collapsed vertices and triangles from the mesh; keeps the order. Returns the old number of each vertex.
  std::vector<int> finish();

 private:
  // Corner c of triangle t is 3 t + c; the corners of a vertex form a list.
  void collect(int v, std::vector<int>& found) const;
  void drop_gone(int v);
  [[nodiscard]] bool keeps_topology(int u, int v);
  [[nodiscard]] bool keeps_shape(int u, int v, const Point<3>& p) const;

  Mesh& mesh_;
  std::vector<int> first_;  // corner of each vertex, -1: gone
  std::vector<int> next_;   // corner of the same vertex, -1: none
  std::vector<char> gone_;  // triangles
  std::vector<int> around_, around_u_, around_v_;
};

/// Collapses edges shorter than `length` where topology and shape allow it, except at `pinned` vertices (one entry per
/// vertex; empty: none). Returns the old number of each vertex; empty: nothing changed.
std::vector<int> collapse_short_edges(double length, Mesh& mesh, const std::vector<char>& pinned = {});

}  // namespace csrbf
