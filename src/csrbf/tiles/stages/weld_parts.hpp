#pragma once

#include "csrbf/tiles/stages/mesh_tile.hpp"

namespace csrbf {

/// The mesh of all tiles.
struct WeldedMesh {
  Topology topology;
  Index dropped = 0;  ///< components without points
};

/// Joins the parts of all tiles, in the given rounds, and writes the mesh: .ply in pieces, other formats at once.
/// Memory: one part, and what parts share; for other formats the whole mesh. Throws IoError.
WeldedMesh weld_parts(const TileFolder& folder, const std::vector<int>& rounds, const std::string& output,
                      const Progress& progress);

}  // namespace csrbf
