#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/tiles/tile_share.hpp"

namespace csrbf {

/// How fit_tiles() works. Options not given are chosen from the data.
struct FitTileOptions {
  /// About the largest number of samples per tile. Memory grows with it: some 300 bytes for each sample of a tile.
  Index tile_points = 2'000'000;
  /// Memory for each process, in bytes, which determines the size of the tiles; 0: `tile_points` does.
  double memory = 0;
  /// Folder for finished steps. If it has steps of the same work, they are continued, with the same result.
  std::string folder;
  SampleColumns columns = {};  ///< of coordinates, values and weights
  /// Refused: `centers`, `periods`, `sphere`, `drift`, `gradients`, `faults`, and a `transform` other than auto and
  /// none.
  FitOptions fit = {};
  TileShare share = {};
  /// Called at the start if the disk may be too small; if unset, a warning of the report says so.
  std::function<void(const std::string&)> warn = {};
};

/// What fit_tiles() found, chose and measured.
struct FitTileReport {
  /// Over all tiles: errors and noise are means or maxima; methods and kernels those of the tiles.
  FitReport fit;
  Index tiles = 0;
  Index tile_points = 0;  ///< about the largest number of samples per tile
  Index continued = 0;    ///< tiles that an earlier run or another process had fitted
  Index dropped = 0;      ///< rows left out because a number or value is missing
  std::vector<std::string> coordinate_names, value_names;
};

/// fit() for more samples than fit in memory: makes a model file from a file of samples, tile by tile.
///
/// Space is cut into tiles with about the same number of samples. Each tile is fitted on its own, with its own method
/// and smoothing, to all samples in it and around it and, beyond gaps, to ever fewer samples farther away, so that it
/// knows what lies there. Where tiles meet, their functions are blended. The model holds the models of all tiles; to
/// evaluate it, only those needed are read, so it may be larger than memory too.
///
/// As with reconstruct_tiles(), interrupted work continues, several processes may share it, and the model is the same,
/// byte for byte, for any number of processes and threads. .npy files in C order are read in pieces, others at once.
/// Time O(n log n); memory proportional to the samples of a tile; disk up to 50 bytes for each number of a sample.
///
/// Throws as fit(); IoError for files; InvalidInput for options that are refused and if the folder has steps of other
/// work; SolverFailure if another process failed.
FitTileReport fit_tiles(const std::string& samples, const std::string& model, const FitTileOptions& options);

}  // namespace csrbf
