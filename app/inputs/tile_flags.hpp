#pragma once

#include "session.hpp"

#include "csrbf/tiles/tile_share.hpp"

namespace csrbf::app {

/// Work in tiles.
struct TileFlags {
  Index points = 0;    ///< of a tile at most; 0: as the memory says
  std::string memory;  ///< a size; empty: not given
  std::string folder;
  std::string share;
};

/// Whether the flags ask for work in tiles. Throws UsageError for --tile-share alone.
bool works_in_tiles(const TileFlags& flags);

/// Bytes of --memory; 0: not given, or --tile-points is, which goes before.
double tile_memory(const TileFlags& flags);

/// Points of a tile at most where --memory does not say it: those given, or a million.
Index tile_points(const TileFlags& flags);

/// The process K of N that --tile-share names; "auto": that of mpirun or srun.
TileShare tile_share(const TileFlags& flags, Session& session);

/// The folder given, or that beside the output.
std::string tile_folder(const TileFlags& flags, const std::string& output);

/// Adds what was used to the options of the report.
void add_tile_options(Index points, const TileShare& share, const std::string& folder, Session& session);

/// Warns when the work took more than the memory given.
void check_tile_memory(const TileFlags& flags, Session& session);

/// Throws UsageError: a flag that tiles do not know, and what to do instead.
[[noreturn]] void refuse_in_tiles(const std::string& flag, const std::string& instead);

/// Throws UsageError unless input and output are files, and for a report in HTML.
void expect_tile_files(const std::string& input, const std::string& output, const Session& session);

}  // namespace csrbf::app
