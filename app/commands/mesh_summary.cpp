#include "commands/mesh_summary.hpp"

#include "commands/formats.hpp"

#include "csrbf/io/mesh.hpp"

namespace csrbf::app {

void expect_mesh_output(const std::string& path, Session& session) {
  session.expect_output("--output", path, is_mesh_file(path), std::string("mesh files are ") + written_mesh_formats);
}

void add_mesh_summary(const std::string& path, const Mesh& mesh, Session& session) {
  Topology found = session.timed("polygonize", [&] { return topology(mesh); });
  found.vertices = mesh.vertices.cols();  // also those of no triangle
  add_mesh_summary(path, found, session);
}

void add_mesh_summary(const std::string& path, const Topology& t, Session& session) {
  session.result.update({{"vertices", t.vertices},
                         {"triangles", t.triangles},
                         {"components", t.components},
                         {"watertight", t.watertight()},
                         {"manifold", t.manifold()},
                         {"euler", t.euler}});
  session.say((path == "-" ? "standard output" : path) + ": " + counted(t.vertices, "vertex") + ", " +
              counted(t.triangles, "triangle") + ", " + counted(t.components, "component") +
              (t.components > 1 ? " (pieces that do not touch), " : ", ") +
              (t.watertight() ? "watertight" : "not watertight"));
}

void add_weak_features(Index count, Session& session) {
  session.result["weak_features"] = count;
  if (count == 0) return;
  session.say(counted(count, "handle") + " thinner than the data can show removed");
}

}  // namespace csrbf::app
