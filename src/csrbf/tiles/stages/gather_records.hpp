#pragma once

#include "csrbf/tiles/folder/tile_files.hpp"
#include "csrbf/tiles/folder/tile_work.hpp"

namespace csrbf {

/// All points in a tile and around it, up to the halo. Needs the points of the tiles there.
template <int Dim>
Records<Dim> gather_near(const TileWork<Dim>& work, const TileFolder& folder, Index tile);

/// Adds ever fewer points farther away. Needs the points of all tiles.
template <int Dim>
void add_far(const TileWork<Dim>& work, const TileFolder& folder, Index tile, Records<Dim>& near);

/// Whether there is a cube without points in the tile that is as wide as the halo: what lies around such a gap may be
/// farther away than the points near the tile.
template <int Dim>
bool has_gaps(const TileWork<Dim>& work, Index tile, const Records<Dim>& near);

/// All points, thinned to at most about `most`. Needs the points of all tiles.
template <int Dim>
Records<Dim> thinned_records(const TileWork<Dim>& work, const TileFolder& folder, Index most);

}  // namespace csrbf
