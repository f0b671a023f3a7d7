#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/tiles/folder/tile_work.hpp"

namespace csrbf {

/// What is known about the function of a tile.
struct FunctionTile {
  Index samples = 0;  ///< in the tile
  FitReport report;   ///< of these and those around them
  bool has_variances = false;
  double variance_unit = 1;  ///< see Fit
};

/// Fits the function in a tile and around it from all samples there, and where there are gaps from ever fewer farther
/// away, and writes it, "model", and what is known about it, "fit". Memory and time are proportional to the samples of
/// a tile. Throws as fit().
template <int Dim>
void fit_function_tile(const TileWork<Dim>& work, const TileFolder& folder, Index tile, const FitOptions& options);

/// Throws IoError.
FunctionTile read_function_tile(const TileFolder& folder, Index tile);

/// Writes the model of the whole. Needs the models of all tiles. `scales`: what the coordinates of tiles are divided
/// by.
template <int Dim>
void write_function(const TileWork<Dim>& work, const TileFolder& folder, const std::vector<FunctionTile>& tiles,
                    const FitReport& report, const Point<Dim>& scales, Extrapolation extrapolation,
                    const std::string& path);

}  // namespace csrbf
