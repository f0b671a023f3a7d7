#include "inputs/tile_flags.hpp"

namespace csrbf::app {
namespace {

// "3/8": the third of eight processes.
TileShare parse_share(const std::string& text) {
  if (text.empty()) return {};
  const std::size_t slash = text.find('/');
  const auto number = [&](const std::string& word) -> Index {
    const bool digits = !word.empty() && word.size() < 10 && word.find_first_not_of("0123456789") == std::string::npos;
    return digits ? std::stoll(word) : 0;
  };
  const Index rank = number(text.substr(0, slash));
  const Index count = slash == std::string::npos ? 0 : number(text.substr(slash + 1));
  if (rank < 1 || rank > count) throw UsageError("--tile-share " + text + ": must be K/N, process K of N, such as 1/4");
  return {rank - 1, count};
}

}  // namespace

bool works_in_tiles(const TileFlags& flags) {
  if (flags.points > 0) return true;
  if (!flags.folder.empty()) throw UsageError("--tile-folder needs --tile-points N");
  if (!flags.share.empty()) throw UsageError("--tile-share needs --tile-points N");
  return false;
}

TileShare tile_share(const TileFlags& flags) {
  return parse_share(flags.share);
}

std::string tile_folder(const TileFlags& flags, const std::string& output) {
  return flags.folder.empty() ? output + ".tiles" : flags.folder;
}

void add_tile_options(const TileFlags& flags, const std::string& output, Session& session) {
  const TileShare share = tile_share(flags);
  session.options["tile_points"] = flags.points;
  session.options["tile_folder"] = tile_folder(flags, output);
  session.options["tile_share"] = std::to_string(share.rank + 1) + "/" + std::to_string(share.count);
}

void refuse_in_tiles(const std::string& flag, const std::string& instead) {
  throw UsageError(flag + " does not go with --tile-points; " + instead);
}

void expect_tile_files(const std::string& input, const std::string& output, const Session& session) {
  if (input == "-") refuse_in_tiles("standard input", "give a file, for it is read twice");
  if (output == "-") refuse_in_tiles("standard output", "give a file");
  if (session.wants_page())
    refuse_in_tiles("a report in HTML", "give a report in JSON, and csrbf studio shows the result");
}

}  // namespace csrbf::app
