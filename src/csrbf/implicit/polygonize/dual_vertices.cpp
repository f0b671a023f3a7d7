#include "csrbf/implicit/polygonize/dual_vertices.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/polygonize/cell_loops.hpp"
#include "csrbf/implicit/polygonize/edge_vertices.hpp"

#include <tuple>

namespace csrbf::polygonization {
namespace {

constexpr Index dual_bricks = 32;  // large enough to hide the cost of a task

// In cells; chosen by hand. Sharp edges that run almost along a wall between cells affect cells on both sides; confined
// to their cells, vertices would miss them by up to 0.15 cells.
constexpr double largest_overhang = 0.5;

// Largest rms distance of a vertex from its planes at an edge or a tip, in cells; on rough surfaces it is larger.
// Chosen by hand.
constexpr double loose_fit = 0.005;

int edge_number(const Brick& brick, int cell, const CellEdge& edge) {
  return edge_vertex(corner_at(brick, cell, edge.corner), 1 << edge.axis);
}

// Position of a cell around one of its edges, counter-clockwise seen from the upper end of the edge.
int place_around(const CellEdge& edge) {
  const int b = edge.corner >> (edge.axis + 1) % 3 & 1;
  const int c = edge.corner >> (edge.axis + 2) % 3 & 1;
  return b == 0 ? 3 * c : 1 + c;
}

bool lower_end_is_inside(const Brick& brick, int cell, const CellEdge& edge) {
  const CornerRef lower = corner_at(brick, cell, edge.corner);
  return lower.brick.inside >> lower.bit & 1;
}

// Corner of the quad around an edge that belongs to the cell, counter-clockwise seen from outside.
int quad_corner(const CellEdge& edge, bool lower_inside) {
  return lower_inside ? place_around(edge) : 3 - place_around(edge);
}

unsigned edges_of_loop(const CellLoop& loop) {
  unsigned edges = 0;
  for (int i = 0; i < loop.size; ++i) edges |= 1U << loop.edges[i];
  return edges;
}

// The edges of a cell on its upper face along an axis.
constexpr unsigned upper_face(int axis) {
  unsigned edges = 0;
  for (int e = 0; e < 12; ++e)
    if (cell_edges[e].axis != axis && (cell_edges[e].corner >> axis & 1)) edges |= 1U << e;
  return edges;
}

constexpr std::array<unsigned, 3> upper_faces{upper_face(0), upper_face(1), upper_face(2)};

bool passes_a_face_twice(const CellLoop& loop) {
  const unsigned edges = edges_of_loop(loop);
  return std::any_of(upper_faces.begin(), upper_faces.end(), [&](unsigned face) { return (edges & face) == face; });
}

class DualBuilder {
 public:
  DualBuilder(const CellLattice& lattice, const std::vector<Brick*>& bricks, const Mesh& crossings, Mesh& mesh,
              std::vector<CellPlanes>* planes)
      : lattice_(lattice), bricks_(bricks), crossings_(crossings), mesh_(mesh), planes_(planes) {}

  DualSurface build() {
    count_loops();
    surface_.loop_vertices = first_.back();
    surface_.loose.resize(first_.back());
    surface_.places.resize(first_.back());
    surface_.quads.setConstant(4, crossings_.vertices.cols(), -1);
    mesh_.vertices.resize(3, first_.back());
    mesh_.normals.resize(3, first_.back());
    if (planes_ != nullptr) planes_->assign(first_.back(), {});
    parallel_for(std::ssize(bricks_), dual_bricks, [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b) place_vertices(b);
    });
    add_side_vertices();
    return std::move(surface_);
  }

 private:
  void count_loops() {
    first_.assign(bricks_.size() + 1, 0);
    doubled_.assign(bricks_.size(), 0);
    parallel_for(std::ssize(bricks_), dual_bricks, [&](Index begin, Index end) {
      for (Index b = begin; b < end; ++b)
        for_each_loop(*bricks_[b], [&](int, const CellLoop& loop) {
          ++first_[b + 1];
          doubled_[b] = doubled_[b] || passes_a_face_twice(loop);
        });
    });
    for (std::size_t b = 0; b < bricks_.size(); ++b) first_[b + 1] += first_[b];
  }

