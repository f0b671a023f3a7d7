#include "csrbf/tiles/reconstruct_tiles.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/tiles/stages/deal_points.hpp"
#include "csrbf/tiles/stages/outline.hpp"
#include "csrbf/tiles/stages/weld_parts.hpp"

#include <filesystem>
#include <map>
#include <set>
#include <sstream>

namespace csrbf {
namespace {

constexpr Index fewest_tile_points = 1000;  // smaller tiles consist of borders

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
  require(!options.folder.empty(), where, "folder", options.folder, "must be named");
  require(options.share.count >= 1 && options.share.rank >= 0 && options.share.rank < options.share.count, where,
          "share", options.share.rank, "must be from 0 to the number of processes less one");
}

// The same for the same input and options.
std::string fingerprint(const std::string& points, const TileOptions& options) {
  const auto path = utf8_path(points);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw IoError(points + ": must be a file, for it is read twice");
  std::ostringstream text;
  text.precision(17);
  const auto changed = std::filesystem::last_write_time(path).time_since_epoch().count();
  text << "size " << std::filesystem::file_size(path) << " changed " << changed << " tile_points "
       << options.tile_points << " normals " << static_cast<int>(options.surface.normals) << " smoothing "
       << options.surface.smoothing.value_or(-1) << " resolution " << options.resolution << " mesh "
       << (options.mesh_method ? static_cast<int>(*options.mesh_method) : -1) << " processes " << options.share.count;
  return text.str();
}

// One process of those that share the work.
class TileProcess {
 public:
  TileProcess(const std::string& points, const std::string& mesh, const TileOptions& options)
      : points_(points), mesh_(mesh), options_(options), folder_(options.folder) {}

  TileReport run() {
    try {
      start();
      prepare();
      fit();
      polygonize();
      if (leads()) finish();
      return report_;
    } catch (const Cancelled&) {
      throw;  // the same command goes on
    } catch (const std::exception& error) {
      if (options_.share.count > 1) write_file(failure(), error.what());
      throw;
    }
  }

 private:
  [[nodiscard]] bool leads() const { return options_.share.rank == 0; }
  [[nodiscard]] bool is_own(Index tile) const { return tile % options_.share.count == options_.share.rank; }
  [[nodiscard]] std::string failure() const { return folder_.file("failed"); }

  void alive() const { report(options_.surface.progress, "wait", 0); }
  void wait(const std::string& path) const {
    wait_for(path, failure(), [this] { alive(); });
  }

  // Calls make(tile) for the own tiles that lack a file, with the progress of the whole stage.
  template <class Make>
  Index for_own_tiles(const std::string& kind, const Make& make) {
    Index found = 0;
    for (Index t = 0; t < work_.plan.size(); ++t) {
      if (!is_own(t)) continue;
      if (exists(folder_.file(kind, t)))
        ++found;
      else
        make(t);
    }
    return found;
  }

  // Progress of step `done` of `total` in a stage.
  [[nodiscard]] Progress part_of(const char* stage, Index done) const {
    const Progress& whole = options_.surface.progress;
    if (!whole) return {};
    const double total = static_cast<double>(work_.plan.size()), before = static_cast<double>(done);
    return [whole, stage, before, total](std::string_view, double fraction) {
      return whole(stage, (before + fraction) / total);
    };
  }

  void start() {
    const std::string print = fingerprint(points_, options_);
    if (leads()) {
      std::error_code ignored;
      std::filesystem::remove(utf8_path(failure()), ignored);
    }
    const std::string file = folder_.file("work");
    if (!exists(file)) {
      if (leads()) {
        stream_.emplace(points_);
        folder_.write_work(
            plan_work(*stream_, options_.tile_points, options_.resolution, print, options_.surface.progress));
      } else {
        wait(file);
      }
    }
    work_ = folder_.read_work();
    if (work_.fingerprint != print)
      throw InvalidInput("reconstruct_tiles: folder = " + options_.folder + " has steps of other work (" +
                         work_.fingerprint + ", now " + print + "); remove it to start over, or name another");
    report_.tiles = work_.plan.size();
  }

  void prepare() {
    const auto start = std::chrono::steady_clock::now();
    const Index processes = options_.share.count;
    const auto dealt = [&](Index process) { return folder_.file("dealt", process); };
    if (!exists(dealt(options_.share.rank))) {
      if (!stream_) stream_.emplace(points_);
      deal_points(*stream_, work_, folder_, options_.share.rank, processes, options_.surface.progress);
      write_file(dealt(options_.share.rank), "");
    }
    stream_.reset();
    for (Index p = 0; p < processes; ++p) wait(dealt(p));
    for_own_tiles("points", [&](Index t) {
      report(options_.surface.progress, "prepare", static_cast<double>(t) / static_cast<double>(work_.plan.size()));
      sort_points(work_, folder_, t, processes);
    });
    report_.surface.prepare_seconds = seconds_since(start);
  }

