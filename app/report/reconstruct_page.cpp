#include "report/reconstruct_page.hpp"

#include "report/drawing.hpp"
#include "report/plots.hpp"
#include "report/surface_view.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/plane_section.hpp"
#include "csrbf/surface/check/surface_distances.hpp"

#include <cmath>

namespace csrbf::app {
namespace {

constexpr double as_percent = 100;

std::string percent_text(double fraction) {
  return readable(as_percent * fraction, 2) + " %";
}

double share_below(const Eigen::VectorXd& values, double share) {
  std::vector<double> finite;
  for (const double value : values)
    if (std::isfinite(value)) finite.push_back(std::abs(value));
  return finite.empty() ? 0 : percentile(finite, share);
}

void add_reconstruct_facts(const ReconstructionShown& shown, Page& page) {
  const ReconstructReport& r = shown.surface.report;
  const Topology t = topology(shown.mesh);
  page.facts = {{grouped(r.points_used), "points used"},
                {percent_text(r.p99_distance), "of the diagonal: 99th percentile of the distance of the points"},
                {grouped(t.triangles), "triangles"},
                {t.watertight() ? "closed" : "open", "surface (" + counted(t.components, "component") + ")"}};
}

void add_findings(const ReconstructionShown& shown, double diagonal, Page& page) {
  const ReconstructReport& r = shown.surface.report;
  page.findings.push_back("99 of 100 points lie within " + readable(r.p99_distance * diagonal, 3) +
                          " of the surface, in the unit of the file; that is " + percent_text(r.p99_distance) +
                          " of the diagonal of their box. The largest distance is " +
                          readable(r.max_distance * diagonal, 3) + ".");
  if (r.composite && r.composite->cross_validation_error > 0)
    page.findings.push_back("Held-out points were missed by " + percent_text(r.composite->cross_validation_error) +
                            " of the diagonal on average: expect this error between the points.");
  if (r.points_used < r.points)
    page.findings.push_back(counted(r.points - r.points_used, "point") +
                            " of the file left out: duplicates, or far from all others.");
  if (r.normals == NormalSource::estimated)
    page.findings.push_back(
        "The file has no normals. They were estimated, as was which side is the outside: check that the surface is not "
        "inside out, and does not bridge gaps that should be open.");
}

// Half the divergence of the normals, which are linear on each triangle: means over the triangles around a vertex, by
// their areas. The normals are those of the function, so that this is as fine as the mesh, and costs next to nothing.
Eigen::VectorXd mean_curvature(const Mesh& mesh) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.vertices.cols()), area = sum;
  for (const auto& t : mesh.triangles.colwise()) {
    const Point<3> a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]), c = mesh.vertices.col(t[2]);
    const Point<3> across = (b - a).cross(c - a);
    const double twice = across.norm();
    if (!(twice > 0)) continue;
    const Point<3> n = across / twice;
    const double divergence = mesh.normals.col(t[0]).dot(n.cross(c - b)) + mesh.normals.col(t[1]).dot(n.cross(a - c)) +
                              mesh.normals.col(t[2]).dot(n.cross(b - a));  // times `twice`
    for (const std::int32_t corner : t) {
      sum[corner] += divergence / 2;
      area[corner] += twice;
    }
  }
  return sum.cwiseQuotient(area);
}

// Curvature is shown in units of 1 / diagonal: 2 is that of a ball whose diameter is the diagonal.
SurfaceColors curvature_colors(const Mesh& mesh, double diagonal) {
  const Eigen::VectorXd mean = diagonal * mean_curvature(mesh);
  constexpr double shown = 0.95;  // percentile at the ends of the scale: sharp edges do not set it
  const double limit = share_below(mean, shown);
  return {"mean curvature", "Mean curvature × diagonal: blue concave, red convex", -limit, limit, true, mean};
}

SurfaceColors distance_colors(const Points<3>& points, const Eigen::VectorXd& distance, const Mesh& mesh) {
  constexpr double most = 0.99;  // percentile at the end of the scale: outliers do not set it
  return {"distance of the points",
          "Distance of the points, % of the diagonal (grey: no points)",
          0,
          share_below(distance, most),
          false,
          values_near(points, distance, mesh.vertices),
          distance};
}

Figure view(const ReconstructionShown& shown, const Points<3>& points, const Eigen::VectorXd& distance,
            double diagonal) {
  SurfaceView view;
  view.mesh = mesh_to_show(shown.mesh);
  view.points = points;
  view.colors.push_back(distance_colors(points, distance, view.mesh));
  view.colors.push_back(curvature_colors(view.mesh, diagonal));
  view.inside = inside_values(*shown.surface.field, view.mesh, "f, zero on the surface");
  view.caption = reduction_note(view.mesh, shown.mesh);
  if (view.points.cols() < shown.used.size())
    view.caption += "Of the points, " + counted(view.points.cols(), "point") + " can be shown.";
  return surface_figure(view);
}

