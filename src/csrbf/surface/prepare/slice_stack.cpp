#include "csrbf/surface/prepare/slice_stack.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index along_row = 6;           // points that show the direction of a row
constexpr Index rows_asked = 1000;       // of all points
constexpr double in_plane = 1e-3;        // share of the squared directions across the planes
constexpr double thin_slice = 0.1;       // largest part of the usual distance of slices that a slice may be thick
constexpr Index fewest_slices = 3;       // that make a stack
constexpr Index most_of_points = 8;      // a slice has at least so many points in the mean
constexpr double within_slice = 0.3;     // mean component of normals out of the plane of a wall that goes on
constexpr double grid_step = 0.5;        // of samples on flat ends, over the distance of slices
constexpr double most_terms = 2e8;       // of winding numbers
constexpr double closed_contours = 0.3;  // length of the mean normal of closed contours

// Points by height above the lowest one, and where slices begin among them; the last entry is the number of points.
struct Stack {
  std::vector<Index> order;
  std::vector<std::size_t> begin;
  double apart = 0;  // median distance of slices
};

std::optional<Stack> find_stack(const Points<3>& points, const Point<3>& normal) {
  const Eigen::VectorXd height = points.transpose() * normal;
  Stack stack;
  stack.order.resize(points.cols());
  std::iota(stack.order.begin(), stack.order.end(), Index{0});
  std::sort(stack.order.begin(), stack.order.end(), [&](Index a, Index b) { return height[a] < height[b]; });
  const auto at = [&](std::size_t k) { return height[stack.order[k]]; };
  const std::size_t most = stack.order.size() / most_of_points;
  const std::size_t n = stack.order.size();
  std::vector<double> gaps;
  for (std::size_t k = 1; k < n; ++k) gaps.push_back(at(k) - at(k - 1));
  // Most gaps are within slices; those between them are the largest ones.
  const double largest = *std::max_element(gaps.begin(), gaps.end());
  std::vector<double> between;
  stack.begin.push_back(0);
  for (std::size_t k = 1; k < n; ++k)
    if (gaps[k - 1] > thin_slice * largest) {
      stack.begin.push_back(k);
      between.push_back(gaps[k - 1]);
    }
  stack.begin.push_back(n);
  const std::size_t slices = stack.begin.size() - 1;
  if (std::cmp_less(slices, fewest_slices) || slices > most) return std::nullopt;
  stack.apart = median(std::move(between));
  for (std::size_t s = 0; s < slices; ++s)
    if (at(stack.begin[s + 1] - 1) - at(stack.begin[s]) > thin_slice * stack.apart) return std::nullopt;
  return stack;
}

// Whether a solid goes on beyond the slice with these points.
bool goes_on(const OrientedPoints& cloud, const std::vector<Index>& ids, const Point<3>& normal, double apart) {
  const Points<3> normals = cloud.normals(Eigen::all, ids);
  const double out_of_plane = (normal.transpose() * normals).cwiseAbs().mean();
  const Box<3> box = bounding_box<3>(Points<3>(cloud.points(Eigen::all, ids)));
  return out_of_plane < within_slice && normals.rowwise().mean().norm() < closed_contours && box.diagonal() > 2 * apart;
}

// Places of a grid within the contours of a slice; by the winding number in the plane.
std::vector<Point<3>> places_inside(const OrientedPoints& cloud, const std::vector<Index>& ids, const Point<3>& normal,
                                    double apart) {
  const Point<3> u = normal.unitOrthogonal(), v = normal.cross(u);
  Points<2> x(2, std::ssize(ids)), outward(2, std::ssize(ids));
  double height = 0;
  for (Index k = 0; k < x.cols(); ++k) {
    const auto p = cloud.points.col(ids[k]);
    const auto n = cloud.normals.col(ids[k]);
    x.col(k) << u.dot(p), v.dot(p);
    outward.col(k) << u.dot(n), v.dot(n);
    height += normal.dot(p) / static_cast<double>(x.cols());
  }
  const Box<2> box = bounding_box<2>(x);
  const double step = grid_step * apart;
  const Point<2> cells = box.extent() / step;
  std::vector<Point<3>> result;
  if (cells.prod() * static_cast<double>(x.cols()) > most_terms) return result;
  const KdTree<2> tree(x);
  for (Index k = 0; k < x.cols(); ++k) {
    Index near[3];
    double squared[3];
    const Index found = tree.nearest(x.col(k), 3, near, squared);
    outward.col(k).normalize();
    outward.col(k) *= found < 3 ? 0 : (std::sqrt(squared[1]) + std::sqrt(squared[2])) / 2;
  }
  for (double a = box.lo[0]; a < box.hi[0]; a += step)
    for (double b = box.lo[1]; b < box.hi[1]; b += step) {
      const Points<2> to = x.colwise() - Point<2>(a, b);
      const double winding =
          (to.cwiseProduct(outward).colwise().sum().array() / to.colwise().squaredNorm().array()).sum();
      if (winding > std::numbers::pi) result.push_back(a * u + b * v + height * normal);
    }
  return result;
}

}  // namespace

std::optional<Point<3>> normal_of_slices(const Points<3>& points, const KdTree<3>& tree) {
  const Index step = (points.cols() + rows_asked - 1) / rows_asked;
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < points.cols(); i += step) {
    Index ids[along_row];
    double squared[along_row];
    const Index found = tree.nearest(points.col(i), along_row, ids, squared);
    Points<3> around = points(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
    around.colwise() -= around.rowwise().mean().eval();
    const Eigen::Vector3d along = symmetric_eigen(Eigen::Matrix3d(around * around.transpose())).vectors.col(2);
    directions += along * along.transpose();
  }
  const auto eigen = symmetric_eigen(directions);
  if (!(eigen.values[0] < in_plane * directions.trace())) return std::nullopt;
  return Point<3>(eigen.vectors.col(0));
}

OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal) {
  OrientedPoints result;
  const std::optional<Stack> stack = find_stack(cloud.points, normal);
  if (!stack) return result;
  std::vector<Point<3>> places;
  std::vector<Point<3>> directions;
  for (const bool last : {false, true}) {
    const std::size_t slice = last ? stack->begin.size() - 2 : 0;
    const auto first = stack->order.begin();
    const std::vector<Index> ids(first + static_cast<std::ptrdiff_t>(stack->begin[slice]),
                                 first + static_cast<std::ptrdiff_t>(stack->begin[slice + 1]));
    if (!goes_on(cloud, ids, normal, stack->apart)) continue;
    const Point<3> out = last ? normal : Point<3>(-normal);
    for (const Point<3>& x : places_inside(cloud, ids, normal, stack->apart)) {
      places.push_back(x + 0.5 * stack->apart * out);
      directions.push_back(out);
    }
  }
  result.points.resize(3, std::ssize(places));
  result.normals.resize(3, std::ssize(places));
  for (Index i = 0; i < std::ssize(places); ++i) {
    result.points.col(i) = places[i];
    result.normals.col(i) = directions[i];
  }
  return result;
}

}  // namespace csrbf
