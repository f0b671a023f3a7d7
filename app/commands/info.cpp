#include "commands/fit_summary.hpp"
#include "inputs/describe_table.hpp"

#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/guessed_format.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace csrbf::app {
namespace {

constexpr Index most_columns = 32;  // of an array that is a list of samples rather than an image; chosen by hand

Json to_json(const Point<3>& p) {
  return {p.x(), p.y(), p.z()};
}

std::string to_text(const Point<3>& p, double extent) {
  return rounded_within(extent, p.x()) + " " + rounded_within(extent, p.y()) + " " + rounded_within(extent, p.z());
}

std::string to_text(const Box<3>& box) {
  return to_text(box.lo, box.diagonal()) + " to " + to_text(box.hi, box.diagonal());
}

// Of patient coordinates, as the end of a line.
std::string space_text(Space space) {
  return space == Space::unknown ? "" : std::string(", in ") + space_name(space);
}

// Null where there are no points.
void report_bounds(const Points<3>& points, Session& session, const std::string& more = "") {
  session.result["bounds"] = nullptr;
  if (points.cols() == 0) return;
  const Box<3> box = bounding_box<3>(points);
  session.result["bounds"] = {{"lo", to_json(box.lo)}, {"hi", to_json(box.hi)}, {"diagonal", box.diagonal()}};
  session.say("bounds:      " + to_text(box) + ", diagonal " + rounded(box.diagonal()) + more);
}

void report_geometry(const Mesh& mesh, Session& session) {
  const bool is_mesh = mesh.triangles.cols() > 0;
  Json properties = Json::array();
  std::vector<std::string> names;
  for (const Property& p : mesh.properties) {
    properties.push_back({{"name", p.name}, {"type", p.type}});
    names.push_back(p.name + " (" + p.type + ")");
  }
  session.result = {{"kind", is_mesh ? "mesh" : "points"},
                    {is_mesh ? "vertices" : "points", mesh.vertices.cols()},
                    {"normals", mesh.normals.cols() > 0},
                    {"properties", properties},
                    {"space", or_null(mesh.space != Space::unknown, space_name(mesh.space))}};
  session.say(is_mesh ? "mesh:        " + counted(mesh.vertices.cols(), "vertex") + ", " +
                            counted(mesh.triangles.cols(), "triangle")
                      : "cloud:       " + counted(mesh.vertices.cols(), "point"));
  report_bounds(mesh.vertices, session, space_text(mesh.space));
  session.say(std::string("normals:     ") + (mesh.normals.cols() > 0 ? "yes" : "no"));
  session.say("properties:  " + (names.empty() ? "none" : joined(names)));
  const Index bad = mesh.vertices.cols() - mesh.vertices.array().isFinite().colwise().all().count();
  session.result["not_finite"] = bad;
  if (bad > 0) session.warn(counted(bad, "point") + " without finite coordinates");
}

void report_topology(const Mesh& mesh, Session& session) {
  const Topology t = session.timed("evaluate", [&] { return topology(mesh); });
  session.result.update({{"triangles", t.triangles},
                         {"edges", t.edges},
                         {"components", t.components},
                         {"watertight", t.watertight()},
                         {"manifold", t.manifold()},
                         {"euler", t.euler},
                         {"boundary_edges", t.boundary_edges},
                         {"nonmanifold_edges", t.nonmanifold_edges},
                         {"nonmanifold_vertices", t.nonmanifold_vertices},
                         {"inconsistent_edges", t.inconsistent_edges}});
  session.say("topology:    " + counted(t.components, "component") + ", Euler characteristic " +
              std::to_string(t.euler) + ", " + (t.watertight() ? "watertight" : "not watertight") +
              (t.manifold() ? ", manifold" : ", not manifold"));
  if (!t.watertight())
    session.say("edges:       " + std::to_string(t.boundary_edges) + " on the boundary, " +
                std::to_string(t.nonmanifold_edges) + " with more than two triangles, " +
                std::to_string(t.inconsistent_edges) + " between triangles of opposite orientation");
}

// Contours in the plane or on slices, or the lines of curvature.
void report_curves(const Polylines& lines, Session& session) {
  session.result = {{"kind", "curves"}, {"points", lines.vertices.cols()}, {"edges", lines.edges.cols()}};
  session.say("curves:      " + counted(lines.vertices.cols(), "point") + ", " + counted(lines.edges.cols(), "edge"));
  report_bounds(lines.vertices, session);
}

// A mesh, points, or the edges that .ply and .obj may have instead of faces.
void report_geometry_of(const std::string& path, Session& session) {
  const auto read = [&]() -> std::variant<Mesh, Polylines> {
    if (is_listed(content_extension(path), ".ply .obj .vtp")) return read_points_or_polylines(path);
    return read_mesh_or_points(path);
  };
  const std::variant<Mesh, Polylines> found = session.timed("read", read);
  if (const auto* lines = std::get_if<Polylines>(&found)) return report_curves(*lines, session);
  const Mesh& mesh = std::get<Mesh>(found);
  report_geometry(mesh, session);
  if (mesh.triangles.cols() > 0) report_topology(mesh, session);
}

template <class Value>
Json described(const Value& value) {
  if constexpr (requires { value.rows(); })
    return {{"rows", value.rows()}, {"columns", value.cols()}};
  else
    return value;
}

void report_function(const NamedFunction& named, Session& session) {
  const Function& function = named.function;
  const Eigen::MatrixXd bounds = function.bounds();
  const Eigen::VectorXd lo = bounds.col(0), hi = bounds.col(1);
  const FitReport& r = function.report();
  session.result.update(
      {{"dimension", function.dimension()},
       {"components", function.components()},
       {"coordinates", named.coordinate_names},
       {"values", named.value_names},
       {"crs", or_null(named.crs)},
       {"bounds",
        {{"lo", std::vector<double>(lo.begin(), lo.end())}, {"hi", std::vector<double>(hi.begin(), hi.end())}}},
       {"samples", r.samples},
       {"method", r.method},
       {"kernel", r.kernel},
       {"centers", r.centers},
       {"smoothing", r.smoothing},
       {"rmse", r.rmse},
       {"max_error", r.max_error},
       {"cross_validation_rmse", r.cross_validation_rmse}});
  std::string box;
  for (Index a = 0; a < lo.size(); ++a)
    box += (a > 0 ? ", " : "") + named.coordinate_names[a] + " from " + rounded_within(hi[a] - lo[a], lo[a]) + " to " +
           rounded_within(hi[a] - lo[a], hi[a]);
  if (r.method == "segment") {
    session.say("model:       " + counted(function.components(), "level set") + " of " +
                joined(named.coordinate_names) + ", of an image of " + counted(r.samples, "voxel"));
    session.say("bounds:      " + box);
    session.say("centers:     " + counted(r.centers, "center") + " of " + r.kernel + ", support " + rounded(r.support));
    return;
  }
  session.say("model:       function " + joined(named.value_names) + " of " + joined(named.coordinate_names) +
              ", fitted to " + counted(r.samples, "sample"));
  session.say("bounds:      " + box);
  say_fit(r, session);
}

void report_model(const std::string& path, const Archive& archive, Session& session) {
  Json contents = Json::object();
  for (const auto& [name, value] : archive.values())
    contents[name] = std::visit([](const auto& v) { return described(v); }, value);
  session.result = {{"kind", "model"}, {"model", archive.kind}, {"format", archive_format}, {"contents", contents}};
  if (archive.kind == function_kind) {
    report_function(function_from(archive), session);
    return;
  }
  session.say("model:       " + archive.kind + ", positive inside");
  const Box<3> box = read_model(path)->bounds();
  Points<3> corners(3, 2);
  corners << box.lo, box.hi;
  report_bounds(corners, session);
}

void report_image(const std::string& path, Session& session) {
  const Volume<float> image = session.timed("read", [&] { return read_volume(path); });
  const auto& size = image.grid.size;
  const Point<3>&spacing = image.grid.spacing, &origin = image.grid.origin;
  Index undefined = 0;
  float lo = std::numeric_limits<float>::infinity(), hi = -lo;
  for (const float value : image.values) {
    if (std::isnan(value)) ++undefined;
    lo = std::min(lo, std::isnan(value) ? lo : value);
    hi = std::max(hi, std::isnan(value) ? hi : value);
  }
  session.result = {{"kind", "image"},
                    {"size", size},
                    {"frames", image.frames},
                    {"components", image.components},
                    {"type", sample_name(image.type)},
                    {"spacing", to_json(spacing)},
                    {"origin", to_json(origin)},
                    {"space", or_null(image.grid.space != Space::unknown, space_name(image.grid.space))},
                    {"not_a_number", undefined}};
  session.result["min"] = or_null(lo <= hi, lo);
  session.result["max"] = or_null(lo <= hi, hi);
  session.say("image:       " + size_text(image.grid) + " pixels of " + std::to_string(image.components) + " " +
              std::string(sample_name(image.type)) + ", " + counted(image.frames, "frame"));
  session.result["crs"] = or_null(image.crs);
  session.say("spacing:     " + to_text(spacing, spacing.norm()) + ", origin " + to_text(origin, spacing.norm()) +
              (image.crs.empty() ? "" : ", on a map: " + short_crs(image.crs)) + space_text(image.grid.space));
  if (lo <= hi)
    session.say("values:      from " + rounded_within(hi - lo, lo) + " to " + rounded_within(hi - lo, hi) +
                (undefined > 0 ? ", " + counted(undefined, "NaN") : ""));
}

// Text and arrays hold points, curves, samples or an image: what their columns are named and how many there are
// decides.
void report_numbers(const std::string& path, Session& session) {
  if (content_extension(path) == ".npy") {
    const std::string bytes = session.timed("read", [&] { return read_content(path); });
    std::string_view rest = bytes;
    const std::vector<Index> shape = parse_npy_header(rest, display_name(path)).shape;
    const bool is_list = shape.size() == 2 && shape[1] <= most_columns && shape[1] < shape[0];
    if (is_list && (shape[1] == 3 || shape[1] == 6)) return report_geometry_of(path, session);
    if (is_list) return report_table(read_sample_source(path), session);
    return report_image(path, session);
  }
  const SampleSource source = session.timed("read", [&] { return read_sample_source(path); });
  const auto has = [&](std::string_view name) {
    return std::any_of(source.names.begin(), source.names.end(),
                       [&](const std::string& other) { return lower_case(other) == name; });
  };
  if (has("contour")) return report_curves(read_polylines(path), session);
  const Index columns = source.values.rows();
  const bool are_points = source.names.empty() ? columns == 3 || columns == 6 : has("x") && has("y") && has("z");
  if (are_points && is_readable_point_file(path)) return report_geometry_of(path, session);
  report_table(source, session);
}

}  // namespace

void run(const InfoCommand& command, Session& session) {
  const std::string& path = command.input;
  session.input = {{"file", path}};
  const std::string extension = content_extension(path);
  if (extension == ".csrbf") {
    const Archive archive = session.timed("read", [&] { return read_archive(path); });
    return report_model(path, archive, session);
  }
  if (is_gdal_table(extension))
    return report_table(session.timed("read", [&] { return read_sample_source(path); }), session);
  // Pipes can be read once only.
  std::error_code error;
  const bool is_plain = std::filesystem::is_regular_file(path, error);
  if (is_plain && is_listed(extension, ".npy .csv .txt .tsv .dat .xyz")) return report_numbers(path, session);
  if (is_readable_volume(path)) return report_image(path, session);
  if (is_plain && extension.empty()) {
    const std::string guess = guessed_format(read_content(path));
    if (guess.empty()) return report_numbers(path, session);
    if (is_readable_volume("file" + guess)) return report_image(path, session);
  }
  report_geometry_of(path, session);
}

}  // namespace csrbf::app
