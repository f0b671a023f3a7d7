#include "csrbf/tiles/reconstruct_tiles.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/tiles/stages/cloud_records.hpp"
#include "csrbf/tiles/stages/outline.hpp"
#include "csrbf/tiles/stages/prepare_tiles.hpp"
#include "csrbf/tiles/stages/weld_parts.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

namespace csrbf {
namespace {

constexpr Index fewest_tile_points = 1000;                  // smaller tiles consist of borders
constexpr Index least_memory_points = 10000;                // with fewer, halos are larger than tiles
constexpr double surface_bytes = 60e6, point_bytes = 1900;  // of memory: without a tile, and for a point (900 to 1800)
constexpr double point_disk = 300, model_disk = 450;        // bytes of files for each point; measured: 250, 430

void check_options(const TileOptions& options) {
  constexpr auto where = "reconstruct_tiles";
  const ReconstructOptions& surface = options.surface;
  require(options.tile_points >= fewest_tile_points, where, "tile_points", options.tile_points,
          "must be at least 1000");
  require(surface.method == "auto" || surface.method == "composite", where, "method", surface.method,
          "tiles are made by the method composite only");
  require(surface.tolerance == 0, where, "tolerance", surface.tolerance, "tiles cannot keep a tolerance");
  require(surface.centers == 0, where, "centers", surface.centers, "tiles cannot share a budget of centres");
  require(!surface.region, where, "region", "(given)", "tiles are made of all points");
}

std::string options_text(const TileOptions& options) {
  std::ostringstream text;
  text.precision(17);
  text << "tile_points " << options.tile_points << " normals " << static_cast<int>(options.surface.normals)
       << " smoothing " << options.surface.smoothing.value_or(-1) << " resolution " << options.resolution << " mesh "
       << (options.mesh_method ? static_cast<int>(*options.mesh_method) : -1)
       << (options.model.empty() ? "" : " model");
  return text.str();
}

// What one process does.
class SurfaceInTiles {
 public:
  SurfaceInTiles(const std::string& points, const std::string& mesh, const TileOptions& options)
      : points_(points),
        mesh_(mesh),
        options_(options),
        team_(options.folder, options.share, options.surface.progress),
        folder_(team_.folder()) {}

  TileReport run() {
    team_.run([this] {
      prepare();
      fit();
      polygonize();
      write();
      team_.finish("work");
    });
    return report_;
  }

 private:
  [[nodiscard]] Index tiles() const { return work_.plan.size(); }

  void prepare() {
    const auto start = std::chrono::steady_clock::now();
    std::optional<PointStream> stream;
    const auto opened = [&]() -> PointStream& {
      if (!stream) stream.emplace(points_);
      return *stream;
    };
    work_ = prepare_tiles<3>(team_, {.open = [&] { return cloud_source(opened()); },
                                     .rules = surface_rules(options_.tile_points, options_.resolution),
                                     .fewest = 4,
                                     .fingerprint = tile_fingerprint(points_, options_text(options_)),
                                     .notes = [&] { return surface_notes(opened()); },
                                     .disk = point_disk + (options_.model.empty() ? 0 : model_disk),
                                     .warn = [&](const std::string& text) { warn(text); }});
    report_.tiles = tiles();
    report_.surface.prepare_seconds = seconds_since(start);
  }

  void warn(const std::string& text) {
    if (options_.warn)
      options_.warn(text);
    else
      report_.surface.warnings.push_back(text);
  }

  void fit() {
    const auto start = std::chrono::steady_clock::now();
    if (tiles() > 1) {
      if (team_.leads() && !exists(folder_.file("outline"))) make_outline(work_, folder_, options_.surface);
      team_.wait(folder_.file("outline"));
    }
    report_.continued = team_.for_own("fit", tiles(), [&](Index t) { fit(t); });
    team_.wait_for_all("fit", tiles());
    for (Index t = 0; t < tiles(); ++t) fits_.push_back(read_tile_fit(folder_, t));
    report_.surface.fit_seconds = seconds_since(start);
    summarise();
  }

  void fit(Index tile) {
    ReconstructOptions here = options_.surface;
    here.progress = team_.part_of("fit", tile, tiles());
    fit_surface_tile(work_, folder_, tile, here, !options_.model.empty());
  }

  // The function of a tile, the largest of its files, is no longer there afterwards. Few tiles are meshed again.
  void mesh(Index tile, int round, const std::vector<polygonization::Cell>& starts) {
    const std::string function = folder_.file("inside", tile);
    if (!exists(function)) fit(tile);
    mesh_tile(work_, mesh_work_, folder_, tile, round, starts, team_.part_of("polygonize", tile, tiles()));
    std::error_code ignored;
    std::filesystem::remove(utf8_path(function), ignored);
  }

