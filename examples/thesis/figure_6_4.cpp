#include "figure_6_4.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/ridges.hpp"
#include "models.hpp"

namespace csrbf::thesis {
namespace {

// A surface of an incomplete cloud: its picture, and a claim that it is whole.
void add_surface(Figure& figure, const PointCloud& cloud, const std::string& method, Index centers, const Look& look,
                 const std::string& what, const std::string& published) {
  const MeasuredSurface surface = with_budget(cloud, method, centers);
  const MeshedSurface mesh = meshed(surface);
  figure.renders.push_back({method + ", " + std::to_string(centers) + " centres", picture(mesh.mesh, look)});
  figure.claims.push_back({what + ", " + method + ", " + std::to_string(centers) + " centres", published,
                           mesh.words() + ", rms Taubin " + number(surface.rms_taubin, 2) + " of the diagonal",
                           verdict(mesh.whole())});
}

// Without what is in balls about some of the points.
PointCloud with_holes(const PointCloud& cloud, const std::vector<Index>& centers, double radius) {
  const double r = radius * bounding_box<3>(cloud.points).diagonal();
  return part_of(cloud, [&](const Point<3>& p) {
    return std::all_of(centers.begin(), centers.end(), [&](Index c) { return (p - cloud.points.col(c)).norm() > r; });
  });
}

std::vector<Index> spread(const PointCloud& cloud, int count) {
  std::vector<Index> ids;
  for (int i = 0; i < count; ++i) ids.push_back((2 * i + 1) * cloud.size() / (2 * count));
  return ids;
}

}  // namespace

PointCloud on_ridges(const PointCloud& cloud, int resolution, double least_turning) {
  const Reconstruction full = reconstruct(cloud, {.normals = Normals::file});
  const Mesh mesh = polygonize(*full.field, {.resolution = resolution});
  const Points<3> points = ridges(*full.field, mesh, {.least_turning = least_turning}).vertices;
  return {points, -full.field->evaluate(points, Derivatives::gradient).gradient.colwise().normalized(), {}};
}

Figure figure_6_4() {
  Figure figure{
      .name = "figure-6.4", .title = "Figs. 6.4, 6.19: the bunny from its ridge and valley lines only", .text = ""};
  const std::optional<PointCloud> bunny = model("bunny");
  if (!bunny) return without_models(figure);
  const PointCloud lines = on_ridges(*bunny, 110, 1);
  figure.text = std::to_string(lines.size()) +
                " points with normals on the ridges and valleys that curvature finds on the full bunny, and surfaces "
                "with fixed budgets: section 6.1 (composite) and section 6.2 (medial axis). The thesis shows holes in "
                "its Fig. 6.19.";
  figure.renders.push_back({"samples", picture(lines, {})});
  add_surface(figure, lines, "composite", 500, {}, "6.4", "closed");
  for (const Index centers : {500, 1000, 2000})
    add_surface(figure, lines, "medial-axis", centers, {}, "6.19", "with holes");
  return figure;
}

Figure figure_6_18() {
  Figure figure{.name = "figure-6.18",
                .title = "Figs. 6.18, 6.20: dragon and knot with large holes",
                .text =
                    "All samples within balls are taken away, of a radius of 6 % of the diagonal for the dragon (a "
                    "Chinese dragon, for that of the thesis is not there) and of 5 % for the knot. Surfaces by "
                    "section 6.2 as they come, no component left out."};
  const std::optional<PointCloud> dragon = model("dragon"), knot = model("knot");
  if (!dragon || !knot) return without_models(figure);
  const Look from_front{{20, 10}, UpAxis::y}, from_above{{20, 50}, UpAxis::z};
  const PointCloud holed_dragon = with_holes(*dragon, spread(*dragon, 5), 0.06),
                   holed_knot = with_holes(*knot, spread(*knot, 6), 0.05);
  figure.renders.push_back({"dragon: samples", picture(holed_dragon, from_front, 20000)});
  for (const Index centers : {500, 1000, 4000})
    add_surface(figure, holed_dragon, "medial-axis", centers, from_front, "6.18, dragon", "closed");
  figure.renders.push_back({"knot: samples", picture(holed_knot, from_above, 20000)});
  add_surface(figure, holed_knot, "medial-axis", 1000, from_above, "6.20, knot", "closed");
  return figure;
}

}  // namespace csrbf::thesis
