#include "inputs/point_selection.hpp"

#include <cmath>

namespace csrbf::app {

PointSelection make_selection(const PointFlags& flags) {
  PointSelection selection;
  selection.returns = flags.returns;
  if (flags.classes.empty()) return selection;
  constexpr double most = 255;
  for (const double number : parse_list(flags.classes, ',', "--class")) {
    if (!(number >= 0 && number <= most && number == std::floor(number)))
      throw UsageError("--class " + flags.classes + ": classes are whole numbers from 0 to 255");
    selection.classes.push_back(static_cast<int>(number));
  }
  return selection;
}

namespace {

// x is 0, 1, 2, ... or 1, 2, 3, ..., and there is another column that z may be in.
bool x_counts_rows(const PointCloud& cloud) {
  constexpr Index enough = 10;  // points
  if (cloud.size() < enough || cloud.properties.empty()) return false;
  const double first = cloud.points(0, 0);
  if (first != 0 && first != 1) return false;
  for (Index i = 0; i < cloud.size(); ++i)
    if (cloud.points(0, i) != first + static_cast<double>(i)) return false;
  return true;
}

}  // namespace

PointCloud vertices_of(Mesh&& mesh, Session& session) {
  PointCloud cloud{std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.properties)};
  if (x_counts_rows(cloud))
    session.warn("x numbers the points from " + rounded(cloud.points(0, 0)) +
                 " on: remove the first column, or name the columns in the first line");
  return cloud;
}

}  // namespace csrbf::app
