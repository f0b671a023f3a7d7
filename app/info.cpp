#include "verbs.hpp"

#include "csrbf/io/archive.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/read_file.hpp"

namespace csrbf::app {
namespace {

Json to_json(const Point<3>& p) {
  return {p.x(), p.y(), p.z()};
}

std::string to_text(const Point<3>& p) {
  return rounded(p.x()) + " " + rounded(p.y()) + " " + rounded(p.z());
}

void tell_geometry(const Mesh& mesh, Session& session) {
  const bool is_mesh = mesh.triangles.cols() > 0;
  const Box<3> box = bounding_box<3>(mesh.vertices);
  Json properties = Json::array();
  std::string names;
  for (const Property& p : mesh.properties) {
    properties.push_back({{"name", p.name}, {"type", p.type}});
    names += (names.empty() ? "" : ", ") + p.name + " (" + p.type + ")";
  }
  session.result = {{"kind", is_mesh ? "mesh" : "points"},
                    {is_mesh ? "vertices" : "points", mesh.vertices.cols()},
                    {"normals", mesh.normals.cols() > 0},
                    {"properties", properties},
                    {"bounds", {{"lo", to_json(box.lo)}, {"hi", to_json(box.hi)}, {"diagonal", box.diagonal()}}}};
  session.say(is_mesh ? "mesh:        " + counted(mesh.vertices.cols(), "vertex") + ", " +
                            counted(mesh.triangles.cols(), "triangle")
                      : "cloud:       " + counted(mesh.vertices.cols(), "point"));
  session.say("bounds:      " + to_text(box.lo) + " to " + to_text(box.hi) + ", diagonal " + rounded(box.diagonal()));
  session.say(std::string("normals:     ") + (mesh.normals.cols() > 0 ? "yes" : "no"));
  session.say("properties:  " + (names.empty() ? "none" : names));
  const Index bad = mesh.vertices.cols() - mesh.vertices.array().isFinite().colwise().all().count();
  session.result["not_finite"] = bad;
  if (bad > 0) session.warn(counted(bad, "point") + " without finite coordinates");
}

void tell_topology(const Mesh& mesh, Session& session) {
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

struct ValueDescription {
  Json operator()(double value) const { return value; }
  Json operator()(std::int64_t value) const { return value; }
  Json operator()(const std::string& value) const { return value; }
  template <class T>
  Json operator()(const ArchiveArray<T>& array) const {
    return {{"rows", array.rows()}, {"columns", array.cols()}};
  }
};

void tell_model(const Archive& archive, Session& session) {
  Json contents = Json::object();
  for (const auto& [name, value] : archive.values()) contents[name] = std::visit(ValueDescription{}, value);
  session.result = {{"kind", "model"}, {"model", archive.kind}, {"format", archive_format}, {"contents", contents}};
  session.say("model:       " + archive.kind);
  constexpr std::size_t most_lines = 8;
  std::size_t shown = 0;
  for (const auto& [name, value] : contents.items()) {
    if (++shown > most_lines) break;
    const bool is_array = value.is_object();
    session.say("  " + name + ": " +
                (is_array ? value["rows"].dump() + " x " + value["columns"].dump() : value.dump()));
  }
  if (contents.size() > most_lines)
    session.say("  and " + std::to_string(contents.size() - most_lines) + " more entries (all in the report)");
}

}  // namespace

void run(const InfoCommand& command, Session& session) {
  session.input = {{"file", command.input}};
  if (file_extension(command.input) == ".csrbf") {
    tell_model(session.timed("read", [&] { return read_archive(command.input); }), session);
    return;
  }
  const Mesh mesh = session.timed("read", [&] { return read_mesh_or_points(command.input); });
  tell_geometry(mesh, session);
  if (mesh.triangles.cols() > 0) tell_topology(mesh, session);
}

}  // namespace csrbf::app
