#include "csrbf/implicit/curvature.hpp"

#include "commands/mesh_summary.hpp"
#include "report/surface_page.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/ridges.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/surface/reconstruct.hpp"

namespace csrbf::app {
namespace {

void add_properties(const Curvatures& at, Mesh& mesh) {
  mesh.normals = at.normals;
  mesh.properties = {{"k1", "float", at.k1}, {"k2", "float", at.k2}};
  for (int axis = 0; axis < 3; ++axis)
    mesh.properties.push_back({std::string("d1") + "xyz"[axis], "float", at.direction1.row(axis)});
  for (int axis = 0; axis < 3; ++axis)
    mesh.properties.push_back({std::string("d2") + "xyz"[axis], "float", at.direction2.row(axis)});
  mesh.properties.push_back({"mean_curvature", "float", at.mean()});
  mesh.properties.push_back({"gaussian_curvature", "float", at.gaussian()});
}

void expect_geometry(const std::string& flag, const std::string& path, Session& session) {
  if (!is_polylines_file(path))
    throw UsageError(flag + " " + path + ": only .ply and .vtp store these vertex properties");
  session.expect_output(path);
}

void add_ridge_summary(const std::string& path, const Polylines& lines, Session& session) {
  const Eigen::VectorXd& kind = lines.properties.front().values;
  const Index ridge_points = (kind.array() > 0).count();
  session.result["ridge_points"] = ridge_points;
  session.result["valley_points"] = kind.size() - ridge_points;
  session.say(path + ": " + counted(ridge_points, "point") + " on ridges, " +
              counted(kind.size() - ridge_points, "point") + " on valleys");
}

}  // namespace

void run(const CurvatureCommand& command, Session& session) {
  expect_geometry("--output", command.output, session);
  if (!command.ridges.empty()) expect_geometry("--ridges", command.ridges, session);
  session.input = {{"file", command.input}};
  const std::shared_ptr<const Field<3>> field = session.timed("read", [&] { return read_model(command.input); });
  const int resolution = command.resolution > 0 ? command.resolution : automatic_resolution(*field);
  session.options = {{"output", command.output}, {"resolution", resolution}, {"ridges", command.ridges}};
  Mesh mesh = session.timed("polygonize", [&] {
    return polygonize(*field,
                      {.resolution = resolution, .method = mesh_method(*field), .progress = session.progress()});
  });
  const Curvatures at = session.timed("evaluate", [&] { return curvature(*field, mesh.vertices, session.progress()); });
  add_mesh_summary(command.output, mesh, session);
  session.result["singular"] = at.singular();
  if (at.singular() > 0)
    session.warn("the surface has no normal at " + counted(at.singular(), "vertex") + ": NaN is written there");
  Polylines lines;
  if (!command.ridges.empty()) {
    lines = session.timed("ridges", [&] { return ridges(*field, mesh, {.progress = session.progress()}); });
    add_ridge_summary(command.ridges, lines, session);
  }
  session.add_to_page([&](Page& page) { show(*field, mesh, at, lines, page); });
  add_properties(at, mesh);
  session.write([&] {
    write_mesh(command.output, mesh);
    if (!command.ridges.empty()) write_polylines(command.ridges, lines);
  });
}

}  // namespace csrbf::app
