#include "csrbf/surface/normals/height_field.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"
#include "csrbf/surface/normals/winding_sides.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index fewest_points = 50;      // fewer are all near each other
constexpr double steep = 0.2;            // cosine between an axis and the direction
constexpr double few_steep = 0.01;       // share of the points
constexpr Index asked_points = 2000;     // whether they hide others
constexpr Index near = 13;               // points in space, that itself among them
constexpr double few_hidden = 0.03;      // share of the points; of two layers about half, of noisy sheets up to 0.06
constexpr Index judged_points = 50'000;  // that show the side
constexpr double bowl = 0.15;            // mean winding number from which on a sheet has an inside
constexpr double tilted = 0.1;           // share of the area by which a sheet faces along an axis

// The eigenvector of the largest eigenvalue of the axes' second moments; zero if too many are far from it.
Point<3> main_direction(const Points<3>& normals) {
  Point<3> direction = symmetric_eigen(Eigen::Matrix3d(normals * normals.transpose())).vectors.col(2);
  const auto far = ((direction.transpose() * normals).array().abs() < steep).count();
  if (static_cast<double>(far) > few_steep * static_cast<double>(normals.cols())) return Point<3>::Zero();
  return direction;
}

// Whether hardly any of some points is nearest in projection to one that is not near in space.
bool hides_nothing(const Points<3>& points, const KdTree<3>& tree, const Point<3>& direction) {
  const Eigen::Matrix<double, 2, 3> plane =
      symmetric_eigen(Eigen::Matrix3d(direction * direction.transpose())).vectors.leftCols<2>().transpose();
  const Points<2> projected = plane * points;
  const KdTree<2> shadow(projected);
  const Index n = points.cols(), count = std::min(asked_points, n);
  std::atomic<Index> hidden = 0;
  parallel_for(count, 128, [&](Index begin, Index end) {
    std::array<Index, near> ids;
    std::array<double, near> squared;
    for (Index s = begin; s < end; ++s) {
      const Index i = (2 * s + 1) * n / (2 * count);
      shadow.nearest(projected.col(i), 2, ids.data(), squared.data());
      const Index beside = ids[0] == i ? ids[1] : ids[0];
      const Index found = tree.nearest(points.col(i), near, ids.data(), squared.data());
      hidden += std::find(ids.begin(), ids.begin() + found, beside) == ids.begin() + found ? 1 : 0;
    }
  });
  return static_cast<double>(hidden) <= few_hidden * static_cast<double>(count);
}

// 1 or -1: the side of a sheet with these normals, by some of the points.
int side(const Points<3>& points, const Points<3>& normals) {
  const auto chosen = Eigen::seq(0, points.cols() - 1, (points.cols() - 1) / judged_points + 1);
  const Points<3> some = points(Eigen::all, chosen), facing = normals(Eigen::all, chosen);
  const NeighborTable table = make_neighbor_table(some, KdTree<3>(some), near - 1);
  Eigen::VectorXd spacing(table.size());
  for (Index i = 0; i < spacing.size(); ++i) spacing[i] = std::sqrt(table.area(i));
  if (const double mean = winding_sides(some, facing, spacing).mean; std::abs(mean) > bowl) return mean < 0 ? -1 : 1;
  const Point<3> sum = facing * spacing.cwiseAbs2();
  for (const Index axis : {2, 1, 0})
    if (std::abs(sum[axis]) > tilted * spacing.squaredNorm()) return sum[axis] < 0 ? -1 : 1;
  return 1;
}

}  // namespace

bool orient_height_field(const Points<3>& points, const KdTree<3>& tree, Points<3>& normals) {
  if (points.cols() < fewest_points) return false;
  const Point<3> direction = main_direction(normals);
  if (direction.isZero() || !hides_nothing(points, tree, direction)) return false;
  const auto turn_towards = [&](const Point<3>& there) {
    for (Index i = 0; i < normals.cols(); ++i)
      if (normals.col(i).dot(there) < 0) normals.col(i) = -normals.col(i).eval();
  };
  turn_towards(direction);
  if (side(points, normals) < 0) turn_towards(-direction);
  return true;
}

}  // namespace csrbf
