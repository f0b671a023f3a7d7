#include "csrbf/surface/estimate_normals.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/orient_normals.hpp"

#include <Eigen/Eigenvalues>

#include <vector>

namespace csrbf {
namespace {

constexpr Index default_neighbors = 12;
constexpr double line = 1e-10;  // second against largest spread of points on a line, squared lengths

// Direction of least spread of the given points; zero when they lie on a line.
Point<3> least_spread(const Points<3>& points, const Index* ids, Index n) {
  Point<3> mean = Point<3>::Zero();
  for (Index i = 0; i < n; ++i) mean += points.col(ids[i]);
  mean /= static_cast<double>(n);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < n; ++i) {
    const Point<3> d = points.col(ids[i]) - mean;
    covariance += d * d.transpose();
  }
  const double scale = covariance.trace();
  if (!(scale > 0)) return Point<3>::Zero();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance / scale);
  return solver.eigenvalues()[1] > line * solver.eigenvalues()[2] ? Point<3>(solver.eigenvectors().col(0))
                                                                  : Point<3>::Zero();
}

// Normals of points in Morton order, with arbitrary signs.
Points<3> directions(const Points<3>& points, Index neighbors, const Progress& progress) {
  constexpr Index batch = 1 << 16;
  const KdTree<3> tree(points);
  Points<3> normals(3, points.cols());
  for (Index done = 0; done < points.cols(); done += batch) {
    report(progress, "estimate normals", static_cast<double>(done) / static_cast<double>(points.cols()));
    parallel_for(std::min(batch, points.cols() - done), 1024, [&](Index begin, Index end) {
      std::vector<Index> ids;
      std::vector<double> distance;
      for (Index i = done + begin; i < done + end; ++i) {
        normals.col(i).setZero();
        for (Index k = neighbors + 1;; k *= 2) {
          ids.resize(static_cast<std::size_t>(std::min(k, points.cols())));
          distance.resize(ids.size());
          const Index found = tree.nearest(points.col(i), static_cast<Index>(ids.size()), ids.data(), distance.data());
          normals.col(i) = least_spread(points, ids.data(), found);
          if (normals.col(i).squaredNorm() > 0 || found == points.cols()) break;
        }
      }
    });
  }
  return normals;
}

}  // namespace

Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options) {
  constexpr const char* name = "estimate_normals";
  require(points.cols() >= 3, name, "points", points.cols(), "at least 3 points are needed");
  require(points.allFinite(), name, "points", "(not finite)", "drop points with NaN or infinite coordinates first");
  require(options.neighbors == 0 || options.neighbors >= 3, name, "neighbors", options.neighbors,
          "must be at least 3, or 0 for the default");
  require(options.viewpoint.allFinite(), name, "viewpoint", options.viewpoint.transpose(), "must be finite");

  const std::vector<Index> order = morton_order<3>(points);
  const Box<3> box = bounding_box<3>(points);
  const double scale = box.extent().maxCoeff();
  Points<3> sorted = points(Eigen::all, order);
  if (scale > 0) sorted = ((sorted.colwise() - box.lo) / scale).eval();
  Points<3> normals =
      directions(sorted, options.neighbors > 0 ? options.neighbors : default_neighbors, options.progress);
  require(normals.squaredNorm() > 0, name, "points", points.cols(),
          "points all lie on one line; normals need a surface");

  if (options.orient == Orient::consistent) {
    OrientOptions orient;
    orient.progress = options.progress;
    orient_normals(sorted, normals, orient);
  } else if (options.orient == Orient::viewpoint) {
    for (Index i = 0; i < normals.cols(); ++i)
      if (normals.col(i).dot(options.viewpoint - points.col(order[static_cast<std::size_t>(i)])) < 0)
        normals.col(i) *= -1;
  }
  Points<3> result(3, points.cols());
  for (std::size_t i = 0; i < order.size(); ++i) result.col(order[i]) = normals.col(static_cast<Index>(i));
  report(options.progress, "estimate normals", 1);
  return result;
}

}  // namespace csrbf
