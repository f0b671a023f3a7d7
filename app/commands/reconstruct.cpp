#include "commands/mesh_summary.hpp"
#include "inputs/tile_flags.hpp"
#include "report/reconstruct_page.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/surface/prepare/face_samples.hpp"
#include "csrbf/surface/prepare/transfer_properties.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"
#include "csrbf/surface/surface_method.hpp"
#include "csrbf/surface/trim.hpp"
#include "csrbf/tiles/reconstruct_tiles.hpp"

#include <filesystem>
#include <optional>
#include <utility>
#include <variant>

namespace csrbf::app {
namespace {

Normals parse_normals(const std::string& text) {
  if (text == "file") return Normals::file;
  return text == "estimate" ? Normals::estimate : Normals::automatic;
}

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
              (r.composite ? counted(r.composite->patches, "patch") : counted(r.centers, "center")));
  session.say("distance of the points to the surface, fractions of the diagonal: rms " + rounded(r.rms_distance) +
              ", 99 % " + rounded(r.p99_distance) + ", largest " + rounded(r.max_distance));
}

// What tiles do not do yet, or never will.
void expect_tile_flags(const ReconstructCommand& command, const Session& session) {
  if (command.trim != "none") refuse_in_tiles("--trim", "leave it out: the mesh is watertight");
  if (command.tolerance > 0) refuse_in_tiles("--tolerance", "leave it out: each tile chooses its settings");
  if (command.centers > 0) refuse_in_tiles("--centers", "leave it out: each tile chooses its settings");
  if (!make_selection(command.points).is_all()) refuse_in_tiles("--class and --returns", "select the points first");
  if (command.method != "auto" && command.method != "composite")
    refuse_in_tiles("--method " + command.method, "tiles are made by the method composite");
  expect_tile_files(command.input, command.output, session);
}

void expect_mesh_outputs(const ReconstructCommand& command, Session& session) {
  if (works_in_tiles(command.tiles) && command.output.ends_with('/')) {
    std::error_code error;
    std::filesystem::create_directories(command.output, error);
    session.expect_output(command.output + "tile_0000.ply");  // says why if there is no folder
  } else {
    expect_mesh_output(command.output, session);
  }
  if (command.model.empty()) return;
  if (file_extension(command.model) != ".csrbf") throw UsageError("--model " + command.model + ": models are .csrbf");
  const SurfaceMethod* method = find_surface_method(command.method);
  if (method != nullptr && !method->has_model)
    throw UsageError("--model " + command.model + ": surfaces of the method " + command.method + " cannot be saved");
  session.expect_output(command.model);
}

void run_in_tiles(const ReconstructCommand& command, Session& session) {
  const TileShare share = tile_share(command.tiles, session);
  expect_mesh_outputs(command, session);
  expect_tile_flags(command, session);
  TileOptions options;
  options.tile_points = tile_points(command.tiles);
  options.memory = tile_memory(command.tiles);
  options.folder = tile_folder(command.tiles, command.output);
  options.surface = make_reconstruct_options(command, session);
  options.resolution = command.resolution;
  if (command.sharp != "auto")
    options.mesh_method = command.sharp == "on" ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;
  options.model = command.model;
  options.share = share;
  options.warn = [&](const std::string& text) { session.warn(text); };
  const TileReport done = reconstruct_tiles(command.input, command.output, options);
  session.input = {{"file", command.input}, {"points", done.surface.points}};
  session.options = {
      {"output", command.output},       {"method", done.surface.method}, {"normals", name_of(done.surface.normals)},
      {"smoothing", command.smoothing}, {"resolution", done.resolution}, {"sharp", command.sharp},
      {"model", or_null(command.model)}};
  add_tile_options(done.tile_points, share, options.folder, session);
  add_report(done.surface, session);
  session.result["tiles"] = done.tiles;
  session.result["tiles_continued"] = done.continued;
  session.result["tiles_meshed_again"] = done.meshed_again;
  session.say(counted(done.tiles, "tile") + " of up to " + counted(done.tile_points, "point"));
  add_weak_features(done.weak_features, session);
  if (share.rank == 0) add_mesh_summary(command.output, done.topology, session);
  say_quality(done.surface, session);
  check_tile_memory(command.tiles, session);
}

