#pragma once

#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/tiles/folder/tile_work.hpp"

namespace csrbf {

/// What is known about the surface in a tile.
struct TileFit {
  Index points = 0;         ///< used, in the tile
  Box<3> bounds;            ///< of these
  double feature_size = 0;  ///< see Field
  bool noisy = false;       ///< the points are beside the surface, not on it
  Index patches = 0, centers = 0, levels = 0;
  Index leaf_size = 0;
  double cross_validation_error = 0;  ///< of the points of the tile and around it
  NormalSource normals = NormalSource::file;
  double squared_distances = 0;  ///< of the points from the surface, fractions of the diagonal, summed
  double largest_distance = 0;
  std::vector<std::int64_t> distances;  ///< how many are in the bins of distance_bin()
  std::vector<std::string> warnings;
};

/// Bins of equal ratio for distances as fractions of the diagonal; bin_distance() is the upper end of one.
Index distance_bin(double distance);
double bin_distance(Index bin);

/// Reconstructs the surface in a tile and around it from all points there and ever fewer farther away, and writes it:
/// "inside" where the tile is alone, "rim" where it blends with others, "fit" what is known, and, if wanted, "model"
/// for write_surface(). Memory and time are proportional to the points of a tile. Throws as reconstruct().
void fit_surface_tile(const TileWork<3>& work, const TileFolder& folder, Index tile, const ReconstructOptions& options,
                      bool with_model);

/// Writes the model of the surface, with those of all tiles in it.
void write_surface(const TileWork<3>& work, const TileFolder& folder, const Box<3>& bounds, double feature_size,
                   const std::string& path);

/// Throws IoError.
TileFit read_tile_fit(const TileFolder& folder, Index tile);

}  // namespace csrbf
