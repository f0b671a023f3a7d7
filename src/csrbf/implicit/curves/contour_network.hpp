#pragma once

#include "csrbf/core/field.hpp"

namespace csrbf::contouring {

/// The corners of the cells with the field minus the level there.
struct Lattice {
  GridAxes<2> axes;
  Eigen::VectorXd value;

  [[nodiscard]] Index cells(std::size_t axis) const { return axes[axis].size() - 1; }
  [[nodiscard]] Index corner(Index i, Index j) const { return i + axes[0].size() * j; }
  [[nodiscard]] bool inside(Index corner) const { return value[corner] >= 0; }
  [[nodiscard]] Point<2> position(Index corner) const {
    return {axes[0][corner % axes[0].size()], axes[1][corner / axes[0].size()]};
  }
  /// Two edges start from a corner, along x and along y.
  [[nodiscard]] Index edge(Index corner, int axis) const { return 2 * corner + axis; }
};

/// The root t of the field along one edge of unit length, with a bracket lo <= t <= hi.
struct EdgeRoot {
  Point<2> start, edge;
  bool starts_inside;
  double t;
  double lo = 0, hi = 1;
  double last_step = 1;
  Point<2> gradient = Point<2>::Zero();

  [[nodiscard]] Point<2> position() const { return start + t * edge; }
};

/// Directed segments between vertices, with the inside on their left; each vertex starts one and ends one. The first
/// vertices are those on crossed edges, the others corners on the border of the box, along which contours are closed.
struct Network {
  static constexpr std::int32_t none = -1;

  std::vector<EdgeRoot> roots;
  std::vector<std::int32_t> vertex_on;  ///< of edges; none where they are not crossed
  std::vector<Index> border_corners;
  std::vector<std::int32_t> next;

  [[nodiscard]] bool on_border(std::int32_t vertex) const { return vertex >= static_cast<std::int32_t>(roots.size()); }
};

/// The segments of all cells and of the border. Vertices on edges are placed by linear interpolation.
Network make_network(const Lattice& lattice);

/// Moves the vertices on edges to where f = level, and fills the gradients there. Throws SolverFailure where the field
/// is not finite.
void solve_roots(const Field<2>& field, double level, std::vector<EdgeRoot>& roots);

/// Throws SolverFailure: the field is not finite at p.
[[noreturn]] void refuse(double value, const Point<2>& p);

}  // namespace csrbf::contouring
