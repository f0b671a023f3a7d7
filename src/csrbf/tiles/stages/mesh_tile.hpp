#pragma once

#include "csrbf/implicit/polygonize_part.hpp"
#include "csrbf/surface/check/data_support.hpp"
#include "csrbf/tiles/stages/fit_surface_tile.hpp"

namespace csrbf {

/// What the meshes of all tiles have in common.
struct MeshWork {
  Box<3> bounds;  ///< of the points used
  double feature_size = 0;
  int resolution = 0;
  PolygonizeMethod method = PolygonizeMethod::marching_cubes;
  polygonization::CellLattice lattice;
};

/// From the fits of all tiles. Resolution 0 and no method: those that suit the data.
MeshWork plan_meshes(const TileWork<3>& work, const std::vector<TileFit>& fits, int resolution,
                     std::optional<PolygonizeMethod> method);

/// The cells whose centres are in a tile.
polygonization::CellRange cells_of_tile(const MeshWork& mesh, const TilePlan<3>& plan, Index tile);

/// The triangles of a tile, with the data of each connected component.
struct TilePart {
  Mesh mesh;
  std::vector<polygonization::SharedVertex> shared;
  std::vector<DataSupport> supports;
};

/// Where surfaces cross from tile to tile.
struct TileBorder {
  std::vector<polygonization::Cell> starts;  ///< further cells that the mesh was traced from
  std::vector<polygonization::Cell> border;  ///< see MeshPart
  std::vector<polygonization::Cell> beyond;
};

/// Writes the triangles of a tile, "part", and its "border"; `round` counts the attempts. Needs the fits of the tiles
/// around it.
void mesh_tile(const TileWork<3>& work, const MeshWork& mesh, const TileFolder& folder, Index tile, int round,
               const std::vector<polygonization::Cell>& starts, const Progress& progress);

std::string part_kind(int round);
std::string border_kind(int round);
TileBorder read_border(const TileFolder& folder, Index tile, int round);
TilePart read_part(const TileFolder& folder, Index tile, int round);

/// Cells of each tile that others know to be crossed, and that it has not found: none when the mesh is complete.
std::vector<std::vector<polygonization::Cell>> missing_starts(const MeshWork& mesh, const TilePlan<3>& plan,
                                                              const std::vector<TileBorder>& borders);

}  // namespace csrbf
