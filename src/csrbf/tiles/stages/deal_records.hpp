#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/tiles/folder/tile_files.hpp"
#include "csrbf/tiles/folder/tile_work.hpp"

namespace csrbf {

/// An input that is read in pieces.
template <int Dim>
struct RecordSource {
  Index size = 0;
  std::size_t payload = 0;  ///< bytes of each point
  /// The records [begin, end). Points that are not finite are left out of the work.
  std::function<Records<Dim>(Index begin, Index end)> read;
};

/// How tiles are made of points.
struct TileRules {
  Index tile_points = 0;  ///< at most, about
  int dimension = 0;      ///< of what the points lie on: 2 for surfaces
  /// Over what lengths tiles blend, and how far beyond that they look, for points of this spacing in a box whose
  /// longest side is `extent`.
  std::function<double(double spacing, double extent)> blend;
  double reach = 0;    ///< spacings
  bool boxed = false;  ///< see TileWork
};

/// Reads all points once and decides on tiles. Memory: a piece of the input and a sample of it. Throws InvalidInput for
/// fewer than `fewest` finite points.
template <int Dim>
TileWork<Dim> plan_work(const RecordSource<Dim>& source, const TileRules& rules, Index fewest,
                        const std::string& fingerprint, const Progress& progress);

/// Deals the share of the input of one process, of so many, to raw files of the tiles.
template <int Dim>
void deal_records(const RecordSource<Dim>& source, const TileWork<Dim>& work, const TileFolder& folder, Index process,
                  Index processes, const Progress& progress);

/// Makes the file "points" of a tile from the raw ones of all processes, and removes these.
template <int Dim>
void sort_records(const TileWork<Dim>& work, const TileFolder& folder, Index tile, Index processes);

}  // namespace csrbf
