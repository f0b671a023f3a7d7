#pragma once

#include "csrbf/io/point_stream.hpp"
#include "csrbf/tiles/folder/tile_folder.hpp"
#include "csrbf/tiles/tile_options.hpp"

namespace csrbf {

/// Reads all points once and decides on the tiles. Memory: a piece of the input and a sample of it. Throws InvalidInput
/// for fewer than four finite points.
TileWork plan_work(PointStream& points, const TileOptions& options, const std::string& fingerprint);

/// Deals this process's share of the input to raw files of the tiles.
void deal_points(PointStream& points, const TileWork& work, const TileFolder& folder, const TileShare& share,
                 const Progress& progress);

/// Makes the file "points" of a tile from the raw ones of all processes, and removes these.
void sort_points(const TileWork& work, const TileFolder& folder, Index tile, Index processes);

}  // namespace csrbf