Figure distance_histogram(const ReconstructReport& r, const Eigen::VectorXd& distance, Index points) {
  constexpr double most = 1.25;  // end of the axis, relative to the 99th percentile: outliers do not set it
  Histogram histogram{.values = {distance.begin(), distance.end()},
                      .hi = most * as_percent * r.p99_distance,
                      .label = "distance to the surface, % of the diagonal",
                      .counted = "points"};
  histogram.marks = {{as_percent * r.rms_distance, "root mean square"}, {as_percent * r.p99_distance, "99 %"}};
  std::string caption = "The last bar includes all points that are further away.";
  if (distance.size() < points) caption += " Shows " + counted(distance.size(), "point") + ", evenly chosen.";
  return {"Distance of the points to the surface", draw(histogram), caption};
}

// Where the mesh meets the plane across an axis, in the other two coordinates: pairs of ends.
Points<2> mesh_section(const Mesh& mesh, int across, double place, const std::array<int, 2>& axes) {
  std::vector<double> ends;
  for (const auto& t : mesh.triangles.colwise())
    for (int k = 0; k < 3; ++k) {
      const auto p = mesh.vertices.col(t[k]), q = mesh.vertices.col(t[(k + 1) % 3]);
      const double from = p[across] - place, to = q[across] - place;
      if ((from >= 0) == (to >= 0)) continue;
      const double part = from / (from - to);
      for (const int axis : axes) ends.push_back(p[axis] + part * (q[axis] - p[axis]));
    }
  return Eigen::Map<const Points<2>>(ends.data(), 2, std::ssize(ends) / 2);
}

// The function on the plane through the centre of the box, normal to an axis.
PlaneMap reconstruct_section(const ReconstructionShown& shown, const Box<3>& box, int across) {
  const std::array<int, 2> axes{across == 0 ? 1 : 0, across == 2 ? 1 : 2};
  Box<2> plane;
  PlaneSection<3>::Across columns = PlaneSection<3>::Across::Zero();
  Point<3> origin = Point<3>::Zero();
  origin[across] = box.center()[across];
  for (int k = 0; k < 2; ++k) {
    plane.lo[k] = box.lo[axes[k]];
    plane.hi[k] = box.hi[axes[k]];
    columns(axes[k], k) = 1;
  }
  const PlaneSection<3> field(*shown.surface.field, origin, columns, plane);
  constexpr Index longest = 125;  // nodes along the longer side, one for two pixels
  const double cell = plane.extent().maxCoeff() / longest;
  GridAxes<2> grid;
  for (int k = 0; k < 2; ++k)
    grid[k] =
        Eigen::VectorXd::LinSpaced(std::max<Index>(2, std::lround(plane.extent()[k] / cell)), plane.lo[k], plane.hi[k]);
  const Eigen::VectorXd values = field.evaluate_grid(grid);
  PlaneMap map{.values = Eigen::Map<const Eigen::MatrixXd>(values.data(), grid[0].size(), grid[1].size()).transpose(),
               .box = plane,
               .x_label = std::string(1, "xyz"[axes[0]]),
               .y_label = std::string(1, "xyz"[axes[1]]),
               .width = 250,
               .description = "The function on the plane across " + std::string(1, "xyz"[across])};
  map.segments = mesh_section(shown.mesh, across, origin[across], axes);
  std::vector<Index> near;
  const double thickness = 0.004 * box.diagonal();  // of points shown as dots, to either side; about a pixel
  for (Index i = 0; i < shown.used.size(); ++i)
    if (std::abs(shown.used.points(across, i) - origin[across]) < thickness) near.push_back(i);
  constexpr Index most = 800;  // dots, beyond which they merge
  map.dots = shown.used.points(axes, spread(near, most));
  return map;
}

Figure sections(const ReconstructionShown& shown, const Box<3>& box) {
  constexpr double margin = 0.04;  // of the diagonal
  std::vector<PlaneMap> maps;
  for (const int across : {2, 1, 0})
    maps.push_back(reconstruct_section(shown, box.inflated(margin * box.diagonal()), across));
  double limit = 0;
  constexpr double most = 0.98;  // percentile at the ends of the scale
  for (const PlaneMap& map : maps) limit = std::max(limit, share_below(map.values.reshaped(), most));
  limit = round_axis(0, limit, "", 1).hi;
  std::vector<std::string> drawings;
  for (PlaneMap& map : maps) {
    map.scale = {-limit, limit, true};
    drawings.push_back(draw(map));
  }
  return {"The function on three planes through the middle", side_by_side(drawings),
          "Positive inside (red), negative outside (blue), zero on the surface (black line). Dots are the points near "
          "the plane.",
          true};
}

}  // namespace

void show(const ReconstructionShown& shown, Page& page) {
  const Box<3> box = bounding_box<3>(shown.used.points);
  const double diagonal = box.diagonal();
  const Points<3> points = shown.used.points(Eigen::all, spread_indices(shown.used.size(), SurfaceView::most_points));
  const std::vector<double> fractions = surface_distances(*shown.surface.field, points, diagonal);
  const Eigen::VectorXd distance =
      as_percent * Eigen::Map<const Eigen::VectorXd>(fractions.data(), std::ssize(fractions));
  add_reconstruct_facts(shown, page);
  add_findings(shown, diagonal, page);
  if (shown.mesh.triangles.cols() > 0) page.figures.push_back(view(shown, points, distance, diagonal));
  page.figures.push_back(distance_histogram(shown.surface.report, distance, shown.used.size()));
  page.figures.push_back(sections(shown, box));
}

}  // namespace csrbf::app
