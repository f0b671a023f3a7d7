#pragma once

#include "csrbf/core/mesh.hpp"

#include <vector>

namespace csrbf::polygonization {

/// Shortens a closed manifold mesh by collapsing edges, one at a time. It stays a closed manifold with the same
/// topology: an edge is collapsed only when its ends have no common neighbours but the two opposite it (the link
/// condition; Dey, Edelsbrunner, Guha, Nekhayev 1999). O(valence) for each collapse.
class EdgeCollapser {
 public:
  /// Holds a reference to the mesh, whose triangles change. Throws SolverFailure beyond 2^31 corners.
  explicit EdgeCollapser(Mesh& mesh);

  /// Moves u to p and merges v into it. False, and nothing changes, when the topology would change, a triangle would
  /// fold over by more than about 80 degrees or become a needle that was none.
  bool collapse(int u, int v, const Point<3>& p);

  /// Vertices joined to v by an edge, each once; empty for vertices that are gone. Valid until the next call.
  [[nodiscard]] const std::vector<int>& neighbours(int v);

  /// Drops what is gone from the mesh; order stays. Returns the old number of each vertex left.
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

/// Collapses the edges shorter than `length`, as far as topology and shape allow.
void collapse_short_edges(double length, Mesh& mesh);

}  // namespace csrbf::polygonization
