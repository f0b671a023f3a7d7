#include "figure_3_1.hpp"

#include "csrbf/approx/levels/level_sum.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"
#include "signals.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <limits>

namespace csrbf::thesis {
namespace {

constexpr Index cluster_samples = 64;
constexpr std::size_t shown = 5;  // levels
constexpr double rounding = 1e-12;

struct Cluster {
  std::vector<Index> ids;
  Point<2> centroid, normal;  // normal: the principal axis
};

Cluster cluster(const Points<2>& points, std::vector<Index> ids) {
  Cluster made{std::move(ids), Point<2>::Zero(), Point<2>::Zero()};
  const Points<2> of = points(Eigen::all, made.ids);
  made.centroid = of.rowwise().mean();
  const Points<2> around = of.colwise() - made.centroid;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(around * around.transpose());
  made.normal = axes.eigenvectors().col(1);
  return made;
}

// (3.1): every cluster of more than one sample is cut by the line through its centroid across its principal axis.
std::vector<Cluster> halved(const Points<2>& points, const std::vector<Cluster>& clusters) {
  std::vector<Cluster> parts;
  for (const Cluster& whole : clusters) {
    if (whole.ids.size() == 1) {
      parts.push_back(whole);
      continue;
    }
    std::vector<Index> lower, upper;
    for (const Index i : whole.ids) (whole.normal.dot(points.col(i) - whole.centroid) < 0 ? lower : upper).push_back(i);
    for (auto* part : {&lower, &upper}) parts.push_back(cluster(points, std::move(*part)));
  }
  return parts;
}

// The largest distance of a centre of the library to the nearest centroid.
double mismatch(const Points<2>& centers, const std::vector<Cluster>& clusters) {
  double largest = 0;
  for (const auto& c : centers.colwise()) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Cluster& k : clusters) nearest = std::min(nearest, (k.centroid - c).norm());
    largest = std::max(largest, nearest);
  }
  return largest;
}

}  // namespace

Figure figure_3_1() {
  Figure figure{.name = "figure-3.1",
                .title = "Figs. 3.1, 3.2: clusters by principal components",
                .text =
                    "64 random samples of the plane, halved again and again by the line through the centroid across "
                    "the principal axis; circles: the supports that pca_multiresolution gives the centroids, three "
                    "fill distances at first and smaller by 1 / sqrt(2) from level to level (printed: 1 / 2)."};
  Points<2> points = random_points<2>(cluster_samples, 11);
  points.row(1) = 0.35 * points.row(1) + 0.3 * points.row(0);
  const Eigen::VectorXd values = random_points<1>(cluster_samples, 12).row(0);
  const LevelFit<2> fit =
      pca_multiresolution<2>({points, values, {}}, {.tolerance = 1e-9, .cluster_size = cluster_samples});
  const auto& levels = fit.fields[0]->levels();
  std::vector<Index> all(cluster_samples);
  for (Index i = 0; i < cluster_samples; ++i) all[i] = i;
  std::vector<Cluster> clusters{cluster(points, all)};
  double largest = 0;
  std::size_t depth = 0;
  for (; depth < 2 * shown; ++depth) {
    if (depth < std::min(shown, levels.size()))
      largest = std::max(largest, mismatch(levels[depth]->basis().centers(), clusters));
    if (depth < shown) {
      Table table{.name = "level " + std::to_string(depth), .columns = {"x", "y", "cluster", "cx", "cy", "support"}};
      for (std::size_t k = 0; k < clusters.size(); ++k)
        for (const Index i : clusters[k].ids)
          table.rows.push_back({points(0, i), points(1, i), static_cast<double>(k), clusters[k].centroid.x(),
                                clusters[k].centroid.y(), levels[depth]->basis().support(0)});
      figure.tables.push_back(std::move(table));
    }
    if (clusters.size() == cluster_samples) break;
    clusters = halved(points, clusters);
  }
  figure.claims = {
      {"until each cluster contains only one sample", "yes",
       std::to_string(clusters.size()) + " clusters of 64 samples after " + std::to_string(depth) + " cuts",
       verdict(clusters.size() == cluster_samples)},
      {"the centres of a level are the centroids of its clusters", "yes",
       "those of pca_multiresolution are at most " + number(largest, 2) + " from the centroids drawn here",
       verdict(largest < rounding)}};
  return figure;
}

}  // namespace csrbf::thesis
