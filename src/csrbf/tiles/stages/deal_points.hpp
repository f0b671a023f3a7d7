#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/io/point_stream.hpp"
#include "csrbf/tiles/folder/tile_folder.hpp"

namespace csrbf {

/// Reads all points once and decides on tiles of up to `tile_points` for a mesh of that resolution (0: automatic).
/// Memory: a piece of the input and a sample of it. Throws InvalidInput for fewer than four finite points.
TileWork plan_work(PointStream& points, Index tile_points, int resolution, const std::string& fingerprint,
                   const Progress& progress);

/// Deals the share of the input of one process, of so many, to raw files of the tiles.
void deal_points(PointStream& points, const TileWork& work, const TileFolder& folder, Index process, Index processes,
                 const Progress& progress);

/// Makes the file "points" of a tile from the raw ones of all processes, and removes these.
void sort_points(const TileWork& work, const TileFolder& folder, Index tile, Index processes);

}  // namespace csrbf
