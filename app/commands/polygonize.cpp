#include "csrbf/implicit/polygonize.hpp"

#include "commands/mesh_summary.hpp"
#include "report/surface_page.hpp"

#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/reconstruct.hpp"

namespace csrbf::app {

void run(const PolygonizeCommand& command, Session& session) {
  expect_mesh_output(command.output, session);
  if (command.tolerance > 0 && command.method != name_of(PolygonizeMethod::adaptive))
    throw UsageError("--tolerance: " + command.method + " has none; use --method adaptive");
  session.input = {{"file", command.input}};
  const std::shared_ptr<const Field<3>> field = session.timed("read", [&] { return read_model(command.input); });
  PolygonizeStatistics statistics;
  const PolygonizeOptions options{
      .resolution = command.resolution > 0 ? command.resolution : automatic_resolution(*field),
      .method = command.method == "auto" ? mesh_method(*field) : polygonize_method_named(command.method).value(),
      .tolerance = command.tolerance,
      .level = command.level,
      .persistence = command.persistence.value_or(field->least_persistence()),
      .refine = command.refine,
      .progress = session.progress(),
      .statistics = &statistics};
  session.options = {{"output", command.output},
                     {"resolution", options.resolution},
                     {"method", name_of(options.method)},
                     {"tolerance", options.tolerance > 0 ? Json(options.tolerance) : Json()},
                     {"level", options.level},
                     {"persistence", *options.persistence},
                     {"refine", options.refine}};
  const Mesh mesh = session.timed("polygonize", [&] { return polygonize(*field, options); });
  add_mesh_summary(command.output, mesh, session);
  add_weak_features(statistics.weak_features, session);
  session.add_to_page([&](Page& page) { show(*field, mesh, page); });
  session.write([&] { session.warn(write_mesh(command.output, mesh)); });
}

}  // namespace csrbf::app
