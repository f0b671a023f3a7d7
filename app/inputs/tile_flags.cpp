#include "inputs/tile_flags.hpp"

#include "inputs/bytes.hpp"
#include "process/peak_memory.hpp"

#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <utility>

namespace csrbf::app {
namespace {

constexpr Index usual_points = 1000000;  // of a tile

// A number of at most nine digits; 0 for other texts.
Index small_number(const std::string& text) {
  const bool digits = !text.empty() && text.size() < 10 && text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::stoll(text) : 0;
}

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

// The names of the rank and of the number of processes in the environment.
using Launcher = std::pair<const char*, const char*>;
constexpr Launcher open_mpi = {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"};
constexpr Launcher mpich = {"PMI_RANK", "PMI_SIZE"};  // and Intel MPI
constexpr Launcher slurm = {"SLURM_PROCID", "SLURM_NTASKS"};

// What the first of these launchers that started this process says.
std::optional<TileShare> share_by(std::initializer_list<Launcher> launchers) {
  for (const auto& [rank_name, count_name] : launchers) {
    const std::string rank = environment(rank_name);
    const Index count = small_number(environment(count_name));
    if (rank.find_first_not_of("0123456789") == std::string::npos && !rank.empty() && small_number(rank) < count)
      return TileShare{small_number(rank), count};
  }
  return std::nullopt;
}

// Not asked of slurm: the script that calls srun has its variables as well.
void warn_of_unshared_work(Session& session) {
  const std::optional<TileShare> share = share_by({open_mpi, mpich});
  if (share && share->count > 1)
    session.warn("each of the " + std::to_string(share->count) +
                 " processes does the whole work: --tile-share auto shares it");
}

}  // namespace

bool works_in_tiles(const TileFlags& flags) {
  if (flags.points > 0 || !flags.memory.empty() || !flags.folder.empty()) return true;
  if (!flags.share.empty()) throw UsageError("--tile-share needs --tile-folder DIR, which the processes share");
  return false;
}

double tile_memory(const TileFlags& flags) {
  return flags.points > 0 || flags.memory.empty() ? 0 : static_cast<double>(parse_bytes(flags.memory, "--memory"));
}

Index tile_points(const TileFlags& flags) {
  return flags.points > 0 ? flags.points : usual_points;
}

// "3/8": the third of eight processes.
TileShare tile_share(const TileFlags& flags, Session& session) {
  const std::string& text = flags.share;
  if (text.empty()) {
    warn_of_unshared_work(session);
    return {};
  }
  if (text == "auto") {
    if (const auto share = share_by({open_mpi, mpich, slurm})) return *share;
    throw UsageError("--tile-share auto: neither mpirun nor srun started this process; give K/N, such as 1/4");
  }
  const std::size_t slash = text.find('/');
  const Index rank = small_number(text.substr(0, slash));
  const Index count = slash == std::string::npos ? 0 : small_number(text.substr(slash + 1));
  if (rank < 1 || rank > count)
    throw UsageError("--tile-share " + text + ": must be auto, or K/N for process K of N, such as 1/4");
  return {rank - 1, count};
}

std::string tile_folder(const TileFlags& flags, const std::string& output) {
  if (!flags.folder.empty()) return flags.folder;
  return output.substr(0, output.find_last_not_of('/') + 1) + ".tiles";
}

void add_tile_options(Index points, const TileShare& share, const std::string& folder, Session& session) {
  session.options["tile_points"] = points;
  session.options["tile_folder"] = folder;
  session.options["tile_share"] = std::to_string(share.rank + 1) + "/" + std::to_string(share.count);
}

void check_tile_memory(const TileFlags& flags, Session& session) {
  if (flags.memory.empty()) return;
  const std::size_t peak = peak_memory_bytes();
  if (peak <= parse_bytes(flags.memory, "--memory")) return;
  constexpr double mega = 1e6;
  session.warn("--memory " + flags.memory + " was exceeded: the peak was " + rounded(static_cast<double>(peak) / mega) +
               " MB; a smaller --tile-points needs less");
}

void refuse_in_tiles(const std::string& flag, const std::string& instead) {
  throw UsageError(flag + " does not go with tiles (--tile-points, --tile-folder, --memory); " + instead);
}

void expect_tile_files(const std::string& input, const std::string& output, const Session& session) {
  if (input == "-") refuse_in_tiles("standard input", "give a file, for it is read twice");
  if (output == "-") refuse_in_tiles("standard output", "give a file");
  if (session.wants_page())
    refuse_in_tiles("a report in HTML", "give a report in JSON, and csrbf studio shows the result");
}

}  // namespace csrbf::app
