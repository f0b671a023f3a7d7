#include "chapter_5.hpp"

#include "csrbf/surface/baselines/method_fit.hpp"
#include "csrbf/surface/surface_method.hpp"
#include "models.hpp"
#include "signals.hpp"
#include "surfaces.hpp"

#include <random>

namespace csrbf::thesis {
namespace {

constexpr Index budget = 1000, blobs = 100;

// The share of samples that are kept falls from all at the lower end to `least` at the upper one.
PointCloud thinned(const PointCloud& cloud, double least) {
  const Box<3> box = bounding_box<3>(cloud.points);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  return part_of(cloud, [&](const Point<3>& p) {
    const double t = (p.y() - box.lo.y()) / (box.hi.y() - box.lo.y());
    return uniform(random) < std::pow(least, t);
  });
}

// Fig. 5.2: one support for dense and sparse samples alike.
void add_one_support(Figure& figure) {
  const std::optional<PointCloud> kitten = model("kitten");
  const PointCloud cloud = thinned(*kitten, 0.01);
  figure.renders.push_back({"Fig. 5.2: samples, dense below, sparse above", picture(cloud, {})});
  std::string words;
  bool whole = true;
  for (const char* method : {"morse", "medial-axis"}) {
    const MeshedSurface mesh = meshed(with_budget(cloud, method, budget), 160);
    figure.renders.push_back({std::string(method) + ": " + mesh.words(), picture(mesh.mesh, {})});
    words += (words.empty() ? "" : "; ") + std::string(method) + " " + mesh.words();
    if (method == std::string("morse")) whole = mesh.whole();
  }
  figure.claims.push_back(
      {"Fig. 5.2: one support fails on irregular samples", "yes (picture)", words, verdict(!whole)});
}

}  // namespace

Figure chapter_5() {
  Figure figure{.name = "chapter-5",
                .title = "Chapter 5: earlier methods; Figs. 5.2, 5.3",
                .text =
                    "The bunny (35,947 vertices with normals) by the two methods of the thesis (composite, "
                    "medial-axis) and the earlier ones, with a budget of 1000 centres (100 blobs, for they take long) "
                    "for those that keep to one: root "
                    "mean square Taubin distance (6.36) of the samples in diagonals, pieces of the surface as it comes "
                    "out (1 is right), seconds. For Fig. 5.2 the kitten with samples that get sparse upwards."};
  const std::optional<PointCloud> bunny = model("bunny");
  if (!bunny) return without_models(figure);
  Table table{.name = "methods", .columns = {"centers", "rms Taubin", "pieces", "seconds"}, .labels = {"composite"}};
  for (const SurfaceMethod& method : surface_methods()) table.labels.emplace_back(method.name);
  MeshedSurface levels;
  for (const std::string& name : table.labels) {
    MeasuredSurface surface;
    const double time = seconds([&] { surface = with_budget(*bunny, name, name == "blobby" ? blobs : budget); });
    MeshedSurface mesh = meshed(surface, 96);
    table.rows.push_back({surface.centers, surface.rms_taubin, static_cast<double>(mesh.topology.components), time});
    if (name == "multilevel") levels = std::move(mesh);
  }
  add_one_support(figure);
  figure.renders.push_back({"Fig. 5.3: multilevel: " + levels.words(), picture(levels.mesh, {})});
  figure.claims.push_back({"Fig. 5.3: levels of CSRBFs (Ohtake 2003) leave extra zero sets", "yes (picture)",
                           levels.words(), verdict(!levels.whole())});
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
