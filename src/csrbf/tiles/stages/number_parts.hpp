#pragma once

#include "csrbf/tiles/folder/tile_folder.hpp"
#include "csrbf/tiles/stages/part_seam.hpp"

#include <set>

namespace csrbf {

/// Components of the mesh that have no data, as components of the parts of tiles.
struct DroppedComponents {
  Index kept = 0, dropped = 0;                       ///< components of the mesh
  std::vector<std::set<std::int32_t>> of_part = {};  ///< left out
};

/// From the seams of all parts, which are read one after the other. Memory: what parts share.
DroppedComponents find_dropped(const std::vector<std::string>& seams);

void write_dropped(const std::string& path, const DroppedComponents& dropped);
/// Throws IoError.
DroppedComponents read_dropped(const std::string& path, Index parts);

/// Where the vertices and triangles of a part are in the mesh.
struct PartNumbers {
  Index first = 0;  ///< vertex: the next ones are those that no part before has
  Index first_triangle = 0;
  std::vector<std::int32_t> shared;  ///< number of each shared vertex; those below `first` are of parts before
};

/// What the mesh of all parts is.
struct WholeMesh {
  Topology topology;
  bool as_double = false;  ///< float would move coordinates by more than is to be seen
  Index weak_features = 0;
};

/// Numbers the vertices part by part, and writes that of each part: "numbers". Memory: what parts share. Throws
/// SolverFailure for more than 2^31 vertices.
WholeMesh number_parts(const std::vector<std::string>& seams, Index components, const TileFolder& folder);

/// Throws IoError.
PartNumbers read_numbers(const TileFolder& folder, Index tile);

void write_whole(const std::string& path, const WholeMesh& whole);
/// Throws IoError.
WholeMesh read_whole(const std::string& path);

}  // namespace csrbf
