#pragma once

#include "csrbf/implicit/polygonize_part.hpp"
#include "csrbf/tiles/stages/fit_surface_tile.hpp"
#include "csrbf/tiles/stages/part_seam.hpp"

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

/// Writes the triangles of a tile, "part", its "seam", and its "border"; `round` counts the attempts. Needs the fits of
/// the tiles around it.
void mesh_tile(const TileWork<3>& work, const MeshWork& mesh, const TileFolder& folder, Index tile, int round,
               const std::vector<polygonization::Cell>& starts, const Progress& progress);

std::string part_kind(int round);
std::string seam_kind(int round);
std::string border_kind(int round);
std::string missing_kind(int round);

/// Tiles whose cells may touch those of a tile, and itself.
std::vector<Index> tiles_around(const MeshWork& mesh, const TilePlan<3>& plan, Index tile);

/// Writes the cells of a tile that others know to be crossed, and that it has not found, "missing": none when the mesh
/// is complete there. Needs the borders of the tiles around it, made in the given rounds.
void find_missing(const MeshWork& mesh, const TilePlan<3>& plan, const TileFolder& folder, Index tile,
                  const std::vector<int>& rounds, int round);

/// Throws IoError.
std::vector<polygonization::Cell> read_missing(const TileFolder& folder, Index tile, int round);

}  // namespace csrbf
