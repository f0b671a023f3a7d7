#include "csrbf/surface/estimate_normals.hpp"

#include "commands/commands.hpp"
#include "commands/formats.hpp"

#include "csrbf/io/mesh.hpp"
#include "csrbf/io/points.hpp"

namespace csrbf::app {
namespace {

constexpr std::string_view viewpoint_word = "viewpoint";

NormalOptions make_normal_options(const EstimateNormalsCommand& command) {
  NormalOptions options;
  options.neighbors = command.neighbors;
  if (command.orient == "none") {
    options.orient = Orient::none;
  } else if (command.orient.starts_with(viewpoint_word) && command.orient.size() > viewpoint_word.size()) {
    options.orient = Orient::viewpoint;
    options.viewpoint = parse_numbers(command.orient.substr(viewpoint_word.size() + 1), ',', 3, "--orient viewpoint");
  } else if (command.orient != "consistent") {
    throw UsageError("--orient " + command.orient + ": unknown; use consistent, viewpoint X,Y,Z or none");
  }
  return options;
}

// The points of a file, and a warning where it has faces, too, which the output does not get.
PointCloud read_cloud(const EstimateNormalsCommand& command, Session& session) {
  const PointSelection selection = make_selection(command.points);
  if (!selection.is_all()) return select_points(read_points(command.input), selection);
  Mesh mesh = read_mesh_or_points(command.input);
  if (mesh.triangles.cols() > 0)
    session.warn("the output holds points only: " + counted(mesh.triangles.cols(), "triangle") + " left out");
  return vertices_of(std::move(mesh), session);
}

// As in `reconstruct`; returns how many there were.
Index drop_non_finite(PointCloud& cloud) {
  std::vector<Index> kept;
  for (Index i = 0; i < cloud.size(); ++i)
    if (cloud.points.col(i).allFinite()) kept.push_back(i);
  const Index dropped = cloud.size() - std::ssize(kept);
  if (dropped == 0) return 0;
  for (Property& p : cloud.properties) p.values = p.values(kept).eval();
  cloud.normals.resize(3, 0);
  cloud.points = cloud.points(Eigen::all, kept).eval();
  return dropped;
}

}  // namespace

void run(const EstimateNormalsCommand& command, Session& session) {
  NormalOptions options = make_normal_options(command);
  options.progress = session.progress();
  std::string formats = "point files are ";
  formats += point_formats;
  session.may_replace_input = true;
  session.expect_output("--output", command.output, is_point_file(command.output), formats);

  PointCloud cloud = session.timed("read", [&] { return read_cloud(command, session); });
  session.input = {{"file", command.input}, {"points", cloud.size()}, {"normals", cloud.has_normals()}};
  const Index dropped = drop_non_finite(cloud);
  if (dropped > 0) session.warn(std::to_string(dropped) + " points with NaN or infinite coordinates dropped");
  NormalReport report;
  cloud.normals = session.timed("fit", [&] { return estimate_normals(cloud.points, options, &report); });
  session.options = {{"output", command.output}, {"neighbors", report.neighbors}, {"orient", command.orient}};
  session.result = {{"points", cloud.size()}, {"duplicates", report.duplicates}, {"undetermined", report.undetermined}};
  session.say(command.output + ": " + counted(cloud.size(), "point") + " with normals from " +
              std::to_string(report.neighbors) + " neighbours each");
  session.write([&] { session.warn(write_points(command.output, cloud)); });
}

}  // namespace csrbf::app
