#include "csrbf/tiles/stages/deal_records.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/models/archive.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr Index piece = 1 << 18;           // points read at a time
constexpr Index sampled_points = 1 << 18;  // points that decide on cuts and spacing

// Calls visit(first, records) for pieces of the input [begin, end).
template <int Dim, class Visit>
void for_each_piece(const RecordSource<Dim>& source, Index begin, Index end, const Progress& progress,
                    const Visit& visit) {
  for (Index at = begin; at < end; at += piece) {
    report(progress, "read", static_cast<double>(at - begin) / static_cast<double>(end - begin));
    visit(at, source.read(at, std::min(at + piece, end)));
  }
}

Index share_begin(Index size, Index share, Index shares) {
  return size / shares * share + size % shares * share / shares;
}

std::string raw_kind(Index share) {
  return "raw" + std::to_string(share);
}

}  // namespace

template <int Dim>
Survey<Dim> survey_records(const RecordSource<Dim>& source, Index share, Index shares, const Progress& progress) {
  Survey<Dim> survey;
  const Index stride = std::max<Index>(1, (source.size + sampled_points - 1) / sampled_points);
  const Index begin = share_begin(source.size, share, shares), end = share_begin(source.size, share + 1, shares);
  for_each_piece(source, begin, end, progress, [&](Index first, const Records<Dim>& records) {
    const auto points = records.matrix();
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<Dim> p = points.col(i);
      ++survey.numbers;
      if (!p.allFinite()) {
        ++survey.non_finite;
        continue;
      }
      survey.bounds.add(p);
      ++survey.points;
      if ((first + i) % stride == 0) survey.sample.insert(survey.sample.end(), p.begin(), p.end());
    }
  });
  return survey;
}

template <int Dim>
void write_survey(const std::string& path, const Survey<Dim>& survey) {
  Archive archive;
  archive.kind = "survey";
  archive.set("points", survey.points);
  archive.set("non_finite", survey.non_finite);
  archive.set("numbers", survey.numbers);
  set_box(archive, survey.bounds);
  archive.set("sample", survey.sample);
  write_archive(path, archive);
}

template <int Dim>
Survey<Dim> read_survey(const std::string& path) {
  const Archive archive = read_archive(path);
  const auto count = [&](const char* name) { return static_cast<Index>(archive.integer(name)); };
  return {count("points"), count("non_finite"), count("numbers"), box_of<Dim>(archive), archive.column("sample")};
}

template <int Dim>
void add_survey(const Survey<Dim>& next, Survey<Dim>& survey) {
  survey.points += next.points;
  survey.non_finite += next.non_finite;
  survey.numbers += next.numbers;
  if (next.points > 0) survey.bounds.add(next.bounds);
  survey.sample.insert(survey.sample.end(), next.sample.begin(), next.sample.end());
}

template <int Dim>
TileWork<Dim> plan_work(const Survey<Dim>& survey, const TileRules& rules, Index fewest) {
  TileWork<Dim> work;
  work.points = survey.points;
  work.non_finite = survey.non_finite;
  work.bounds = survey.bounds;
  require(work.points >= fewest, "tiles", "points", work.points,
          "too few finite points; at least " + std::to_string(fewest) + " are needed");
  const Eigen::Map<const Points<Dim>> sample(survey.sample.data(), Dim, std::ssize(survey.sample) / Dim);
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
void deal_records(const RecordSource<Dim>& source, const TileWork<Dim>& work, const TileFolder& folder, Index share,
                  const Progress& progress) {
  std::vector<std::string> paths;
  for (Index t = 0; t < work.plan.size(); ++t) paths.push_back(folder.file(raw_kind(share), t));
  RecordDealer dealer(paths);
  const bool numbered = !work.first_numbers.empty();
  Index number = numbered ? work.first_numbers[static_cast<std::size_t>(share)] : 0;
  std::string payload;
  const Index begin = share_begin(source.size, share, work.shares);
  const Index end = share_begin(source.size, share + 1, work.shares);
  for_each_piece(source, begin, end, progress, [&](Index, const Records<Dim>& records) {
    const auto points = records.matrix();
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<Dim> p = points.col(i);
      if (!numbered) {
        if (p.allFinite()) dealer.add<Dim>(work.plan.tile_of(p), p, records.payload_of(i));
        continue;
      }
      payload = records.payload_of(i);
      append_scalar(payload, static_cast<std::int64_t>(number++));
      if (p.allFinite()) dealer.add<Dim>(work.plan.tile_of(p), p, payload);
    }
  });
  dealer.flush();
}

template <int Dim>
void sort_records(const TileWork<Dim>& work, const TileFolder& folder, Index tile) {
  std::vector<std::string> raw;
  for (Index s = 0; s < work.shares; ++s) raw.push_back(folder.file(raw_kind(s), tile));
  const Records<Dim> records = read_raw_records<Dim>(raw, work.payload);
  write_tile(folder.file("points", tile), records, thin<Dim>(records.matrix(), work.grid));
  std::error_code ignored;
  for (const std::string& path : raw) std::filesystem::remove(utf8_path(path), ignored);
}

#define CSRBF_INSTANTIATE(Dim)                                                                              \
  template Survey<Dim> survey_records<Dim>(const RecordSource<Dim>&, Index, Index, const Progress&);        \
  template void write_survey<Dim>(const std::string&, const Survey<Dim>&);                                  \
  template Survey<Dim> read_survey<Dim>(const std::string&);                                                \
  template void add_survey<Dim>(const Survey<Dim>&, Survey<Dim>&);                                          \
  template TileWork<Dim> plan_work<Dim>(const Survey<Dim>&, const TileRules&, Index);                       \
  template void deal_records<Dim>(const RecordSource<Dim>&, const TileWork<Dim>&, const TileFolder&, Index, \
                                  const Progress&);                                                         \
  template void sort_records<Dim>(const TileWork<Dim>&, const TileFolder&, Index);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