// The points of a file, or samples of its faces where they tell more.
PointCloud points_of(Mesh mesh, Session& session) {
  if (std::optional<PointCloud> samples = samples_of_coarse_faces(mesh)) {
    session.warn("the vertices are too few to tell the surface between them without the faces of the file: " +
                 counted(samples->size(), "point") + " on its faces used in their place");
    return *std::move(samples);
  }
  return vertices_of(std::move(mesh), session);
}

std::variant<PointCloud, Polylines> read_input(const ReconstructCommand& command, Session& session) {
  const PointSelection selection = make_selection(command.points);
  if (command.method == "contours") return read_polylines(command.input);
  if (!selection.is_all()) return select_points(read_points(command.input), selection);
  if (command.method != "auto") return points_of(read_mesh_or_points(command.input), session);
  std::variant<Mesh, Polylines> input = read_points_or_polylines(command.input);
  if (Mesh* const mesh = std::get_if<Mesh>(&input)) return points_of(std::move(*mesh), session);
  return std::get<Polylines>(std::move(input));
}

// Flags about points do not apply to contours.
void expect_no_point_flags(const ReconstructCommand& command) {
  const auto refuse = [&](const char* flag) {
    throw UsageError(std::string(flag) + " is for points, not for contours; leave it out, or give --method composite");
  };
  if (command.normals != "auto") refuse("--normals");
  if (command.tolerance > 0) refuse("--tolerance");
  if (command.trim != "none") refuse("--trim");
}

// The options as given, automatic ones replaced by what was chosen.
void add_reconstruct_options(const ReconstructCommand& command, const ReconstructReport& r, int resolution,
                             Session& session) {
  session.options = {{"output", command.output},
                     {"method", r.method},
                     {"normals", name_of(r.normals)},
                     {"centers", or_null(command.centers > 0, command.centers)},
                     {"tolerance", or_null(command.tolerance > 0, command.tolerance)},
                     {"smoothing", r.smoothing},
                     {"resolution", resolution},
                     {"sharp", command.sharp},
                     {"trim", command.trim},
                     {"class", or_null(command.points.classes)},
                     {"returns", command.points.returns},
                     {"model", or_null(command.model)}};
  if (!r.composite) return;
  const CompositeSettings& used = r.composite->settings;
  session.options["leaf_size"] = used.leaf_size;
  session.options["overlap"] = used.overlap;
  session.options["centers_per_patch"] = used.centers_per_patch;
  session.options["normal_weight"] = used.normal_weight;
}

// The points that the surface was made from, with the normals used and their properties.
PointCloud used_points(const PointCloud& cloud, Reconstruction& surface) {
  PointCloud used;
  used.points = cloud.points(Eigen::all, surface.source);
  used.normals = std::move(surface.normals);
  for (const Property& p : cloud.properties) used.properties.push_back({p.name, p.type, p.values(surface.source)});
  return used;
}

// A surface and the points that it is made from.
struct Made {
  PointCloud used;
  Reconstruction surface;
};

Made from_points(const PointCloud& cloud, const ReconstructOptions& options, const ReconstructCommand& command,
                 Session& session) {
  session.input = {{"file", command.input}, {"points", cloud.size()}, {"normals", cloud.has_normals()}};
  Made made;
  made.surface = reconstruct(cloud, options);
  made.used = used_points(cloud, made.surface);
  return made;
}

Made from_contours(const Polylines& contours, const ReconstructOptions& given, const ReconstructCommand& command,
                   Session& session) {
  expect_no_point_flags(command);
  ContourOptions options{.smoothing = given.smoothing, .progress = given.progress};
  if (command.centers > 0) options.centers = command.centers;
  session.input = {{"file", command.input}, {"points", contours.vertices.cols()}, {"edges", contours.edges.cols()}};
  Made made;
  made.surface = reconstruct_contours(contours, options);
  made.used.points = contours.vertices(Eigen::all, made.surface.source);
  made.used.normals = std::move(made.surface.normals);
  return made;
}