  void place_vertices(Index b) {
    const Brick& brick = *bricks_[b];
    Index vertex = first_[b];
    int last_cell = -1, loop_of_cell = 0;
    for_each_loop(brick, [&](int cell, const CellLoop& loop) {
      const Point<3> corner = lattice_.position(brick.corner(cell));
      Quadric quadric;
      Point<3> normal = Point<3>::Zero();
      for (int i = 0; i < loop.size; ++i) {
        const CellEdge edge = cell_edges[loop.edges[i]];
        const int e = edge_number(brick, cell, edge);
        quadric.add(crossings_.vertices.col(e) - corner, crossings_.normals.col(e));
        normal += crossings_.normals.col(e);
        surface_.quads(quad_corner(edge, lower_end_is_inside(brick, cell, edge)), e) = static_cast<int>(vertex);
        if (planes_ != nullptr) add_plane(e, (*planes_)[vertex]);
      }
      loop_of_cell = cell == last_cell ? loop_of_cell + 1 : 0;
      last_cell = cell;
      surface_.places[vertex] = {brick.corner(cell), loop_of_cell};
      if (planes_ != nullptr) (*planes_)[vertex].cell = brick.corner(cell);
      const Box<3> room = room_for_vertices(lattice_, corner, 1);
      const Point<3> p = quadric.minimizer({room.lo - corner, room.hi - corner});
      surface_.loose[vertex] = quadric.distance(p) > loose_fit * lattice_.spacing.minCoeff();
      mesh_.vertices.col(vertex) = corner + p;
      mesh_.normals.col(vertex) = normal.stableNormalized();
      ++vertex;
    });
  }

  void add_plane(int crossing, CellPlanes& to) const {
    to.planes.add(crossings_.vertices.col(crossing) - lattice_.origin, crossings_.normals.col(crossing));
  }

  void add_side_vertices() {
    std::vector<Point<3>> points;
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
      if (!doubled_[b]) continue;
      for_each_loop(*bricks_[b], [&](int cell, const CellLoop& loop) {
        for (int axis = 0; axis < 3; ++axis)
          if ((edges_of_loop(loop) & upper_faces[axis]) == upper_faces[axis])
            separate(*bricks_[b], cell, loop, axis, points);
      });
    }
    std::sort(
        surface_.side_vertices.begin(), surface_.side_vertices.end(),
        [](const SideVertex& a, const SideVertex& b) { return std::tie(a.quad, a.side) < std::tie(b.quad, b.side); });
    const auto n = std::ssize(points);
    mesh_.vertices.conservativeResize(3, surface_.loop_vertices + n);
    mesh_.normals.conservativeResize(3, surface_.loop_vertices + n);
    mesh_.normals.rightCols(n).setZero();
    for (Index i = 0; i < n; ++i) mesh_.vertices.col(surface_.loop_vertices + i) = points[i];
  }

  // If both cuts of the upper face along an axis lead to the same vertex, the second gets a vertex on the face.
  void separate(const Brick& brick, int cell, const CellLoop& loop, int axis, std::vector<Point<3>>& points) {
    int neighbour = -1;
    for (int i = 0; i < loop.size; ++i) {
      const std::array<int, 2> ends{loop.edges[i], loop.edges[(i + 1) % loop.size]};
      if (!(upper_faces[axis] >> ends[0] & 1) || !(upper_faces[axis] >> ends[1] & 1)) continue;
      std::array<SideVertex, 2> sides;
      int across = -1;
      for (int k = 0; k < 2; ++k) {
        const CellEdge edge = cell_edges[ends[k]];
        const CellEdge from_above{edge.axis, edge.corner & ~(1 << axis)};  // as the cell above the face sees it
        const int quad = edge_number(brick, cell, edge);
        const bool lower_inside = lower_end_is_inside(brick, cell, edge);
        const int here = quad_corner(edge, lower_inside), there = quad_corner(from_above, lower_inside);
        across = surface_.quads(there, quad);
        const auto vertex = static_cast<int>(surface_.loop_vertices + std::ssize(points));
        sides[k] = {quad, (here + 1) % 4 == there ? here : there, vertex};
      }
      if (across < 0) continue;  // no cell across the face
      if (across != neighbour) {
        neighbour = across;
        continue;
      }
      if (planes_ != nullptr) planes_->push_back({brick.corner(cell), {}});
      for (const SideVertex& side : sides) {
        surface_.side_vertices.push_back(side);
        if (planes_ != nullptr) add_plane(side.quad, planes_->back());
      }
      surface_.places.push_back({brick.corner(cell), 0, axis});
      points.emplace_back(0.5 * (crossings_.vertices.col(sides[0].quad) + crossings_.vertices.col(sides[1].quad)));
    }
  }

  const CellLattice& lattice_;
  const std::vector<Brick*>& bricks_;
  const Mesh& crossings_;
  Mesh& mesh_;
  std::vector<CellPlanes>* planes_;
  DualSurface surface_;
  std::vector<Index> first_;   // vertex of each brick
  std::vector<char> doubled_;  // bricks in which a loop passes a face twice
};

}  // namespace

Box<3> room_for_vertices(const CellLattice& lattice, const Point<3>& corner, int cells) {
  const Box<3> limits = lattice.capped_box();
  const Point<3> overhang = largest_overhang * lattice.spacing;
  return {limits.lo.cwiseMax(corner - overhang), limits.hi.cwiseMin(corner + cells * lattice.spacing + overhang)};
}

DualSurface make_dual_surface(const CellLattice& lattice, const std::vector<Brick*>& bricks, const Mesh& crossings,
                              Mesh& mesh, std::vector<CellPlanes>* planes) {
  return DualBuilder(lattice, bricks, crossings, mesh, planes).build();
}

}  // namespace csrbf::polygonization
