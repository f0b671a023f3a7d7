#pragma once

#include "csrbf/core/mesh.hpp"
#include "csrbf/surface/reconstruct_options.hpp"
#include "csrbf/tiles/folder/tile_work.hpp"

namespace csrbf {

/// Writes the whole cloud, thinned to some ten thousand points, with its normals: "outline". It says which side is
/// outside where tiles alone might disagree. Needs the points of all tiles.
void make_outline(const TileWork<3>& work, const TileFolder& folder, const ReconstructOptions& options);

/// Throws IoError.
PointCloud read_outline(const TileFolder& folder);

/// Whether normals (of points, 3 x n each) point to the other side than those of the outline in a box, in most places.
bool is_turned(const PointCloud& outline, const Box<3>& box, const PointsRef<3>& points, const PointsRef<3>& normals);

}  // namespace csrbf