Made make_surface(const ReconstructCommand& command, Session& session) {
  const ReconstructOptions options = make_reconstruct_options(command, session);
  const std::variant<PointCloud, Polylines> input = session.timed("read", [&] { return read_input(command, session); });
  if (const Polylines* contours = std::get_if<Polylines>(&input))
    return from_contours(*contours, options, command, session);
  return from_points(std::get<PointCloud>(input), options, command, session);
}

// The components of the mesh with data.
DataComponents with_data(Mesh mesh, const PointCloud& used, std::optional<double> trim_distance) {
  if (trim_distance) mesh = trim(mesh, used.points, *trim_distance, used.normals);
  return keep_components_with_data(std::move(mesh), used.points);
}

PolygonizeMethod method_of(const ReconstructCommand& command, const Field<3>& field) {
  if (command.sharp == "auto") return mesh_method(field);
  return command.sharp == "on" ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;
}

Mesh make_mesh(const Field<3>& field, const PointCloud& used, const PolygonizeOptions& options,
               std::optional<double> trim_distance, Session& session) {
  PolygonizeStatistics statistics;
  PolygonizeOptions counting = options;
  counting.statistics = &statistics;
  Mesh mesh = session.timed("polygonize", [&] { return polygonize(field, counting); });
  add_weak_features(statistics.weak_features, session);
  session.timed("evaluate", [&] {
    DataComponents kept = with_data(std::move(mesh), used, trim_distance);
    if (kept.dropped > 0) session.warn(counted(kept.dropped, "component") + " of the mesh without data left out");
    if (!kept.warning.empty()) session.warn(kept.warning);
    mesh = std::move(kept.mesh);
    if (mesh.triangles.cols() == 0)
      throw SolverFailure(trim_distance ? "no surface is left within " + rounded(*trim_distance) +
                                              " spacings of the points; raise --trim, to 4 or more"
                                        : "the mesh has no surface near the points; raise --resolution");
    mesh.properties = transfer_properties(used.points, used.properties, mesh.vertices);
  });
  return mesh;
}

// Surface far from all points is a guess, however good it looks.
void warn_of_closed_gaps(const Mesh& mesh, const PointCloud& used, Session& session) {
  constexpr double far = 4, small_share = 0.01;  // spacings, of the area; chosen by hand
  const double share = session.timed("evaluate", [&] { return share_without_data(mesh, used.points, far); });
  session.result["without_data"] = share;
  if (share < small_share) return;
  session.warn(std::to_string(std::lround(100 * share)) +
               " % of the surface is farther than 4 spacings from all points: it closes gaps without data; --trim 4 "
               "leaves them open");
}

}  // namespace

void run(const ReconstructCommand& command, Session& session) {
  if (works_in_tiles(command.tiles)) {
    run_in_tiles(command, session);
    return;
  }
  const std::optional<double> trim_distance = parse_word_or_number(command.trim, "none", "--trim");
  if (trim_distance && !(*trim_distance > 0)) throw UsageError("--trim " + command.trim + ": must be positive");
  expect_mesh_outputs(command, session);
  Made made = make_surface(command, session);
  const PointCloud& used = made.used;
  Reconstruction& surface = made.surface;
  add_report(surface.report, session);
  const int resolution = command.resolution > 0 ? command.resolution : automatic_resolution(*surface.field);
  add_reconstruct_options(command, surface.report, resolution, session);
  const PolygonizeOptions options{
      .resolution = resolution, .method = method_of(command, *surface.field), .progress = session.progress()};
  const Mesh mesh = make_mesh(*surface.field, used, options, trim_distance, session);
  if (!trim_distance && !surface.report.contours && used.size() > 1) warn_of_closed_gaps(mesh, used, session);
  session.add_to_page([&](Page& page) { show({surface, used, mesh}, page); });
  if (command.model.empty()) surface.field.reset();  // frees memory
  add_mesh_summary(command.output, mesh, session);
  say_quality(surface.report, session);

  session.write([&] {
    session.warn(write_mesh(command.output, mesh));
    if (!command.model.empty()) write_model(command.model, *surface.field);
  });
}

}  // namespace csrbf::app