  void fit() {
    const auto start = std::chrono::steady_clock::now();
    for (Index t = 0; t < work_.plan.size(); ++t) wait(folder_.file("points", t));
    if (leads() && work_.plan.size() > 1 && !exists(folder_.file("outline")))
      make_outline(work_, folder_, options_.surface);
    if (work_.plan.size() > 1) wait(folder_.file("outline"));
    report_.continued = for_own_tiles("fit", [&](Index t) {
      ReconstructOptions here = options_.surface;
      here.progress = part_of("fit", t);
      fit_tile(work_, folder_, t, here);
    });
    for (Index t = 0; t < work_.plan.size(); ++t) {
      wait(folder_.file("fit", t));
      fits_.push_back(read_tile_fit(folder_, t));
    }
    report_.surface.fit_seconds = seconds_since(start);
    summarise();
  }

  void polygonize() {
    mesh_work_ = plan_meshes(work_, fits_, options_.resolution, options_.mesh_method);
    report_.resolution = mesh_work_.resolution;
    report_.mesh_method = mesh_work_.method;
    rounds_.assign(work_.plan.size(), 0);
    std::vector<std::vector<polygonization::Cell>> starts(work_.plan.size());
    std::set<Index> open;  // tiles to be made in this round
    for (Index t = 0; t < work_.plan.size(); ++t) open.insert(t);
    for (int round = 0; !open.empty(); ++round) {
      for_own_tiles(border_kind(round), [&](Index t) {
        if (open.count(t) > 0) mesh_tile(work_, mesh_work_, folder_, t, round, starts[t], part_of("polygonize", t));
      });
      for (const Index t : open) {
        wait(folder_.file(border_kind(round), t));
        rounds_[t] = round;
      }
      std::vector<TileBorder> borders;
      for (Index t = 0; t < work_.plan.size(); ++t) borders.push_back(read_border(folder_, t, rounds_[t]));
      const std::vector<std::vector<polygonization::Cell>> missing = missing_starts(mesh_work_, work_.plan, borders);
      open.clear();
      for (Index t = 0; t < work_.plan.size(); ++t) {
        if (missing[t].empty()) continue;
        open.insert(t);
        starts[t].insert(starts[t].end(), missing[t].begin(), missing[t].end());
      }
    }
    write_file(folder_.file("left", options_.share.rank), "");
  }

  void finish() {
    const WeldedMesh welded = weld_parts(folder_, rounds_, mesh_, options_.surface.progress);
    report_.topology = welded.topology;
    if (welded.dropped > 0)
      report_.surface.warnings.push_back(std::to_string(welded.dropped) +
                                         " components of the mesh without data left out");
    for (Index p = 0; p < options_.share.count; ++p) wait(folder_.file("left", p));
    folder_.remove();
  }

  // The reports of all tiles in one.
  void summarise() {
    ReconstructReport& out = report_.surface;
    out.method = "composite";
    out.points = work_.points + work_.non_finite;
    out.composite.emplace();
    std::vector<std::int64_t> distances;
    double squares = 0;
    std::map<std::string, Index> warnings;
    for (const TileFit& fit : fits_) {
      out.points_used += fit.points;
      out.centers += fit.centers;
      out.composite->patches += fit.patches;
      out.composite->levels = std::max(out.composite->levels, fit.levels);
      if (fit.normals != NormalSource::file) out.normals = fit.normals;
      squares += fit.squared_distances;
      out.max_distance = std::max(out.max_distance, fit.largest_distance);
      distances.resize(fit.distances.size());
      for (std::size_t b = 0; b < distances.size(); ++b) distances[b] += fit.distances[b];
      for (const std::string& warning : fit.warnings) ++warnings[warning];
    }
    const auto n = static_cast<double>(out.points_used);
    out.rms_distance = std::sqrt(squares / n);
    double below = 0;
    for (std::size_t b = 0; b < distances.size(); ++b) {
      below += static_cast<double>(distances[b]);
      if (below < 0.99 * n) continue;
      out.p99_distance = std::min(bin_distance(static_cast<Index>(b)), out.max_distance);
      break;
    }
    if (work_.non_finite > 0)
      out.warnings.push_back(std::to_string(work_.non_finite) + " points with NaN or infinite coordinates dropped");
    for (const auto& [text, count] : warnings)
      out.warnings.push_back((count > 1 ? "in " + std::to_string(count) + " tiles: " : "in one tile: ") + text);
  }

  const std::string& points_;
  const std::string& mesh_;
  const TileOptions& options_;
  TileFolder folder_;
  std::optional<PointStream> stream_;
  TileWork work_;
  std::vector<TileFit> fits_;
  MeshWork mesh_work_;
  std::vector<int> rounds_;  // in which the part of each tile was made
  TileReport report_;
};

}  // namespace

TileReport reconstruct_tiles(const std::string& points, const std::string& mesh, const TileOptions& options) {
  check_options(options);
  return TileProcess(points, mesh, options).run();
}

}  // namespace csrbf
