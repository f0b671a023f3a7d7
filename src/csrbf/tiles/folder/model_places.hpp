#pragma once

#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/tiles/folder/tile_folder.hpp"

namespace csrbf {

/// The models of all tiles, as files of the folder.
std::vector<TilePlace> model_places(const TileFolder& folder, Index tiles);

}  // namespace csrbf
