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
  /// The records [begin, end). Points that are not finite are left out of the work; those that are NaN have no number
  /// either.
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

/// What planning needs to know of a part of the input.
template <int Dim>
struct Survey {
  Index points = 0, non_finite = 0;
  Index numbers = 0;           ///< points, also those that are NaN
  Box<Dim> bounds;             ///< of the finite points
  std::vector<double> sample;  ///< some of these, the same of the whole input whatever its parts are
};

/// Reads the share of the input, of so many, once. Memory: a piece of the input and the sample.
template <int Dim>
Survey<Dim> survey_records(const RecordSource<Dim>& source, Index share, Index shares, const Progress& progress);

template <int Dim>
void write_survey(const std::string& path, const Survey<Dim>& survey);
/// Throws IoError.
template <int Dim>
Survey<Dim> read_survey(const std::string& path);

/// Decides on tiles, by the surveys of all parts in one: see add_survey(). Throws InvalidInput for fewer than `fewest`
/// finite points.
template <int Dim>
TileWork<Dim> plan_work(const Survey<Dim>& survey, const TileRules& rules, Index fewest);

/// The survey of what follows.
template <int Dim>
void add_survey(const Survey<Dim>& next, Survey<Dim>& survey);

/// Deals a share of the input, of work.shares, to raw files of the tiles. Points get numbers if the work says so.
template <int Dim>
void deal_records(const RecordSource<Dim>& source, const TileWork<Dim>& work, const TileFolder& folder, Index share,
                  const Progress& progress);

/// Makes the file "points" of a tile from the raw ones of all shares, and removes these.
template <int Dim>
void sort_records(const TileWork<Dim>& work, const TileFolder& folder, Index tile);

}  // namespace csrbf
