#include "csrbf/surface/prepare/decimate.hpp"

namespace csrbf {
namespace {

constexpr Index decimation = 4;      // most samples merged into one: the spacing doubles on a surface
constexpr double run_reach = 4;      // spacings between samples that may merge; this and the next chosen by hand
constexpr double run_normals = 0.3;  // least cosine between their normals

// Ends of runs of at most `decimation` samples in Morton order that lie together on one sheet.
std::vector<Index> runs(const OrientedPoints& cloud) {
  std::vector<Index> ends;
  Index first = 0;
  for (Index i = 0; i < cloud.size(); ++i) {
    const double reach = run_reach * cloud.spacing[first];
    const bool joins = i - first < decimation && cloud.normals.col(i).dot(cloud.normals.col(first)) > run_normals &&
                       (cloud.points.col(i) - cloud.points.col(first)).squaredNorm() < reach * reach;
    if (i > first && !joins) {
      ends.push_back(i);
      first = i;
    }
  }
  if (cloud.size() > 0) ends.push_back(cloud.size());
  return ends;
}

}  // namespace

OrientedPoints decimate(const OrientedPoints& cloud) {
  const std::vector<Index> ends = runs(cloud);
  const auto count = static_cast<Index>(ends.size());
  OrientedPoints coarse{Points<3>(3, count), Points<3>(3, count), Eigen::VectorXd(count)};
  for (Index g = 0; g < count; ++g) {
    const Index begin = g > 0 ? ends[g - 1] : 0, n = ends[g] - begin;
    const auto points = cloud.points.middleCols(begin, n);
    const Point<3> mean = points.rowwise().mean(), normal = cloud.normals.middleCols(begin, n).rowwise().sum();
    Index nearest = 0;
    (points.colwise() - mean).colwise().squaredNorm().minCoeff(&nearest);
    coarse.points.col(g) = points.col(nearest);
    coarse.normals.col(g) = normal.normalized();
    coarse.spacing[g] = cloud.spacing.segment(begin, n).norm();
  }
  return coarse;
}

}  // namespace csrbf
