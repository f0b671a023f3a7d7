#include "commands/commands.hpp"
#include "report/image_page.hpp"
#include "report/surface_page.hpp"

#include "csrbf/implicit/compare.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/levelset/compare_labels.hpp"

namespace csrbf::app {
namespace {

Json described_difference(const std::string& path, const Mesh& mesh) {
  return {{"file", path}, {"points", mesh.vertices.cols()}, {"triangles", mesh.triangles.cols()}};
}

Json described_difference(const DistanceStatistics& d) {
  return {{"mean", d.mean}, {"rms", d.rms}, {"p99", d.p99}, {"max", d.max}};
}

// Points with finite coordinates.
PointCloud points_of(const Mesh& mesh, Session& session) {
  std::vector<Index> kept;
  for (Index i = 0; i < mesh.vertices.cols(); ++i)
    if (mesh.vertices.col(i).allFinite()) kept.push_back(i);
  const Index dropped = mesh.vertices.cols() - std::ssize(kept);
  if (dropped > 0) session.warn(std::to_string(dropped) + " points with NaN or infinite coordinates left out");
  PointCloud cloud;
  cloud.points = mesh.vertices(Eigen::all, kept);
  if (mesh.normals.cols() > 0) cloud.normals = mesh.normals(Eigen::all, kept);
  return cloud;
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

std::string part_of_diagonal(double fraction) {
  constexpr double percent = 100;
  return readable(percent * fraction, 2) + " %";
}

void compare_meshes(const Mesh& mesh, const Mesh& reference, Session& session) {
  const CompareOptions options{.progress = session.progress()};
  session.options = {{"samples", options.samples}, {"seed", options.seed}};
  const MeshComparison c = session.timed("evaluate", [&] { return compare(mesh, reference, options); });
  session.result = {{"chamfer_mean", c.chamfer_mean},
                    {"hausdorff99", c.hausdorff99},
                    {"normal_error_deg", c.normal_error_deg},
                    {"accuracy", described_difference(c.accuracy)},
                    {"completeness", described_difference(c.completeness)},
                    {"diagonal", c.diagonal}};
  add_topology(c.topology, session.result);
  session.say("distances are fractions of the diagonal of the reference (" + rounded(c.diagonal) + ")");
  session.say("chamfer mean:        " + rounded(c.chamfer_mean));
  session.say("hausdorff 99 %:      " + rounded(c.hausdorff99));
  session.say("A to B:              mean " + rounded(c.accuracy.mean) + ", largest " + rounded(c.accuracy.max));
  session.say("B to A:              mean " + rounded(c.completeness.mean) + ", largest " + rounded(c.completeness.max));
  session.say("normals:             " + rounded(c.normal_error_deg) + " degrees");
  session.say(describe(c.topology));
  session.add_to_page([&](Page& page) {
    page.facts = {{part_of_diagonal(c.chamfer_mean), "mean distance, of the diagonal"},
                  {part_of_diagonal(c.hausdorff99), "99 % are nearer than this"},
                  {readable(c.normal_error_deg, 3) + "°", "mean angle between normals"}};
    show_distances(mesh, reference, page);
  });
}

void compare_points(const Mesh& mesh, const PointCloud& points, Session& session) {
  const PointComparison c =
      session.timed("evaluate", [&] { return compare(mesh, points, {.progress = session.progress()}); });
  session.result = {{"chamfer_mean", c.distance.mean},
                    {"hausdorff99", c.distance.p99},
                    {"normal_error_deg", c.normal_error_deg},
                    {"distance", described_difference(c.distance)},
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
  session.add_to_page([&](Page& page) {
    page.facts = {{part_of_diagonal(c.distance.mean), "mean distance, of the diagonal"},
                  {part_of_diagonal(c.distance.p99), "99 % of the points are nearer than this"},
                  {part_of_diagonal(c.distance.max), "largest distance"}};
    show_distances(mesh, points, page);
  });
}

Json described_difference(const std::string& path, const Volume<float>& image) {
  Json size = Json::array();
  for (int a = 0; a < image.grid.axes; ++a) size.push_back(image.grid.size[a]);
  return {{"file", path}, {"size", size}};
}

Json described_difference(const LabelAgreement& agreement) {
  return {{"dice", agreement.dice}, {"jaccard", agreement.jaccard}, {"hausdorff95", agreement.hausdorff95}};
}

// The image has no position: its format stores none.
bool has_no_position(const Grid& grid) {
  return grid.space == Space::unknown && grid.spacing == Point<3>::Ones() && grid.origin == Point<3>::Zero() &&
         grid.direction == Eigen::Matrix3d::Identity();
}

// Pictures and arrays are given the position of the other image.
void share_position(const CompareCommand& command, Grid& a, Grid& b, Session& session) {
  if (a.size != b.size || has_no_position(a) == has_no_position(b)) return;
  const bool first = has_no_position(a);
  (first ? a : b) = first ? b : a;
  session.warn((first ? command.first : command.second) + " stores no position for its voxels: assuming that of " +
               (first ? command.second : command.first));
}

// Does each image have a single label, but with different values?
bool has_one_label_each(const Volume<float>& a, const Volume<float>& b) {
  const auto single_label = [](const Volume<float>& image) {
    float label = 0;
    for (const float value : image.values) {
      if (value == 0 || value == label) continue;
      if (label != 0) return 0.0F;
      label = value;
    }
    return label;
  };
  const float in_a = single_label(a), in_b = single_label(b);
  return in_a != 0 && in_b != 0 && in_a != in_b;
}

// The same objects may have other numbers.
void warn_of_numbers(const Volume<float>& a, const Volume<float>& b, const LabelsComparison& found, Session& session) {
  constexpr double clearly = 0.2;
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    both += a.values[i] != 0 && b.values[i] != 0 ? 1 : 0;
    sum += (a.values[i] != 0 ? 1 : 0) + (b.values[i] != 0 ? 1 : 0);
  }
  const double any = sum > 0 ? 2 * both / sum : 1;
  if (any - found.dice <= clearly || session.options["inside_only"] == true) return;
  session.warn(
      "voxels are compared by the number of their label; where only counts whether they have one, the Dice is " +
      rounded(any));
}

void compare_images(const CompareCommand& command, Session& session) {
  Volume<float> a = session.timed("read", [&] { return read_volume(command.first); });
  Volume<float> b = session.timed("read", [&] { return read_volume(command.second); });
  session.input = {{"a", described_difference(command.first, a)}, {"b", described_difference(command.second, b)}};
  share_position(command, a.grid, b.grid, session);
  const CompareLabelsOptions options{.inside_only = has_one_label_each(a, b), .progress = session.progress()};
  if (options.inside_only)
    session.warn("each image has a single label, with different values: compared as the same region");
  session.options = {{"inside_only", options.inside_only}};
  const LabelsComparison c = session.timed("evaluate", [&] { return compare_labels(a, b, options); });
  session.result = described_difference(c);
  Json& labels = session.result["labels"] = Json::array();
  for (const LabelComparison& one : c.labels) {
    Json entry = {{"label", one.label}, {"voxels", one.voxels}, {"reference_voxels", one.reference_voxels}};
    entry.update(described_difference(static_cast<const LabelAgreement&>(one)));
    labels.push_back(entry);
  }
  warn_of_numbers(a, b, c, session);
  session.say("dice:                " + rounded(c.dice));
  session.say("jaccard:             " + rounded(c.jaccard));
  session.say("hausdorff 95 %:      " + rounded(c.hausdorff95) + " (units of the voxel size)");
  session.add_to_page([&](Page& page) {
    page.facts = {{readable(c.dice, 4), "Dice"}, {readable(c.jaccard, 4), "Jaccard"}};
    show_agreement(a, b, page);
  });
  constexpr std::size_t most_lines = 6;  // of the summary; the report has every label
  if (c.labels.size() < 2) return;
  for (std::size_t i = 0; i < std::min(c.labels.size(), most_lines); ++i)
    session.say("label " + std::to_string(c.labels[i].label) + ":             dice " + rounded(c.labels[i].dice) +
                ", hausdorff 95 % " + rounded(c.labels[i].hausdorff95));
  if (c.labels.size() > most_lines)
    session.say("and " + counted(static_cast<Index>(c.labels.size() - most_lines), "more label"));
}

}  // namespace

void run(const CompareCommand& command, Session& session) {
  if (is_readable_volume(command.first) && is_readable_volume(command.second)) return compare_images(command, session);
  Mesh a = session.timed("read", [&] { return read_mesh_or_points(command.first); });
  Mesh b = session.timed("read", [&] { return read_mesh_or_points(command.second); });
  session.input = {{"a", described_difference(command.first, a)}, {"b", described_difference(command.second, b)}};
  if (a.triangles.cols() == 0) std::swap(a, b);
  if (a.triangles.cols() == 0)
    throw IoError(command.first + " and " + command.second + " are both points; one must be a mesh");
  if (b.triangles.cols() > 0)
    compare_meshes(a, b, session);
  else
    compare_points(a, points_of(b, session), session);
}

}  // namespace csrbf::app
