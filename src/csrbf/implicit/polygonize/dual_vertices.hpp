#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/implicit/polygonize/brick_grid.hpp"
#include "csrbf/implicit/polygonize/quadric.hpp"

namespace csrbf::polygonization {

/// The four vertices around every crossed edge, counter-clockwise seen from outside; column = number of the edge.
using Quads = Eigen::Matrix<std::int32_t, 4, Eigen::Dynamic>;

/// A vertex between corners `side` and side + 1 of a quad.
struct SideVertex {
  int quad;
  int side;
  int vertex;
};

/// Where a vertex is: in a cell, or on its upper face across an axis.
struct VertexPlace {
  Cell cell = Cell::Zero();
  int loop = 0;   ///< which of the loops of the cell it stands for; on a face: none
  int face = -1;  ///< axis; -1: in the cell

  static constexpr int kinds = 8;
  /// Tells the vertices of a cell apart: below `kinds`.
  [[nodiscard]] int kind() const { return face < 0 ? loop : 4 + face; }
};

/// The cell of a vertex and the planes it was placed by, measured from the origin of the lattice.
struct CellPlanes {
  Cell cell = Cell::Zero();
  Quadric planes;
};

/// The surface dual to the polygons of marching cubes: a vertex for every loop of a cell (Nielson 2004), a quad for
/// every crossed edge.
struct DualSurface {
  Quads quads;
  std::vector<SideVertex> side_vertices;  ///< by quad and side
  std::vector<char> loose;                ///< whether the planes of a vertex in a cell do not meet in a point
  Index loop_vertices = 0;                ///< vertices in cells; those on faces follow
  std::vector<VertexPlace> places;        ///< of the vertices
};

/// The box allowed for a vertex of a cube of cells: half a cell beyond it, but not beyond the caps.
Box<3> room_for_vertices(const CellLattice& lattice, const Point<3>& corner, int cells);

/// Numbers the loops of the cells in the order of bricks and cells, places a vertex in each where the sum of squared
/// distances from the planes through the crossings of its edges is least (Ju, Losasso, Schaefer, Warren 2002), and
/// collects the quads. `crossings` holds crossing points and normals of all edges. Fills vertices, and the mean normals
/// of the planes, of the mesh; and, unless null, the planes of each vertex.
///
/// Where cells around an edge are not there, its quad has vertices -1.
///
/// Two loops in neighbouring cells can meet twice on their common face. One of the two lines between them then gets a
/// vertex on the face, or both would be the same edge of the mesh.
DualSurface make_dual_surface(const CellLattice& lattice, const std::vector<Brick*>& bricks, const Mesh& crossings,
                              Mesh& mesh, std::vector<CellPlanes>* planes);

}  // namespace csrbf::polygonization
