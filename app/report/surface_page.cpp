#include "report/surface_page.hpp"

#include "report/plots.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/mesh/triangle_tree.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <cmath>

namespace csrbf::app {
namespace {

constexpr double percent = 100;

double size_below(const Eigen::VectorXd& values, double share) {
  std::vector<double> finite;
  for (const double value : values)
    if (std::isfinite(value)) finite.push_back(std::abs(value));
  return finite.empty() ? 1 : percentile(finite, share);
}

void add_surface_facts(const Mesh& mesh, Page& page) {
  const Topology t = topology(mesh);
  page.facts = {{grouped(t.vertices), "vertices"},
                {grouped(t.triangles), "triangles"},
                {t.watertight() ? "closed" : "open", "surface (" + counted(t.components, "component") + ")"}};
}

SurfaceView view_of(const Mesh& mesh) {
  SurfaceView view;
  view.mesh = mesh_to_show(mesh);
  view.caption = reduction_note(view.mesh, mesh);
  return view;
}

// Symmetric about 0; sharp edges do not set the ends.
SurfaceColors diverging(const std::string& name, const std::string& title, const Eigen::VectorXd& values) {
  constexpr double shown = 0.95;
  const double limit = size_below(values, shown);
  return {name, title, -limit, limit, true, values};
}

Histogram histogram_of(const Eigen::VectorXd& values, const std::string& label, const std::string& counted) {
  constexpr double most = 0.99, more = 1.25;  // the axis ends at 1.25 times the 99th percentile
  return {.values = {values.begin(), values.end()},
          .hi = more * size_below(values, most),
          .label = label,
          .counted = counted};
}

Eigen::VectorXd distances_to(const TriangleTree& tree, const PointsRef<3>& points) {
  Eigen::VectorXd distance(points.cols());
  constexpr Index grain = 256;  // points per task: larger balances worse, smaller costs overhead
  parallel_for(points.cols(), grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) distance[i] = tree.closest(points.col(i)).distance;
  });
  return distance;
}

void add_distances(SurfaceView view, const Eigen::VectorXd& on_mesh, const Eigen::VectorXd& of_points,
                   const std::string& counted, Page& page) {
  constexpr double most = 0.99;  // percentile at the end of the scale: outliers do not set it
  const double limit = size_below(of_points.size() > 0 ? of_points : on_mesh, most);
  view.title = "Distances";
  view.shown = "0";
  view.colors.push_back({"distance", "Distance, % of the diagonal (grey: no points)", 0, limit, false, on_mesh,
                         view.points.cols() > 0 ? of_points : Eigen::VectorXd()});
  page.figures.push_back(surface_figure(view));
  const std::string label = "distance, % of the diagonal";
  page.figures.push_back({"How far they are apart",
                          draw(histogram_of(of_points.size() > 0 ? of_points : on_mesh, label, counted)),
                          "The last bar includes all that are further away."});
}

}  // namespace

void show(const Field<3>& field, const Mesh& mesh, Page& page) {
  add_surface_facts(mesh, page);
  if (mesh.triangles.cols() == 0) return;
  SurfaceView view = view_of(mesh);
  view.inside = inside_values(field, view.mesh, "f, zero on the surface");
  page.figures.push_back(surface_figure(view));
}

void show(const Field<3>& field, const Mesh& mesh, const Curvatures& at, const Polylines& lines, Page& page) {
  add_surface_facts(mesh, page);
  if (mesh.triangles.cols() == 0) return;
  SurfaceView view = view_of(mesh);
  const bool is_whole = view.mesh.vertices.cols() == mesh.vertices.cols();
  const Curvatures& shown = is_whole ? at : curvature(field, view.mesh.vertices);
  view.lines = lines;
  view.shown = "0";
  view.colors = {diverging("mean curvature", "Mean curvature: blue concave, red convex", shown.mean()),
                 diverging("Gaussian curvature", "Gaussian curvature: blue saddles, red caps", shown.gaussian()),
                 diverging("largest curvature", "Largest principal curvature k1", shown.k1),
                 diverging("smallest curvature", "Smallest principal curvature k2", shown.k2)};
  view.caption += lines.edges.cols() > 0 ? "Lines: ridges and valleys." : "";
  page.figures.push_back(surface_figure(view));
  const SurfaceColors& mean = view.colors.front();
  Histogram histogram{.values = {mean.values.begin(), mean.values.end()},
                      .lo = mean.lo,
                      .hi = mean.hi,
                      .label = "mean curvature, 1 over the unit of length",
                      .counted = "vertices"};
  page.figures.push_back({"Curvatures", draw(histogram), "The outermost bars include all vertices beyond them."});
}

void show_distances(const Mesh& mesh, const Mesh& reference, Page& page) {
  SurfaceView view = view_of(mesh);
  const double diagonal = bounding_box<3>(reference.vertices).diagonal();
  const Eigen::VectorXd distance = percent / diagonal * distances_to(TriangleTree(reference), view.mesh.vertices);
  view.caption = "The first mesh, coloured by its distance from the second one. " + view.caption;
  add_distances(std::move(view), distance, {}, "vertices", page);
}

void show_distances(const Mesh& mesh, const PointCloud& reference, Page& page) {
  SurfaceView view = view_of(mesh);
  const double diagonal = bounding_box<3>(reference.points).diagonal();
  view.points = reference.points(Eigen::all, spread_indices(reference.size(), SurfaceView::most_points));
  const Eigen::VectorXd distance = percent / diagonal * distances_to(TriangleTree(mesh), view.points);
  const Eigen::VectorXd on_mesh = values_near(view.points, distance, view.mesh.vertices);
  view.caption = "The mesh, coloured by the distances of the points near it. " + view.caption;
  add_distances(std::move(view), on_mesh, distance, "points", page);
}

}  // namespace csrbf::app
