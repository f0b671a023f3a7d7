#include "verbs.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/compare.hpp"
#include "csrbf/io/mesh.hpp"

namespace csrbf::app {
namespace {

Json described(const std::string& path, const Mesh& mesh) {
  return {{"file", path}, {"points", mesh.vertices.cols()}, {"triangles", mesh.triangles.cols()}};
}

Json described(const DistanceStatistics& d) {
  return {{"mean", d.mean}, {"rms", d.rms}, {"p99", d.p99}, {"max", d.max}};
}

PointCloud points_of(Mesh&& mesh) {
  return {std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.properties)};
}

void add_topology(const Topology& topology, Json& result) {
  result["watertight"] = topology.watertight();
  result["manifold"] = topology.manifold();
  result["components"] = topology.components;
  result["euler"] = topology.euler;
  result["boundary_edges"] = topology.boundary_edges;
}

std::string describe(const Topology& t) {
  return std::string("mesh:                ") + (t.watertight() ? "watertight, " : "not watertight, ") +
         (t.manifold() ? "manifold, " : "not manifold, ") + counted(t.components, "component");
}

void compare_meshes(const Mesh& mesh, const Mesh& reference, Session& session) {
  const CompareOptions options{.progress = session.progress()};
  session.options = {{"samples", options.samples}, {"seed", options.seed}};
  const MeshComparison c = session.timed("evaluate", [&] { return compare(mesh, reference, options); });
  session.result = {{"chamfer_mean", c.chamfer_mean},
                    {"hausdorff99", c.hausdorff99},
                    {"normal_error_deg", c.normal_error_deg},
                    {"accuracy", described(c.accuracy)},
                    {"completeness", described(c.completeness)},
                    {"diagonal", c.diagonal}};
  add_topology(c.topology, session.result);
  session.say("distances are fractions of the diagonal of the reference (" + rounded(c.diagonal) + ")");
  session.say("chamfer mean:        " + rounded(c.chamfer_mean));
  session.say("hausdorff 99 %:      " + rounded(c.hausdorff99));
  session.say("A to B:              mean " + rounded(c.accuracy.mean) + ", largest " + rounded(c.accuracy.max));
  session.say("B to A:              mean " + rounded(c.completeness.mean) + ", largest " + rounded(c.completeness.max));
  session.say("normals:             " + rounded(c.normal_error_deg) + " degrees");
  session.say(describe(c.topology));
}

void compare_points(const Mesh& mesh, const PointCloud& points, Session& session) {
  const PointComparison c =
      session.timed("evaluate", [&] { return compare(mesh, points, {.progress = session.progress()}); });
  session.result = {{"chamfer_mean", c.distance.mean},
                    {"hausdorff99", c.distance.p99},
                    {"normal_error_deg", c.normal_error_deg},
                    {"distance", described(c.distance)},
                    {"diagonal", c.diagonal}};
  add_topology(c.topology, session.result);
  session.say("distances from the points to the mesh, fractions of the diagonal of the points (" + rounded(c.diagonal) +
              ")");
  session.say("mean:                " + rounded(c.distance.mean));
  session.say("rms:                 " + rounded(c.distance.rms));
  session.say("99 %:                " + rounded(c.distance.p99));
  session.say("largest:             " + rounded(c.distance.max));
  if (points.has_normals()) session.say("normals:             " + rounded(c.normal_error_deg) + " degrees");
  session.say(describe(c.topology));
}

}  // namespace

void run(const CompareCommand& command, Session& session) {
  Mesh a = session.timed("read", [&] { return read_mesh_or_points(command.first); });
  Mesh b = session.timed("read", [&] { return read_mesh_or_points(command.second); });
  session.input = {{"a", described(command.first, a)}, {"b", described(command.second, b)}};
  if (a.triangles.cols() == 0) std::swap(a, b);
  if (a.triangles.cols() == 0)
    throw IoError(command.first + " and " + command.second + " are both points; one must be a mesh");
  if (b.triangles.cols() > 0)
    compare_meshes(a, b, session);
  else
    compare_points(a, points_of(std::move(b)), session);
}

}  // namespace csrbf::app
