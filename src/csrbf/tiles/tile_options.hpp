#pragma once

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct_options.hpp"

#include <string>

namespace csrbf {

/// Which part of the work of reconstruct_tiles() a process does, when several share a folder.
struct TileShare {
  Index rank = 0;   ///< of this process, from 0
  Index count = 1;  ///< processes; each must be started
};

/// How reconstruct_tiles() works. What is not said here is chosen from the data.
struct TileOptions {
  /// Points per tile at most, about; memory grows with it: about 800 bytes for each point of a tile.
  Index tile_points = 1'000'000;
  /// Where finished steps are kept. A folder with steps of the same work is continued, to the same result.
  std::string folder;
  /// Method composite; `tolerance`, `centers` and `region` are refused.
  ReconstructOptions surface = {};
  /// Cells along the longest side; 0: from the data, as automatic_resolution().
  int resolution = 0;
  /// Edges and corners of the mesh: not set: dual contouring for clean samples, marching cubes for noisy ones.
  std::optional<PolygonizeMethod> mesh_method = {};
  TileShare share = {};
};

}  // namespace csrbf
