#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/tiles/folder/tile_team.hpp"
#include "csrbf/tiles/stages/deal_records.hpp"

#include <map>

namespace csrbf {

/// What is cut into tiles, and how.
template <int Dim>
struct TileInput {
  std::function<RecordSource<Dim>()> open;  ///< called when the input is read; not where earlier steps suffice
  TileRules rules;
  Index fewest = 1;       ///< finite points that are needed
  bool numbered = false;  ///< points keep their number in the input
  std::string fingerprint;
  std::function<Archive()> notes;                ///< see TileWork
  double disk = 0;                               ///< bytes for each point that all files take at most, about
  std::function<void(const std::string&)> warn;  ///< called at the start when the disk may be too small for them
};

/// The first steps of all work, by all processes: each looks at its share of the input, the leading one decides on
/// tiles, and all deal and sort the points of theirs. Returns once the points of all tiles are there. Throws
/// InvalidInput when the folder has steps of other work, or for too few points; IoError when the disk is too small for
/// the points alone.
template <int Dim>
TileWork<Dim> prepare_tiles(TileTeam& team, const TileInput<Dim>& input);

/// Warnings of tiles in one list, which says in how many of them each came.
class TileWarnings {
 public:
  void add(const std::vector<std::string>& warnings);
  void append_to(std::vector<std::string>& warnings) const;

 private:
  std::map<std::string, Index> times_;
};

}  // namespace csrbf
