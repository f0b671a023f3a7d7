#include "csrbf/surface/prepare/flat_ends.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/surface/prepare/planar_winding.hpp"
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
constexpr double grid_step = 0.5;        // of samples on flat ends, over the distance of slices ...
constexpr double most_places = 100000;   // ... and more where the box of a slice has more
constexpr double least_width = 0.75;     // largest distance from a contour within it, over the distance of slices ...
constexpr double closes_within = 2;      // ... and over how far a slope moves the wall in that distance: balls reach 2
constexpr Index on_curve = 5;            // points of a contour that spread along a line ...
constexpr double narrow_curve = 0.1;     // ... and have at most this ratio of variances across and along it
constexpr double closed_contours = 0.3;  // length of the mean normal of closed contours
constexpr double far_apart = 3;          // median distances to the nearest sample: more on a contour are rare
constexpr Index on_both_sides = 8;       // nearest points of a contour, of which one at least lies on either side
constexpr double flat_cap = 0.8;         // component of a normal across the slice
constexpr double cells_inside = 4;       // least distance of caps from contours, in halves of the step of the grid
constexpr double in_slice = 0.3;         // distances of slices: as thick as one may be
constexpr double within_contours = 1.5;  // times pi: half way between 1, on a contour, and 2

// Lengths of curve that points on it represent: half of the way to the nearest one on either side.
Eigen::VectorXd lengths_of_curve(const Points<2>& x, const Points<2>& outward, const KdTree<2>& tree) {
  Eigen::VectorXd lengths(x.cols());
  for (Index k = 0; k < x.cols(); ++k) {
    Index near[on_both_sides];
    double squared[on_both_sides];
    const Index found = tree.nearest(x.col(k), on_both_sides, near, squared);
    double sides[2] = {0, 0};
    for (Index j = 0; j < found; ++j) {
      const Point<2> to = x.col(near[j]) - x.col(k);
      double& side = sides[outward(0, k) * to[1] > outward(1, k) * to[0] ? 1 : 0];
      if (side == 0) side = std::sqrt(squared[j]);
    }
    lengths[k] = (sides[0] + sides[1]) / 2;
  }
  return lengths;
}

// Samples of a slice, seen from beyond the end of the stack.
struct SliceSamples {
  Points<2> x, outward;
  Eigen::VectorXd slope;   // component of normals beyond the end
  Eigen::VectorXd height;  // beyond the end

  [[nodiscard]] SliceSamples some(const std::vector<Index>& ids) const {
    return {x(Eigen::all, ids), outward(Eigen::all, ids), slope(ids), height(ids)};
  }
  [[nodiscard]] Eigen::VectorXd lengths() const { return lengths_of_curve(x, outward, KdTree<2>(x)); }
  [[nodiscard]] PlanarWinding winding(double cell) const { return {x, outward * lengths().asDiagonal(), cell}; }
};

// Those on contours, and those within: samples of a cap that closes the solid there.
struct EndSamples {
  SliceSamples contours, caps;
};

EndSamples split_caps(const SliceSamples& all, double cell) {
  const KdTree<2> tree(all.x);
  std::vector<double> nearest(all.x.cols(), 0);
  for (Index k = 0; k < all.x.cols(); ++k) {
    Index near[2];
    double squared[2];
    if (tree.nearest(all.x.col(k), 2, near, squared) == 2) nearest[k] = std::sqrt(squared[1]);
  }
  const double usual = median(std::vector(nearest));
  std::vector<Index> contours, doubtful, caps;
  for (Index k = 0; k < all.x.cols(); ++k)
    (nearest[k] > far_apart * usual || std::abs(all.slope[k]) > flat_cap ? doubtful : contours).push_back(k);
  if (std::ssize(contours) < on_curve) return {all, all.some({})};
  const SliceSamples sure = all.some(contours);
  const KdTree<2> tree_of_sure(sure.x);
  const PlanarWinding winding = sure.winding(cell);
  std::size_t alone = 0;  // few: they are a small contour where the wall is flat
  for (const Index k : doubtful) {
    const bool inside = winding.angle(all.x.col(k)) > within_contours * std::numbers::pi;
    const bool cap = inside && !tree_of_sure.any_within(all.x.col(k), cells_inside * cell);
    (cap ? caps : contours).push_back(k);
    if (cap && nearest[k] > far_apart * usual) ++alone;
  }
  if (3 * alone < caps.size()) {
    contours.insert(contours.end(), caps.begin(), caps.end());
    caps.clear();
  }
  std::sort(contours.begin(), contours.end());
  return {all.some(contours), all.some(caps)};
}

