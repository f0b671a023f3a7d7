#include "csrbf/tiles/stages/prepare_tiles.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <zlib.h>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace csrbf {
namespace {

constexpr Index most_shares = 64;  // of the input: each makes a file for every tile

// Surveys of other input have another name.
std::string survey_name(const std::string& fingerprint, Index shares) {
  const auto checksum = crc32_z(0, reinterpret_cast<const Bytef*>(fingerprint.data()), fingerprint.size());
  return survey_kind + std::to_string(checksum) + "of" + std::to_string(shares);
}

std::string size_text(double bytes) {
  constexpr double mega = 1e6, giga = 1e9;
  const double number = bytes < giga ? bytes / mega : bytes / giga;
  std::ostringstream text;
  if (number < 10)
    text << std::setprecision(2) << number;
  else
    text << std::llround(number);
  return text.str() + (bytes < giga ? " MB" : " GB");
}

// Whether the disk has room, before anything is written.
template <int Dim>
void check_room(const TileFolder& folder, const TileInput<Dim>& input) {
  std::error_code unknown;
  const auto space = std::filesystem::space(utf8_path(folder.path()), unknown);
  if (unknown) return;
  const RecordSource<Dim> source = input.open();
  const auto points = static_cast<double>(source.size), free = static_cast<double>(space.available);
  const double least = points * static_cast<double>(Dim * sizeof(double) + source.payload), most = points * input.disk;
  const std::string start = folder.path() + ": " + size_text(free) + " are free on this disk, but ";
  if (least > free)
    throw IoError(start + "the points alone take " + size_text(least) +
                  "; make room, or name a folder on another disk");
  if (most > free && input.warn)
    input.warn(start + "the steps may take " + size_text(most) +
               "; when it is full, make room and give the same command again");
}

template <int Dim>
TileWork<Dim> plan(const TileTeam& team, const TileInput<Dim>& input, const std::string& surveys, Index shares) {
  Survey<Dim> whole;
  std::vector<Index> first_numbers;
  for (Index share = 0; share < shares; ++share) {
    const std::string path = team.folder().file(surveys, share);
    team.wait(path);
    first_numbers.push_back(whole.numbers);
    add_survey(read_survey<Dim>(path), whole);
  }
  TileWork<Dim> work = plan_work(whole, input.rules, input.fewest);
  work.fingerprint = input.fingerprint;
  work.shares = shares;
  work.payload = input.open().payload;
  if (input.numbered) {
    work.first_numbers = std::move(first_numbers);
    work.payload += sizeof(std::int64_t);
  }
  work.notes = input.notes();
  return work;
}

}  // namespace

template <int Dim>
TileWork<Dim> prepare_tiles(TileTeam& team, const TileInput<Dim>& input) {
  const TileFolder& folder = team.folder();
  const std::string file = folder.file("work");
  const Index shares = std::min(team.processes(), most_shares);
  const std::string surveys = survey_name(input.fingerprint, shares);
  team.declare(surveys);
  if (!exists(file)) {
    if (team.leads()) check_room(folder, input);
    team.for_own(surveys, shares, [&](Index share) {
      write_survey(folder.file(surveys, share), survey_records(input.open(), share, shares, team.progress()));
    });
    if (team.leads()) {
      team.clear();
      write_work(folder, plan(team, input, surveys, shares));
    }
  }
  team.wait(file);
  const TileWork<Dim> work = read_work<Dim>(folder);
  require_same_work(work.fingerprint, input.fingerprint, team.folder().path());

  team.for_own("dealt", work.shares, [&](Index share) {
    deal_records(input.open(), work, folder, share, team.progress());
    write_file(folder.file("dealt", share), "");
  });
  team.wait_for_all("dealt", work.shares);
  const Index tiles = work.plan.size();
  team.for_own("points", tiles, [&](Index t) {
    report(team.progress(), "prepare", static_cast<double>(t) / static_cast<double>(tiles));
    sort_records(work, folder, t);
  });
  team.wait_for_all("points", tiles);
  return work;
}

void TileWarnings::add(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) ++times_[warning];
}

void TileWarnings::append_to(std::vector<std::string>& warnings) const {
  for (const auto& [text, times] : times_)
    warnings.push_back((times > 1 ? "in " + std::to_string(times) + " tiles: " : "in one tile: ") + text);
}

#define CSRBF_INSTANTIATE(Dim) template TileWork<Dim> prepare_tiles<Dim>(TileTeam&, const TileInput<Dim>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
