#include "csrbf/implicit/combine.hpp"

#include "commands/commands.hpp"
#include "report/surface_page.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/reconstruct.hpp"

namespace csrbf::app {
namespace {

Operation operation_of(const CombineCommand& command) {
  return command.operation == "blend" ? Operation::unite : operation_named(command.operation).value();
}

CombineOptions make_options(const CombineCommand& command) {
  CombineOptions options;
  const bool is_rounded = command.operation == "blend" || command.radius || command.sharpness;
  if (!command.blending.empty())
    options.blending = blending_named(command.blending).value();
  else if (is_rounded && command.operation != "complement")
    options.blending = Blending::super_elliptic;
  if (is_rounded && !has_range(options.blending))
    throw UsageError("--blending " + std::string(name_of(options.blending)) + ": has no radius or sharpness" +
                     (command.operation == "blend" ? "; use union" : ""));
  options.radius = command.radius.value_or(options.radius);
  options.sharpness = command.sharpness.value_or(options.sharpness);
  return options;
}

}  // namespace

void run(const CombineCommand& command, Session& session) {
  CombineOptions options = make_options(command);
  options.progress = session.progress();
  if (file_extension(command.output) != ".csrbf")
    throw UsageError("--output " + command.output + ": models are .csrbf");
  const bool is_complement = command.operation == "complement";
  if (is_complement ? command.inputs.size() != 1 : command.inputs.size() < 2)
    throw UsageError(command.operation + (is_complement ? " takes one model" : " takes at least two models"));
  session.expect_output(command.output);
  session.input = {{"files", command.inputs}};
  session.options = {{"output", command.output},
                     {"operation", command.operation},
                     {"blending", name_of(options.blending)},
                     {"radius", has_range(options.blending) ? Json(options.radius) : Json()},
                     {"sharpness", has_range(options.blending) ? Json(options.sharpness) : Json()}};
  std::vector<Solid> solids;
  session.timed("read", [&] {
    for (const std::string& file : command.inputs) solids.push_back(read_model(file));
  });
  const Solid combined = session.timed("combine", [&] { return combine(operation_of(command), solids, options); });
  const Box<3> box = combined->bounds();
  session.result = {{"models", solids.size()},
                    {"bounds",
                     {{"lo", {box.lo.x(), box.lo.y(), box.lo.z()}},
                      {"hi", {box.hi.x(), box.hi.y(), box.hi.z()}},
                      {"diagonal", box.diagonal()}}}};
  session.say(command.output + ": " + command.operation + " of " + counted(std::ssize(solids), "model") + ", " +
              std::string(name_of(options.blending)));
  session.add_to_page([&](Page& page) {
    constexpr int cells = 80;  // a mesh to look at, in a tenth of a second
    show(*combined, polygonize(*combined, {.resolution = cells, .method = mesh_method(*combined)}), page);
  });
  session.write([&] { write_model(command.output, *combined); });
}

}  // namespace csrbf::app