// A slice seen from beyond the end of the stack.
class EndSlice {
 public:
  EndSlice(const OrientedPoints& cloud, std::span<const Index> ids, const Points<3>& isolated, const Point<3>& out,
           double apart)
      : out_(out), u_(out.unitOrthogonal()), v_(out.cross(u_)), apart_(apart) {
    const Index n = std::ssize(ids);
    SliceSamples all{Points<2>(2, n), Points<2>(2, n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
    for (Index k = 0; k < n; ++k) {
      const auto p = cloud.points.col(ids[k]);
      const auto n_k = cloud.normals.col(ids[k]);
      all.x.col(k) << u_.dot(p), v_.dot(p);
      all.outward.col(k) << u_.dot(n_k), v_.dot(n_k);
      all.slope[k] = out.dot(n_k);
      all.height[k] = out.dot(p);
    }
    all.outward.colwise().normalize();
    height_ = all.height.mean();
    const Eigen::Vector2d extent = bounding_box<2>(all.x).extent();
    step_ = std::max(grid_step * apart, std::sqrt(extent.prod() / most_places));
    samples_ = split_caps(all, step_ / 2);
    lengths_ = samples_.contours.lengths();
    add_caps(isolated);
  }

  // Places on a grid within contours beyond which the solid goes on: half a spacing beyond the slice, or at the height
  // of samples of a cap.
  [[nodiscard]] std::vector<Point<3>> places() const {
    std::vector<Point<3>> result;
    const KdTree<2> tree(samples_.contours.x);
    if (!has_curves(tree)) return result;
    const std::vector<Inner> inside = find_inside(tree);
    const std::vector<std::vector<Index>> parts = parts_of(inside);
    const std::vector<double> heights = heights_of(inside, parts);
    const KdTree<2> caps(samples_.caps.x);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const double slope = slope_where_it_goes_on(inside, parts[p]);
      for (const Index i : parts[p]) {
        const Inner& place = inside[i];
        if (place.depth > (heights[p] - height_) * slope && !caps.any_within(place.x, step_))
          result.push_back(place.x[0] * u_ + place.x[1] * v_ + heights[p] * out_);
      }
    }
    return result;
  }

 private:
  struct Inner {
    Point<2> x;
    Index column, row;  // of the grid
    double depth;       // distance to the contour
    Index nearest;      // point of it
  };

  // Adds those of some points that lie within the contours, before the next slice.
  void add_caps(const Points<3>& points) {
    const PlanarWinding winding = samples_.contours.winding(step_ / 2);
    const KdTree<2> tree(samples_.contours.x);
    std::vector<Point<3>> found;
    for (Index i = 0; i < points.cols(); ++i) {
      const Point<3> p(u_.dot(points.col(i)), v_.dot(points.col(i)), out_.dot(points.col(i)));
      const double beyond = (p[2] - height_) / apart_;
      if (beyond > -in_slice && beyond < 1 && winding.angle(p.head<2>()) > within_contours * std::numbers::pi &&
          !tree.any_within(p.head<2>(), cells_inside * step_ / 2))
        found.push_back(p);
    }
    SliceSamples& caps = samples_.caps;
    const Index before = caps.x.cols();
    caps.x.conservativeResize(2, before + std::ssize(found));
    caps.height.conservativeResize(caps.x.cols());
    for (std::size_t i = 0; i < found.size(); ++i) {
      caps.x.col(before + static_cast<Index>(i)) = found[i].head<2>();
      caps.height[before + static_cast<Index>(i)] = found[i][2];
    }
  }

  // Whether points lie on curves; on a lattice they fill the slice.
  [[nodiscard]] bool has_curves(const KdTree<2>& tree) const {
    const Points<2>& x = samples_.contours.x;
    std::vector<double> ratios(x.cols());
    for (Index k = 0; k < x.cols(); ++k) {
      Index ids[on_curve];
      double squared[on_curve];
      const Index found = tree.nearest(x.col(k), on_curve, ids, squared);
      Points<2> around = x(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
      around.colwise() -= around.rowwise().mean().eval();
      const Eigen::Vector2d variance = symmetric_eigen_direct(Eigen::Matrix2d(around * around.transpose())).values;
      ratios[k] = variance[1] > 0 ? variance[0] / variance[1] : 1;
    }
    return median(std::move(ratios)) < narrow_curve;
  }

  // Places of the grid inside the contours, column by column.
  [[nodiscard]] std::vector<Inner> find_inside(const KdTree<2>& tree) const {
    const Box<2> box = bounding_box<2>(samples_.contours.x);
    const PlanarWinding winding = samples_.contours.winding(step_ / 2);
    const auto columns = static_cast<Index>(std::ceil(box.extent()[0] / step_));
    const auto rows = static_cast<Index>(std::ceil(box.extent()[1] / step_));
    std::vector<std::vector<Inner>> found(columns);
    parallel_for(columns, 1, [&](Index begin, Index end) {
      for (Index a = begin; a < end; ++a)
        for (Index b = 0; b < rows; ++b) {
          Inner inner{box.lo + step_ * Point<2>(static_cast<double>(a), static_cast<double>(b)), a, b, 0, 0};
          if (!(winding.angle(inner.x) > std::numbers::pi)) continue;
          double squared = 0;
          tree.nearest(inner.x, 1, &inner.nearest, &squared);
          inner.depth = std::sqrt(squared);
          found[a].push_back(inner);
        }
    });
    std::vector<Inner> result;
    for (const std::vector<Inner>& column : found) result.insert(result.end(), column.begin(), column.end());
    return result;
  }

  // Places that are connected, as indices.
  [[nodiscard]] static std::vector<std::vector<Index>> parts_of(const std::vector<Inner>& inside) {
    Index rows = 0;
    for (const Inner& place : inside) rows = std::max(rows, place.row + 1);
    const auto cell = [&](const Inner& place) { return place.column * rows + place.row; };
    DisjointSets joined(inside.size());
    std::size_t beside = 0;  // at a cell in the column before, or behind it
    for (std::size_t i = 0; i < inside.size(); ++i) {
      while (cell(inside[beside]) < cell(inside[i]) - rows) ++beside;
      if (cell(inside[beside]) == cell(inside[i]) - rows)
        joined.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(beside));
      if (i > 0 && inside[i].row > 0 && cell(inside[i - 1]) == cell(inside[i]) - 1)
        joined.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i - 1));
    }
    std::map<std::uint32_t, std::vector<Index>> members;
    for (std::size_t i = 0; i < inside.size(); ++i)
      members[joined.find(static_cast<std::uint32_t>(i))].push_back(static_cast<Index>(i));
    std::vector<std::vector<Index>> result;
    for (auto& [first, part] : members) result.push_back(std::move(part));
    return result;
  }

  // Where parts end: half a spacing beyond the slice, but where their caps have samples, there.
  [[nodiscard]] std::vector<double> heights_of(const std::vector<Inner>& inside,
                                               const std::vector<std::vector<Index>>& parts) const {
    Points<2> x(2, std::ssize(inside));
    std::vector<std::size_t> part_of(inside.size());
    for (std::size_t p = 0; p < parts.size(); ++p)
      for (const Index i : parts[p]) {
        x.col(i) = inside[i].x;
        part_of[i] = p;
      }
    const KdTree<2> tree(x);
    std::vector<std::vector<double>> caps(parts.size());
    for (Index k = 0; k < samples_.caps.x.cols(); ++k) {
      Index nearest = 0;
      double squared = 0;
      if (tree.nearest(samples_.caps.x.col(k), 1, &nearest, &squared) == 1)
        caps[part_of[nearest]].push_back(samples_.caps.height[k]);
    }
    std::vector<double> result;
    for (std::vector<double>& heights : caps)
      result.push_back(heights.empty() ? height_ + 0.5 * apart_ : median(std::move(heights)));
    return result;
  }

  // How far the wall moves inward per height around a part; infinite if the solid does not go on there.
  [[nodiscard]] double slope_where_it_goes_on(const std::vector<Inner>& inside, const std::vector<Index>& part) const {
    std::vector<Index> contour;
    double depth = 0;
    for (const Index i : part) {
      depth = std::max(depth, inside[i].depth);
      contour.push_back(inside[i].nearest);
    }
    std::sort(contour.begin(), contour.end());
    contour.erase(std::unique(contour.begin(), contour.end()), contour.end());
    const double sine = samples_.contours.slope(contour).mean();
    const double tangent = sine / std::sqrt(std::max(1e-6, 1 - sine * sine));
    const Point<2> sum = samples_.contours.outward(Eigen::all, contour) * lengths_(contour);
    const bool closed = sum.norm() < closed_contours * lengths_(contour).sum();
    const bool goes_on = depth > apart_ * std::max(least_width, closes_within * tangent);
    return closed && goes_on ? tangent : std::numeric_limits<double>::infinity();
  }

  Point<3> out_, u_, v_;
  double apart_, height_ = 0, step_ = 0;
  EndSamples samples_;
  Eigen::VectorXd lengths_;  // of contours
};

}  // namespace

OrientedPoints flat_ends(const OrientedPoints& cloud, const Point<3>& normal, const Points<3>& isolated) {
  OrientedPoints result;
  const std::optional<SliceStack> stack = find_slices(cloud.points, normal);
  if (!stack) return result;
  std::vector<Point<3>> places, directions;
  for (const bool last : {false, true}) {
    const Point<3> out = last ? normal : Point<3>(-normal);
    const EndSlice end(cloud, stack->slice(last ? stack->slices() - 1 : 0), isolated, out, stack->apart);
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
