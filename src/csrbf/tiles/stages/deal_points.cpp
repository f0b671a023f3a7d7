#include "csrbf/tiles/stages/deal_points.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/tiles/folder/tile_files.hpp"

#include <filesystem>

namespace csrbf {
namespace {

constexpr Index piece = 1 << 18;        // points read at a time
constexpr Index sample_size = 1 << 18;  // points that decide on cuts and spacing

// In spacings, chosen by hand: tiles blend over the width of a few patches, and see the samples of all patches there.
constexpr double narrowest_blend = 4;
constexpr double cells_in_blend = 3;  // cells of the mesh: vertices beside a face move by less than two
constexpr double patch_reach = 10;
constexpr double finest_cells = 1024;  // along the longest side, where the data decide: see automatic_resolution()
constexpr double coarsest_cell = 1.25;

// Calls visit(cloud) for pieces of the points [begin, end).
template <class Visit>
void for_each_piece(PointStream& points, Index begin, Index end, const Progress& progress, const Visit& visit) {
  for (Index at = begin; at < end; at += piece) {
    report(progress, "read", static_cast<double>(at - begin) / static_cast<double>(end - begin));
    visit(at, points.read(at, std::min(at + piece, end)));
  }
}

std::string raw_kind(Index process, Index processes) {
  return "raw" + std::to_string(process) + "of" + std::to_string(processes);
}

}  // namespace

TileWork plan_work(PointStream& points, Index tile_points, int resolution, const std::string& fingerprint,
                   const Progress& progress) {
  TileWork work;
  work.fingerprint = fingerprint;
  const Index stride = (points.size() + sample_size - 1) / sample_size;
  std::vector<double> chosen;
  for_each_piece(points, 0, points.size(), progress, [&](Index first, const PointCloud& cloud) {
    work.normals = cloud.has_normals();
    for (Index i = 0; i < cloud.size(); ++i) {
      const Point<3> p = cloud.points.col(i);
      if (!p.allFinite()) {
        ++work.non_finite;
        continue;
      }
      work.bounds.add(p);
      ++work.points;
      if ((first + i) % stride == 0) chosen.insert(chosen.end(), p.begin(), p.end());
    }
  });
  require(work.points >= 4, "reconstruct", "points", work.points, "too few finite points; at least 4 are needed");
  const Eigen::Map<const Points<3>> sample(chosen.data(), 3, std::ssize(chosen) / 3);
  const double extent = work.bounds.extent().maxCoeff();
  work.spacing = typical_spacing<3>(sample, work.points, 2);
  const double cell =
      resolution > 0 ? extent / resolution : std::max(coarsest_cell * work.spacing, extent / finest_cells);
  const double blend = std::max(narrowest_blend * work.spacing, cells_in_blend * cell);
  work.halo = blend + patch_reach * work.spacing;
  work.grid = ThinningGrid<3>::over(work.bounds, work.spacing);
  const Index tiles = (work.points + tile_points - 1) / tile_points;
  work.plan = TilePlan<3>(cut_into_tiles<3>(sample, std::min(tiles, sample.cols())), blend);
  return work;
}

void deal_points(PointStream& points, const TileWork& work, const TileFolder& folder, Index process, Index processes,
                 const Progress& progress) {
  std::vector<std::string> paths;
  for (Index t = 0; t < work.plan.size(); ++t) paths.push_back(folder.file(raw_kind(process, processes), t));
  PointDealer dealer(paths, work.normals);
  const Index begin = points.size() * process / processes, end = points.size() * (process + 1) / processes;
  for_each_piece(points, begin, end, progress, [&](Index, const PointCloud& cloud) {
    for (Index i = 0; i < cloud.size(); ++i) {
      const Point<3> p = cloud.points.col(i);
      if (!p.allFinite()) continue;
      const Point<3> normal = work.normals ? Point<3>(cloud.normals.col(i)) : Point<3>::Zero();
      dealer.add(work.plan.tile_of(p), p, &normal);
    }
  });
  dealer.flush();
}

void sort_points(const TileWork& work, const TileFolder& folder, Index tile, Index processes) {
  std::vector<std::string> raw;
  for (Index p = 0; p < processes; ++p) raw.push_back(folder.file(raw_kind(p, processes), tile));
  const PointCloud cloud = read_raw_points(raw, work.normals);
  write_tile_points(folder.file("points", tile), cloud, thin<3>(cloud.points, work.grid));
  std::error_code ignored;
  for (const std::string& path : raw) std::filesystem::remove(utf8_path(path), ignored);
}

}  // namespace csrbf
