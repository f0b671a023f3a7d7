#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/spatial/thinned_points.hpp"
#include "csrbf/spatial/tile_plan.hpp"
#include "csrbf/tiles/folder/tile_folder.hpp"

namespace csrbf {

/// What all tiles have in common.
template <int Dim>
struct TileWork {
  std::string fingerprint;                ///< of the input and the options
  Index points = 0;                       ///< finite ones in the input
  Index non_finite = 0;                   ///< others, left out
  Index shares = 1;                       ///< of the input, which are dealt to tiles one by one
  std::vector<Index> first_numbers = {};  ///< of the points of each share; empty: points have no numbers
  std::size_t payload =
      0;               ///< bytes that belong to each point: its normal, or its values, then its number, if it has one
  Box<Dim> bounds;     ///< of the finite points
  double spacing = 0;  ///< typical distance between neighbouring points
  double halo = 0;     ///< a tile sees all points up to that distance
  bool boxed = false;  ///< distances from a tile are the largest of those along the axes
  ThinningGrid<Dim> grid;
  TilePlan<Dim> plan;
  Archive notes;  ///< what one kind of work adds
};

/// The file "work" of the folder. Throws IoError.
template <int Dim>
void write_work(const TileFolder& folder, const TileWork<Dim>& work);
template <int Dim>
TileWork<Dim> read_work(const TileFolder& folder);

}  // namespace csrbf
