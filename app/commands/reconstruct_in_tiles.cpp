#include "commands/reconstruct_in_tiles.hpp"

#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/tiles/reconstruct_tiles.hpp"

namespace csrbf::app {
namespace {

Normals parse_normals(const std::string& text) {
  if (text == "file") return Normals::file;
  return text == "estimate" ? Normals::estimate : Normals::automatic;
}

}  // namespace

ReconstructOptions make_reconstruct_options(const ReconstructCommand& command, Session& session) {
  return {.method = command.method,
          .normals = parse_normals(command.normals),
          .centers = command.centers,
          .tolerance = command.tolerance,
          .smoothing = parse_smoothing(command.smoothing),
          .progress = session.progress()};
}

void add_report(const ReconstructReport& r, Session& session) {
  session.add_time("prepare", r.prepare_seconds);
  session.add_time("fit", r.fit_seconds);
  session.add_time("evaluate", r.evaluate_seconds);
  session.warn(r.warnings);
  session.result = {{"points", r.points},
                    {"points_used", r.points_used},
                    {"normals", name_of(r.normals)},
                    {"centers", r.centers},
                    {"method", r.method},
                    {"rms_distance", r.rms_distance},
                    {"p99_distance", r.p99_distance},
                    {"max_distance", r.max_distance}};
  if (r.contours) {
    session.result["contours"] = r.contours->contours;
    session.result["slices"] = r.contours->slices;
    session.result["caps"] = r.contours->caps;
  }
  if (!r.composite) return;
  session.result["patches"] = r.composite->patches;
  session.result["levels"] = r.composite->levels;
  session.result["cross_validation_error"] = r.composite->cross_validation_error;
}

void say_quality(const ReconstructReport& r, Session& session) {
  const std::string used = r.contours ? counted(r.contours->contours, "contour") + " on " +
                                            counted(r.contours->slices, "slice") +
                                            " used; ends closed by a cap: " + std::to_string(r.contours->caps)
                                      : counted(r.points_used, "point") + " used; normals: " + name_of(r.normals);
  session.say(counted(r.points, "point") + " given, " + used + "; method: " + r.method + " with " +
              counted(r.centers, "center"));
  session.say("distance of the points to the surface, fractions of the diagonal: rms " + rounded(r.rms_distance) +
              ", 99 % " + rounded(r.p99_distance) + ", largest " + rounded(r.max_distance));
}

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

// What tiles do not do yet, or never will.
void expect_tile_flags(const ReconstructCommand& command, const Session& session) {
  const auto refuse = [](const std::string& flag, const std::string& instead) {
    throw UsageError(flag + " does not go with --tile-points; " + instead);
  };
  if (command.trim != "none") refuse("--trim", "leave it out: the mesh is watertight");
  if (!command.model.empty()) refuse("--model", "leave it out: the mesh is all that is kept");
  if (command.resume) refuse("--resume", "leave it out: tiles always go on from --tile-folder");
  if (command.tolerance > 0) refuse("--tolerance", "leave it out: each tile chooses its settings");
  if (command.centers > 0) refuse("--centers", "leave it out: each tile chooses its settings");
  if (!make_selection(command.points).is_all()) refuse("--class and --returns", "select the points first");
  if (command.method != "auto" && command.method != "composite")
    refuse("--method " + command.method, "tiles are made by the method composite");
  if (command.input == "-") refuse("standard input", "give a file, for it is read twice");
  if (command.output == "-") refuse("standard output", "give a file");
  if (session.wants_page()) refuse("a report in HTML", "give a report in JSON, and csrbf studio shows the mesh");
}

}  // namespace

bool works_in_tiles(const ReconstructCommand& command) {
  if (command.tile_points > 0) return true;
  if (!command.tile_folder.empty()) throw UsageError("--tile-folder needs --tile-points N");
  if (!command.tile_share.empty()) throw UsageError("--tile-share needs --tile-points N");
  return false;
}

void run_in_tiles(const ReconstructCommand& command, Session& session) {
  const TileShare share = parse_share(command.tile_share);
  expect_mesh_output(command.output, session);
  expect_tile_flags(command, session);
  TileOptions options;
  options.tile_points = command.tile_points;
  options.folder = command.tile_folder.empty() ? command.output + ".tiles" : command.tile_folder;
  options.surface = make_reconstruct_options(command, session);
  options.resolution = command.resolution;
  if (command.sharp != "auto")
    options.mesh_method = command.sharp == "on" ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;
  options.share = share;
  const TileReport done = reconstruct_tiles(command.input, command.output, options);
  session.input = {{"file", command.input}, {"points", done.surface.points}};
  session.options = {{"output", command.output},
                     {"method", done.surface.method},
                     {"normals", name_of(done.surface.normals)},
                     {"smoothing", command.smoothing},
                     {"resolution", done.resolution},
                     {"sharp", command.sharp},
                     {"tile_points", command.tile_points},
                     {"tile_folder", options.folder},
                     {"tile_share", std::to_string(share.rank + 1) + "/" + std::to_string(share.count)}};
  add_report(done.surface, session);
  session.result["tiles"] = done.tiles;
  session.result["tiles_continued"] = done.continued;
  session.say(counted(done.tiles, "tile") + " of up to " + counted(command.tile_points, "point"));
  if (share.rank == 0) add_mesh_summary(command.output, done.topology, session);
  say_quality(done.surface, session);
}

}  // namespace csrbf::app
