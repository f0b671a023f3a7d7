#include "figure_6_10.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/voronoi_poles.hpp"
#include "models.hpp"

#include <algorithm>

namespace csrbf::thesis {
namespace {

constexpr double yellow = 0.15;  // of the diagonal

RgbImage sizes_picture(const Mesh& mesh, const Points<3>& centers, const Eigen::VectorXd& size, const Look& look) {
  const KdTree<3> tree(centers);
  Eigen::VectorXd at_vertices(mesh.vertices.cols());
  for (Index i = 0; i < at_vertices.size(); ++i) {
    Index nearest = 0;
    double squared = 0;
    tree.nearest(mesh.vertices.col(i), 1, &nearest, &squared);
    at_vertices[i] = size[nearest];
  }
  return colored(mesh, at_vertices, yellow, look);
}

Mesh full_mesh(const PointCloud& cloud) {
  return meshed(with_budget(cloud, "medial-axis", 5000), 160).mesh;
}

}  // namespace

SupportSizes support_sizes(const PointCloud& cloud, Index centers) {
  const double diagonal = bounding_box<3>(cloud.points).diagonal();
  SupportSizes sizes{cloud.points(Eigen::all, farthest_points<3>(cloud.points, centers).indices), {}, {}};
  const VoronoiPoles<3> poles = voronoi_poles<3>(sizes.centers);
  sizes.own = (poles.negative - sizes.centers).colwise().norm() / diagonal;
  sizes.nearest = medial_axis_distances<3>(sizes.centers, poles) / diagonal;
  return sizes;
}

Figure figure_6_10() {
  Figure figure{.name = "figure-6.10",
                .title = "Figs. 6.10-6.13: supports that end at the medial axis",
                .text =
                    "Distance of centres to their own negative pole (6.21) and to the nearest of all negative poles "
                    "(6.22), in diagonals; pictures from 0 (blue) to .15 (yellow). For the Venus, the squirrel and "
                    "the vessels of the thesis there are the kitten and a generated tree."};
  const std::optional<PointCloud> bunny = model("bunny"), kitten = model("kitten"), knot = model("knot"),
                                  dragon = model("dragon");
  if (!bunny || !kitten || !knot || !dragon) return without_models(figure);
  Table table{.name = "bunny",
              .columns = {"centers", "largest (6.21)", "largest (6.22)", "median (6.21)", "median (6.22)"}};
  const Mesh mesh = full_mesh(*bunny);
  bool smaller = true;
  for (const Index centers : {250, 500, 1000, 2000, 5000}) {
    const SupportSizes s = support_sizes(*bunny, centers);
    std::vector<double> own(s.own.begin(), s.own.end()), nearest(s.nearest.begin(), s.nearest.end());
    std::erase_if(own, [](double size) { return !std::isfinite(size); });
    const double largest_own = *std::max_element(own.begin(), own.end()), largest = s.nearest.maxCoeff();
    table.rows.push_back({static_cast<double>(centers), largest_own, largest, median(own), median(nearest)});
    smaller = smaller && (s.own.array().isNaN() || s.nearest.array() <= 1.000001 * s.own.array()).all();
    if (centers != 250 && centers != 1000) continue;
    const std::string count = std::to_string(centers) + " centres";
    figure.renders.push_back({"bunny, (6.21), " + count, sizes_picture(mesh, s.centers, s.own, {})});
    figure.renders.push_back({"bunny, (6.22), " + count, sizes_picture(mesh, s.centers, s.nearest, {})});
  }
  const auto add = [&](const std::string& name, const PointCloud& cloud, Index centers, const Look& look) {
    const SupportSizes s = support_sizes(cloud, centers);
    figure.renders.push_back({name + ", (6.22), " + std::to_string(centers) + " centres",
                              sizes_picture(full_mesh(cloud), s.centers, s.nearest, look)});
  };
  add("vessels", vessel_tree(30000), 2000, {{-60, 10}, UpAxis::z});
  add("knot", *knot, 1000, {{20, 50}, UpAxis::z});
  add("kitten", *kitten, 1000, {});
  add("dragon", *dragon, 5000, {{20, 10}, UpAxis::y});
  const auto& few = table.rows.front();
  figure.claims = {{"(6.21) explodes locally with few centres", "yes",
                    "largest with 250 centres " + number(few[1], 2) + " of the diagonal, median " + number(few[3], 2),
                    verdict(few[1] > 3 * few[3])},
                   {"(6.22) does not", "yes", "largest " + number(few[2], 2) + ", median " + number(few[4], 2),
                    verdict(few[2] < few[1])},
                   {"(6.22) is at most (6.21) at every centre", "-", smaller ? "yes" : "no", verdict(smaller)}};
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
