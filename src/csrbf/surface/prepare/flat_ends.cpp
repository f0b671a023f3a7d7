#include "csrbf/surface/prepare/flat_ends.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/surface/prepare/slice_stack.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double grid_step = 0.5;        // of samples on flat ends, over the distance of slices
constexpr double most_terms = 2e8;       // of winding numbers
constexpr double least_width = 0.75;     // largest distance from a contour within it, over the distance of slices ...
constexpr double closes_within = 2;      // ... and over how far a slope moves the wall in that distance: balls reach 2
constexpr Index on_curve = 5;            // points of a contour that spread along a line ...
constexpr double narrow_curve = 0.1;     // ... and have at most this ratio of variances across and along it
constexpr double closed_contours = 0.3;  // length of the mean normal of closed contours

// A slice seen from beyond the end of the stack.
class EndSlice {
 public:
  EndSlice(const OrientedPoints& cloud, std::span<const Index> ids, const Point<3>& out, double apart)
      : out_(out),
        u_(out.unitOrthogonal()),
        v_(out.cross(u_)),
        apart_(apart),
        x_(2, std::ssize(ids)),
        outward_(2, std::ssize(ids)),
        slope_(std::ssize(ids)) {
    for (Index k = 0; k < x_.cols(); ++k) {
      const auto p = cloud.points.col(ids[k]);
      const auto n = cloud.normals.col(ids[k]);
      x_.col(k) << u_.dot(p), v_.dot(p);
      outward_.col(k) << u_.dot(n), v_.dot(n);
      slope_[k] = out.dot(n);
      height_ += out.dot(p) / static_cast<double>(x_.cols());
    }
    outward_.colwise().normalize();
  }

  // Places on a grid within contours beyond which the solid goes on, half a spacing beyond the slice.
  [[nodiscard]] std::vector<Point<3>> places() const {
    std::vector<Point<3>> result;
    const KdTree<2> tree(x_);
    if (!has_curves(tree)) return result;
    for (const std::vector<Inner>& part : parts(tree)) {
      const double slope = slope_where_it_goes_on(part);
      for (const Inner& place : part)
        if (place.depth > 0.5 * apart_ * slope)
          result.push_back(place.x[0] * u_ + place.x[1] * v_ + (height_ + 0.5 * apart_) * out_);
    }
    return result;
  }

 private:
  struct Inner {
    Point<2> x;
    double depth;   // distance to the contour
    Index nearest;  // point of it
  };

  // Whether points lie on curves; on a lattice they fill the slice.
  [[nodiscard]] bool has_curves(const KdTree<2>& tree) const {
    std::vector<double> ratios(x_.cols());
    for (Index k = 0; k < x_.cols(); ++k) {
      Index ids[on_curve];
      double squared[on_curve];
      const Index found = tree.nearest(x_.col(k), on_curve, ids, squared);
      Points<2> around = x_(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
      around.colwise() -= around.rowwise().mean().eval();
      const Eigen::Vector2d variance = symmetric_eigen_direct(Eigen::Matrix2d(around * around.transpose())).values;
      ratios[k] = variance[1] > 0 ? variance[0] / variance[1] : 1;
    }
    return median(std::move(ratios)) < narrow_curve;
  }

  // Connected parts of the inside of the contours, by the winding number in the plane.
  [[nodiscard]] std::vector<std::vector<Inner>> parts(const KdTree<2>& tree) const {
    const Box<2> box = bounding_box<2>(x_);
    const double step = grid_step * apart_;
    const Eigen::Array2d cells = (box.extent().array() / step).ceil();
    if (cells.prod() * static_cast<double>(x_.cols()) > most_terms) return {};
    Points<2> dipoles = outward_;
    for (Index k = 0; k < x_.cols(); ++k) {
      Index near[3];
      double squared[3];
      const Index found = tree.nearest(x_.col(k), 3, near, squared);
      dipoles.col(k) *= found < 3 ? 0 : (std::sqrt(squared[1]) + std::sqrt(squared[2])) / 2;
    }
    const auto columns = static_cast<Index>(cells[0]), rows = static_cast<Index>(cells[1]);
    std::vector<Inner> inside;
    std::vector<Index> at(columns * rows, -1);
    for (Index a = 0; a < columns; ++a)
      for (Index b = 0; b < rows; ++b) {
        const Point<2> place = box.lo + step * Point<2>(static_cast<double>(a), static_cast<double>(b));
        const Points<2> to = x_.colwise() - place;
        const double winding =
            (to.cwiseProduct(dipoles).colwise().sum().array() / to.colwise().squaredNorm().array()).sum();
        if (!(winding > std::numbers::pi)) continue;
        Inner inner{place, 0, 0};
        double squared = 0;
        tree.nearest(place, 1, &inner.nearest, &squared);
        inner.depth = std::sqrt(squared);
        at[a * rows + b] = std::ssize(inside);
        inside.push_back(inner);
      }
    DisjointSets joined(inside.size());
    const auto join = [&](Index i, Index j) {
      if (at[i] >= 0 && at[j] >= 0) joined.unite(static_cast<std::uint32_t>(at[i]), static_cast<std::uint32_t>(at[j]));
    };
    for (Index a = 0; a < columns; ++a)
      for (Index b = 0; b < rows; ++b) {
        if (a > 0) join(a * rows + b, (a - 1) * rows + b);
        if (b > 0) join(a * rows + b, a * rows + b - 1);
      }
    std::map<std::uint32_t, std::vector<Inner>> members;
    for (std::size_t i = 0; i < inside.size(); ++i)
      members[joined.find(static_cast<std::uint32_t>(i))].push_back(inside[i]);
    std::vector<std::vector<Inner>> result;
    for (auto& [first, part] : members) result.push_back(std::move(part));
    return result;
  }

  // How far the wall moves inward per height around a part; infinite if the solid does not go on there.
  [[nodiscard]] double slope_where_it_goes_on(const std::vector<Inner>& part) const {
    std::vector<Index> contour;
    double depth = 0;
    for (const Inner& place : part) {
      depth = std::max(depth, place.depth);
      contour.push_back(place.nearest);
    }
    std::sort(contour.begin(), contour.end());
    contour.erase(std::unique(contour.begin(), contour.end()), contour.end());
    const double sine = slope_(contour).mean();
    const double tangent = sine / std::sqrt(std::max(1e-6, 1 - sine * sine));
    const bool closed = Points<2>(outward_(Eigen::all, contour)).rowwise().mean().norm() < closed_contours;
    const bool goes_on = depth > apart_ * std::max(least_width, closes_within * tangent);
    return closed && goes_on ? tangent : std::numeric_limits<double>::infinity();
  }

  Point<3> out_, u_, v_;
  double apart_, height_ = 0;
  Points<2> x_, outward_;
  Eigen::VectorXd slope_;  // component of normals beyond the end
};

}  // namespace

OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal) {
  OrientedPoints result;
  const std::optional<SliceStack> stack = find_slices(cloud.points, normal);
  if (!stack) return result;
  std::vector<Point<3>> places, directions;
  for (const bool last : {false, true}) {
    const Point<3> out = last ? normal : Point<3>(-normal);
    const EndSlice end(cloud, stack->slice(last ? stack->slices() - 1 : 0), out, stack->apart);
    for (const Point<3>& place : end.places()) {
      places.push_back(place);
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
