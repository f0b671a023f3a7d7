#pragma once

#include "csrbf/tiles/folder/tile_team.hpp"
#include "csrbf/tiles/stages/mesh_tile.hpp"

namespace csrbf {

/// The mesh of all tiles.
struct WeldedMesh {
  Topology topology;
  Index dropped = 0;  ///< components without points
  Index weak_features = 0;
};

/// Joins the parts of all tiles, made in the given rounds, and writes the mesh. All processes call it: the leading one
/// numbers the vertices, by what parts share, and each writes the bytes of its tiles, where the output is .ply; other
/// formats the leading one writes at once. An output that ends with a slash is a folder, made if there is none: each
/// tile with a part of the mesh gets a file tile_NNNN.ply in it; those of earlier meshes are replaced or removed.
/// Memory: one part, and in the leading process what parts share; for other formats the whole mesh. Throws IoError;
/// SolverFailure for a mesh without triangles.
WeldedMesh weld_parts(const TileTeam& team, const std::vector<int>& rounds, const std::string& output);

}  // namespace csrbf