  void polygonize() {
    mesh_work_ = plan_meshes(work_, fits_, options_.resolution, options_.mesh_method);
    report_.resolution = mesh_work_.resolution;
    report_.mesh_method = mesh_work_.method;
    rounds_.assign(tiles(), 0);
    std::vector<std::vector<polygonization::Cell>> starts(tiles());
    std::set<Index> open;  // tiles to be made in this round
    for (Index t = 0; t < tiles(); ++t) open.insert(t);
    for (int round = 0; !open.empty(); ++round) {
      for (const Index t : open) rounds_[t] = round;
      team_.for_own(border_kind(round), tiles(), [&](Index t) {
        if (open.count(t) == 0) return;
        mesh(t, round, starts[t]);
      });
      team_.for_own(missing_kind(round), tiles(), [&](Index t) {
        for (const Index other : tiles_around(mesh_work_, work_.plan, t))
          team_.wait(folder_.file(border_kind(rounds_[other]), other));
        find_missing(mesh_work_, work_.plan, folder_, t, rounds_, round);
      });
      team_.wait_for_all(missing_kind(round), tiles());
      open.clear();
      for (Index t = 0; t < tiles(); ++t) {
        const std::vector<polygonization::Cell> missing = read_missing(folder_, t, round);
        if (!missing.empty()) open.insert(t);
        starts[t].insert(starts[t].end(), missing.begin(), missing.end());
      }
    }
    report_.meshed_again = std::count_if(rounds_.begin(), rounds_.end(), [](int round) { return round > 0; });
  }

  void write() {
    const WeldedMesh welded = weld_parts(team_, rounds_, mesh_);
    report_.topology = welded.topology;
    report_.weak_features = welded.weak_features;
    if (!options_.model.empty() && team_.leads())
      write_surface(work_, folder_, mesh_work_.bounds, mesh_work_.feature_size, options_.model);
    if (welded.dropped > 0)
      report_.surface.warnings.push_back(std::to_string(welded.dropped) +
                                         " components of the mesh without data left out");
  }

  // The reports of all tiles in one.
  void summarise() {
    ReconstructReport& out = report_.surface;
    out.method = "composite";
    out.points = work_.points + work_.non_finite;
    out.composite.emplace();
    std::vector<std::int64_t> distances;
    double squares = 0, predicted = 0;  // squared distances, distances of points left out
    TileWarnings warnings;
    for (const TileFit& fit : fits_) {
      out.points_used += fit.points;
      out.centers += fit.centers;
      out.composite->patches += fit.patches;
      out.composite->levels = std::max(out.composite->levels, fit.levels);
      if (fit.normals != NormalSource::file) out.normals = fit.normals;
      squares += fit.squared_distances;
      predicted += fit.cross_validation_error * static_cast<double>(fit.points);
      out.max_distance = std::max(out.max_distance, fit.largest_distance);
      distances.resize(fit.distances.size());
      for (std::size_t b = 0; b < distances.size(); ++b) distances[b] += fit.distances[b];
      warnings.add(fit.warnings);
    }
    const auto n = static_cast<double>(out.points_used);
    out.rms_distance = std::sqrt(squares / n);
    out.composite->cross_validation_error = predicted / n;
    double below = 0;
    for (std::size_t b = 0; b < distances.size(); ++b) {
      below += static_cast<double>(distances[b]);
      if (below < 0.99 * n) continue;
      out.p99_distance = std::min(bin_distance(static_cast<Index>(b)), out.max_distance);
      break;
    }
    if (work_.non_finite > 0)
      out.warnings.push_back(std::to_string(work_.non_finite) + " points with NaN or infinite coordinates dropped");
    if (const std::string names = left_out(work_); !names.empty())
      out.warnings.push_back("properties of points (" + names + ") are not carried over by tiles");
    warnings.append_to(out.warnings);
  }

  const std::string& points_;
  const std::string& mesh_;
  const TileOptions& options_;
  TileTeam team_;
  const TileFolder& folder_;
  TileWork<3> work_;
  std::vector<TileFit> fits_;
  MeshWork mesh_work_;
  std::vector<int> rounds_;  // in which the part of each tile was made
  TileReport report_;
};

// Points of a tile that fits in the memory.
Index points_within(double memory) {
  const auto points = static_cast<Index>((memory - surface_bytes) / point_bytes);
  constexpr double mega = 1e6;
  const double least = surface_bytes + point_bytes * static_cast<double>(least_memory_points);
  if (points < least_memory_points)
    throw InvalidInput("reconstruct_tiles: memory = " + std::to_string(static_cast<Index>(memory / mega)) +
                       " MB: is too little; give at least " +
                       std::to_string(static_cast<Index>(std::ceil(least / mega))) + " MB");
  return points;
}

}  // namespace

TileReport reconstruct_tiles(const std::string& points, const std::string& mesh, const TileOptions& options) {
  TileOptions used = options;
  if (used.memory > 0) used.tile_points = points_within(used.memory);
  check_options(used);
  TileReport report = SurfaceInTiles(points, mesh, used).run();
  report.tile_points = used.tile_points;
  return report;
}

}  // namespace csrbf
