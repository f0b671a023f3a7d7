#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/tiles/tile_share.hpp"

namespace csrbf {

/// How fit_tiles() works. What is not said here is chosen from the data.
struct FitTileOptions {
  /// Samples per tile at most, about; memory grows with it: some 300 bytes for each sample of a tile.
  Index tile_points = 2'000'000;
  double memory = 0;  ///< bytes for each process, from which the size of tiles follows; 0: `tile_points` is the size
  /// Where finished steps are kept. A folder with steps of the same work is continued, to the same result.
  std::string folder;
  SampleColumns columns = {};  ///< coordinates, values and weights
  /// `centers`, `periods`, `sphere`, `drift`, `gradients` and `faults` are refused.
  FitOptions fit = {};
  TileShare share = {};
  /// Called at the start when the disk may be too small; not set: the report says so.
  std::function<void(const std::string&)> warn = {};
};

/// What fit_tiles() found, chose and measured.
struct FitTileReport {
  /// Over all tiles: errors and noise are means, or the largest; methods and kernels those of the tiles.
  FitReport fit;
  Index tiles = 0;
  Index tile_points = 0;  ///< samples per tile at most, about
  Index continued = 0;    ///< tiles that an earlier run, or another process, had fitted
  Index dropped = 0;      ///< rows left out because they lack a number, or a value
  std::vector<std::string> coordinate_names, value_names;
};

/// fit() for more samples than memory: from a file of samples to a file of a model, tile by tile.
///
/// Space is cut into tiles with about as many samples each, as for surfaces (reconstruct_tiles). A tile is fitted from
/// all samples in it and around it, and where there are gaps from ever fewer farther away, so that it knows what lies
/// beyond them; it chooses its own method and smoothing. Where tiles meet, their functions blend (TiledField). The
/// model holds the models of all tiles; whoever evaluates it reads those that are needed, so that it may be larger than
/// memory too.
///
/// Steps, processes and bytes are as for reconstruct_tiles(): interrupted work goes on, and the model is the same for
/// any number of processes and threads. Files .npy in C order are read in pieces, others whole. Time O(n log n); memory
/// proportional to the samples of a tile; disk up to 50 bytes for each number of a sample.
///
/// Throws as fit(), IoError for files, InvalidInput when the folder has steps of other work, SolverFailure when another
/// process failed.
FitTileReport fit_tiles(const std::string& samples, const std::string& model, const FitTileOptions& options);

}  // namespace csrbf
