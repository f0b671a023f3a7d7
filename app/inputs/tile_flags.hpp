#pragma once

#include "session.hpp"

#include "csrbf/tiles/tile_share.hpp"

namespace csrbf::app {

/// Work in tiles.
struct TileFlags {
  Index points = 0;  ///< of a tile at most; 0: all at once
  std::string folder;
  std::string share;
};

/// Whether the flags ask for work in tiles. Throws UsageError for flags that need --tile-points.
bool works_in_tiles(const TileFlags& flags);

TileShare tile_share(const TileFlags& flags);

/// The folder given, or that beside the output.
std::string tile_folder(const TileFlags& flags, const std::string& output);

/// Adds the flags to the options of the report.
void add_tile_options(const TileFlags& flags, const std::string& output, Session& session);

/// Throws UsageError: a flag that tiles do not know, and what to do instead.
[[noreturn]] void refuse_in_tiles(const std::string& flag, const std::string& instead);

/// Throws UsageError unless input and output are files, and for a report in HTML.
void expect_tile_files(const std::string& input, const std::string& output, const Session& session);

}  // namespace csrbf::app
