#include "csrbf/tiles/stages/deal_records.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/open_file.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr Index piece = 1 << 18;        // points read at a time
constexpr Index sample_size = 1 << 18;  // points that decide on cuts and spacing

// Calls visit(first, records) for pieces of the input [begin, end).
template <int Dim, class Visit>
void for_each_piece(const RecordSource<Dim>& source, Index begin, Index end, const Progress& progress,
                    const Visit& visit) {
  for (Index at = begin; at < end; at += piece) {
    report(progress, "read", static_cast<double>(at - begin) / static_cast<double>(end - begin));
    visit(at, source.read(at, std::min(at + piece, end)));
  }
}

std::string raw_kind(Index process, Index processes) {
  return "raw" + std::to_string(process) + "of" + std::to_string(processes);
}

}  // namespace

template <int Dim>
TileWork<Dim> plan_work(const RecordSource<Dim>& source, const TileRules& rules, Index fewest,
                        const std::string& fingerprint, const Progress& progress) {
  TileWork<Dim> work;
  work.fingerprint = fingerprint;
  work.payload = source.payload;
  const Index stride = std::max<Index>(1, (source.size + sample_size - 1) / sample_size);
  std::vector<double> chosen;
  for_each_piece(source, 0, source.size, progress, [&](Index first, const Records<Dim>& records) {
    const auto points = records.matrix();
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<Dim> p = points.col(i);
      if (!p.allFinite()) {
        ++work.non_finite;
        continue;
      }
      work.bounds.add(p);
      ++work.points;
      if ((first + i) % stride == 0) chosen.insert(chosen.end(), p.begin(), p.end());
    }
  });
  require(work.points >= fewest, "tiles", "points", work.points,
          "too few finite points; at least " + std::to_string(fewest) + " are needed");
  const Eigen::Map<const Points<Dim>> sample(chosen.data(), Dim, std::ssize(chosen) / Dim);
  work.spacing = typical_spacing<Dim>(sample, work.points, rules.dimension);
  const double blend = rules.blend(work.spacing, work.bounds.extent().maxCoeff());
  work.halo = blend + rules.reach * work.spacing;
  work.boxed = rules.boxed;
  work.grid = ThinningGrid<Dim>::over(work.bounds, work.spacing);
  const Index tiles = (work.points + rules.tile_points - 1) / rules.tile_points;
  work.plan = TilePlan<Dim>(cut_into_tiles<Dim>(sample, std::min(tiles, sample.cols())), blend);
  return work;
}

template <int Dim>
void deal_records(const RecordSource<Dim>& source, const TileWork<Dim>& work, const TileFolder& folder, Index process,
                  Index processes, const Progress& progress) {
  std::vector<std::string> paths;
  for (Index t = 0; t < work.plan.size(); ++t) paths.push_back(folder.file(raw_kind(process, processes), t));
  RecordDealer dealer(paths);
  const Index begin = source.size * process / processes, end = source.size * (process + 1) / processes;
  for_each_piece(source, begin, end, progress, [&](Index, const Records<Dim>& records) {
    const auto points = records.matrix();
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<Dim> p = points.col(i);
      if (p.allFinite()) dealer.add<Dim>(work.plan.tile_of(p), p, records.payload_of(i));
    }
  });
  dealer.flush();
}

template <int Dim>
void sort_records(const TileWork<Dim>& work, const TileFolder& folder, Index tile, Index processes) {
  std::vector<std::string> raw;
  for (Index p = 0; p < processes; ++p) raw.push_back(folder.file(raw_kind(p, processes), tile));
  const Records<Dim> records = read_raw_records<Dim>(raw, work.payload);
  write_tile(folder.file("points", tile), records, thin<Dim>(records.matrix(), work.grid));
  std::error_code ignored;
  for (const std::string& path : raw) std::filesystem::remove(utf8_path(path), ignored);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                     \
  template TileWork<Dim> plan_work<Dim>(const RecordSource<Dim>&, const TileRules&, Index, const std::string&,     \
                                        const Progress&);                                                          \
  template void deal_records<Dim>(const RecordSource<Dim>&, const TileWork<Dim>&, const TileFolder&, Index, Index, \
                                  const Progress&);                                                                \
  template void sort_records<Dim>(const TileWork<Dim>&, const TileFolder&, Index, Index);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
